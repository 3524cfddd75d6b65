// A picture that is kept: somewhat larger than the view, so that it can be moved along without being drawn anew.

const MARGIN = 0.2; // of the view, on each side

export function makeLayer() {
  return { canvas: document.createElement("canvas"), camera: null, ratio: 0, key: null, row: -1 };
}

/**
 * Bring a layer up to date and copy it to the view.
 *
 * paint(context, camera, from, to) draws what is new between two rows; from is -1 on an empty layer.
 */
export function showLayer(layer, context, camera, ratio, key, row, alpha, paint) {
  const own = layer.camera, wide = Math.ceil(camera.width * (1 + 2 * MARGIN)), high = Math.ceil(camera.height * (1 + 2 * MARGIN));
  const moved = own && [(own.x - camera.x) * camera.scale, (camera.y - own.y) * camera.scale];
  const fits = own && own.scale === camera.scale && own.width === wide && own.height === high && layer.ratio === ratio
    && Math.abs(moved[0]) <= MARGIN * camera.width && Math.abs(moved[1]) <= MARGIN * camera.height;
  const target = layer.canvas.getContext("2d");
  if (!fits || layer.key !== key || row < layer.row) {
    layer.camera = { ...camera, width: wide, height: high };
    layer.ratio = ratio;
    layer.key = key;
    layer.row = -1;
    layer.canvas.width = Math.round(wide * ratio);
    layer.canvas.height = Math.round(high * ratio);
  }
  if (row > layer.row) {
    paint(target, layer.camera, layer.row, row);
    layer.row = row;
  }
  const { x, y } = layer.camera;
  const left = (camera.width - wide) / 2 + (x - camera.x) * camera.scale;
  const top = (camera.height - high) / 2 + (camera.y - y) * camera.scale;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.globalAlpha = alpha;
  context.drawImage(layer.canvas, Math.round(left * ratio), Math.round(top * ratio));
  context.globalAlpha = 1;
}
