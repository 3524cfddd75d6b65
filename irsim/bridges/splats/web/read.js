// The data of the page: base64 of a zlib stream; what is inside is written by irsim/bridges/splats/page_data.py.

const KINDS = { f4: Float32Array, u1: Uint8Array, i1: Int8Array };

export async function readData(text) {
  const raw = atob(text.trim());
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const block = await new Response(stream).arrayBuffer();
  const length = new DataView(block).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(block, 4, length)));
  const columns = {};
  for (const { name, kind, begin, count } of head.columns) {
    columns[name] = new KINDS[kind](block.slice(begin, begin + count * KINDS[kind].BYTES_PER_ELEMENT));
  }
  return { head, columns };
}
