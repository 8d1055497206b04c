// The two pictures. Positions are in the vehicle frame: x forward, y to the left, metres.

const kPerson = "#ff4dff";
const kFreeFill = "rgba(40, 190, 80, 0.28)";
const kTrail_s = 5;

/** Near is red, far is blue, as in the program's own pictures. */
export function rangeColor(range_m) {
  const share = Math.min(1, Math.max(0, range_m / 40));
  return `hsl(${Math.round(240 * share)} 100% 55%)`;
}

function fitnessColor(share) {
  return `hsl(${Math.round(240 * (1 - share))} 100% 50%)`;
}

/** Of a canvas that is shown smaller than it is: how much larger to write, so that it can be read. */
function writingScale({ width, clientWidth }) {
  return clientWidth > 0 ? Math.max(1, width / clientWidth) : 1;
}

/** Writes where nothing is written yet: what comes first is read, what has no room is in the table. */
class Labels {
  #taken = [];

  constructor(context, scale) {
    this.context = context;
    this.scale = scale;
  }

  put(text, x, y, color, { weight = 600, size = 13, ground = "rgba(0, 0, 0, 0.7)" } = {}) {
    const { context, scale } = this;
    context.font = `${weight} ${size * scale}px system-ui, sans-serif`;
    const width = context.measureText(text).width + 6 * scale, height = (size + 4) * scale;
    const left = Math.max(0, Math.min(x, context.canvas.width - width));
    const top = Math.max(0, y - height);
    const meets = (other) => left < other.left + other.width && other.left < left + width &&
      top < other.top + other.height && other.top < top + height;
    if (this.#taken.some(meets)) return;
    this.#taken.push({ left, top, width, height });
    context.fillStyle = ground;
    context.fillRect(left, top, width, height);
    context.fillStyle = color;
    context.fillText(text, left + 3 * scale, top + size * scale);
  }
}

function fillPolygon(context, points) {
  context.beginPath();
  points.forEach(([x, y], i) => (i === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
  context.closePath();
  context.fill();
}

function drawBox(context, box, color, scale) {
  context.strokeStyle = color;
  context.lineWidth = 2 * scale;
  context.strokeRect(box.u_px, box.v_px, box.width_px, box.height_px);
}

/** The left picture: free ground, obstacles and their range, people and how sure they are, numbers of tracks. */
export function drawLeft(canvas, image, state, flies) {
  if (canvas.width !== state.width_px || canvas.height !== state.height_px) {
    canvas.width = state.width_px;
    canvas.height = state.height_px;
  }
  const context = canvas.getContext("2d");
  const scale = writingScale(canvas);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  context.fillStyle = kFreeFill;
  for (const polygon of state.free_px) fillPolygon(context, polygon);
  for (const [u, v, , , fitness] of flies ?? []) {
    context.fillStyle = fitnessColor(fitness);
    context.fillRect(u - 1, v - 1, 2, 2);
  }
  const { obstacles, pedestrians, tracks } = state.record;
  for (const { box, range_m } of [...obstacles].reverse()) drawBox(context, box, rangeColor(range_m), scale);
  for (const { box } of [...pedestrians].reverse()) drawBox(context, box, kPerson, scale);
  const labels = new Labels(context, scale);  // nearest first
  for (const { box, probability } of pedestrians)
    labels.put(`person ${(100 * probability).toFixed(0)} %`, box.u_px, box.v_px, kPerson);
  for (const { box, range_m } of obstacles)
    labels.put(`${range_m.toFixed(1)} m`, box.u_px, box.v_px, rangeColor(range_m));
  for (const { id, box, class: kind } of tracks)
    labels.put(`#${id}`, box.u_px, box.v_px + box.height_px, kind === "person" ? kPerson : "#fff",
      { weight: 400, size: 11, ground: "rgba(0, 0, 0, 0.4)" });
}

/** Where tracks were, in a frame that stands still. */
export class Trails {
  #points = new Map();
  #segment = null;

  add(state) {
    const { pose, record } = state;
    if (this.#segment !== pose.segment) this.#points.clear();
    this.#segment = pose.segment;
    const c = Math.cos(pose.yaw_rad), s = Math.sin(pose.yaw_rad);
    for (const { id, x_m, y_m } of record.tracks) {
      const point = { x: pose.x_m + c * x_m - s * y_m, y: pose.y_m + s * x_m + c * y_m, time_s: record.time_s };
      if (!this.#points.has(id)) this.#points.set(id, []);
      this.#points.get(id).push(point);
    }
    for (const [id, points] of this.#points) {
      const kept = points.filter(({ time_s }) => time_s > record.time_s - kTrail_s);
      if (kept.length > 0) this.#points.set(id, kept);
      else this.#points.delete(id);
    }
  }

  /** In the vehicle frame of now. */
  ofVehicle(pose) {
    const c = Math.cos(pose.yaw_rad), s = Math.sin(pose.yaw_rad);
    return [...this.#points].map(([id, points]) => ({
      id,
      points: points.map(({ x, y }) => [c * (x - pose.x_m) + s * (y - pose.y_m), -s * (x - pose.x_m) + c * (y - pose.y_m)]),
    }));
  }
}

const kAhead_m = 48, kBehind_m = 2;

/** The view from above: x up, y to the left. */
export function drawTop(canvas, state, trails, flies) {
  const context = canvas.getContext("2d");
  const writing = writingScale(canvas);
  const scale = canvas.height / (kAhead_m + kBehind_m);
  const at = ([x_m, y_m]) => [canvas.width / 2 - y_m * scale, canvas.height - (x_m + kBehind_m) * scale];
  context.fillStyle = "#f7f8f9";
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = kFreeFill;
  if (state.free_m.length > 2) fillPolygon(context, state.free_m.map(at));

  context.strokeStyle = "#cfd5da";
  context.fillStyle = "#5c6670";
  context.font = `${12 * writing}px system-ui, sans-serif`;
  context.lineWidth = 1;
  for (let x_m = 0; x_m <= kAhead_m; x_m += 10) {
    const [, v] = at([x_m, 0]);
    line(context, [0, v], [canvas.width, v]);
    context.fillText(`${x_m} m`, 4, v - 3);
  }
  for (const side of [-1, 1]) line(context, at([0, 0]), at([kAhead_m, side * kAhead_m * Math.tan(state.half_view_rad)]));

  for (const [, , x_m, y_m, fitness] of flies ?? []) {
    const [u, v] = at([x_m, y_m]);
    context.fillStyle = fitnessColor(fitness);
    context.fillRect(u - 1, v - 1, 2, 2);
  }
  context.lineWidth = 2;
  context.strokeStyle = "rgba(60, 90, 140, 0.5)";
  for (const { points } of trails) {
    context.beginPath();
    points.map(at).forEach(([u, v], i) => (i === 0 ? context.moveTo(u, v) : context.lineTo(u, v)));
    context.stroke();
  }
  for (const obstacle of state.record.obstacles) drawObstacle(context, at, obstacle);
  const labels = new Labels(context, writing);  // nearest first
  for (const track of state.record.tracks) drawTrack(context, at, track, labels);
}

function line(context, from, to) {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

function drawObstacle(context, at, { x_m, y_m, width_m, middle_offset_m, range_m }) {
  const bearing = Math.atan2(y_m, x_m);
  const end = (side) => {
    const across = middle_offset_m + (side * width_m) / 2;
    return at([x_m - Math.sin(bearing) * across, y_m + Math.cos(bearing) * across]);
  };
  context.strokeStyle = rangeColor(range_m);
  context.lineWidth = 4;
  line(context, end(-1), end(1));
}

function drawTrack(context, at, track, labels) {
  const isPerson = track.class === "person";
  const [u, v] = at([track.x_m, track.y_m]);
  if (u < 0 || v < 0 || u > context.canvas.width || v > context.canvas.height) return;  // in the table alone
  const speed = Math.hypot(track.vx_mps, track.vy_mps);
  context.globalAlpha = track.unseen_s > 0 ? 0.4 : 1;
  context.fillStyle = isPerson ? "#c000c0" : "#30363c";
  context.beginPath();
  context.arc(u, v, isPerson ? 6 : 3, 0, 2 * Math.PI);
  context.fill();
  if (speed > 0.3) {  // where it will be in a second
    context.strokeStyle = context.fillStyle;
    context.lineWidth = 2;
    line(context, [u, v], at([track.x_m + track.vx_mps, track.y_m + track.vy_mps]));
  }
  labels.put(`#${track.id}`, u + 4, v + 8 * labels.scale, context.fillStyle,
    { weight: 400, size: 11, ground: "transparent" });
  context.globalAlpha = 1;
}
