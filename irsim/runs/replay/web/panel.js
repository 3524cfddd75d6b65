// The column at the side, the head line and the clock.

import { hasBeliefs } from "./beliefs.js";
import { $, element, setTerms } from "./dom.js";
import { eventWords, manyWords, ofRobot, seconds, valuesOf } from "./words.js";

const LISTED = 300; // events at a time
const NONE = -1;

export function fillPanel(player, goToEvent) {
  const { run } = player, { head } = run;
  document.title = `${head.title} · irsim ${head.growing ? "run" : "replay"}`;
  $("title").textContent = $("title").title = head.title;
  unfold(false);
  const movers = run.objects.filter(({ track, role }) => track >= 0 && role !== "robot").map(({ index }) => index);
  $("robot").replaceChildren(
    element("option", { value: NONE, textContent: "none" }),
    ...[...run.robots, ...movers].map((index) => element("option", { value: index, textContent: run.objects[index].name })),
  );
  $("view").setAttribute("aria-label", `The world from above: ${run.robots.length} robots, ${run.objects.length - run.robots.length} other objects`);
  player.goToEvent = goToEvent;
  showRun(player);
}

/** How the run ended, what its record lacks, and its events. */
export function showRun(player) {
  const { run } = player, { head } = run;
  sayOutcome(run);
  const lacks = (head.notes ?? []).join("; "), left = Object.entries(head.left_out ?? {});
  note($("recordnote"), lacks && `This run: ${lacks}.`);
  note($("leftout"), left.length ? `Not listed, evenly over time: ${left.map(([kind, count]) => `${count} ${manyWords(kind)}`).join(", ")}.` : "");
  listEvents(player, 0);
  measureRun(run);
}

/** What depends on the length of the run and on the number of its events. */
function measureRun({ head, events, rows, time }) {
  $("time").max = rows - 1;
  $("events").style.setProperty("--time", `${seconds(time[rows - 1]).length}ch`);
  $("eventshead").textContent = `Events (${events.length < head.event_count ? `${events.length} of ` : ""}${head.event_count})`;
}

/** Show that a run has become longer, which had so many events before. */
export function growPanel(player, before) {
  const { run, listed, listedFrom } = player, count = run.events.length, list = $("events");
  measureRun(run);
  sayFacts(run);
  if (count === before) return;
  if (!before) {
    listEvents(player, 0);
    return;
  }
  if (listedFrom + listed.length < before) list.lastChild.remove(); // how many more there are
  for (let place = listedFrom + listed.length; place < Math.min(count, listedFrom + LISTED); place++) {
    listed.push(eventButton(player, run.events[place]));
    list.append(element("li", {}, listed.at(-1)));
  }
  const more = count - listedFrom - listed.length;
  if (more) list.append(element("li", {}, element("p", { textContent: `… ${more} more` })));
}

function note(place, text) {
  place.hidden = !text;
  place.textContent = text;
}

/** Show all of the facts, or as much as has room. */
export function unfold(whole) {
  const button = $("more");
  button.closest("header").classList.toggle("whole", whole);
  button.setAttribute("aria-expanded", String(whole));
  button.textContent = whole ? "less" : "more";
  if (!whole) offerMore();
}

/** A button where the facts have no room. */
export function offerMore() {
  const facts = $("facts"), button = $("more");
  if (button.getAttribute("aria-expanded") === "true") return;
  button.hidden = true;
  button.hidden = facts.scrollHeight <= facts.clientHeight + 1;
}

/** List the events from a place on. */
function listEvents(player, first) {
  const { run } = player, list = $("events"), count = run.events.length;
  const last = Math.min(count, first + LISTED), held = list.contains(document.activeElement);
  const buttons = run.events.slice(first, last).map((event) => eventButton(player, event));
  const before = first ? [element("p", { textContent: `… ${first} before` })] : [];
  const after = count > last ? [element("p", { textContent: `… ${count - last} more` })] : [];
  const none = count ? [] : [element("p", { textContent: run.growing ? "Nothing has happened yet." : "Nothing happened." })];
  list.replaceChildren(...[...before, ...buttons, ...after, ...none].map((part) => element("li", {}, part)));
  Object.assign(player, { listed: buttons, listedFrom: first, current: null, heldFocus: held });
}

function eventButton({ run, goToEvent }, event) {
  const className = `${event.kind}${ofRobot(run, event) ? "" : " other"}`, button = element("button", { type: "button", className },
    element("i"), element("time", { textContent: seconds(event.time) }), element("span", { textContent: eventWords(run, event) }));
  button.addEventListener("click", () => goToEvent(event));
  return button;
}

/** The outcome; of a simulation that ran ahead it is what comes, until its end has been shown. */
function sayOutcome(run) {
  const { outcome, status } = run.head, badge = $("outcome"), comes = outcome && !run.endShown;
  badge.hidden = false;
  badge.textContent = comes ? `ends with: ${outcome}` : outcome ?? status;
  badge.className = `badge ${comes ? "" : outcome ?? ""}`;
  sayFacts(run);
}

function sayFacts(run) {
  $("facts").textContent = $("facts").title = factsOf(run);
  offerMore();
}

function factsOf({ head, robots, growing, endShown, time, rows }) {
  const until = `simulated until ${seconds(time[rows - 1])}`, most = seconds(head.horizon * head.step_time);
  const far = growing ? `${until} of at most ${most}` : !endShown && head.outcome && `${until}, its end`;
  const facts = [far || head.reason || head.summary, `${robots.length} robot${robots.length === 1 ? "" : "s"}`, `seed ${head.seed}`];
  if (head.every > 1) facts.push(`one in ${head.every} steps is shown`);
  return facts.filter(Boolean).join(" · ");
}

export function showMoment(player) {
  const { run, shown } = player, row = Math.floor(shown.at + 1e-6), time = player.seconds;
  $("time").value = row;
  const step = run.step[row], last = run.head.last_step;
  $("time").setAttribute("aria-valuetext", `${seconds(time)}, step ${step} of ${last}`);
  const clock = $("clock");
  if (!clock.firstChild) clock.append(element("span"), element("small"));
  clock.firstChild.textContent = seconds(time);
  clock.lastChild.textContent = ` / ${seconds(run.time[run.rows - 1])} · step ${step}`;
  setTerms($("values"), shown.robot >= 0 ? valuesOf(run, shown.robot, shown.at) : []);
  markCurrent(player, shown.at + 1e-6);
  if (!run.endShown && !run.growing && row >= run.rows - 1) {
    run.endShown = true;
    sayOutcome(run);
  }
}

/** The last event so far is marked in the list, and brought into view when it changes. */
function markCurrent(player, at) {
  const { events } = player.run, place = eventsUntil(events, at) - 1;
  const off = place - player.listedFrom, beyond = (off < 0 && player.listedFrom > 0) || off >= LISTED;
  if (beyond) listEvents(player, Math.max(0, Math.min(events.length - LISTED, place - LISTED / 2)));
  const button = player.listed[place - player.listedFrom] ?? null;
  $("events").classList.toggle("begins", place < 0);
  if (button === player.current) return;
  player.current?.removeAttribute("aria-current");
  player.current = button;
  if (!button) return;
  button.setAttribute("aria-current", "true");
  if (player.heldFocus) button.focus({ preventScroll: true });
  player.heldFocus = false;
  const list = $("events"), top = button.offsetTop - list.offsetTop;
  if (top < list.scrollTop || top + button.offsetHeight > list.scrollTop + list.clientHeight) {
    list.scrollTop = top - list.clientHeight / 2;
  }
}

function eventsUntil(events, at) {
  let low = 0, high = events.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (events[middle].row <= at) low = middle + 1;
    else high = middle;
  }
  return low;
}

export function showChoices({ run, shown }) {
  $("robot").value = shown.robot;
  for (const name of ["follow", "lidar", "trails", "goals", "names", "belief"]) $(name).setAttribute("aria-pressed", String(shown[name]));
  $("follow").disabled = shown.robot < 0;
  $("belief").hidden = !hasBeliefs(run);
  const lidars = run.lidars.get(shown.robot) ?? [], told = $("scannote");
  $("lidar").disabled = !lidars.length;
  $("follow").title = shown.robot < 0 ? "Choose a robot to follow" : "Keep the robot in the middle (F)";
  $("lidar").title = lidars.length ? "Its scan (L)" : shown.robot < 0 ? "Choose a robot with a lidar" : "It has no lidar";
  told.hidden = !(shown.lidar && lidars.length);
  told.textContent = lidars.every(({ ranges }) => ranges)
    ? "Lidar: ranges as recorded in the run."
    : "Lidar: computed in this page from the shapes drawn, without the noise of the sensor.";
}
