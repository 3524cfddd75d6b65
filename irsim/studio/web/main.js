// Starts the page of a run that is being simulated: the player of recorded runs, fed by the server of the page.

import { $, element } from "./dom.js";
import { BEGIN, command, END, enter, follow, Refused, ROWS } from "./feed.js";
import { begin, extend, finish, player, say, show } from "./player.js";

const AGAIN = [200, 500, 1000, 2000, 4000]; // milliseconds before further attempts to reach the server
const GONE = { outcome: null, status: "ended", summary: "irsim has ended; what was simulated until then stays here" };

let next = 0, held = false;
const button = element("button", { id: "hold", type: "button", hidden: true });

function hold(on) {
  held = on;
  button.textContent = on ? "Go on" : "Hold";
  button.title = on ? "Let the simulation go on (H)" : "Hold the simulation, which runs ahead of what is shown (H)";
  button.setAttribute("aria-pressed", String(on));
}

function order(what) {
  command(what).catch((problem) => say(`The simulation does not hear: ${problem.message}`));
}

function toggle() {
  hold(!held);
  order({ hold: held });
}

async function take(kind, number, content) {
  if (kind === BEGIN) {
    hold(false);
    button.hidden = false;
    await show(content);
  } else if (kind === ROWS) {
    await extend(content);
  } else if (kind === END) {
    button.hidden = true;
    finish(JSON.parse(new TextDecoder().decode(content)));
  } else {
    return;
  }
  next = number + 1;
}

async function run() {
  await enter();
  let tries = 0;
  while (tries < AGAIN.length) {
    const before = next;
    try {
      await follow(next, (...one) => take(...one).catch(({ message }) => {
        throw new Refused(`this page does not work: ${message}`);
      }));
      if (player.run && !player.run.growing) return; // the server has ended the stream, and nothing is left to come
    } catch (problem) {
      if (problem instanceof Refused) {
        say(`${problem.message}.`);
        return;
      }
    }
    tries = next > before ? 0 : tries;
    await new Promise((done) => setTimeout(done, AGAIN[tries++]));
  }
  button.hidden = true;
  if (player.run?.growing) finish(GONE);
  else if (!player.run) say("irsim has ended.");
}

hold(false);
$("ahead").after(button);
$("keys").querySelector("table").tBodies[0].append(element("tr", {}, element("td", {}, element("kbd", { textContent: "H" })),
  element("td", { textContent: "hold the simulation, which runs ahead of what is shown, or let it go on" })));
button.addEventListener("click", toggle);
document.addEventListener("keydown", (event) => {
  if (event.key.toLowerCase() !== "h" || event.ctrlKey || event.altKey || event.metaKey || button.hidden) return;
  event.preventDefault();
  toggle();
});
player.ahead = (steps) => held && order({ steps });
say("Waiting for the simulation …");
begin();
run().catch((problem) => say(`This page does not work: ${problem.message}`));
