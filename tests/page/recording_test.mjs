// recording_test.mjs FLIES WORK: recordings and the WebSocket server, read by the formats' own packages. Status 77: skipped.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { open } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

const [flies, work] = process.argv.slice(2);

let mcap, schemas, protocol, WebSocket, fzstd;
try {
  const require = createRequire(join(process.env.FLIES_NODE_MODULES, "..", "x.js"));
  mcap = require("@mcap/core");
  schemas = require("@foxglove/schemas/jsonschema");
  protocol = require("@foxglove/ws-protocol");
  ({ WebSocket } = require("ws"));
  fzstd = require("fzstd");
} catch (error) {
  console.log(`SKIP_ a package is missing; scripts/install-node-tools installs it: ${error.message.split("\n")[0]}`);
  process.exit(77);
}

rmSync(work, { recursive: true, force: true });
mkdirSync(work, { recursive: true });
const paint = ["synth", "street", "--sequence", "--seed", "3", "--frames", "12", "--width_px", "640", "--height_px",
  "240", "--focal_px", "400"];
assert.equal(spawnSync(flies, paint, { cwd: work }).status, 0);
const source = ["live", "street/left", "street/right", "--calib", "street/calib.yaml", "--rate", "10"];

/** What is missing or of another type in a message, by a JSON Schema: objects, arrays, plain types, constants. */
function faults(value, schema, path = "") {
  if (schema.oneOf) return schema.oneOf.some((one) => one.const === value) ? [] : [`${path}: ${value} is none of the constants`];
  const is = { object: (v) => v !== null && typeof v === "object" && !Array.isArray(v), array: Array.isArray,
    string: (v) => typeof v === "string", number: (v) => typeof v === "number", boolean: (v) => typeof v === "boolean",
    integer: Number.isInteger };
  if (schema.type && !is[schema.type](value)) return [`${path}: ${JSON.stringify(value)} is no ${schema.type}`];
  const found = [];
  if (schema.minimum !== undefined && value < schema.minimum) found.push(`${path}: ${value} is below ${schema.minimum}`);
  if (schema.maximum !== undefined && value > schema.maximum) found.push(`${path}: ${value} is above ${schema.maximum}`);
  for (const name of schema.required ?? []) if (!(name in value)) found.push(`${path}.${name} is missing`);
  for (const [name, own] of Object.entries(schema.properties ?? {}))
    if (value[name] !== undefined) found.push(...faults(value[name], own, `${path}.${name}`));
  if (schema.type === "object" && schema.properties && Object.keys(schema.properties).length > 0)
    for (const name of Object.keys(value)) if (!(name in schema.properties)) found.push(`${path}.${name} is unknown`);
  if (schema.type === "array" && schema.items && !Array.isArray(schema.items))
    value.forEach((item, i) => found.push(...faults(item, schema.items, `${path}[${i}]`)));
  return found;
}

function checkMessage(schemaName, message) {
  if (!schemaName.startsWith("foxglove.")) return;
  const published = schemas[schemaName.replace("foxglove.", "")];
  assert.ok(published, `${schemaName} is published`);
  assert.deepEqual(faults(message, published, schemaName).slice(0, 5), []);
}

const decompressHandlers = { zstd: (buffer) => fzstd.decompress(buffer) };
const text = new TextDecoder();

async function indexed(path) {
  const file = await open(path, "r");
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      await file.read(buffer, 0, Number(length), Number(offset));
      return buffer;
    },
  };
  const reader = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
  return { reader, file };
}

function streamed(path) {
  const reader = new mcap.McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(readFileSync(path));
  const messages = [];
  for (let record; (record = reader.nextRecord()); ) if (record.type === "Message") messages.push(record);
  return messages;
}

// ---- a recording, by its index
{
  const run = spawnSync(flies, [...source, "--every-pair", "--record", "out.mcap", "--json", "out.jsonl"],
    { cwd: work, encoding: "utf8" });
  assert.equal(run.status, 0, run.stderr);
  const lines = readFileSync(join(work, "out.jsonl"), "utf8").trim().split("\n");
  const { reader, file } = await indexed(join(work, "out.mcap"));
  const byTopic = new Map();
  let before = 0n;
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(channel.messageEncoding, "json");
    assert.equal(schema.encoding, "jsonschema");
    JSON.parse(text.decode(schema.data));
    const data = JSON.parse(text.decode(message.data));
    checkMessage(schema.name, data);
    assert.ok(message.logTime >= before);
    before = message.logTime;
    if (!byTopic.has(channel.topic)) byTopic.set(channel.topic, []);
    byTopic.get(channel.topic).push(data);
  }
  await file.close();
  const topics = ["/left", "/right", "/left/calibration", "/right/calibration", "/left/annotations", "/scan", "/flies",
    "/tracks", "/pose", "/tf/vehicle", "/tf/camera", "/record"];
  for (const topic of topics) assert.equal(byTopic.get(topic)?.length, lines.length, topic);
  assert.deepEqual(byTopic.get("/record"), lines.map((line) => JSON.parse(line)));
  const tracks = byTopic.get("/record").at(-1).tracks;
  assert.ok(tracks.length > 3);
  assert.deepEqual(byTopic.get("/tracks").at(-1).entities.map(({ id }) => id), tracks.map(({ id }) => String(id)));
  for (const [i, { entities }] of byTopic.get("/tracks").entries())
    for (const { id, arrows: [arrow] } of entities) {
      if (!arrow) continue;
      const track = byTopic.get("/record")[i].tracks.find((one) => String(one.id) === id);
      assert.ok(Math.abs(arrow.shaft_length + arrow.head_length - Math.hypot(track.vx_mps, track.vy_mps)) < 2e-3, id);
    }
  assert.equal(byTopic.get("/left/annotations").at(-1).points.length, tracks.length);
  assert.equal(Buffer.from(byTopic.get("/left")[0].data, "base64").subarray(0, 2).toString("hex"), "ffd8");
  assert.equal(reader.statistics.messageCount, BigInt(topics.length * lines.length + (byTopic.get("/log")?.length ?? 0)));
  const camera = byTopic.get("/tf/camera")[0].rotation;
  assert.ok(Math.abs(Math.hypot(camera.x, camera.y, camera.z, camera.w) - 1) < 1e-6);
  assert.deepEqual(streamed(join(work, "out.mcap")).length, Number(reader.statistics.messageCount));
}

// ---- read back
{
  const run = spawnSync(flies, ["track", "out.mcap", "--json", "-"], { cwd: work, encoding: "utf8", maxBuffer: 1 << 28 });
  assert.equal(run.status, 0, run.stderr);
  const again = run.stdout.trim().split("\n").map((line) => JSON.parse(line));
  const before = readFileSync(join(work, "out.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
  assert.equal(again.length, before.length);
  let close = 0;
  again.forEach((record, i) => {
    assert.ok(Math.abs(record.time_s - (before[i].time_s - before[0].time_s)) < 1e-6);
    if (Math.abs(record.obstacles[0].range_m - before[i].obstacles[0].range_m) < 0.5) ++close;
  });
  // The pictures went through JPEG, so that now and then another obstacle is the nearest.
  assert.ok(close >= 0.75 * again.length, `${close} of ${again.length} nearest obstacles are the same`);
  assert.match(again[0].left, /^out\.mcap \/left 0$/);
}

// ---- a recording of ROS 2, written by the format's own package
{
  // Fields of a message as CDR lays them out: numbers aligned behind the first four bytes.
  const cdr = () => {
    let bytes = Buffer.from([0, 1, 0, 0]);
    const aligned = (size) => { bytes = Buffer.concat([bytes, Buffer.alloc((size - ((bytes.length - 4) % size)) % size)]); };
    const self = {
      u32(value) { aligned(4); const own = Buffer.alloc(4); own.writeUInt32LE(value); bytes = Buffer.concat([bytes, own]); return self; },
      f64(...values) {
        for (const value of values) { aligned(8); const own = Buffer.alloc(8); own.writeDoubleLE(value); bytes = Buffer.concat([bytes, own]); }
        return self;
      },
      text(value) { self.u32(value.length + 1); bytes = Buffer.concat([bytes, Buffer.from(`${value}\0`)]); return self; },
      list(value) { self.u32(value.length); bytes = Buffer.concat([bytes, value]); return self; },
      header: (time) => self.u32(Math.floor(time)).u32(Math.round((time % 1) * 1e9)).text("cam"),
      bytes: () => bytes,
    };
    return self;
  };
  const parts = [];
  let size = 0n;
  const writer = new mcap.McapWriter({ writable: { position: () => size, write: async (bytes) => {
    parts.push(Buffer.from(bytes));
    size += BigInt(bytes.byteLength);
  } } });
  await writer.start({ profile: "ros2", library: "" });
  const channels = {};
  for (const side of ["left", "right"])
    for (const [topic, type] of [["image_rect_color/compressed", "CompressedImage"], ["camera_info", "CameraInfo"]]) {
      const schemaId = await writer.registerSchema({ name: `sensor_msgs/msg/${type}`, encoding: "ros2msg", data: new Uint8Array() });
      channels[`${side} ${type}`] = await writer.registerChannel({ topic: `/zed/${side}/${topic}`, schemaId, messageEncoding: "cdr",
        metadata: new Map() });
    }
  const baseline = Number(/baseline_m: (\S+)/.exec(readFileSync(join(work, "street/calib.yaml"), "utf8"))[1]);
  for (let i = 0; i < 12; ++i)
    for (const side of ["left", "right"]) {
      const time = 100 + 0.1 * i + (side === "right" ? 0.002 : 0), logTime = BigInt(Math.round(time * 1e9));
      const picture = readFileSync(join(work, "street", side, `${String(i).padStart(6, "0")}.png`));
      const add = (type, message) => writer.addMessage({ channelId: channels[`${side} ${type}`], sequence: i, logTime,
        publishTime: logTime, data: message.bytes() });
      await add("CompressedImage", cdr().header(time).text("bgr8; png compressed bgr8").list(picture));
      await add("CameraInfo", cdr().header(time).u32(240).u32(640).text("plumb_bob").u32(5).f64(0, 0, 0, 0, 0)
        .f64(400, 0, 320, 0, 400, 120, 0, 0, 1).f64(1, 0, 0, 0, 1, 0, 0, 0, 1)
        .f64(400, 0, 320, side === "right" ? -400 * baseline : 0, 0, 400, 120, 0, 0, 0, 1, 0).u32(0).u32(0).u32(0).u32(0).u32(0).u32(0)
        .u32(0));
    }
  await writer.end();
  writeFileSync(join(work, "ros2.mcap"), Buffer.concat(parts));
  const run = spawnSync(flies, ["track", "ros2.mcap", "--json", "-"], { cwd: work, encoding: "utf8", maxBuffer: 1 << 28 });
  assert.equal(run.status, 0, run.stderr);
  const ours = run.stdout.trim().split("\n").map((line) => JSON.parse(line));
  assert.equal(ours.length, 12);
  assert.match(ours[0].left, /^ros2\.mcap \/zed\/left\/image_rect_color\/compressed 0$/);
  assert.ok(Math.abs(ours[11].time_s - 1.1) < 1e-6);
  const folder = spawnSync(flies, ["track", "street", "--json", "-"], { cwd: work, encoding: "utf8", maxBuffer: 1 << 28 });
  const same = folder.stdout.trim().split("\n").map((line) => JSON.parse(line));
  // The pictures are the same to the bit; what differs is what the calibration file says of the mount.
  const close = ours.filter((record, i) => Math.abs(record.obstacles[0].range_m - same[i].obstacles[0].range_m) < 0.5).length;
  assert.ok(close >= 9, `${close} of 12 nearest obstacles are the same`);
}

// ---- a killed writer leaves whole chunks
{
  const child = spawn(flies, [...source, "--loop", "--record", "killed.mcap", "--json", "killed.jsonl"], { cwd: work });
  const lines = () => existsSync(join(work, "killed.jsonl")) ? readFileSync(join(work, "killed.jsonl"), "utf8").split("\n").length - 1 : 0;
  // The recorder lets others have the processor first, so that on a busy machine it may lag behind the lines.
  const bytes = () => existsSync(join(work, "killed.mcap")) ? statSync(join(work, "killed.mcap")).size : 0;
  const isEarly = () => lines() < 40 || bytes() < 4e6;
  for (let i = 0; i < 1200 && isEarly() && child.exitCode === null; ++i) await new Promise((resolve) => setTimeout(resolve, 100));
  child.kill("SIGKILL");
  await new Promise((resolve) => child.on("exit", resolve));
  const messages = streamed(join(work, "killed.mcap"));
  assert.ok(messages.length > 12 * 5, `${messages.length} messages in ${bytes()} bytes`);
  const run = spawnSync(flies, ["track", "killed.mcap", "--json", "-"], { cwd: work, encoding: "utf8", maxBuffer: 1 << 28 });
  assert.equal(run.status, 0, run.stderr);
  assert.match(run.stderr, /killed\.mcap: is cut off or damaged after \d+ pairs/);
}

// A program under a sanitizer takes many times as long.
const patience = Number(process.env.FLIES_PATIENCE ?? 1);

// ---- the WebSocket server, by the protocol's own client
{
  const child = spawn(flies, [...source, "--loop", "--foxglove", "0", "--json", "ws.jsonl", "--baseline", "0.53"], { cwd: work });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  let said = "";
  const address = await new Promise((resolve, reject) => {
    child.stderr.on("data", (data) => {
      said += data;
      const found = /Foxglove at (\S+)/.exec(said);
      if (found) resolve(found[1]);
    });
    ended.then((code) => reject(new Error(`flies ended with ${code}: ${said}`)));
  });
  // Another protocol and a page of another site are refused.
  for (const [protocols, options] of [[["other"], {}],
    [[protocol.FoxgloveClient.SUPPORTED_SUBPROTOCOL], { origin: "https://evil.example" }],
    [[protocol.FoxgloveClient.SUPPORTED_SUBPROTOCOL], { origin: "https://app.foxglove.dev.evil.example" }]]) {
    const refused = new WebSocket(address, protocols, options);
    await new Promise((resolve) => refused.on("error", resolve));
  }
  const client = new protocol.FoxgloveClient({
    ws: new WebSocket(address, [protocol.FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
  const channels = new Map(), bySubscription = new Map(), counts = new Map();
  const awaited = ["/record", "/left", "/scan", "/flies", "/tracks", "/pose"];
  const tracks = new Set(), pictures = [];
  let enough;
  const done = new Promise((resolve, reject) => {
    enough = resolve;
    client.on("error", reject);
    setTimeout(() => reject(new Error(`too few messages: ${JSON.stringify([...counts])}`)), 30000 * patience).unref();
  });
  client.on("serverInfo", (info) => assert.equal(info.name, "flies"));
  client.on("advertise", (advertised) => {
    for (const channel of advertised) {
      assert.equal(channel.schemaEncoding, "jsonschema");
      channels.set(channel.id, channel);
      if (channel.topic !== "/right") bySubscription.set(client.subscribe(channel.id), channel);
    }
  });
  client.on("message", ({ subscriptionId, timestamp, data }) => {
    const channel = bySubscription.get(subscriptionId);
    const message = JSON.parse(text.decode(data));
    checkMessage(channel.schemaName, message);
    assert.ok(timestamp > 1600000000n * 1000000000n);
    counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
    if (channel.topic === "/tracks") tracks.add(timestamp);
    if (channel.topic === "/left") pictures.push(timestamp);
    if (awaited.every((topic) => (counts.get(topic) ?? 0) >= 10)) enough();
  });
  await done;
  assert.equal(channels.size, 13);
  // But for those before all subscriptions were served, and the last, whose tracks may be on their way.
  const lonely = pictures.slice(3, -2).filter((timestamp) => !tracks.has(timestamp));
  assert.ok(lonely.length <= 1, "pictures have tracks of their own pair, unless a busy machine left some out");
  assert.equal(counts.get("/right"), undefined, "only what was subscribed to");
  assert.match(said, /flies: note: .*the baseline is 0\.53 m as given/);
  assert.ok(counts.get("/log") >= 1, "what was told before anybody listened");
  // Who unsubscribes gets no more.
  for (const id of bySubscription.keys()) client.unsubscribe(id);
  await new Promise((resolve) => setTimeout(resolve, 500));
  const before = counts.get("/record");
  await new Promise((resolve) => setTimeout(resolve, 500));
  assert.equal(counts.get("/record"), before);
  const closed = new Promise((resolve) => client.on("close", resolve));
  child.kill("SIGINT");
  assert.equal(await ended, 0);
  await closed;
}
console.log("recordings and messages are what the formats' own packages read");
