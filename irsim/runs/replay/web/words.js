// What the page says about objects and events.

import { ARRIVED, beliefAt, COLLIDED, courseAt, flagsAt, goalAt, hasLeft, isAbsent, poseAt, speedAt, STOPPED, waits } from "./run.js";

const KINDS = {
  collision: "hits", arrival: "arrives", waypoint: "passes a waypoint", no_path: "finds no way", believed_arrival: "believes to be at its goal",
  overshoot: "jumps over its goal", zone_entry: "enters", zone_exit: "leaves", line_crossing: "crosses",
  sight_start: "sees", sight_end: "no longer sees",
};
const MANY_OF = {
  collision: "collisions", arrival: "arrivals", waypoint: "waypoints", no_path: "searches without a way",
  overshoot: "jumps over goals", zone_entry: "zones entered", zone_exit: "zones left", line_crossing: "lines crossed",
  sight_start: "sights begun", sight_end: "sights ended", contact_between_steps: "contacts between steps",
  passed_through: "passages through something", believed_arrival: "arrivals in belief",
};

export const manyWords = (kind) => MANY_OF[kind] ?? kind;

export const metres = (value) => `${value.toFixed(2)} m`;
export const seconds = (value) => `${value.toFixed(Math.abs(value) < 1000 ? 2 : 1)} s`;

const degrees = (angle) => `${Math.round((angle * 180) / Math.PI)}°`;

/** A name in a sentence; a person without a name of their own has the number of an obstacle. */
const called = ({ kind, name }) => (kind === "person" && /^obstacle_\d+$/.test(name) ? `the person ${name}` : name);

export function eventWords(run, { kind, object, partner, where }) {
  const name = called(run.objects[object]), whom = partner >= 0 ? ` ${called(run.objects[partner])}` : where && ` ${where}`;
  if (kind === "collision") return `${name} hits${whom || " something"}`;
  if (kind === "passed_through") return `${name} passes through${whom} between two steps`;
  if (kind === "contact_between_steps") return `${name} touches${whom} between two steps`;
  return `${name} ${KINDS[kind] ?? kind}${whom}`;
}

/** Whether a robot takes part in an event. */
export const ofRobot = (run, { object, partner }) => [object, partner].some((index) => run.objects[index]?.role === "robot");

/** Name and value pairs of an object at a moment. */
export function valuesOf(run, index, at) {
  const object = run.objects[index], pose = poseAt(run, index, at), goal = goalAt(run, index, at);
  if (hasLeft(run, object, at)) return [["state", `left at ${seconds(object.to * run.head.step_time)}`]];
  if (isAbsent(run, object, at)) return [["state", `appears at ${seconds(object.from * run.head.step_time)}`]];
  const turn = Math.atan2(Math.sin(pose.heading), Math.cos(pose.heading));
  const pairs = [
    ["position", `${pose.x.toFixed(2)}, ${pose.y.toFixed(2)} m`],
    ["heading", `${turn.toFixed(2)} rad (${degrees(turn)})`],
  ];
  const belief = beliefAt(run, index, at);
  if (belief) {
    const off = metres(Math.hypot(belief.x - pose.x, belief.y - pose.y));
    pairs.push(["believes", `(${belief.x.toFixed(2)}, ${belief.y.toFixed(2)}), off by ${off}`]);
  }
  if (object.motion && (object.role === "robot" || object.arrow)) {
    const course = courseAt(run, index, at, NaN);
    pairs.push(["dart", Number.isNaN(course) ? "heading, as it stands" : `along its motion, ${degrees(course)}`]);
  }
  if (object.track >= 0 || object.role === "robot") {
    const { speed, ends } = speedAt(run, index, at);
    pairs.push(["speed", `${speed.toFixed(2)} m/s${ends ? " on arrival" : ""}`]);
  }
  if (goal) pairs.push(["to goal", metres(Math.hypot(goal.x - pose.x, goal.y - pose.y))]);
  const flags = flagsAt(run, index, at);
  const state = [[COLLIDED, "in collision"], [ARRIVED, "arrived"], [STOPPED, "stopped"]];
  const told = state.filter(([bit]) => flags & bit).map(([, word]) => word).join(", ");
  if (object.role === "robot" || told) pairs.push(["state", told || (waits(run, object, at) ? "waits" : "under way")]);
  return pairs;
}
