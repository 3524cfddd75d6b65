// The studio: the text and the scene of a scenario side by side, kept equal; runs are played where the scene is.

import { $, element } from "./dom.js";
import { ask, BEGIN, END, enter, FAILED, receive, RESULT, ROWS } from "./feed.js";
import { actions, begin, extend, finish, player, say, show } from "./player.js";
import { drawChosen, listenToScene, scene } from "./scene.js";
import { addToStrip, beginStrip } from "./seeds.js";
import { compare, drawViews, endComparison } from "./compare.js";
import { makeText } from "./text.js";

const WAIT = 100; // milliseconds without a key until the text is checked
const MANY = 20; // seeds of the strip
const NEW = {
  robot: { kinematics: { name: "diff" }, shape: { name: "circle", radius: 0.2 }, behavior: { name: "dash" } },
  circle: { shape: { name: "circle", radius: 0.4 } },
  box: { shape: { name: "rectangle", length: 1, width: 0.6 } },
};
const file = { name: "scenario.yaml", mark: null, text: "" }; // its text as it was opened or saved; no mark: it is new
let version = 0, timer = 0, running = null, ran = "", fits = true;

const text = makeText($("editor"), {
  changed: () => {
    clearTimeout(timer);
    timer = setTimeout(check, WAIT);
    showSaved();
  },
  moved: (line) => {
    const index = scene.places.findIndex(({ lines }) => lines[0] <= line && line <= lines[1]);
    if (index >= 0) pick(index, false);
  },
  complete,
  keys: [
    { key: "Mod-s", run: () => (save(), true) },
    { key: "Mod-Enter", run: () => (run(), true) },
  ],
});

const seed = () => ($("seed").value === "" ? null : Number($("seed").value));
const asked = () => ({ text: text.get(), name: file.name, seed: seed(), policy: $("policy").value || null });

/** Check the text, and show the scene that it describes. */
async function check() {
  const mine = ++version, wanted = asked();
  const answer = await ask("/check", wanted);
  if (mine !== version) return; // the text has changed meanwhile
  if (answer.why) {
    state(answer.why, "error");
    return;
  }
  const findings = answer.findings.map((finding) => ({ ...finding, mend: finding.edit && (() => mend(finding.edit)) }));
  text.mark(findings);
  list(findings);
  state(answer.summary, findings.some(({ severity }) => severity === "error") || !answer.scene ? "error" : "good");
  if (!answer.scene || scene.drag) return;
  scene.places = answer.objects;
  if (running && ran === wanted.text) return; // this very text is being run
  stop();
  const chosen = scene.chosen;
  await show(bytesOf(answer.scene), !fits);
  fits = false;
  pick(chosen < answer.objects.length ? chosen : -1, false);
}

const bytesOf = (base64) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));

function state(words, kind) {
  $("state").textContent = words;
  $("state").className = kind;
}

function list(findings) {
  $("problems").replaceChildren(...findings.map(({ severity, message, fix, line, mend: mended }) => {
    const words = element("span", { textContent: message });
    if (fix) words.append(element("small", { textContent: `fix: ${fix}` }));
    const place = element("button", { type: "button", className: "line", title: `Go to line ${line ?? 1}` }, element("b", { textContent: severity }), element("small", { textContent: `line ${line ?? 1}` }));
    place.addEventListener("click", () => text.goTo(line ?? 1));
    const item = element("li", { className: severity }, place, words);
    if (mended) {
      const button = element("button", { type: "button", textContent: "Fix" });
      button.addEventListener("click", mended);
      item.append(button);
    }
    return item;
  }));
}

function pathOf(written) {
  return [...written.matchAll(/([^.[\]]+)|\[(\d+)\]/g)].map(([, key, index]) => (index === undefined ? key : Number(index)));
}

const mend = (found) => edit([{ ...found, path: pathOf(found.path) }]);

/** Make edits in the text. */
async function edit(edits) {
  const answer = await ask("/edit", { text: text.get(), edits });
  if (answer.why) {
    say(`Not changed: ${answer.why}.`);
    await check();
    return false;
  }
  text.put(answer.text);
  return true;
}

function pick(index, jump = true) {
  scene.chosen = index;
  const place = scene.places[index], object = player.run?.objects[index];
  $("remove").disabled = $("duplicate").disabled = !place || place.path[0] === "world";
  $("picked").textContent = place && object ? `${object.name}${place.why ? `: ${place.why}` : ""}` : "";
  if (place && jump) text.goTo(place.lines[0], false);
  actions.refresh();
}

async function add(kind) {
  const { x, y } = player.camera, at = [Math.round(20 * x) / 20, Math.round(20 * y) / 20, 0];
  const role = kind === "robot" ? "robot" : "obstacle", goal = kind === "robot" ? { goal: [at[0] + 2, at[1]] } : {};
  if (await edit([{ action: "append", path: [role], value: { ...NEW[kind], state: at, ...goal } }])) say("", true);
}

async function duplicate() {
  const { path } = scene.places[scene.chosen];
  await edit([{ action: "duplicate", path }]);
}

async function remove() {
  const { path } = scene.places[scene.chosen];
  scene.chosen = -1;
  await edit([{ action: "delete", path }]);
}

function stop() {
  endComparison();
  running?.abort();
  running = null;
  $("run").textContent = "Run";
  $("many").textContent = "20 seeds";
  $("compare").textContent = "Compare";
}

const parsed = (content) => JSON.parse(new TextDecoder().decode(content));

/** Simulate the text; `take(kind, content)` gets the frames. */
async function simulate(button, more, take) {
  if (running) {
    stop();
    check();
    return;
  }
  endComparison();
  const mine = running = new AbortController();
  ran = text.get();
  button.textContent = "Stop";
  try {
    await receive("/run", { ...asked(), ...more }, async (kind, number, content) => {
      if (running !== mine) return;
      if (kind === FAILED) state(new TextDecoder().decode(content), "error");
      else await take(kind, content);
    }, mine.signal);
  } catch (problem) {
    if (problem.name !== "AbortError") state(`The run was lost: ${problem.message}`, "error");
  }
  if (running === mine) stop();
}

/** Simulate one episode, which is played while it is simulated. */
const run = () => simulate($("run"), {}, async (kind, content) => {
  if (kind === BEGIN) await show(content, true);
  else if (kind === ROWS) await extend(content);
  else if (kind === END) finish(parsed(content));
  else if (kind === RESULT) sayResult(parsed(content));
});

function sayResult({ summary, reason, outcome, decisive_step: step }) {
  state(reason ? `${summary}. ${reason}` : summary, outcome === "success" ? "good" : "error");
  if (step === null) return;
  const jump = element("button", { type: "button", textContent: `Go to step ${step}` });
  jump.addEventListener("click", () => {
    const { run } = player, row = run.step.findIndex((one) => one >= step);
    actions.play(false);
    actions.seek(row < 0 ? run.rows - 1 : row);
  });
  $("state").append(jump);
}

/** Let the user choose policies, run each, and show them side by side. */
async function runCompared() {
  if (running) {
    stop();
    check();
    return;
  }
  const names = await choosePolicies();
  if (!names.length) return;
  const runs = [];
  for (const name of names) {
    const one = { name: name || "as written", blocks: [] };
    await simulate($("compare"), { policy: name || null }, (kind, content) => {
      if (kind === BEGIN || kind === ROWS) one.blocks.push(content);
      else if (kind === END) one.ending = parsed(content);
      else if (kind === RESULT) one.result = parsed(content);
    });
    if (!one.result) return; // it failed, or was stopped
    runs.push(one);
  }
  await compare(runs);
  state(runs.map(({ name, result }) => `${name}: ${result.outcome}`).join(", "), "");
}

function choosePolicies() {
  const boxes = [...$("policy").options].map(({ value, textContent, title }) => {
    const box = element("input", { type: "checkbox", value, checked: value === $("policy").value });
    return element("label", { title }, box, ` ${textContent}`);
  });
  $("choices").replaceChildren($("choices").firstElementChild, ...boxes);
  const chosen = () => [...$("choices").querySelectorAll("input:checked")].map(({ value }) => value);
  $("choices").onchange = () => {
    $("go").disabled = chosen().length < 2 || chosen().length > 4;
  };
  $("choices").onchange();
  $("choose").returnValue = "";
  $("choose").showModal();
  return new Promise((done) => {
    $("choose").onclose = () => done($("choose").returnValue === "go" ? chosen() : []);
  });
}

/** Simulate several seeds, and show how each ends. */
function runMany() {
  const outcomes = new Map();
  let one = null;
  if (!running) beginStrip();
  return simulate($("many"), { seeds: Array.from({ length: MANY }, (_, k) => k) }, async (kind, content) => {
    if (kind === BEGIN) one = { blocks: [content] };
    else if (kind === ROWS) one.blocks.push(content);
    else if (kind === END) one.ending = parsed(content);
    else if (kind === RESULT) {
      one.result = parsed(content);
      outcomes.set(one.result.outcome, (outcomes.get(one.result.outcome) ?? 0) + 1);
      await addToStrip(one);
      state([...outcomes].map(([outcome, count]) => `${count} × ${outcome}`).join(", "), outcomes.size === 1 && outcomes.has("success") ? "good" : "");
    }
  });
}

/** Words that fit at the cursor, for the editor: it asks after letters, and when the user does. */
async function complete(context) {
  const { number, from } = context.state.doc.lineAt(context.pos);
  if (!context.explicit && !context.matchBefore(/[\w-]+/) && !/[:{,-]\s$/.test(context.state.sliceDoc(from, context.pos))) return null;
  const answer = await ask("/complete", { text: text.get(), line: number, column: context.pos - from });
  if (answer.why || !answer.options.length) return null;
  const options = answer.options.map(({ label, apply, detail, info, kind }) => ({ label, apply, detail, type: kind, info: info || undefined }));
  return { from: from + answer.column, options, filter: false };
}

/** Have the browser keep the run of the text as a page of its own. */
async function download() {
  state("The page is being made …", "");
  const answer = await ask("/page", asked());
  if (answer.why) {
    state(answer.why, "error");
    return;
  }
  const address = URL.createObjectURL(new Blob([answer.html], { type: "text/html" }));
  element("a", { href: address, download: `${file.name.replace(/\.ya?ml$/, "")}.html` }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
  state("The page is in your downloads.", "good");
}

const isChanged = () => text.get() !== file.text;

function showSaved() {
  $("save").classList.toggle("changed", isChanged() || file.mark === null);
}

async function save() {
  const name = $("filename").value.trim(), written = text.get();
  const answer = await ask("/save", { name, text: written, mark: name === file.name ? file.mark : null });
  if (answer.text !== undefined && confirm(`${answer.why}. Replace it with the text of this page?`)) {
    const { mark } = await ask("/open", { name });
    Object.assign(file, await ask("/save", { name, text: written, mark }), { name, text: written });
  } else if (answer.why) {
    state(answer.why, "error");
    return;
  } else {
    Object.assign(file, { name, mark: answer.mark, text: written });
  }
  showSaved();
  await offer();
}

async function open(choice) {
  const answer = await ask("/open", choice);
  if (answer.why) {
    state(answer.why, "error");
    return;
  }
  Object.assign(file, { name: answer.name, mark: answer.mark, text: answer.text });
  $("filename").value = answer.name;
  if (answer.seed !== undefined) $("seed").value = answer.seed;
  $("seeds").hidden = true;
  fits = true;
  scene.chosen = -1;
  text.open(answer.text);
  showSaved();
  await check();
}

async function offer() {
  const { files, templates, policies, first } = await ask("/files", {});
  const chosen = $("policy").value;
  $("policy").replaceChildren(...policies.map(({ name, about }) => element("option", {
    value: name === "as-written" ? "" : name, textContent: name === "as-written" ? "as written" : name, title: about,
  })));
  $("policy").value = chosen;
  const group = (label, options) => element("optgroup", { label }, ...options);
  $("file").replaceChildren(
    element("option", { value: "", textContent: "Open …" }),
    group("Files", files.map((name) => element("option", { value: `name ${name}`, textContent: name }))),
    group("Templates", templates.map(({ name, title }) => element("option", { value: `template ${name}`, textContent: `${name}: ${title}` }))),
  );
  return { first };
}

async function start() {
  await enter();
  const { first } = await offer();
  await open(first ?? { template: "crossing" });
  if (first?.run) await run();
}

$("file").addEventListener("change", () => {
  const [kind, ...rest] = $("file").value.split(" ");
  $("file").value = "";
  const leave = !isChanged() || confirm("The text has changes that are not saved. Open another one?");
  if (kind && leave) open({ [kind]: rest.join(" ") });
});
$("save").addEventListener("click", save);
$("run").addEventListener("click", run);
$("many").addEventListener("click", runMany);
$("page").addEventListener("click", download);
$("compare").addEventListener("click", runCompared);
$("single").addEventListener("click", () => {
  endComparison();
  check();
});
$("seed").addEventListener("change", check);
$("duplicate").addEventListener("click", duplicate);
$("remove").addEventListener("click", remove);
for (const button of document.querySelectorAll("[data-add]")) button.addEventListener("click", () => add(button.dataset.add));
addEventListener("beforeunload", (event) => isChanged() && event.preventDefault());
listenToScene({
  edit,
  picked: pick,
  remove,
  duplicate,
  refuse: (index, why) => say(`${player.run.objects[index].name} cannot be dragged: ${why}.`),
});
player.over = (context, ratio) => drawViews(ratio) || drawChosen(context, ratio);
begin();
start().catch((problem) => say(`This page does not work: ${problem.message}`));
