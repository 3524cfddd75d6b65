// The order of splats from back to front, found in a worker so that the page stays smooth.

function work() {
  let centers, count;
  self.onmessage = ({ data }) => {
    if (data.centers) {
      centers = data.centers;
      count = centers.length / 3;
      return;
    }
    const [a, b, c] = data.axis;
    const depth = new Float32Array(count);
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < count; i++) {
      const d = a * centers[3 * i] + b * centers[3 * i + 1] + c * centers[3 * i + 2];
      depth[i] = d;
      if (d < low) low = d;
      if (d > high) high = d;
    }
    const steps = 65536, begin = new Uint32Array(steps + 1), keys = new Uint16Array(count);
    const scale = high > low ? (steps - 1) / (high - low) : 0;
    for (let i = 0; i < count; i++) {
      keys[i] = steps - 1 - Math.floor((depth[i] - low) * scale);
      begin[keys[i] + 1]++;
    }
    for (let k = 0; k < steps; k++) begin[k + 1] += begin[k];
    const order = new Uint32Array(count);
    for (let i = 0; i < count; i++) order[begin[keys[i]]++] = i;
    self.postMessage({ order, axis: data.axis }, [order.buffer]);
  };
}

// Calls `done` with an order that fits a direction of view; directions that come meanwhile wait, and only the last counts.
export function sorter(centers, done) {
  const worker = new Worker(URL.createObjectURL(new Blob([`(${work})()`], { type: "text/javascript" })));
  worker.postMessage({ centers });
  let busy = false, next = null, last = null;
  worker.onmessage = ({ data }) => {
    busy = false;
    done(data.order);
    if (next) ask(next);
  };
  function ask(axis) {
    if (last && axis.every((value, k) => Math.abs(value - last[k]) < 1e-4)) {
      if (!busy) next = null;
      return;
    }
    if (busy) {
      next = axis;
      return;
    }
    [busy, next, last] = [true, null, axis];
    worker.postMessage({ axis });
  }
  return { ask, idle: () => !busy && !next };
}
