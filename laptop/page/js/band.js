// The threshold as a band on the signal: its edges are one threshold off the middle, and can be dragged.

import { element, fine } from "./dom.js";

/** How many samples in view, evenly spread, are looked at for the middle. */
const LOOKED = 201;

/** The median of the signal in view: where it is most of the time. */
function middle(signal, start, end) {
  const all = Float64Array.from({ length: LOOKED }, (_, place) => signal.at(Math.min(Math.max(start, end - 1), start + Math.floor(((end - start) * place) / LOOKED))));
  return all.sort()[LOOKED >> 1];
}

export class Band {
  #band = element("div", { className: "band", ariaHidden: "true" });
  #words = element("span");
  #middle = 0;

  /** `onChange(value)` is called with the threshold that the user drags to. */
  constructor(plots, onChange) {
    Object.assign(this, { plots, onChange });
    const edges = [element("div"), element("div")];
    this.#band.append(...edges, this.#words);
    for (const edge of edges) {
      const stop = (event) => event.stopPropagation();
      // The chart below would begin to zoom.
      for (const name of ["mousedown", "click", "dblclick"]) edge.addEventListener(name, stop);
      edge.addEventListener("pointerdown", (event) => {
        stop(event);
        edge.setPointerCapture(event.pointerId);
      });
      edge.addEventListener("pointermove", (event) => {
        if (edge.hasPointerCapture(event.pointerId)) this.#drag(event);
      });
    }
  }

  #drag({ clientY }) {
    const plot = this.plots.upper, value = plot.posToVal(clientY - plot.over.getBoundingClientRect().top, "y");
    const threshold = Math.abs(value - this.#middle);
    if (threshold > 0) this.onChange(threshold);
  }

  /** Draws a band of this threshold; none if it is undefined. */
  show(threshold, unit) {
    Object.assign(this, { threshold, unit });
    this.draw();
  }

  draw() {
    const { upper, signal } = this.plots, { threshold, unit } = this;
    if (!upper || !(threshold > 0)) return this.#band.remove();
    if (this.#band.parentElement !== upper.over) upper.over.append(this.#band);
    this.#middle = middle(signal, ...this.plots.samples());
    const height = upper.over.clientHeight, edge = (value) => Math.max(0, Math.min(height, upper.valToPos(value, "y")));
    const top = edge(this.#middle + threshold), bottom = edge(this.#middle - threshold);
    Object.assign(this.#band.style, { top: `${top}px`, height: `${Math.max(1, bottom - top)}px` });
    this.#words.textContent = `± ${fine(threshold)}${unit ? ` ${unit}` : ""}`;
  }
}
