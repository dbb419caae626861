// The picture as an SVG of its own, with what the plots show.

import { lowerBound } from "./pyramid.js";

const [WIDTH, LEFT, RIGHT, SIGNAL, SPIKES, GAP] = [960, 76, 12, 300, 90, 26];
const escape = (text) => String(text).replace(/[&<>"]/g, (own) => `&#${own.charCodeAt(0)};`);
const short = (value) => String(Number(value.toPrecision(4)));

/** Round numbers between two. */
function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((own) => own * power).find((own) => own >= rough);
  const all = [];
  for (let at = Math.ceil(low / step) * step; at <= high; at += step) all.push(at);
  return all;
}

export function picture(plots, colours) {
  const { recording, runs, view, times } = plots;
  const [[xs, ...series]] = plots.data();
  let [low, high] = [Infinity, -Infinity];
  for (const own of series) for (const value of own) if (value !== null) [low, high] = [Math.min(low, value), Math.max(high, value)];
  const air = 0.06 * (high - low) || 1;
  [low, high] = [low - air, high + air];
  const x = (time) => LEFT + ((time - view[0]) / (view[1] - view[0])) * (WIDTH - LEFT - RIGHT);
  const y = (value) => 30 + ((high - value) / (high - low)) * (SIGNAL - 40);
  const height = SIGNAL + runs.length * (SPIKES + GAP) + 34;
  const text = (words, at, more = "") => `<text x="${at[0].toFixed(1)}" y="${at[1].toFixed(1)}" ${more}>${escape(words)}</text>`;
  const out = [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}" font-family="sans-serif" font-size="13" fill="${colours.ink}" stroke-linejoin="round">`,
    `<rect width="100%" height="100%" fill="${colours.paper}"/>`,
    `<clipPath id="inside"><rect x="${LEFT}" y="0" width="${WIDTH - LEFT - RIGHT}" height="${height}"/></clipPath>`,
  ];
  for (const value of ticks(low, high, 5)) {
    out.push(`<path d="M${LEFT} ${y(value).toFixed(1)}H${WIDTH - RIGHT}" stroke="${colours.grid}"/>`, text(short(value), [LEFT - 6, y(value) + 4], 'text-anchor="end"'));
  }
  out.push(text(recording.unit ? `${recording.name}, ${recording.unit}` : recording.name, [LEFT, 18]));
  series.forEach((own, place) => {
    if (own[0] === null) return; // hidden
    const points = xs.map((time, at) => `${x(time).toFixed(1)} ${y(own[at]).toFixed(1)}`);
    const colour = place === 0 ? colours.signal : runs[place - 1].colour;
    out.push(`<path clip-path="url(#inside)" d="M${points.join("L")}" fill="none" stroke="${colour}" stroke-width="1.5"/>`);
  });
  const [start, end] = plots.samples();
  runs.forEach((run, place) => {
    const top = SIGNAL + GAP + place * (SPIKES + GAP);
    const { sample, neuron, slot, up } = run.arrays;
    const row = SPIKES / run.neurons;
    const drawn = ["", ""], seen = new Set();
    for (let at = lowerBound(sample, start); at < sample.length && sample[at] < end; at++) {
      const time = times.at(sample[at]) + (run.slots > 1 ? (slot[at] / run.slots) * times.step : 0);
      const column = x(time).toFixed(1), key = `${column} ${neuron[at]} ${up[at]}`;
      if (seen.has(key)) continue;
      seen.add(key);
      const [from, length] = run.neurons > 1 ? [top + SPIKES - (neuron[at] + 1) * row, row]
        : run.isSigned ? [up[at] ? top : top + SPIKES / 2, SPIKES / 2] : [top, SPIKES];
      drawn[up[at]] += `M${column} ${from.toFixed(1)}v${length.toFixed(1)}`;
    }
    out.push(text(`${run.name}: ${run.figures.spikes} spikes, RMSE ${short(run.figures.rmse)}`, [LEFT, top - 6], `style="fill:${run.colour}"`));
    out.push(`<path clip-path="url(#inside)" d="${drawn[1]}" stroke="${colours.ink}" fill="none"/>`, `<path clip-path="url(#inside)" d="${drawn[0]}" stroke="${colours.down}" fill="none"/>`);
  });
  for (const time of ticks(view[0], view[1], 8)) out.push(text(short(time), [x(time), height - 18], 'text-anchor="middle"'));
  out.push(text(`time, ${times.unit}`, [WIDTH / 2, height - 3], 'text-anchor="middle"'), "</svg>\n");
  return out.join("\n");
}
