// Runs of two to four policies side by side on one clock, and a table of how they differ from the first one.

import { fit, makeCamera, resize } from "./camera.js";
import { $, element } from "./dom.js";
import { drawFrame, makeDrawing } from "./draw.js";
import { actions, extend, finish, player, show } from "./player.js";
import { unpack } from "./read.js";
import { extendRun, makeRun, rowOfTime } from "./run.js";

const ROWS = [
  ["outcome", ({ outcome }) => outcome, null],
  ["time", ({ sim_time: time }) => time, "s"],
  ["path, mean", ({ robots }) => mean(robots.map(({ path_length: length }) => length)), "m"],
  ["least clearance", ({ robots }) => least(robots.map(({ min_clearance: gap }) => gap)), "m"],
  ["collisions", ({ robots }) => robots.reduce((sum, robot) => sum + robot.collision_count, 0), ""],
];
let views = [];

const mean = (values) => (values.length ? values.reduce((a, b) => a + b, 0) / values.length : null);
const least = (values) => {
  const known = values.filter((value) => value !== null);
  return known.length ? Math.min(...known) : null;
};

/** Leave the comparison, and show one run again. */
export function endComparison() {
  views = [];
  $("compared").hidden = true;
}

/** Show runs: each has its name, its blocks, how it ended, and its result. The longest one gives the clock. */
export async function compare(runs) {
  const longest = runs.reduce((one, other) => (other.result.sim_time > one.result.sim_time ? other : one));
  await show(longest.blocks[0], true);
  for (const block of longest.blocks.slice(1)) await extend(block);
  finish(longest.ending);
  views = await Promise.all(runs.map(async ({ name, blocks, result }) => {
    const run = makeRun(await unpack(blocks[0]));
    for (const block of blocks.slice(1)) extendRun(run, await unpack(block));
    run.growing = false;
    run.head.run_id = name; // what a drawing keeps belongs to one run
    const canvas = element("canvas", { title: result.reason ?? result.summary });
    return { run, canvas, drawing: makeDrawing(), camera: makeCamera(run.head.world), name, result };
  }));
  $("pictures").replaceChildren(...views.map(({ name, canvas, result }) => element("figure", {},
    element("figcaption", {}, `${name} `, element("b", { className: result.outcome, textContent: result.outcome })), canvas)));
  $("differences").replaceChildren(...table(views));
  $("compared").hidden = false;
  measureViews();
  actions.play(true);
}

function table(all) {
  const head = element("tr", {}, element("th"), ...all.map(({ name }) => element("th", { scope: "col", textContent: name })));
  return [head, ...ROWS.map(([words, value, unit]) => {
    const first = value(all[0].result);
    return element("tr", {}, element("th", { scope: "row", textContent: words }), ...all.map(({ result }, k) => {
      const own = value(result), shown = own === null ? "–" : unit === null ? own : `${Number(own.toFixed(2))} ${unit}`.trim();
      const by = k && unit !== null && own !== null && first !== null ? own - first : 0;
      return element("td", { textContent: by ? `${shown} (${by > 0 ? "+" : "−"}${Number(Math.abs(by).toFixed(2))})` : shown });
    }));
  })];
}

function measureViews() {
  const ratio = Math.min(2, devicePixelRatio || 1);
  for (const { canvas, camera } of views) {
    const { clientWidth, clientHeight } = canvas;
    [canvas.width, canvas.height] = [Math.round(clientWidth * ratio), Math.round(clientHeight * ratio)];
    resize(camera, clientWidth, clientHeight);
    fit(camera);
  }
}

/** Draw all views at the moment of the player; true while there is a comparison. */
export function drawViews(ratio) {
  for (const { run, canvas, drawing, camera } of views) {
    const shown = { ...player.shown, at: Math.min(run.rows - 1, rowOfTime(run, player.seconds)), robot: -1 };
    drawFrame(canvas.getContext("2d"), drawing, run, shown, camera, player.colors, ratio, 10000);
  }
  return views.length > 0;
}

new ResizeObserver(() => {
  measureViews();
  if (views.length) actions.refresh();
}).observe($("pictures"));
