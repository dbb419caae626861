// Signal, reconstructions, errors and spikes on one time axis that zooms and pans.

import { AXIS, charts, heights, RIGHT, TIMES } from "./charts.js";
import { css } from "./dom.js";
import { listen } from "./gestures.js";
import { Pyramid } from "./pyramid.js";
import { Times } from "./times.js";

/** A series that is hidden. */
const NOTHING = { at: () => null, range: () => [null, null] };

export class Plots {
  /** `onRange` is called with the samples in view, `onCursor` when the cursor or the mark moved, `onSignal` when the signal was drawn. */
  constructor(host, { onRange, onCursor, onSignal }) {
    Object.assign(this, { host, onRange, onCursor, onSignal });
    this.runs = [];
    /** The colours of the series that the user hides. */
    this.hidden = new Set();
    new ResizeObserver(() => this.resize()).observe(host);
  }

  get all() {
    return this.upper ? [this.upper, this.errors, ...this.rasters] : [];
  }

  /** Shows a recording, unless it is shown already. */
  look(recording) {
    if (recording === this.recording || !recording) return;
    this.recording = recording;
    this.times = new Times(recording.samples, recording.rate, recording.arrays.times);
    this.signal = new Pyramid(recording.arrays.values);
    this.runs = [];
    this.mark = this.pointed = undefined;
    this.onCursor();
    this.full = [this.times.at(0), Math.max(this.times.at(recording.samples - 1), this.times.at(0) + this.times.step)];
    this.view = [...this.full];
    this.rebuild();
  }

  /** Shows these runs, each with `decoded`, spikes, colour and name. */
  setRuns(runs, hidden) {
    this.hidden = hidden;
    const isShown = hidden.size === this.shownHidden && runs.length === this.runs.length && runs.every((own, place) => own === this.runs[place]);
    if (isShown && this.upper) return;
    this.shownHidden = hidden.size;
    const shape = (all) => all.map((own) => `${own.name}${own.colour}${own.neurons}`).join();
    const isSame = shape(runs) === shape(this.runs);
    const { values } = this.recording.arrays;
    for (const own of runs) {
      own.pyramid ??= new Pyramid(own.arrays.decoded);
      own.errors ??= new Pyramid(own.arrays.decoded, own.arrays.coded ?? values);
    }
    this.runs = runs;
    if (isSame && this.upper) this.draw();
    else this.rebuild();
  }

  rebuild() {
    for (const own of this.all) own.destroy();
    this.host.textContent = "";
    if (!this.recording) return;
    Object.assign(this, charts(this));
    this.size = `${this.width()} ${this.height()}`;
    for (const own of this.all) listen(own, this);
    this.onSignal();
    this.onCursor();
    this.onRange(this.samples());
  }

  /** Remembers the sample under the pointer, of the plot that it is over. */
  point(plot) {
    const { event, left } = plot.cursor;
    // A pointer that rests has no say after the keyboard moved the cursor.
    if (event === undefined || (this.isStepped && event === this.restsAt)) return;
    const sample = left >= 0 ? this.times.first(plot.posToVal(left, "x") - this.times.step / 2) : undefined;
    this.restsAt = event;
    this.isStepped = false;
    this.pointed = sample < this.times.count ? sample : undefined;
    this.onCursor();
  }

  /** Moves the cursor without a pointer, by so many columns of pixels or, where these are farther apart, samples. */
  step(by) {
    const [start, end] = this.samples(), stride = Math.max(1, Math.floor((end - start) / this.columns()));
    this.pointed = Math.max(0, Math.min(this.times.count - 1, this.pointed === undefined ? (start + end) >> 1 : this.pointed + by * stride));
    this.isStepped = true;
    const time = this.times.at(this.pointed), half = (this.view[1] - this.view[0]) / 2;
    if (time < this.view[0] || time > this.view[1]) this.show(time - half, time + half);
    else this.draw();
    this.onCursor();
  }

  /** Sets the mark on the sample under the cursor, or takes it away from there. */
  setMark() {
    this.mark = this.pointed === this.mark ? undefined : this.pointed;
    this.onCursor();
    this.draw();
  }

  /** Takes mark and cursor away. */
  clearCursor() {
    this.mark = this.pointed = undefined;
    this.onCursor();
    this.draw();
  }

  width() {
    return Math.max(240, this.host.clientWidth);
  }

  height() {
    return Math.max(240, this.host.clientHeight);
  }

  resize() {
    if (!this.upper || !this.host.clientWidth || this.size === `${this.width()} ${this.height()}`) return;
    const width = this.width(), tall = heights(this.height(), this.runs);
    this.size = `${width} ${this.height()}`;
    this.upper.setSize({ width, height: tall.signal });
    this.errors.setSize({ width, height: tall.errors });
    this.rasters.forEach((own, place) => own.setSize({ width, height: tall.spikes[place] + (place === this.rasters.length - 1 ? TIMES : 0) }));
    this.draw();
  }

  /** Columns of pixels that the signal has. */
  columns() {
    return Math.max(100, this.width() - AXIS - RIGHT);
  }

  /** The samples in view. */
  samples() {
    return [this.times.first(this.view[0]), this.times.first(this.view[1] + this.times.step / 2)];
  }

  /** Lowest and highest value of each column of pixels, or the samples where there are few: of signal and decoded values, and of the errors. */
  data() {
    const columns = this.columns();
    const start = Math.max(0, this.times.first(this.view[0]) - 1);
    const end = Math.min(this.times.count, this.times.first(this.view[1]) + 1);
    const shown = (own, series) => (this.hidden.has(own.variable) ? NOTHING : series);
    const signals = [this.hidden.has("--signal") ? NOTHING : this.signal, ...this.runs.map((own) => shown(own, own.pyramid))];
    const errors = this.runs.map((own) => shown(own, own.errors));
    const xs = [];
    this.isThinned = end - start > 4 * columns;
    if (!this.isThinned) {
      for (let sample = start; sample < end; sample++) xs.push(this.times.at(sample));
      const values = (own) => xs.map((_, place) => own.at(start + place));
      return [[xs, ...signals.map(values)], [xs, ...errors.map(values)]];
    }
    const per = (end - start) / columns, from = (column) => start + Math.floor(column * per);
    for (let column = 0; column < columns; column++) xs.push(this.times.at(from(column)), this.times.at(from(column)));
    const ranges = (own) => {
      const values = [];
      for (let column = 0; column < columns; column++) values.push(...own.range(from(column), Math.max(from(column) + 1, from(column + 1))));
      return values;
    };
    return [[xs, ...signals.map(ranges)], [xs, ...errors.map(ranges)]];
  }

  draw() {
    const [signal, errors] = this.data();
    this.upper.setData(signal);
    this.errors.setData(errors);
    for (const own of this.rasters) own.setData([this.view, [0, 0]]);
    this.onRange(this.samples());
  }

  show(low, high) {
    const [first, last] = this.full;
    const least = Math.min(last - first, 4 * this.times.step);
    const length = Math.max(least, Math.min(high - low, last - first));
    const start = Math.max(first, Math.min(low + (high - low - length) / 2, last - length));
    this.view = [start, start + length];
    this.draw();
  }

  zoom(factor, around = (this.view[0] + this.view[1]) / 2) {
    this.show(around + (this.view[0] - around) * factor, around + (this.view[1] - around) * factor);
  }

  pan(part) {
    const by = (this.view[1] - this.view[0]) * part;
    this.show(this.view[0] + by, this.view[1] + by);
  }

  select(plot) {
    if (plot.select.width < 3) return;
    this.hasDragged = true;
    const [low, high] = [plot.select.left, plot.select.left + plot.select.width].map((at) => plot.posToVal(at, "x"));
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.show(low, high);
  }

  /** The canvases below each other, as one. */
  canvas() {
    const all = this.all.map((own) => own.ctx.canvas);
    const joined = Object.assign(document.createElement("canvas"), {
      width: Math.max(...all.map((own) => own.width)),
      height: all.reduce((sum, own) => sum + own.height, 0),
    });
    const context = joined.getContext("2d");
    context.fillStyle = css("--paper");
    context.fillRect(0, 0, joined.width, joined.height);
    let top = 0;
    for (const own of all) {
      context.drawImage(own, 0, top);
      top += own.height;
    }
    return joined;
  }
}
