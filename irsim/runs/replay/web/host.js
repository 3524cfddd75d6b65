// In a host of MCP Apps: JSON-RPC over postMessage. The host tells the result of run_episode; its run is read from there.

import { bytesOf } from "./read.js";

const PROTOCOL = "2026-01-26", HEIGHT = 560;
const PATIENCE = 20000; // milliseconds for an answer

/** Talk to the host: `show(bytes)` gets each packed run, `say(text)` what there is to wait for, `dress(theme)` its theme. */
export function connect({ show, say, dress }) {
  const host = window.parent, waiting = new Map();
  let last = 0, latest = null;

  const send = (message) => host.postMessage({ jsonrpc: "2.0", ...message }, "*");
  const notify = (method, params = {}) => send({ method, params });

  function ask(method, params) {
    const id = ++last;
    send({ id, method, params });
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => finish(id, reject, new Error(`no answer to ${method}`)), PATIENCE);
      waiting.set(id, { resolve, reject, timer });
    });
  }

  function finish(id, how, what) {
    clearTimeout(waiting.get(id)?.timer);
    waiting.delete(id);
    how(what);
  }

  window.addEventListener("message", ({ source, data }) => {
    if (source !== host || data?.jsonrpc !== "2.0") return;
    const { id, method, params, result, error } = data;
    if (method === undefined) {
      const asked = waiting.get(id);
      if (asked) finish(id, error ? asked.reject : asked.resolve, error ? new Error(String(error.message)) : result);
    } else if (id !== undefined) {
      if (method === "ui/resource-teardown" || method === "ping") send({ id, result: {} });
      else send({ id, error: { code: -32601, message: "Method not found" } });
    } else if (method === "ui/notifications/tool-input") {
      say("Simulating …");
    } else if (method === "ui/notifications/tool-result") {
      onResult(params);
    } else if (method === "ui/notifications/tool-cancelled") {
      say("The run was cancelled.");
    } else if (method === "ui/notifications/host-context-changed") {
      dress(params?.theme);
    }
  });

  async function onResult(result) {
    const run = result?.structuredContent?.run_id;
    latest = run;
    if (typeof run !== "string") {
      say(result?.isError ? "The run failed; the answer of the tool says why." : "This run was not recorded.");
      return;
    }
    say("Reading the run …");
    try {
      const bytes = await readRun(run);
      if (latest === run) await show(bytes);
    } catch (problem) {
      if (latest === run) say(`The run cannot be read: ${problem.message}`);
    }
  }

  async function readRun(run) {
    const parts = [];
    for (let offset = 0, total = 1; offset < total;) {
      const { contents } = await ask("resources/read", { uri: `irsim://runs/${encodeURIComponent(run)}/replay.json?offset=${offset}` });
      const piece = JSON.parse(contents[0].text);
      if (!piece.data) throw new Error("a part of it is empty");
      parts.push(piece.data);
      offset += piece.data.length;
      total = piece.total;
    }
    return bytesOf(parts.join(""));
  }

  async function begin() {
    const answer = await ask("ui/initialize", {
      protocolVersion: PROTOCOL,
      appInfo: { name: "irsim-replay", version: "1" },
      appCapabilities: { availableDisplayModes: ["inline", "fullscreen"] },
    });
    dress(answer?.hostContext?.theme);
    notify("ui/notifications/initialized");
    notify("ui/notifications/size-changed", { height: HEIGHT });
  }

  say("Waiting for a run …");
  begin().catch((problem) => say(`The host does not answer: ${problem.message}`));
}
