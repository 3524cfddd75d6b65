// A run in memory: where everybody is at a moment. Rows are the kept steps; `at` may lie between two rows.

import { cellsOf } from "./cells.js";

export const ARRIVED = 1, COLLIDED = 2, STOPPED = 4;
const STANDING = 1e-4; // metres per row

export function makeRun({ head, columns }) {
  const [quantum, turn] = head.quanta;
  const count = head.objects.length;
  const run = {
    head,
    growing: Boolean(head.growing),
    endShown: !head.growing,
    rows: columns.step.length,
    stride: columns.step.length, // from one track to the next
    time: Float64Array.from(columns.step, (step) => step * head.step_time),
    step: columns.step,
    x: scaled(columns.x, quantum),
    y: scaled(columns.y, quantum),
    heading: scaled(columns.heading, turn),
    objects: head.objects,
    robots: [],
    goals: makeChanges(count),
    flagged: makeChanges(count),
    detectors: head.detectors ?? [], // the robot of each
    seen: makeChanges((head.detectors ?? []).length),
    lidars: new Map(),
    cells: head.grid ? cellsOf(head.grid, columns.cells, columns.unknown) : null,
    paths: head.shapes.map(pathOf),
    zones: (head.zones ?? []).map((zone) => ({ ...zone, path: pathOf(zone) })),
    reach: head.shapes.map(reachOf),
  };
  addAllChanges(run, columns, 0);
  head.objects.forEach((object, index) => {
    object.index = index;
    object.track ??= -1;
    object.belief ??= -1;
    object.first = rowOfStep(run, object.from ?? 0);
    if (object.role === "robot") run.robots.push(index);
  });
  const moving = run.objects.filter(isMover);
  run.movers = moving.sort((one, other) => (one.role === "robot") - (other.role === "robot")); // robots on top
  for (const lidar of head.lidars) {
    lidar.ranges = lidar.scan ? columns[lidar.scan] : null;
    lidar.measured = lidar.from ? columns[lidar.from] : null; // the place between rows of each shown scan
    if (!run.lidars.has(lidar.object)) run.lidars.set(lidar.object, []);
    run.lidars.get(lidar.object).push(lidar);
  }
  run.events = eventsOf(run, head.events);
  return run;
}

/** Append the rows, changes and events of a block to a run that grows. */
export function extendRun(run, { head, columns }) {
  const before = run.rows, more = columns.step.length, [quantum, turn] = run.head.quanta;
  reserve(run, before + more);
  run.rows += more;
  run.step = appended(run.step, columns.step);
  run.time = appended(run.time, columns.step, run.head.step_time);
  for (const [name, unit] of [["x", quantum], ["y", quantum], ["heading", turn]]) {
    const values = scaled(columns[name], unit);
    for (let track = 0; track * more < values.length; track++) {
      run[name].set(values.subarray(track * more, (track + 1) * more), track * run.stride + before);
    }
  }
  addAllChanges(run, columns, before);
  for (const [index, bounds] of head.bounds) {
    const object = Object.assign(run.objects[index], bounds);
    object.first = rowOfStep(run, object.from ?? 0);
  }
  run.events.push(...eventsOf(run, head.events));
  run.head.event_count = head.event_count;
  run.head.last_step = run.step[run.rows - 1];
}

/** Room for so many rows of every track. */
function reserve(run, rows) {
  if (rows <= run.stride) return;
  const stride = Math.max(rows, 2 * run.stride, 64);
  for (const name of ["x", "y", "heading"]) {
    const tracks = run[name].length / run.stride, wider = new Float32Array(tracks * stride);
    for (let track = 0; track < tracks; track++) {
      wider.set(run[name].subarray(track * run.stride, track * run.stride + run.rows), track * stride);
    }
    run[name] = wider;
  }
  run.stride = stride;
}

/** A list of numbers and others after it, as a view of a buffer with room for more. */
function appended(values, more, unit = 1) {
  const length = values.length + more.length;
  let all = values;
  if (values.buffer.byteLength < length * values.BYTES_PER_ELEMENT) {
    all = new values.constructor(2 * length);
    all.set(values);
  }
  all = new values.constructor(all.buffer, 0, length);
  for (let i = 0; i < more.length; i++) all[values.length + i] = more[i] * unit;
  return all;
}

function eventsOf(run, events) {
  return events.map(([step, kind, object, partner, x, y, where = "", within]) => ({
    row: within === undefined ? rowOfStep(run, step) : rowOfTime(run, within), // within a step: between two rows
    time: within ?? step * run.head.step_time, step, kind, object, partner, x, y, where,
  })).sort((one, other) => one.row - other.row);
}

/** Whether an event is a contact that begins and ends within one step. */
export const isBetweenSteps = ({ kind }) => kind === "passed_through" || kind === "contact_between_steps";

const scaled = (values, quantum) => Float32Array.from(values, (value) => value * quantum);

/** Changes of values of objects: the rows and values of all, and for each object the places of its own, by row. */
const makeChanges = (count) => ({ rows: [], values: [], of: Array.from({ length: count }, () => []) });

function addChanges(changes, rows, objects, shift, valueOf) {
  for (let i = 0; i < rows.length; i++) {
    changes.of[objects[i]].push(changes.rows.length);
    changes.rows.push(rows[i] + shift);
    changes.values.push(valueOf(i));
  }
}

function addAllChanges(run, columns, shift) {
  const [quantum, turn] = run.head.quanta, { goal_set: set, goal_x: x, goal_y: y, goal_heading: heading, flags } = columns;
  addChanges(run.goals, columns.goal_row, columns.goal_object, shift, (i) =>
    set[i] ? { x: x[i] * quantum, y: y[i] * quantum, heading: heading[i] * turn } : null);
  addChanges(run.flagged, columns.flag_row, columns.flag_object, shift, (i) => flags[i]);
  const { seen_row: rows, seen_detector: detectors, seen_count: counts, seen_x, seen_y, seen_object } = columns;
  let next = 0;
  if (rows) addChanges(run.seen, rows, detectors, shift, (i) =>
    Array.from({ length: counts[i] }, () => ({ x: seen_x[next] * quantum, y: seen_y[next] * quantum, object: seen_object[next++] })));
}

/** The value that holds at a row, or what stands for none before the first change. */
function valueAt({ rows, values, of }, object, row, none) {
  const places = of[object];
  let low = 0, high = places.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rows[places[middle]] <= row) low = middle + 1;
    else high = middle;
  }
  return low ? values[places[low - 1]] : none;
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
  if (track >= 0) return trackAt(run, track, at, out);
  [out.x, out.y, out.heading] = pose;
  return out;
}

/** Pose that a robot believes to have, or null if it decides from the true one. */
export function beliefAt(run, object, at) {
  const { belief } = run.objects[object];
  return belief < 0 ? null : trackAt(run, belief, at, {});
}

/** Tracks of other objects that the detectors of a robot report, in its frame. */
export function seenAt(run, object, at) {
  return run.detectors.flatMap((carrier, detector) => (carrier === object ? valueAt(run.seen, detector, Math.floor(at), []) : []));
}

function trackAt(run, track, at, out) {
  const row = Math.min(Math.floor(at), run.rows - 1), share = at - row, i = track * run.stride + row;
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

/**
 * Speed since the row before [m/s]; of what has arrived or was stopped until the row after, so that it is 0 if it stands.
 * `ends` says that there is no row after: the run ends in the step in which it arrives.
 */
export function speedAt(run, object, at) {
  const { track } = run.objects[object], flags = flagsAt(run, object, at), last = Math.floor(at) >= run.rows - 1;
  const after = flags & (ARRIVED | STOPPED) && !last, row = after ? Math.floor(at) + 1 : Math.ceil(at);
  if (track < 0 || row === 0 || (last && flags & STOPPED)) return { speed: 0, ends: false };
  const i = track * run.stride + row;
  const speed = Math.hypot(run.x[i] - run.x[i - 1], run.y[i] - run.y[i - 1]) / (run.time[row] - run.time[row - 1]);
  return { speed, ends: last && Boolean(flags & ARRIVED) && !(flagsAt(run, object, at - 1) & ARRIVED) };
}

/** Direction in which something drives that need not look there; its heading when it stands. */
export function courseAt(run, object, at, heading) {
  const { track } = run.objects[object], row = Math.max(1, Math.ceil(at));
  if (track < 0 || row >= run.rows) return heading;
  const i = track * run.stride + row, dx = run.x[i] - run.x[i - 1], dy = run.y[i] - run.y[i - 1];
  return Math.hypot(dx, dy) > STANDING ? Math.atan2(dy, dx) : heading;
}

/** Present goal as { x, y, heading }, or null. */
export const goalAt = (run, object, at) => valueAt(run.goals, object, Math.floor(at), null);

export const flagsAt = (run, object, at) => valueAt(run.flagged, object, Math.floor(at), 0);

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
