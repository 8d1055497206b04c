import { drawLeft, drawTop, Trails } from "./draw.js";

const $ = (id) => document.getElementById(id);

const kSliders = {
  "evolve.flies": { name: "Flies", min: 500, max: 20000, step: 500 },
  "field.x_max_m": { name: "Look ahead, metres", min: 10, max: 100, step: 5 },
  "classify.threshold_offset": { name: "Strictness about people", min: -3, max: 5, step: 0.1 },
  "track.min_probability": { name: "Minimum certainty of tracks", min: 0, max: 0.95, step: 0.05 },
};

const shown = { run: null, number: null, changes: null, state: null, flies: null };
const sliders = {}; // by path
let trails = new Trails();
let isPaused = false;

// ---- what the program is asked and told

async function get(path) {
  const answer = await fetch(path, { signal: AbortSignal.timeout(5000) });
  if (!answer.ok) throw Object.assign(new Error((await answer.text()).trim()), { status: answer.status });
  return answer;
}

/** Returns whether the order was taken. */
async function order(path, body = {}) {
  $("fault").textContent = "";
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Flies": "page" },
      body: JSON.stringify(body),
      signal: AbortSignal.timeout(5000),
    });
    if (!answer.ok) $("fault").textContent = (await answer.text()).trim();
    return answer.ok;
  } catch {
    $("fault").textContent = "The program cannot be reached.";
    return false;
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
      const isAnother = shown.run !== null && state.run !== shown.run;
      if (state.run !== shown.run) startAnew(state.run);
      if (isAnother) continue; // what was asked for was what has changed since the run before
      await show(state);
      setConnection(state.is_paused ? "paused" : "connected", false);
    } catch (error) {
      const isForeign = error.status === 403; // the program was started anew, with another token
      const refusal = `${error.message} Open the address that the program prints now.`;
      setConnection(isForeign ? refusal : "connection lost, trying again", true);
      await sleep(1000);
    }
  }
}

function startAnew(run) {
  Object.assign(shown, { run, number: null, changes: null, state: null, flies: null });
  trails = new Trails();
  $("save").disabled = true;
}

// ---- what is shown

async function show(state) {
  if (state.changes !== shown.changes) {
    shown.changes = state.changes;
    showControls(state);
    showNotes(state.notes);
  }
  if (state.number === undefined || state.number === shown.number) return;
  const pair = await pairOf(state.number);
  if (!pair) return;
  shown.image?.close(); // holds a picture's memory until then
  shown.flies = pair.flies;
  shown.number = state.number;
  shown.state = state;
  shown.image = pair.image;
  $("save").disabled = false;
  trails.add(state);
  draw();
  showRates(state.rates);
  showTracks(state.record.tracks);
  summarise(state.record);
  document.body.dataset.number = state.number;
}

/** Picture and flies; null when newer pairs have displaced this one. */
async function pairOf(number) {
  try {
    const [image, flies] = await Promise.all([picture(number), $("flies").checked ? fliesOf(number) : null]);
    return { image, flies };
  } catch (error) {
    if (error.status === 404) return null;
    throw error;
  }
}

async function picture(number) {
  return createImageBitmap(await (await get(`api/left.jpg?number=${number}`)).blob());
}

async function fliesOf(number) {
  return (await (await get(`api/flies?number=${number}`)).json()).flies;
}

function draw() {
  const { state, image, flies } = shown;
  if (!state) return;
  drawLeft($("left"), image, state, flies);
  drawTop($("top"), state, trails.ofVehicle(state.pose), flies);
}

function showControls(state) {
  isPaused = state.is_paused;
  $("pause").textContent = isPaused ? "Resume" : "Pause";
  $("step").disabled = !isPaused;
  for (const [path, { value, meaning }] of Object.entries(state.options ?? {})) showOption(path, value, meaning);
}

function showOption(path, value, meaning) {
  const slider = (sliders[path] ??= newSlider(path, meaning));
  slider.told = value;
  showTold(slider);
}

/** Unless a hand is on the slider, or the program has yet to say what it thinks of its last move. */
function showTold({ input, output, told, isHeld, orders }) {
  if (isHeld || orders > 0) return;
  input.value = told;
  output.textContent = String(told);
}

function newSlider(path, meaning) {
  const id = `option-${path.replace(".", "-")}`;
  const { name, min, max, step } = kSliders[path];
  const row = document.createElement("div");
  row.className = "option";
  const label = Object.assign(document.createElement("label"), { htmlFor: id, textContent: name, title: meaning });
  const output = Object.assign(document.createElement("output"), { id: `${id}-value` });
  const input = Object.assign(document.createElement("input"), { id, type: "range", min, max, step });
  row.append(label, output, input);
  $("options").append(row);
  const slider = { input, output, told: null, isHeld: false, orders: 0 };
  input.addEventListener("input", () => {
    slider.isHeld = true;
    output.textContent = input.value;
  });
  input.addEventListener("change", () => moved(slider, path));
  for (const end of ["pointerup", "pointercancel", "blur"]) // of a move that changed nothing
    input.addEventListener(end, () => (slider.isHeld = false));
  return slider;
}

async function moved(slider, path) {
  slider.isHeld = false;
  ++slider.orders;
  const isTaken = await order("api/option", { path, value: slider.input.value });
  --slider.orders;
  if (!isTaken) showTold(slider);
}

function showNotes(notes) {
  const list = $("notes");
  while (list.children.length > notes.length) list.lastChild.remove();
  notes.forEach((note, i) => {
    const item = list.children[i] ?? list.appendChild(document.createElement("li"));
    if (item.textContent !== note) item.textContent = note;
  });
}

function showRates({ pairs_hz, latency_ms, latency_p99_ms, dropped, skipped, broken, losses }) {
  const parts = [`${pairs_hz.toFixed(1)} pairs per second`,
    `latency ${latency_ms.toFixed(1)} ms, 99 %: ${latency_p99_ms.toFixed(1)} ms`, `${dropped} dropped`];
  if (skipped > 0) parts.push(`${skipped} not read in time`);
  if (broken > 0) parts.push(`${broken} broken`);
  if (losses > 0) parts.push(`source lost ${losses} times`);
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
    shown.flies = await fliesOf(shown.number);
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
window.addEventListener("resize", draw);
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input[type=text], textarea")) return;
  if (event.key === "p") togglePause();
  if (event.key === "s" && isPaused) step();
  if (event.key === "f") $("flies").click();
});

follow();
