// The player: what it shows and at which moment, of a run that is there at once or grows while it is simulated.

import { centre, fit, makeCamera, resize } from "./camera.js";
import { themeColors } from "./colors.js";
import { listen, offerSpeed, showTip, SPEEDS } from "./controls.js";
import { $ } from "./dom.js";
import { drawFrame, makeDrawing } from "./draw.js";
import { crowding } from "./glyphs.js";
import { fillPanel, growPanel, offerMore, showChoices, showMoment, showRun } from "./panel.js";
import { unpack } from "./read.js";
import { extendRun, makeRun, poseAt, rowOfTime, timeOfRow } from "./run.js";
import { drawMarks } from "./timeline.js";
import { eventWords, seconds } from "./words.js";

const POINTS = { playing: 2500, resting: 10000 }; // of trails, painted in one frame
const LONG = 60; // seconds: longer runs begin at a higher speed
const DARK = matchMedia("(prefers-color-scheme: dark)"), PRINT = matchMedia("print");

export const player = {
  run: null,
  camera: makeCamera([0, 1, 0, 1]),
  drawing: makeDrawing(),
  colors: null,
  chosenTheme: null,
  playing: false,
  seconds: 0,
  shown: { at: 0, robot: -1, follow: false, lidar: true, trails: true, goals: true, names: false, belief: true, speed: 1 },
  pointer: null,
  frame: 0,
  before: 0,
  wanted: null, // a row that is not simulated yet
  over: null, // draws on top of a frame, with its context
  ahead: null, // is called with the number of steps that are wanted beyond the last one
};

const PLAY = "M4 2.5v11l9.5-5.5z", PAUSE = "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z";

function refresh() {
  if (!player.frame) player.frame = requestAnimationFrame(onFrame);
}

function onFrame(now) {
  player.frame = 0;
  const { run, shown, camera } = player;
  if (!run) return;
  if (player.playing) {
    const passed = Math.min(0.25, Math.max(0, now - player.before) / 1000), end = run.time[run.rows - 1];
    player.seconds = Math.min(end, player.seconds + passed * shown.speed);
    shown.at = rowOfTime(run, player.seconds);
    if (player.seconds >= end && !run.growing) play(false);
  }
  player.before = now;
  if (shown.follow && shown.robot >= 0) {
    const { x, y } = poseAt(run, shown.robot, shown.at);
    centre(camera, x, y);
  }
  const most = player.playing ? POINTS.playing : POINTS.resting;
  const whole = drawFrame($("view").getContext("2d"), player.drawing, run, shown, camera, player.colors, ratio(), most);
  player.over?.($("view").getContext("2d"), ratio());
  showMoment(player);
  if (player.pointer) showTip(player);
  const waits = run.growing && player.seconds >= run.time[run.rows - 1];
  if ((player.playing && !waits) || !whole) refresh();
}

const ratio = () => Math.min(2, devicePixelRatio || 1);

function play(on) {
  const { run } = player;
  if (on && player.seconds >= run.time[run.rows - 1] && !run.growing) seek(0);
  player.playing = on;
  player.before = performance.now();
  $("play").setAttribute("aria-label", on ? "Pause" : "Play");
  $("play").querySelector("path").setAttribute("d", on ? PAUSE : PLAY);
  refresh();
}

function seek(row) {
  if (!player.run) return;
  goTo(row);
  if (player.wanted !== null) player.ahead?.(row - player.run.rows + 1);
}

function goTo(row) {
  const { run, shown } = player;
  player.wanted = run.growing && row > run.rows - 1 ? row : null;
  shown.at = Math.min(run.rows - 1, Math.max(0, row));
  player.seconds = timeOfRow(run, shown.at);
  refresh();
}

export function say(text, quiet = false) {
  $("message").textContent = text;
  $("message").className = quiet ? "quiet" : "";
}

export const actions = {
  seek,
  play,
  refresh,
  toggle: () => player.run && play(!player.playing),
  goToEvent(event) {
    const { run, shown } = player;
    play(false);
    seek(event.row);
    const robot = [event.object, event.partner].find((index) => run.objects[index]?.role === "robot");
    if (robot !== undefined) actions.choose(robot);
    if (shown.robot < 0) showChoices(player);
    say(`${seconds(event.time)}: ${eventWords(run, event)}`, true);
  },
  flip(name) {
    player.shown[name] = !player.shown[name];
    if (name === "follow" && player.shown.follow && player.camera.fitted) player.camera.scale *= 2;
    showChoices(player);
    refresh();
  },
  choose(index) {
    player.shown.robot = index;
    if (index < 0) player.shown.follow = false;
    showChoices(player);
    refresh();
  },
  setSpeed(speed) {
    player.shown.speed = speed;
    offerSpeed(speed);
    $("speed").value = speed;
  },
  theme() {
    player.chosenTheme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    dress();
  },
};

export function dress() {
  document.documentElement.dataset.theme = PRINT.matches ? "light" : player.chosenTheme ?? (DARK.matches ? "dark" : "light");
  player.colors = themeColors();
  if (player.run) {
    drawMarks(player.run, player.colors, ratio());
    refresh();
  }
}

function measure() {
  const canvas = $("view"), { clientWidth, clientHeight } = canvas;
  canvas.width = Math.round(clientWidth * ratio());
  canvas.height = Math.round(clientHeight * ratio());
  resize(player.camera, clientWidth, clientHeight);
  if (!player.run) return;
  offerMore();
  drawMarks(player.run, player.colors, ratio());
  if (player.frame) cancelAnimationFrame(player.frame);
  onFrame(performance.now());
}

/** Show a run from its start on; `keep` leaves the view and the choice of a robot as they are. */
export async function show(bytes, keep = false) {
  const run = makeRun(await unpack(bytes)), { shown } = player, chosen = player.run?.objects[shown.robot]?.name;
  player.run = run;
  player.playing = false;
  player.drawing = makeDrawing();
  if (!keep) player.camera = makeCamera(run.head.world);
  else if (String(player.camera.world) !== String(run.head.world)) Object.assign(player.camera, { world: run.head.world, fitted: true });
  const first = run.robots.find((index) => run.lidars.has(index)) ?? run.robots[0] ?? -1;
  const again = keep ? run.objects.findIndex(({ name }) => name === chosen) : -1;
  Object.assign(shown, { at: 0, follow: false, robot: again < 0 ? first : again });
  if (!keep) shown.names = crowding(run) < 2;
  fillPanel(player, actions.goToEvent);
  const length = run.time[run.rows - 1];
  actions.setSpeed(run.head.speed ?? SPEEDS.find((speed) => speed >= 1 && length / speed <= LONG) ?? SPEEDS.at(-1));
  say("", true);
  measure();
  if (player.camera.fitted) fit(player.camera);
  showChoices(player);
  play(false);
  seek(0);
  if (run.growing) play(true);
}

/** Append what has been simulated since. */
export async function extend(bytes) {
  const { run } = player, listed = run.events.length;
  extendRun(run, await unpack(bytes));
  growPanel(player, listed);
  drawMarks(run, player.colors, ratio());
  if (player.wanted !== null && !player.playing) goTo(player.wanted);
  refresh();
}

/** The run is over: say how it ended. */
export function finish(ending) {
  const { run } = player;
  Object.assign(run.head, ending);
  run.growing = false;
  player.wanted = null;
  showRun(player);
  refresh();
}

/** Put on a theme, the user's before that of a host before that of the system, light on paper, and listen to the user. */
export function begin() {
  dress();
  DARK.addEventListener("change", dress);
  PRINT.addEventListener("change", () => {
    dress();
    measure(); // at once, as paper waits for no frame
  });
  listen(player, actions);
  new ResizeObserver(measure).observe($("stage"));
}
