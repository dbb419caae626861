// The whole recording in a strip, with a brush over the part that is in view.

import { css } from "./dom.js";
import { AXIS, RIGHT } from "./charts.js";

/** How near to an edge of the brush a pointer takes the edge, in pixels. */
const EDGE = 7;

export class Overview {
  #drag;

  constructor(canvas, plots) {
    [this.canvas, this.plots] = [canvas, plots];
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => this.#start(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (this.#drag = undefined));
    canvas.addEventListener("dblclick", () => plots.recording && plots.show(...plots.full));
  }

  #width() {
    return Math.max(1, this.canvas.clientWidth - AXIS - RIGHT);
  }

  /** Where a time is, in pixels, and back. */
  #x(time) {
    const [first, last] = this.plots.full;
    return AXIS + ((time - first) / (last - first)) * this.#width();
  }

  #time(x) {
    const [first, last] = this.plots.full;
    return first + ((x - AXIS) / this.#width()) * (last - first);
  }

  /** Takes an edge of the brush, the brush itself, or begins a new one. */
  #start(event) {
    const { plots } = this;
    if (!plots.recording) return;
    this.canvas.setPointerCapture(event.pointerId);
    const x = event.offsetX, [left, right] = plots.view.map((time) => this.#x(time)), isWhole = plots.view[0] <= plots.full[0] && plots.view[1] >= plots.full[1];
    if (!isWhole && Math.abs(x - left) < EDGE) this.#drag = { from: plots.view[1] };
    else if (!isWhole && Math.abs(x - right) < EDGE) this.#drag = { from: plots.view[0] };
    else if (!isWhole && x > left && x < right) this.#drag = { grip: this.#time(x) - plots.view[0] };
    else this.#drag = { from: this.#time(x) };
  }

  #move({ offsetX: x }) {
    const { plots } = this;
    if (!this.#drag) return;
    const { from, grip } = this.#drag, time = this.#time(x);
    if (grip !== undefined) {
      const length = plots.view[1] - plots.view[0];
      plots.show(time - grip, time - grip + length);
    } else if (Math.abs(this.#x(from) - x) > 2) plots.show(Math.min(from, time), Math.max(from, time));
  }

  draw() {
    const { canvas, plots } = this, { recording, signal, times, view } = plots;
    const scale = devicePixelRatio, width = this.#width() * scale, height = canvas.clientHeight * scale;
    Object.assign(canvas, { width: canvas.clientWidth * scale, height });
    if (!recording || !canvas.clientWidth) return;
    const context = canvas.getContext("2d"), count = recording.samples, [low, high] = [recording.min, recording.max];
    const y = (value) => height - 2 - ((value - low) / (high - low || 1)) * (height - 4);
    context.fillStyle = css("--signal");
    const key = `${width} ${height}`;
    // The bars are the same until the recording or the size changes.
    if (this.bars?.signal !== signal || this.bars.key !== key) {
      const all = [], [first, last] = plots.full;
      for (let column = 0; column < width; column++) {
        const time = (part) => first + ((last - first) * part) / width;
        const from = Math.min(count - 1, times.first(time(column))), to = Math.min(count, Math.max(from + 1, times.first(time(column + 1))));
        all.push(signal.range(from, to));
      }
      this.bars = { signal, key, all };
    }
    this.bars.all.forEach(([least, most], column) => context.fillRect(AXIS * scale + column, y(most), 1, Math.max(scale, y(least) - y(most))));
    context.fillStyle = css("--gap");
    for (const after of recording.gaps) {
      const left = this.#x(times.at(after)) * scale;
      context.fillRect(left, 0, Math.max(2 * scale, this.#x(times.at(after + 1)) * scale - left), height);
    }
    const [left, right] = view.map((time) => this.#x(time) * scale);
    context.fillStyle = css("--brush");
    context.fillRect(left, 0, right - left, height);
    context.fillStyle = css("--signal");
    for (const edge of [left, right - 2 * scale]) context.fillRect(edge, 0, 2 * scale, height);
  }
}
