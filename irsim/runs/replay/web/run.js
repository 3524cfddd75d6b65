// A run in memory: where everybody is at a moment. Rows are the kept steps; `at` may lie between two rows.

import { cellsOf } from "./cells.js";

export const ARRIVED = 1, COLLIDED = 2, STOPPED = 4;
const STANDING = 1e-4; // metres per row

export function makeRun({ head, columns }) {
  const [quantum, turn] = head.quanta;
  const run = {
    head,
    rows: columns.step.length,
    time: Float64Array.from(columns.step, (step) => step * head.step_time),
    step: columns.step,
    x: scaled(columns.x, quantum),
    y: scaled(columns.y, quantum),
    heading: scaled(columns.heading, turn),
    objects: head.objects,
    robots: [],
    goals: changesOf(columns.goal_row, columns.goal_object, head.objects.length),
    goalSet: columns.goal_set,
    goalX: scaled(columns.goal_x, quantum),
    goalY: scaled(columns.goal_y, quantum),
    goalHeading: scaled(columns.goal_heading, turn),
    flagged: changesOf(columns.flag_row, columns.flag_object, head.objects.length),
    flags: columns.flags,
    lidars: new Map(),
    cells: head.grid ? cellsOf(head.grid, columns.cells, columns.unknown) : null,
    paths: head.shapes.map(pathOf),
    zones: (head.zones ?? []).map((zone) => ({ ...zone, path: pathOf(zone) })),
    reach: head.shapes.map(reachOf),
  };
  head.objects.forEach((object, index) => {
    object.index = index;
    object.track ??= -1;
    object.first = rowOfStep(run, object.from ?? 0);
    if (object.role === "robot") run.robots.push(index);
  });
  const moving = run.objects.filter(isMover);
  run.movers = moving.sort((one, other) => (one.role === "robot") - (other.role === "robot")); // robots on top
  for (const lidar of head.lidars) {
    lidar.ranges = lidar.scan ? columns[lidar.scan] : null;
    if (!run.lidars.has(lidar.object)) run.lidars.set(lidar.object, []);
    run.lidars.get(lidar.object).push(lidar);
  }
  run.events = head.events.map(([step, kind, object, partner, x, y, where = "", within]) => ({
    row: within === undefined ? rowOfStep(run, step) : rowOfTime(run, within), // within a step: between two rows
    time: within ?? step * head.step_time, step, kind, object, partner, x, y, where,
  })).sort((one, other) => one.row - other.row);
  return run;
}

/** Whether an event is a contact that begins and ends within one step. */
export const isBetweenSteps = ({ kind }) => kind === "passed_through" || kind === "contact_between_steps";

const scaled = (values, quantum) => Float32Array.from(values, (value) => value * quantum);

/** Per object the range [from, to) of its changes, which are sorted by row. */
function changesOf(rows, objects, count) {
  const from = new Int32Array(count + 1);
  for (const object of objects) from[object + 1]++;
  for (let i = 0; i < count; i++) from[i + 1] += from[i];
  return { rows, from };
}

/** Place of the change that holds at a row, -1 before the first. */
function changeAt({ rows, from }, object, row) {
  let low = from[object], high = from[object + 1];
  const first = low;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[middle] <= row) low = middle + 1;
    else high = middle;
  }
  return low > first ? low - 1 : -1;
}

function rowOfStep(run, step) {
  return firstAtLeast(run.step, step);
}

function firstAtLeast(values, wanted) {
  let low = 0, high = values.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Moment in rows, with a fraction, of a time in seconds. */
export function rowOfTime(run, time) {
  const next = firstAtLeast(run.time, time);
  if (next === 0 || run.time[next] <= time) return next;
  const before = run.time[next - 1];
  return next - 1 + (time - before) / (run.time[next] - before);
}

export function timeOfRow(run, at) {
  const row = Math.floor(at), last = run.rows - 1;
  if (row >= last) return run.time[last];
  return run.time[row] + (at - row) * (run.time[row + 1] - run.time[row]);
}

/** Pose of an object as { x, y, heading }. */
export function poseAt(run, object, at, out = {}) {
  const { track, pose } = run.objects[object];
  if (track < 0) {
    [out.x, out.y, out.heading] = pose;
    return out;
  }
  const row = Math.min(Math.floor(at), run.rows - 1), share = at - row, i = track * run.rows + row;
  const j = share > 0 && row + 1 < run.rows ? i + 1 : i;
  out.x = run.x[i] + share * (run.x[j] - run.x[i]);
  out.y = run.y[i] + share * (run.y[j] - run.y[i]);
  out.heading = run.heading[i] + share * (run.heading[j] - run.heading[i]);
  return out;
}

/** Whether an object is drawn for each moment: what moves, robots, and what waits, which is pale until it may. */
export const isMover = ({ track, role, until = 0 }) => track >= 0 || role === "robot" || until > 0;

const stepAt = (run, at) => run.step[Math.min(Math.floor(at), run.rows - 1)];

/** Whether an object has left the world at a moment. */
export const hasLeft = (run, { to = Infinity }, at) => stepAt(run, at) > to;

/** Whether an object is not in the world at a moment: not yet, or no more. */
export const isAbsent = (run, object, at) => stepAt(run, at) < (object.from ?? 0) || hasLeft(run, object, at);

/** Whether an object stands at its start because its time has not come. */
export const waits = (run, { until = 0 }, at) => stepAt(run, at) < until;

/** Speed since the row before [m/s]. */
export function speedAt(run, object, at) {
  const { track } = run.objects[object], row = Math.ceil(at);
  if (track < 0 || row === 0) return 0;
  const i = track * run.rows + row;
  return Math.hypot(run.x[i] - run.x[i - 1], run.y[i] - run.y[i - 1]) / (run.time[row] - run.time[row - 1]);
}

/** Direction in which something drives that need not look there; its heading when it stands. */
export function courseAt(run, object, at, heading) {
  const { track } = run.objects[object], row = Math.max(1, Math.ceil(at));
  if (track < 0 || row >= run.rows) return heading;
  const i = track * run.rows + row, dx = run.x[i] - run.x[i - 1], dy = run.y[i] - run.y[i - 1];
  return Math.hypot(dx, dy) > STANDING ? Math.atan2(dy, dx) : heading;
}

/** Present goal as { x, y, heading }, or null. */
export function goalAt(run, object, at) {
  const change = changeAt(run.goals, object, Math.floor(at));
  if (change < 0 || !run.goalSet[change]) return null;
  return { x: run.goalX[change], y: run.goalY[change], heading: run.goalHeading[change] };
}

export function flagsAt(run, object, at) {
  const change = changeAt(run.flagged, object, Math.floor(at));
  return change < 0 ? 0 : run.flags[change];
}

/** How far a shape gets from the origin of its object. */
function reachOf({ circle, rings, line }) {
  let reach = circle ? Math.hypot(circle[0], circle[1]) + circle[2] : 0;
  for (const flat of [...(rings ?? []), line ?? []]) {
    for (let i = 0; i < flat.length; i += 2) reach = Math.max(reach, Math.hypot(flat[i], flat[i + 1]));
  }
  return reach;
}

/** A shape in the frame of its object, ready to be filled and stroked. */
function pathOf({ circle, rings, line }) {
  const path = new Path2D();
  if (circle) path.arc(circle[0], circle[1], circle[2], 0, 2 * Math.PI);
  for (const ring of rings ?? []) {
    addPoints(path, ring);
    path.closePath();
  }
  if (line) addPoints(path, line);
  return path;
}

function addPoints(path, flat) {
  for (let i = 0; i < flat.length; i += 2) {
    if (i) path.lineTo(flat[i], flat[i + 1]);
    else path.moveTo(flat[i], flat[i + 1]);
  }
}
