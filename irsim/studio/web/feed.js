// The server of the page: an exchange of the token for a cookie, frames of a run, and commands to its simulation.

export const BEGIN = 1, ROWS = 2, END = 3, RESULT = 5, FAILED = 6;
const HEADER = 9; // bytes: length, kind, number

export class Refused extends Error {}

async function post(path, body, signal) {
  const answer = await fetch(path, { method: "POST", body, signal, cache: "no-store", credentials: "same-origin", redirect: "error" });
  if (answer.status === 403) throw new Refused(await answer.text());
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}

/** Exchange the token after the # of the address, which is gone from it afterwards, for a cookie. */
export async function enter() {
  const token = location.hash.slice(1);
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  await post("/session", token);
}

export const command = (what) => post("/command", JSON.stringify(what));

/** The answer of the server to a question, as data. */
export const ask = async (path, what) => (await post(path, JSON.stringify(what))).json();

/** Hand the frames from a number on to take(kind, number, content), one after the other, as long as the server sends. */
export const follow = (from, take) => receive("/stream", { from }, take);

/** Hand the frames with which the server answers to take(kind, number, content), until the last one. */
export async function receive(path, what, take, signal) {
  const reader = (await post(path, JSON.stringify(what), signal)).body.getReader();
  let held = new Uint8Array(0);
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    const more = new Uint8Array(held.length + value.length);
    more.set(held);
    more.set(value, held.length);
    held = more;
    let at = 0;
    while (held.length - at >= HEADER) {
      const view = new DataView(held.buffer, held.byteOffset + at), length = view.getUint32(0, true);
      if (held.length - at < HEADER + length) break;
      await take(view.getUint8(4), view.getUint32(5, true), held.slice(at + HEADER, at + HEADER + length));
      at += HEADER + length;
    }
    held = held.slice(at);
  }
}
