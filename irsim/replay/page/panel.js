// The column at the side, the head line and the clock.

import { $, element, setTerms } from "./dom.js";
import { eventWords, seconds, valuesOf } from "./words.js";

const LISTED = 500;
const NONE = -1;

export function fillPanel(player, goToEvent) {
  const { run } = player, { head } = run;
  document.title = `${head.title} · irsim replay`;
  $("title").textContent = $("title").title = head.title;
  const badge = $("outcome");
  badge.hidden = false;
  badge.textContent = head.outcome ?? head.status;
  badge.className = `badge ${head.outcome ?? ""}`;
  $("facts").textContent = $("facts").title = factsOf(run);
  const movers = run.objects.filter(({ track, role }) => track >= 0 && role !== "robot").map(({ index }) => index);
  $("robot").replaceChildren(
    element("option", { value: NONE, textContent: "none" }),
    ...[...run.robots, ...movers].map((index) => element("option", { value: index, textContent: run.objects[index].name })),
  );
  $("view").setAttribute("aria-label", `The world from above: ${run.robots.length} robots, ${run.objects.length - run.robots.length} other objects`);
  const told = run.events.slice(0, LISTED);
  $("eventshead").textContent = `Events (${head.event_count})`;
  $("events").replaceChildren(
    ...told.map((event) => {
      const button = element("button", { type: "button", className: event.kind }, element("i"),
        element("time", { textContent: seconds(event.time) }), element("span", { textContent: eventWords(run, event) }));
      button.addEventListener("click", () => goToEvent(event));
      return element("li", {}, button);
    }),
  );
  if (!told.length) $("events").append(element("p", { textContent: "Nothing happened." }));
  if (head.event_count > told.length) $("events").append(element("p", { textContent: `… and ${head.event_count - told.length} more` }));
  $("time").max = run.rows - 1;
  player.listed = [...$("events").querySelectorAll("button")];
  player.current = null;
}

function factsOf({ head, robots }) {
  const facts = [head.reason ?? head.summary, `${robots.length} robot${robots.length === 1 ? "" : "s"}`, `seed ${head.seed}`];
  if (head.every > 1) facts.push(`every ${head.every}th step is shown`);
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
  markCurrent(player, row);
}

/** The last event so far is marked in the list, and brought into view when it changes. */
function markCurrent(player, row) {
  const { run, listed } = player;
  let low = 0, high = listed.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (run.events[middle].row <= row) low = middle + 1;
    else high = middle;
  }
  const button = listed[low - 1] ?? null;
  if (button === player.current) return;
  player.current?.removeAttribute("aria-current");
  player.current = button;
  if (!button) return;
  button.setAttribute("aria-current", "true");
  const list = $("events"), top = button.offsetTop - list.offsetTop;
  if (top < list.scrollTop || top + button.offsetHeight > list.scrollTop + list.clientHeight) {
    list.scrollTop = top - list.clientHeight / 2;
  }
}

export function showChoices({ run, shown }) {
  $("robot").value = shown.robot;
  for (const name of ["follow", "lidar", "trails", "goals", "names"]) $(name).setAttribute("aria-pressed", String(shown[name]));
  $("follow").disabled = shown.robot < 0;
  const lidars = run.lidars.get(shown.robot) ?? [], note = $("scannote");
  $("lidar").disabled = !lidars.length;
  note.hidden = !(shown.lidar && lidars.length);
  note.textContent = lidars.every(({ ranges }) => ranges)
    ? "Lidar: ranges as recorded in the run."
    : "Lidar: computed in this page from the shapes drawn, without the noise of the sensor.";
}
