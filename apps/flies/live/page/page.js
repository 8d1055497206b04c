import { drawLeft, drawTop, Trails } from "./draw.js";

const $ = (id) => document.getElementById(id);

const kSliders = {
  "evolve.flies": { name: "Flies", min: 500, max: 20000, step: 500 },
  "field.x_max_m": { name: "Look ahead, metres", min: 10, max: 100, step: 5 },
  "classify.threshold_offset": { name: "Strictness about people", min: -3, max: 5, step: 0.1 },
  "track.min_probability": { name: "Sureness of tracks", min: 0, max: 0.95, step: 0.05 },
};

const shown = { run: null, number: null, changes: null, state: null, flies: null };
let trails = new Trails();
let isPaused = false;

// ---- what the program is asked and told

async function get(path) {
  const answer = await fetch(path, { signal: AbortSignal.timeout(5000) });
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer;
}

async function order(path, body = {}) {
  $("fault").textContent = "";
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Flies": "page" },
      body: JSON.stringify(body),
    });
    if (!answer.ok) $("fault").textContent = (await answer.text()).trim();
  } catch {
    $("fault").textContent = "The program cannot be reached.";
  }
}

function setConnection(text, isLost) {
  if ($("connection").textContent !== text) $("connection").textContent = text;
  $("connection").classList.toggle("lost", isLost);
}

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Shows pair after pair; when the program is gone, tries until it is back. */
async function follow() {
  while (true) {
    try {
      const query = new URLSearchParams();
      if (shown.number !== null) query.set("after", shown.number);
      if (shown.changes !== null) query.set("changes", shown.changes);
      const state = await (await get(`api/state?${query}`)).json();
      if (state.run !== shown.run) startAnew(state.run);
      await show(state);
      setConnection(state.is_paused ? "paused" : "connected", false);
    } catch (error) {
      setConnection("connection lost, trying again", true);
      await sleep(1000);
    }
  }
}

function startAnew(run) {
  Object.assign(shown, { run, number: null, changes: null, state: null, flies: null });
  trails = new Trails();
}

// ---- what is shown

async function show(state) {
  if (state.changes !== shown.changes) {
    shown.changes = state.changes;
    showControls(state);
    showNotes(state.notes);
  }
  if (state.number === undefined || state.number === shown.number) return;
  const swarm = $("flies").checked ? (await (await get(`api/flies?number=${state.number}`)).json()).flies : null;
  const image = await picture(state.number);
  shown.image?.close(); // holds a picture's memory until then
  shown.flies = swarm;
  shown.number = state.number;
  shown.state = state;
  shown.image = image;
  trails.add(state);
  draw();
  showRates(state.rates);
  showTracks(state.record.tracks);
  summarise(state.record);
  document.body.dataset.number = state.number;
}

async function picture(number) {
  return createImageBitmap(await (await get(`api/left.jpg?number=${number}`)).blob());
}

function draw() {
  const { state, image, flies } = shown;
  if (!state) return;
  drawLeft($("left"), image, state, flies);
  drawTop($("top"), state, trails.ofVehicle(state.pose), flies);
}

function showControls(state) {
  isPaused = state.is_paused;
  $("pause").textContent = isPaused ? "Go on" : "Pause";
  $("step").disabled = !isPaused;
  for (const [path, { value, meaning }] of Object.entries(state.options ?? {})) showOption(path, value, meaning);
}

function showOption(path, value, meaning) {
  const id = `option-${path.replace(".", "-")}`;
  let slider = $(id);
  if (!slider) {
    const { name, min, max, step } = kSliders[path];
    const row = document.createElement("div");
    row.className = "option";
    const label = Object.assign(document.createElement("label"), { htmlFor: id, textContent: name, title: meaning });
    const output = Object.assign(document.createElement("output"), { id: `${id}-value` });
    slider = Object.assign(document.createElement("input"), { id, type: "range", min, max, step });
    slider.addEventListener("input", () => (output.textContent = slider.value));
    slider.addEventListener("change", () => order("api/option", { path, value: slider.value }));
    row.append(label, output, slider);
    $("options").append(row);
  }
  if (document.activeElement !== slider || Number(slider.value) !== value) slider.value = value;
  $(`${id}-value`).textContent = String(value);
}

function showNotes(notes) {
  const list = $("notes");
  while (list.children.length > notes.length) list.lastChild.remove();
  notes.forEach((note, i) => {
    const item = list.children[i] ?? list.appendChild(document.createElement("li"));
    if (item.textContent !== note) item.textContent = note;
  });
}

function showRates({ pairs_hz, latency_ms, latency_p99_ms, dropped, broken, losses }) {
  const parts = [`${pairs_hz.toFixed(1)} pairs a second`,
    `latency ${latency_ms.toFixed(1)} ms, 99 %: ${latency_p99_ms.toFixed(1)} ms`, `${dropped} dropped`];
  if (broken > 0) parts.push(`${broken} broken`);
  if (losses > 0) parts.push(`source gone ${losses} times`);
  $("rates").textContent = parts.join("; ");
}

function showTracks(tracks) {
  const rows = tracks.map((track) => {
    const row = document.createElement("tr");
    row.className = track.class;
    const speed = Math.hypot(track.vx_mps, track.vy_mps);
    for (const text of [track.id, track.class === "person" ? "person" : "thing", `${track.x_m.toFixed(1)} m`,
      `${track.y_m.toFixed(1)} m`, `${speed.toFixed(1)} m/s`, `${(100 * track.probability).toFixed(0)} %`])
      row.append(Object.assign(document.createElement("td"), { textContent: text }));
    return row;
  });
  $("tracks").replaceChildren(...rows);
}

/** In words, for who does not see the pictures: not more often than can be read aloud. */
const kReadAloud_ms = 5000;
let summary = "", summaryTimer = null;
function summarise({ obstacles, pedestrians }) {
  const count = (n, one, many) => `${n} ${n === 1 ? one : many}`;
  summary = `${count(obstacles.length, "obstacle", "obstacles")}, ${count(pedestrians.length, "person", "people")}`;
  if (obstacles.length > 0) summary += `; nearest obstacle ${obstacles[0].range_m.toFixed(1)} m`;
  if (pedestrians.length > 0) summary += `, nearest person ${pedestrians[0].range_m.toFixed(1)} m`;
  $("left").setAttribute("aria-label", `Left picture with what was found: ${summary}`);
  $("top").setAttribute("aria-label", `View from above: ${summary}`);
  if (summaryTimer !== null) return;
  $("summary").textContent = summary;
  summaryTimer = setTimeout(() => {
    summaryTimer = null;
    $("summary").textContent = summary;
  }, kReadAloud_ms);
}

// ---- what the user does

const togglePause = () => order(isPaused ? "api/resume" : "api/pause");
const step = () => order("api/step");

async function toggleFlies() {
  shown.flies = null;
  if ($("flies").checked && shown.number !== null)
    shown.flies = (await (await get(`api/flies?number=${shown.number}`)).json()).flies;
  draw();
}

async function save() {
  try {
    const blob = await (await get(`api/report.zip?number=${shown.number}`)).blob();
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: `flies-pair-${shown.number}.zip` });
    link.click();
    URL.revokeObjectURL(link.href);
  } catch (error) {
    $("fault").textContent = error.message;
  }
}

$("pause").addEventListener("click", togglePause);
$("step").addEventListener("click", step);
$("save").addEventListener("click", save);
$("flies").addEventListener("change", () => toggleFlies().catch(() => {}));
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input[type=text], textarea")) return;
  if (event.key === "p") togglePause();
  if (event.key === "s" && isPaused) step();
  if (event.key === "f") $("flies").click();
});

follow();
