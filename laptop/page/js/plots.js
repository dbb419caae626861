// Signal and reconstructions over spikes, on one time axis that zooms and pans.

import uPlot from "uplot";
import { listen } from "./gestures.js";
import { lowerBound, Pyramid } from "./pyramid.js";
import { Times } from "./times.js";

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const AXIS = 64;
/** A series that is hidden. */
const NOTHING = { at: () => null, range: () => [null, null] };
const line = uPlot.paths.linear();

export class Plots {
  /** `onRange` is told the samples in view, `onCursor` the one under the pointer, and the one with the mark. */
  constructor(host, { onRange, onCursor }) {
    Object.assign(this, { host, onRange, onCursor });
    this.runs = [];
    /** The colours of the series that the user hides. */
    this.hidden = new Set();
    new ResizeObserver(() => this.resize()).observe(host);
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
    for (const own of runs) own.pyramid ??= new Pyramid(own.arrays.decoded);
    this.runs = runs;
    if (isSame && this.upper) this.draw();
    else this.rebuild();
  }

  rebuild() {
    for (const own of [this.upper, ...(this.rasters ?? [])]) own?.destroy();
    this.host.textContent = "";
    if (!this.recording) return;
    const width = this.width(), ink = css("--ink"), grid = css("--grid");
    const axis = (label, more) => ({ stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid }, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif", label, labelSize: 18, ...more });
    const common = {
      width, legend: { show: false }, padding: [8, 12, 0, 0],
      cursor: { drag: { x: true, y: false, setScale: false }, sync: { key: "time" } },
      hooks: { setSelect: [(plot) => this.select(plot)], setCursor: [(plot) => this.point(plot)] },
    };
    const { name, unit } = this.recording;
    const scales = { x: { time: false, range: () => this.view }, y: { range: (_, low, high) => air(low, high) } };
    this.upper = new uPlot({
      ...common, height: this.tall(), scales,
      axes: [axis("", { size: 24 }), axis(unit ? `${name}, ${unit}` : name, { size: AXIS })],
      series: [{}, ...[css("--signal"), ...this.runs.map((own) => own.colour)].map((stroke) => ({ stroke, width: 1.5, points: { show: false }, paths: (...asked) => (this.isThinned ? null : line(...asked)) }))],
      hooks: { ...common.hooks, draw: [(plot) => this.drawColumns(plot), (plot) => this.drawMark(plot)] },
    }, this.data(), this.host);
    this.rasters = this.runs.map((own, place) => {
      const isLast = place === this.runs.length - 1;
      const rows = own.neurons > 1 ? [-0.8, own.neurons - 0.2] : own.isSigned ? [-1.25, 1.25] : [0, 1.25];
      return new uPlot({
        ...common, height: (own.neurons > 1 ? 130 : 70) + (isLast ? 46 : 24),
        scales: { x: scales.x, y: { range: () => rows } },
        axes: [axis(isLast ? `time, ${this.times.unit}` : "", { size: isLast ? 28 : 24 }),
          axis((own.neurons > 1 ? "neuron" : "spikes") + (this.runs.length > 1 ? ` ${own.name[0]}` : ""), { size: AXIS, grid: { show: false }, splits: own.neurons > 1 ? undefined : () => (own.isSigned ? [-1, 0, 1] : [0, 1]) })],
        series: [{}, { paths: () => null, points: { show: false } }],
        hooks: { ...common.hooks, draw: [(plot) => this.drawSpikes(plot, this.runs[place]), (plot) => this.drawMark(plot)] },
      }, [this.view, [0, 0]], this.host);
    });
    for (const own of [this.upper, ...this.rasters]) listen(own, this);
    this.onRange(this.samples());
  }

  /** Tells the sample under the pointer, of the plot that it is over. */
  point(plot) {
    if (plot.cursor.event === undefined) return;
    const { left } = plot.cursor;
    const sample = left >= 0 ? this.times.first(plot.posToVal(left, "x") - this.times.step / 2) : undefined;
    this.pointed = sample < this.times.count ? sample : undefined;
    this.onCursor(this.pointed, this.mark);
  }

  /** Sets the mark on the sample under the pointer, or takes it away from there. */
  setMark() {
    this.mark = this.pointed === this.mark ? undefined : this.pointed;
    this.onCursor(this.pointed, this.mark);
    this.draw();
  }

  drawMark(plot) {
    if (this.mark === undefined) return;
    const { ctx, bbox: { left, width, top, height } } = plot;
    const x = Math.round(plot.valToPos(this.times.at(this.mark), "x", true));
    if (x < left || x > left + width) return;
    ctx.fillStyle = css("--ink");
    ctx.fillRect(x, top, Math.max(1, Math.round(devicePixelRatio)), height);
  }

  /** How tall the signal is drawn: what a window leaves beside spikes and figures. */
  tall() {
    return Math.max(150, Math.min(300, Math.round(0.3 * innerHeight)));
  }

  width() {
    return Math.max(240, this.host.clientWidth);
  }

  resize() {
    const width = this.width();
    if (!this.upper || this.upper.width === width) return;
    for (const own of [this.upper, ...this.rasters]) own.setSize({ width, height: own.height });
    this.draw();
  }

  /** Columns of pixels that the signal has. */
  columns() {
    return Math.max(100, this.width() - AXIS);
  }

  /** The samples in view. */
  samples() {
    return [this.times.first(this.view[0]), this.times.first(this.view[1] + this.times.step / 2)];
  }

  /** Lowest and highest value of each column of pixels, or the samples where there are few. */
  data() {
    const columns = this.columns();
    const start = Math.max(0, this.times.first(this.view[0]) - 1);
    const end = Math.min(this.times.count, this.times.first(this.view[1]) + 1);
    const all = [this.hidden.has("--signal") ? NOTHING : this.signal, ...this.runs.map((own) => (this.hidden.has(own.variable) ? NOTHING : own.pyramid))];
    const xs = [], series = all.map(() => []);
    this.isThinned = end - start > 4 * columns;
    if (!this.isThinned) {
      for (let sample = start; sample < end; sample++) {
        xs.push(this.times.at(sample));
        all.forEach((own, place) => series[place].push(own.at(sample)));
      }
      return [xs, ...series];
    }
    const per = (end - start) / columns;
    for (let column = 0; column < columns; column++) {
      const from = start + Math.floor(column * per), to = Math.max(from + 1, start + Math.floor((column + 1) * per));
      const x = this.times.at(from);
      xs.push(x, x);
      all.forEach((own, place) => series[place].push(...own.range(from, to)));
    }
    return [xs, ...series];
  }

  draw() {
    this.upper.setData(this.data());
    for (const own of this.rasters) own.setData([this.view, [0, 0]]);
    this.onRange(this.samples());
  }

  /** Where columns of pixels stand for many samples, each is a bar: thousands of tall lines take a browser long. */
  drawColumns(plot) {
    if (!this.isThinned) return;
    const { ctx, data: [xs, ...series] } = plot;
    const thick = 1.5 * devicePixelRatio;
    ctx.save();
    series.forEach((own, place) => {
      ctx.fillStyle = plot.series[place + 1].stroke();
      let [before, after] = [own[0], own[1]];
      for (let at = 0; at < xs.length; at += 2) {
        const x = Math.round(plot.valToPos(xs[at], "x", true));
        const end = at + 2 < xs.length ? Math.round(plot.valToPos(xs[at + 2], "x", true)) : x + 1;
        if (own[at] === null) continue;
        // Up to the bar before it, so that a line stays one.
        const top = plot.valToPos(Math.max(own[at + 1], before), "y", true);
        const bottom = plot.valToPos(Math.min(own[at], after), "y", true);
        ctx.fillRect(x, top - thick / 2, Math.max(1, end - x), bottom - top + thick);
        [before, after] = [own[at], own[at + 1]];
      }
    });
    ctx.restore();
  }

  /** One stroke for all spikes of a neuron that fall on a column of pixels. */
  drawSpikes(plot, run) {
    if (!run) return;
    const { sample, neuron, slot, up } = run.arrays;
    const { ctx } = plot;
    const { left, width, top, height } = plot.bbox;
    const x = (time) => Math.round(plot.valToPos(time, "x", true));
    const y = (value) => plot.valToPos(value, "y", true);
    const [start, end] = this.samples();
    let at = lowerBound(sample, start);
    const stop = lowerBound(sample, end, at);
    const tick = Math.max(1, Math.round(devicePixelRatio));
    const isPopulation = run.neurons > 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    const colours = [css("--down"), css("--ink")];
    let colour;
    const last = [new Int32Array(run.neurons).fill(-1), new Int32Array(run.neurons).fill(-1)];
    // Where there are many spikes in a column, those of its first samples stand for all.
    const most = Math.ceil((4 * run.neurons * (run.slots || 1)));
    let column = -1, seen = 0;
    while (at < stop) {
      const own = sample[at];
      const time = this.times.at(own) + (run.slots > 1 ? (slot[at] / run.slots) * this.times.step : 0);
      const place = x(time);
      if (place !== column) [column, seen] = [place, 0];
      else if (++seen > most && stop - at > 4096) {
        const next = this.times.first(plot.posToVal((place + 1 - left) / devicePixelRatio, "x"));
        at = lowerBound(sample, Math.max(own + 1, next), at + 1, stop);
        continue;
      }
      const sign = up[at], of = isPopulation ? neuron[at] : 0;
      if (last[sign][of] !== place) {
        last[sign][of] = place;
        const [low, high] = isPopulation ? [of - 0.42, of + 0.42] : sign ? [0, 1] : [-1, 0];
        const upper = y(high);
        if (colour !== sign) ctx.fillStyle = colours[(colour = sign)];
        ctx.fillRect(place, upper, tick, Math.max(tick, y(low) - upper));
      }
      at++;
    }
    ctx.restore();
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
    const all = [this.upper, ...this.rasters].map((own) => own.ctx.canvas);
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

/** A range with air around it. */
function air(low, high) {
  if (!(low < high)) return [low - 1, low + 1];
  const more = 0.06 * (high - low);
  return [low - more, high + more];
}
