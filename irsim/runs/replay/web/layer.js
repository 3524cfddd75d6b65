// A picture that is kept: somewhat larger than the view, so that it can be moved along without drawing it again.

const MARGIN = 0.2; // of the view, on each side
const SLICE = 2000; // rows times tracks that are painted at a time

export function makeLayer() {
  return { canvas: document.createElement("canvas"), camera: null, ratio: 0, key: null, from: 0, row: -1 };
}

/** Copy a layer to the view; paint(context, camera) fills it where it does not fit any more. */
export function showLayer(layer, context, camera, ratio, key, paint) {
  if (prepared(layer, camera, ratio, key)) paint(layer.canvas.getContext("2d"), layer.camera);
  copied(layer, context, camera, ratio, 1);
}

/**
 * Bring a layer of trails up to a row and copy it to the view.
 *
 * paint(context, camera, from, to) draws what lies between two rows and returns how many points that were. What is
 * newest comes first; about `most` points are painted at a time, the others in the frames that follow.
 *
 * @returns whether the trails are there from the start on
 */
export function showTrails(layer, context, camera, ratio, key, row, tracks, alpha, most, paint) {
  const slice = Math.max(8, Math.ceil(SLICE / Math.max(1, tracks)));
  const anew = prepared(layer, camera, ratio, key);
  if (anew || row < layer.row || row > layer.row + slice) {
    if (!anew) layer.canvas.width = layer.canvas.width; // empties it
    layer.from = layer.row = row;
  }
  const target = layer.canvas.getContext("2d");
  let points = row > layer.row ? paint(target, layer.camera, layer.row, row) : 0;
  layer.row = row;
  while (layer.from > 0 && points < most) {
    const from = Math.max(0, layer.from - slice);
    points += paint(target, layer.camera, from, layer.from);
    layer.from = from;
  }
  copied(layer, context, camera, ratio, alpha);
  return layer.from === 0;
}

/** Whether the layer had to be emptied, because it shows something else or another place. */
function prepared(layer, camera, ratio, key) {
  const own = layer.camera, wide = Math.ceil(camera.width * (1 + 2 * MARGIN)), high = Math.ceil(camera.height * (1 + 2 * MARGIN));
  const moved = own && [(own.x - camera.x) * camera.scale, (camera.y - own.y) * camera.scale];
  const fits = own && own.scale === camera.scale && own.width === wide && own.height === high && layer.ratio === ratio
    && Math.abs(moved[0]) <= MARGIN * camera.width && Math.abs(moved[1]) <= MARGIN * camera.height;
  if (fits && layer.key === key) return false;
  layer.camera = { ...camera, width: wide, height: high };
  layer.ratio = ratio;
  layer.key = key;
  layer.canvas.width = Math.round(wide * ratio);
  layer.canvas.height = Math.round(high * ratio);
  return true;
}

function copied(layer, context, camera, ratio, alpha) {
  if (!layer.canvas.width || !layer.canvas.height) return; // the page has no size yet, as in a frame of a notebook
  const { x, y, width, height } = layer.camera;
  const left = (camera.width - width) / 2 + (x - camera.x) * camera.scale;
  const top = (camera.height - height) / 2 + (camera.y - y) * camera.scale;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.globalAlpha = alpha;
  context.drawImage(layer.canvas, Math.round(left * ratio), Math.round(top * ratio));
  context.globalAlpha = 1;
}
