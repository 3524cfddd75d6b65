// The page: splats of a scene, the paths of robots in it, and the objects as they move.

import { carriedView, freeView, orbit } from "./camera.js";
import { lookAt, perspective } from "./math.js";
import { readData } from "./read.js";
import { prism, solidLayer, tube } from "./solids.js";
import { sorter } from "./sort.js";
import { splatLayer } from "./splats.js";

const byId = (id) => document.getElementById(id);
const [NEAR, FAR] = [0.05, 1000];

async function start() {
  const { head, columns } = await readData(byId("data").textContent);
  byId("data").remove();
  byId("title").textContent = head.title;
  byId("facts").textContent = head.facts;
  const canvas = byId("view");
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: false });
  if (!gl) throw new Error("this browser does not offer WebGL 2, with which the page draws");
  const splats = splatLayer(gl, columns, head.scales), solids = solidLayer(gl);
  const objects = head.objects.map((item, number) => {
    const pose = (row) => columns.pose.subarray(3 * (row * head.objects.length + number)).slice(0, 3);
    const points = Array.from({ length: head.rows }, (_, row) => [pose(row)[0], pose(row)[1], 0.04]);
    const known = points.filter(([x, y]) => Number.isFinite(x + y));
    return {
      ...item, pose,
      body: solids.make(prism(item, 0.02, item.height)),
      path: item.path ? solids.make(tube(known, 0.035)) : null,
    };
  });
  const robots = objects.filter((item) => item.path);
  for (const [number, robot] of robots.entries()) byId("robot").add(new Option(robot.name, number));
  byId("who").hidden = robots.length < 2;
  byId("cut").max = head.top.toFixed(1);
  byId("cut").value = Math.min(1.9, head.top);
  byId("time").max = Math.max(0, head.rows - 1);
  const [sorts, free] = [sorter(columns.center.slice(), (order) => { splats.order(order); ordered = true; ask(); }),
    orbit(canvas, head.eye, () => { byId("eye").value = "free"; fixed = null; ask(); })];
  let ordered = false, asked = false, playing = null, fixed = null;

  const row = () => Number(byId("time").value);
  const robot = () => robots[Number(byId("robot").value) || 0];

  function view() {
    if (fixed) return fixed.view;
    const kind = byId("eye").value;
    return kind === "free" || !robot() ? freeView(free) : carriedView(robot().pose(row()), kind, head.camera_height);
  }

  function draw() {
    asked = false;
    const ratio = fixed ? 1 : Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const focal = fixed ? fixed.focal : height / 2 / Math.tan(head.fov / 2);
    const eye = { view: view(), focal, width, height, near: NEAR, far: FAR };
    // What is above the cut, or close to an eye behind a robot, would hide the robot.
    const kind = fixed ? "fixed" : byId("eye").value;
    eye.hidden = kind === "behind" ? 2.6 : 0;
    eye.cut = kind === "fixed" || kind === "robot" ? 1e9 : Number(byId("cut").value);
    eye.projection = perspective(focal, width, height, NEAR, FAR);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...(fixed ? fixed.background : [0.08, 0.09, 0.1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    if (!fixed || fixed.objects) {
      for (const item of objects) {
        const pose = item.pose(row());
        const inside = kind === "robot" && item === robot();
        if (Number.isFinite(pose[0]) && !inside) solids.draw(item.body, item.color, pose, eye);
        if (item.path) solids.draw(item.path, item.color, [0, 0, 0], eye);
      }
    }
    if (byId("shown").checked && ordered) splats.draw(eye);
    sorts.ask([-eye.view[2], -eye.view[6], -eye.view[10]]);
    byId("cut_at").textContent = `${Number(byId("cut").value).toFixed(1)} m`;
    byId("clock").textContent = `${(head.times[row()] ?? 0).toFixed(1)} s`;
    canvas.dataset.state = ordered && sorts.idle() ? "ready" : "sorting";
  }

  function ask() {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  }

  function play(now) {
    if (!playing) return;
    const last = head.rows - 1, time = playing.time + (now - playing.now) / 1000;
    let at = row();
    while (at < last && head.times[at + 1] <= time) at++;
    byId("time").value = at;
    draw();
    if (at >= last) toggle();
    else requestAnimationFrame(play);
  }

  function toggle() {
    if (playing) playing = null;
    else {
      if (row() >= head.rows - 1) byId("time").value = 0;
      playing = { now: performance.now(), time: head.times[row()] };
      requestAnimationFrame(play);
    }
    byId("play").textContent = playing ? "pause" : "play";
    byId("play").setAttribute("aria-pressed", String(Boolean(playing)));
  }

  byId("play").addEventListener("click", toggle);
  canvas.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    event.preventDefault();
    toggle();
  });
  for (const id of ["time", "eye", "robot", "cut", "shown"]) byId(id).addEventListener("input", () => {
    fixed = null;
    if (playing && id === "time") toggle();
    ask();
  });
  window.addEventListener("resize", ask);
  byId("message").textContent = "";
  // For programs: look from a point to another one with a focal length in pixels, without or with objects.
  globalThis.irsim = {
    look(eye, target, focal, background = [1, 1, 1], shown = true) {
      fixed = { view: lookAt(eye, target), focal, background, objects: shown };
      canvas.dataset.state = "sorting";
      ask();
    },
  };
  ask();
}

start().catch((error) => {
  byId("message").textContent = `The scene cannot be shown: ${error.message}`;
  byId("view").dataset.state = "failed";
});
