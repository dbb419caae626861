// What uPlot does not draw: bars for many samples, spikes, gaps, and the mark.

import { css } from "./dom.js";
import { lowerBound } from "./pyramid.js";

/** Where columns of pixels stand for many samples, each is a bar: thousands of tall lines take a browser long. */
export function paintColumns(plot) {
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

/** A line at the sample that is marked, and one at the cursor if the keyboard moves it. */
export function paintMark(plot, { mark, pointed, isStepped, times }) {
  const { ctx, bbox: { left, width, top, height } } = plot;
  for (const [sample, colour] of [[mark, "--ink"], [isStepped ? pointed : undefined, "--quiet"]]) {
    if (sample === undefined) continue;
    const x = Math.round(plot.valToPos(times.at(sample), "x", true));
    if (x < left || x > left + width) continue;
    ctx.fillStyle = css(colour);
    ctx.fillRect(x, top, Math.max(1, Math.round(devicePixelRatio)), height);
  }
}

/** The gaps of the recording, as bars over the whole height. */
export function paintGaps(plot, { recording: { gaps }, times }) {
  const { ctx, bbox: { left, width, top, height } } = plot;
  ctx.fillStyle = css("--gap");
  for (const after of gaps) {
    const from = Math.max(left, plot.valToPos(times.at(after), "x", true)), to = Math.min(left + width, plot.valToPos(times.at(after + 1), "x", true));
    if (to > left && from < left + width) ctx.fillRect(from, top, Math.max(devicePixelRatio, to - from), height);
  }
}

/** One stroke for all spikes of a neuron that fall on a column of pixels. */
export function paintSpikes(plot, run, plots) {
  if (!run) return;
  const { times } = plots, { sample, neuron, slot, up } = run.arrays;
  const { ctx } = plot;
  const { left, width, top, height } = plot.bbox;
  const x = (time) => Math.round(plot.valToPos(time, "x", true));
  const y = (value) => plot.valToPos(value, "y", true);
  const [start, end] = plots.samples();
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
  const most = Math.ceil(4 * run.neurons * (run.slots || 1));
  let column = -1, seen = 0;
  while (at < stop) {
    const own = sample[at];
    const time = times.at(own) + (run.slots > 1 ? (slot[at] / run.slots) * times.step : 0);
    const place = x(time);
    if (place !== column) [column, seen] = [place, 0];
    else if (++seen > most && stop - at > 4096) {
      const next = times.first(plot.posToVal((place + 1 - left) / devicePixelRatio, "x"));
      at = lowerBound(sample, Math.max(own + 1, next), at + 1, stop);
      continue;
    }
    const sign = up[at], row = isPopulation ? neuron[at] : 0;
    if (last[sign][row] !== place) {
      last[sign][row] = place;
      const [low, high] = isPopulation ? [row - 0.42, row + 0.42] : sign ? [0, 1] : [-1, 0];
      const upper = y(high);
      if (colour !== sign) ctx.fillStyle = colours[(colour = sign)];
      ctx.fillRect(place, upper, tick, Math.max(tick, y(low) - upper));
    }
    at++;
  }
  ctx.restore();
}
