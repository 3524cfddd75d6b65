// The cells of a map: unpacked, drawn once as an image, and crossed by beams.

export function cellsOf({ cells: [nx, ny], extent: [left, right, bottom, top] }, runs, unknownRuns) {
  const full = unpacked(nx * ny, runs), unknown = unpacked(nx * ny, unknownRuns ?? []);
  return { nx, ny, left, right, bottom, top, dx: (right - left) / nx, dy: (top - bottom) / ny, full, unknown };
}

/** Cells that alternate in runs, beginning with 0. */
function unpacked(count, runs) {
  const cells = new Uint8Array(count);
  let at = 0, set = 0;
  for (const length of runs) {
    if (set) cells.fill(1, at, at + length);
    at += length;
    set ^= 1;
  }
  return cells;
}

/** The map as an image of one pixel per cell, the top row first; unknown cells are pale. */
export function cellImage({ nx, ny, full, unknown }, [red, green, blue]) {
  const canvas = document.createElement("canvas");
  canvas.width = nx;
  canvas.height = ny;
  const context = canvas.getContext("2d"), image = context.createImageData(nx, ny);
  for (let j = 0; j < ny; j++) {
    for (let i = 0; i < nx; i++) {
      const cell = j * nx + i;
      if (full[cell] || unknown[cell])
        image.data.set([red, green, blue, full[cell] ? 255 : 60], 4 * ((ny - 1 - j) * nx + i));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Distance to the first occupied cell, at most `reach`: from border to border of the cells a beam crosses. */
export function castCells(cells, x, y, dx, dy, reach) {
  const { nx, ny, left, bottom, right, top, full } = cells;
  let near = 0, far = reach;
  for (const [from, way, low, high] of [[x, dx, left, right], [y, dy, bottom, top]]) {
    if (Math.abs(way) < 1e-12) {
      if (from < low || from > high) return reach;
      continue;
    }
    const a = (low - from) / way, b = (high - from) / way;
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  if (near >= far) return reach;
  const start = near + 1e-9;
  let i = Math.min(nx - 1, Math.max(0, Math.floor((x + start * dx - left) / cells.dx)));
  let j = Math.min(ny - 1, Math.max(0, Math.floor((y + start * dy - bottom) / cells.dy)));
  const stepX = dx > 0 ? 1 : -1, stepY = dy > 0 ? 1 : -1;
  const overX = Math.abs(cells.dx / dx), overY = Math.abs(cells.dy / dy);
  let nextX = dx ? (left + (i + (dx > 0)) * cells.dx - x) / dx : Infinity;
  let nextY = dy ? (bottom + (j + (dy > 0)) * cells.dy - y) / dy : Infinity;
  let at = near;
  while (at < far && i >= 0 && i < nx && j >= 0 && j < ny) {
    if (full[j * nx + i]) return at;
    if (nextX < nextY) {
      at = nextX;
      nextX += overX;
      i += stepX;
    } else {
      at = nextY;
      nextY += overY;
      j += stepY;
    }
  }
  return reach;
}
