// page_test.mjs FLIES WORK: the page in headless Chromium; screenshots stay in WORK. Exit status 77: skipped.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [flies, work] = process.argv.slice(2);

function skip(reason) {
  console.log(`SKIP_ ${reason}`);
  process.exit(77);
}

const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
if (!browserPath) skip("there is no chromium");
let chromium;
try {
  const require = createRequire(join(process.env.FLIES_NODE_MODULES, "..", "x.js"));
  ({ chromium } = require("playwright-core"));
} catch {
  skip("there is no playwright-core; scripts/install-node-tools installs it");
}

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });

function painted() {
  const words = ["synth", "street", "--sequence", "--seed", "3", "--frames", "12", "--width_px", "640", "--height_px", "240",
    "--focal_px", "400"];
  assert.equal(spawnSync(flies, words, { cwd: work }).status, 0);
}

/** Starts the program and waits until it says where its page is. */
function start(port, more = []) {
  const words = ["live", "street/left", "street/right", "--calib", "street/calib.yaml", "--loop", "--rate", "10",
    "--view", String(port), "--json", "out.jsonl", ...more];
  const child = spawn(flies, words, { cwd: work, stdio: ["ignore", "ignore", "pipe"] });
  const ended = new Promise((resolve) => child.on("exit", (code) => resolve(code)));
  return new Promise((resolve, reject) => {
    let text = "";
    child.stderr.on("data", (data) => {
      text += data;
      const address = /page at (\S+)/.exec(text)?.[1];
      if (address) resolve({ child, ended, address, said: () => text });
    });
    ended.then((code) => reject(new Error(`flies ended with ${code}: ${text}`)));
  });
}

async function stop(run) {
  run.child.kill("SIGINT");
  assert.equal(await run.ended, 0, "SIGINT ends cleanly");
}


/** Is there a pixel of this colour, or nearly, along the box's left edge? */
async function edgeIsPainted(page, box, isRight) {
  return page.evaluate(([{ u_px, v_px, height_px }, test]) => {
    const canvas = document.getElementById("left");
    const context = canvas.getContext("2d");
    const u = Math.min(canvas.width - 2, Math.max(1, Math.round(u_px)));
    let hits = 0, rows = 0;
    for (let v = Math.max(0, Math.round(v_px) + 2); v < Math.min(canvas.height, v_px + height_px - 2); v += 2, ++rows) {
      const pixels = context.getImageData(u - 1, v, 3, 1).data;
      const coloured = [0, 4, 8].some((i) => {
        const [r, g, b] = pixels.slice(i, i + 3);
        return test === "person" ? r > 150 && b > 150 && g < 140 : Math.max(r, g, b) - Math.min(r, g, b) > 60;
      });
      if (coloured) ++hits;
    }
    return rows === 0 ? null : hits / rows;
  }, [box, isRight]);
}

// A program under a sanitizer takes many times as long.
const patience = Number(process.env.FLIES_PATIENCE ?? 1);
const until = (page, test, argument) => page.waitForFunction(test, argument, { timeout: 20000 * patience });

const numberOf = (page) => page.evaluate(() => Number(document.body.dataset.number));

/** The number at which a page stands still, once pairs that were under way are shown; ten a second come while it runs. */
async function standingNumber(page) {
  for (let i = 0, before = -1; i < 10; ++i) {
    const now = await numberOf(page);
    if (now === before) return now;
    before = now;
    await page.waitForTimeout(700);
  }
  assert.fail("the page does not stand still");
}

/** Presses "Save report". Returns the folder that the report is unpacked into, or null where nothing unpacks it. */
async function savedReport(page, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
  const report = join(work, `${name}.zip`);
  await download.saveAs(report);
  assert.match(download.suggestedFilename(), /^flies-pair-\d+\.zip$/);
  const folder = join(work, name);
  return spawnSync("python3", ["-m", "zipfile", "-e", report, folder]).status === 0 ? folder : null;
}

/** The whole lines of the output so far. */
function records() {
  const path = join(work, "out.jsonl");
  return existsSync(path) ? readFileSync(path, "utf8").split("\n").slice(0, -1).map((line) => JSON.parse(line)) : [];
}

painted();
let run = await start(0);
const port = new URL(run.address).port;
const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
const complaints = [];
let isRefusalDue = false;
page.on("console", (message) => {
  const isDue = isRefusalDue && /net::ERR|Failed to load resource/.test(message.text());
  if (message.type() === "error" && !isDue) complaints.push(message.text());
});
page.on("pageerror", (error) => complaints.push(String(error)));

try {
  // Pairs come and are shown.
  await page.goto(run.address);
  await until(page, () => Number(document.body.dataset.number) > 8);
  assert.equal(await page.textContent("#connection"), "connected");
  assert.match(await page.textContent("#rates"), /^\d+\.\d pairs per second; latency .* dropped/);
  assert.match(await page.textContent("#summary"), /^\d+ obstacles, \d+ (person|people); nearest obstacle [0-9.]+ m/);
  assert.ok((await page.locator("#tracks tr").count()) > 3);

  // A paused page stands still, by the keyboard, and a step goes on by one.
  await page.keyboard.press("p");
  await until(page, () => document.getElementById("connection").textContent === "paused");
  assert.equal(await page.textContent("#pause"), "Resume");
  const paused = await standingNumber(page);
  await page.locator("#step").focus();
  await page.keyboard.press("Enter");
  await until(page, (number) => Number(document.body.dataset.number) === number, paused + 1);

  // Boxes are where the JSON says. Steps go on, by the key, to a pair in which someone is seen.
  const newestRecord = () => records().at(-1);
  let shownNumber = await standingNumber(page);
  for (let i = 0; i < 12 && newestRecord().pedestrians.length === 0; ++i) {
    await page.keyboard.press("s");
    await until(page, (number) => Number(document.body.dataset.number) === number, ++shownNumber);
  }
  const record = newestRecord();
  assert.equal(record.frame, shownNumber);
  assert.ok(record.obstacles.length > 3 && record.pedestrians.length > 0);
  const canvas = await page.evaluate(() => [document.getElementById("left").width, document.getElementById("left").height]);
  assert.deepEqual(canvas, [640, 240]);
  const person = record.pedestrians[0];
  assert.ok((await edgeIsPainted(page, person.box, "person")) > 0.6, "the nearest person has its box");
  const nearest = record.obstacles[0];
  assert.ok((await edgeIsPainted(page, nearest.box, "other")) > 0.6, "the nearest obstacle has its box");
  const shownTracks = await page.locator("#tracks tr").evaluateAll((rows) => rows.map((row) => row.cells[0].textContent));
  assert.deepEqual(shownTracks, record.tracks.map(({ id }) => String(id)));

  const people = record.pedestrians.length;
  const words = `${record.obstacles.length} obstacles, ${people} ${people === 1 ? "person" : "people"}; nearest`;
  await until(page, (text) => document.getElementById("summary").textContent.startsWith(text), words);

  await page.screenshot({ path: join(work, "page-1280.png"), fullPage: true });

  // The report holds what it takes to see the pair again.
  const report = await savedReport(page, "report");
  if (report) {
    const again = spawnSync(flies, ["detect", "left.png", "right.png", "--calib", "calib.yaml", "--options",
      "options.yaml", "--json", "-"], { cwd: report, encoding: "utf8" });
    assert.equal(again.status, 0, again.stderr);
    assert.ok(JSON.parse(again.stdout).obstacles.length > 3);
    assert.equal(JSON.parse(readFileSync(join(report, "result.json"))).frame, shownNumber);
  }

  // Flies are shown on request, a slider changes an option, a fault is told.
  const before = await page.evaluate(() => document.getElementById("top").toDataURL());
  await page.keyboard.press("f");
  await until(page, (old) => document.getElementById("top").toDataURL() !== old, before);
  await page.screenshot({ path: join(work, "page-flies.png") });
  await page.keyboard.press("f");
  await page.locator("#option-evolve-flies").focus();
  await page.keyboard.press("ArrowRight");
  await until(page, () => document.getElementById("option-evolve-flies-value").textContent === "3500");

  // A report has the options that its pair was seen with, not those of now.
  const later = await savedReport(page, "report-later");
  if (later) {
    const options = [report, later].map((folder) => readFileSync(join(folder, "options.yaml"), "utf8"));
    assert.equal(options[1], options[0]);
  }

  // An order that is refused is told, whatever is folded away, and the slider goes back.
  isRefusalDue = true;
  await page.evaluate(() => {
    document.querySelector("details").open = false;
    const slider = document.getElementById("option-evolve-flies");
    slider.max = 1e9;
    slider.value = 1e9;
    slider.dispatchEvent(new Event("input"));
    slider.dispatchEvent(new Event("change"));
  });
  await page.waitForSelector("#fault:not(:empty)", { state: "visible", timeout: 20000 });
  await until(page, () => document.getElementById("option-evolve-flies-value").textContent === "3500");
  assert.equal(await page.inputValue("#option-evolve-flies"), "3500");
  await page.evaluate(() => {
    document.querySelector("details").open = true;
    document.getElementById("option-evolve-flies").max = 20000;
  });
  isRefusalDue = false;

  await page.keyboard.press("p");
  await until(page, (number) => Number(document.body.dataset.number) > number + 5, shownNumber);
  // The server keeps the last twenty pairs: a busy machine may show an older one, so the page stands still again.
  await page.keyboard.press("p");
  await until(page, () => document.getElementById("connection").textContent === "paused");
  await standingNumber(page);
  const flyCount = await page.evaluate(async () =>
    (await (await fetch(`api/flies?number=${document.body.dataset.number}`)).json()).flies.length);
  assert.equal(flyCount, 3500);
  await page.keyboard.press("p");
  await until(page, () => document.getElementById("connection").textContent === "connected");
  assert.equal(await page.textContent("#fault"), "");

  // Other sites reach nothing.
  const refused = await fetch(`http://127.0.0.1:${port}/api/pause`, { method: "POST" });
  assert.equal(refused.status, 403);
  assert.equal((await fetch(`http://127.0.0.1:${port}/nothing`)).status, 404);

  // Narrow: one column, nothing sticks out.
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 390), "no scrolling sideways");
  const tables = await page.evaluate(() => [...document.querySelectorAll(".scroll")].map((box) => box.scrollWidth - box.clientWidth));
  assert.ok(tables.length > 0 && tables.every((hidden_px) => hidden_px <= 0), `columns are cut off: ${tables}`);
  const letters_px = await page.evaluate(() => ["left", "top"].map((id) => {
    const canvas = document.getElementById(id);
    return parseFloat(canvas.getContext("2d").font) * canvas.clientWidth / canvas.width;
  }));
  assert.ok(letters_px.every((size_px) => size_px > 10), `letters in pictures can be read: ${letters_px}`);
  await page.screenshot({ path: join(work, "page-390.png"), fullPage: true });

  // Everything that can be used is reached by the keyboard and has a name.
  const names = await page.evaluate(() => [...document.querySelectorAll("button, input")].map((element) =>
    (element.labels?.[0]?.textContent ?? element.textContent).trim()));
  assert.ok(names.length >= 8 && names.every((name) => name.length > 2), names.join());
  await page.evaluate(() => document.activeElement.blur());
  const reached = new Set();
  for (let i = 0; i < 12; ++i) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.tagName));
  }
  for (const id of ["pause", "save", "flies", "option-evolve-flies"]) assert.ok(reached.has(id), `${id} by Tab: ${[...reached]}`);

  // The program stops and comes back: so does the page.
  isRefusalDue = true;
  await stop(run);
  await until(page, () => document.getElementById("connection").textContent.includes("lost"));
  run = await start(Number(port));
  await until(page, () => document.getElementById("connection").textContent === "connected");
  await until(page, () => Number(document.body.dataset.number) > 2);
  const sliders = await page.evaluate(async () => {
    const { options } = await (await fetch("api/state")).json();
    return Object.entries(options).map(([path, { value }]) => {
      const slider = document.getElementById(`option-${path.replace(".", "-")}`);
      return { path, value, shown: Number(slider.value), step: Number(slider.step) };
    });
  });
  for (const { path, value, shown, step } of sliders)
    assert.ok(Math.abs(shown - value) <= step, `${path} of the new run: ${shown}, ${value}`);

  assert.deepEqual(complaints, [], "nothing in the browser's console");
  await stop(run);
  console.log("the page shows what the program sees");
} catch (error) {
  await page.screenshot({ path: join(work, "page-failed.png"), fullPage: true }).catch(() => {});
  console.error(error, complaints, run.said());
  run.child.kill("SIGKILL");
  process.exitCode = 1;
} finally {
  await browser.close();
}

// At an address that others reach, a token is asked for.
if (!process.exitCode) {
  run = await start(0, ["--view-address", "0.0.0.0"]);
  const address = new URL(run.address);
  const open = `http://127.0.0.1:${address.port}/`;
  assert.equal((await fetch(open)).status, 403);
  const allowed = await fetch(open + address.search);
  assert.equal(allowed.status, 200);
  const cookie = allowed.headers.get("set-cookie").split(";")[0];
  assert.equal((await fetch(`${open}page.js`, { headers: { cookie } })).status, 200);

  // Started anew it has another token: the page says so, and goes on once the new address was opened.
  const browser = await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox"] });
  try {
    const context = await browser.newContext();
    const page = await context.newPage();
    await page.goto(open + address.search);
    await until(page, () => document.getElementById("connection").textContent === "connected");
    await stop(run);
    run = await start(Number(address.port), ["--view-address", "0.0.0.0"]);
    await until(page, () => document.getElementById("connection").textContent.includes("Open the address"));
    await (await context.newPage()).goto(open + new URL(run.address).search);
    await until(page, () => document.getElementById("connection").textContent === "connected");
    await stop(run);
  } catch (error) {
    console.error(error, run.said());
    run.child.kill("SIGKILL");
    process.exitCode = 1;
  } finally {
    await browser.close();
  }
}

// What is set before the camera is known goes on top of what fits it; numbers and counts go on over a change.
if (!process.exitCode) {
  rmSync(join(work, "out.jsonl"));
  run = await start(0, ["--camera-height", "0.5", "--mount", "given"]);
  const setFlies = (value) => fetch(`${run.address}api/option`, { method: "POST", headers: { "X-Flies": "page" },
    body: JSON.stringify({ path: "evolve.flies", value }) });
  const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  const worked = async (value, count) => {
    for (let i = 0; i < 200; ++i, await pause(100)) {
      const found = records().filter(({ run: made }) => made.options["evolve.flies"] === value);
      if (found.length >= count) return found;
    }
    assert.fail(`${count} pairs with ${value} flies`);
  };
  try {
    for (let i = 0; i < 100 && !(await setFlies("3500")).ok; ++i) await pause(20);
    const early = await worked(3500, 8);
    for (const { run: made } of early) assert.ok(made.options["road.x_min_m"] < 4, "a low camera sees the road sooner");
    assert.ok((await setFlies("4500")).ok);
    const late = await worked(4500, 8);
    // The command in a report has the mount that was given, though the road says another.
    const { number } = await (await fetch(`${run.address}api/state`)).json();
    const zip = await fetch(`${run.address}api/report.zip?number=${number}`);
    if (zip.ok) {
      writeFileSync(join(work, "given.zip"), Buffer.from(await zip.arrayBuffer()));
      assert.equal(spawnSync("python3", ["-m", "zipfile", "-e", "given.zip", "given"], { cwd: work }).status, 0);
      const [, command] = /^ {2}flies (.*)$/m.exec(readFileSync(join(work, "given", "README.txt"), "utf8"));
      const again = spawnSync(flies, [...command.split(" "), "--json", "-"], { cwd: join(work, "given"), encoding: "utf8" });
      assert.equal(again.status, 0, again.stderr);
      const [found, told] = [again.stdout, readFileSync(join(work, "given", "result.json"), "utf8")].map((text) => JSON.parse(text).run);
      assert.equal(found.mount.height_m, 0.5);
      assert.deepEqual(found.mount, told.mount);
    }
    const all = records();
    const idsOf = (some) => new Set(some.flatMap(({ tracks }) => tracks.map(({ id }) => id)));
    const before = idsOf(all.filter(({ frame }) => frame < late[0].frame)), after = idsOf(late);
    assert.ok(before.size > 0 && after.size > 0, "there are tracks");
    assert.ok([...after].every((id) => !before.has(id)), "no number is given twice");
    for (const { frame, live } of late) {
      const missing = frame + 1 - all.filter((other) => other.frame <= frame).length;
      assert.ok(live.dropped >= missing, `${live.dropped} dropped, ${missing} missing`);
    }
    await stop(run);
  } catch (error) {
    console.error(error, run.said());
    run.child.kill("SIGKILL");
    process.exitCode = 1;
  }
}
