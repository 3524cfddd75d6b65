// The packed run: base64 of a zlib stream; what is inside is written by irsim/runs/replay/columns.py.

export function bytesOf(text) {
  const raw = atob(text.trim());
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

export async function unpack(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const block = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(block.buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(block.subarray(4, 4 + length)));
  const columns = {};
  let at = 4 + length;
  for (const { name, shape, order } of head.columns) {
    const count = shape.reduce((all, one) => all * one, 1);
    columns[name] = column(block.subarray(at, at + 4 * count), count, shape[shape.length - 1], order);
    at += 4 * count;
  }
  return { head, columns };
}

function column(bytes, count, width, order) {
  const values = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    const folded = bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24);
    values[i] = (folded >>> 1) ^ -(folded & 1);
  }
  for (let turn = 0; turn < order; turn++) {
    for (let i = 0; i < count; i++) if (i % width) values[i] = (values[i] + values[i - 1]) | 0;
  }
  return values;
}
