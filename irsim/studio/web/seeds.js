// A strip with a small picture of the end of each of several runs; a click shows the run.

import { fit, makeCamera, resize } from "./camera.js";
import { $, element } from "./dom.js";
import { drawFrame, makeDrawing } from "./draw.js";
import { extend, finish, player, show } from "./player.js";
import { unpack } from "./read.js";
import { extendRun, makeRun } from "./run.js";

const WIDTH = 360, HEIGHT = 252; // pixels, which are shown at a third of their size, so that signs are small

/** An empty strip, which is shown. */
export function beginStrip() {
  $("seeds").replaceChildren();
  $("seeds").hidden = false;
}

/** Add a run: its blocks, how it ended, and its result. */
export async function addToStrip({ blocks, ending, result }) {
  const canvas = element("canvas", { width: WIDTH, height: HEIGHT });
  const label = element("span", {}, `seed ${result.seed} `, element("b", { className: result.outcome, textContent: result.outcome }));
  const button = element("button", { type: "button", title: result.reason ?? result.summary }, canvas, label);
  button.setAttribute("aria-pressed", "false");
  button.addEventListener("click", async () => {
    for (const other of $("seeds").children) other.setAttribute("aria-pressed", String(other === button));
    await show(blocks[0], true);
    for (const block of blocks.slice(1)) await extend(block);
    finish(ending);
  });
  $("seeds").append(button);
  const run = makeRun(await unpack(blocks[0]));
  for (const block of blocks.slice(1)) extendRun(run, await unpack(block));
  run.growing = false;
  const camera = makeCamera(run.head.world);
  resize(camera, WIDTH + 40, HEIGHT + 40); // of the border of the view little is left
  fit(camera);
  resize(Object.assign(camera, { fitted: false }), WIDTH, HEIGHT);
  const shown = { at: run.rows - 1, robot: -1, trails: true, goals: true, lidar: false, names: false, belief: false };
  drawFrame(canvas.getContext("2d"), makeDrawing(), run, shown, camera, player.colors, 1, Infinity);
}
