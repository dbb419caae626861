// The charts below each other on one time axis, which the last one shows: signal, errors, and spikes of each setting.

import uPlot from "uplot";
import { css, fine } from "./dom.js";
import { paintColumns, paintGaps, paintMark, paintSpikes } from "./painting.js";

/** Width of the numbers and of the label at the left, and height of the time axis. */
const NUMBERS = 56, LABEL = 16;
export const AXIS = NUMBERS + LABEL, TIMES = 36, RIGHT = 12;
/** Heights: the signal has what the others leave, of which errors and spikes give some if it is little. */
const ERRORS = 74, SPIKES = 54, NEURONS = 100, LEAST_SIGNAL = 0.45;
/** Lower strips have no room for numbers. */
const LOW = 40;
const FONT = "12px system-ui, sans-serif";
const line = uPlot.paths.linear();

/** The heights of signal, errors and each run's spikes in a stack of so many pixels. */
export function heights(all, runs) {
  const wanted = [ERRORS, ...runs.map(({ neurons }) => (neurons > 1 ? NEURONS : SPIKES))];
  const room = all - TIMES, sum = wanted.reduce((total, own) => total + own, 0);
  const share = Math.min(1, ((1 - LEAST_SIGNAL) * room) / sum), [errors, ...spikes] = wanted.map((own) => Math.floor(own * share));
  return { signal: Math.max(80, Math.floor(room - share * sum)), errors, spikes };
}

/** A range with air around it. */
function air(low, high) {
  if (!(low < high)) return [low - 1, low + 1];
  const more = 0.06 * (high - low);
  return [low - more, high + more];
}

/** A range around 0. */
function around(low, high) {
  const far = 1.1 * Math.max(Math.abs(low ?? 0), Math.abs(high ?? 0)) || 1;
  return [-far, far];
}

/** The numbers of an axis, or none while the strip is low; `below` is the height of the time axis under it. */
const numbers = (below = 0) => ({ values: (plot, all) => all.map((own) => (plot.height - below < LOW ? "" : fine(own))) });

const axis = (label, more) => ({
  stroke: css("--ink"), grid: { stroke: css("--grid"), width: 1 }, ticks: { stroke: css("--grid") }, font: FONT, labelFont: FONT, label, labelSize: LABEL, ...more,
});

/** Makes the charts in `plots.host`: { upper, errors, rasters }. */
export function charts(plots) {
  const { host, recording: { name, unit }, runs, times } = plots, width = plots.width();
  const tall = heights(plots.height(), runs);
  const common = {
    width, legend: { show: false }, padding: [5, RIGHT, 0, 0],
    cursor: { drag: { x: true, y: false, setScale: false }, sync: { key: "time" } },
  };
  const hooks = (...draw) => ({
    setSelect: [(plot) => plots.select(plot)], setCursor: [(plot) => plots.point(plot)],
    drawClear: [(plot) => paintGaps(plot, plots)], draw: [...draw, (plot) => paintMark(plot, plots)],
  });
  const x = { time: false, range: () => plots.view };
  const hidden = axis(null, { size: 0, ticks: { show: false }, values: (_, all) => all.map(() => "") });
  const stroke = (colour) => ({ stroke: colour, width: 1.5, points: { show: false }, paths: (...asked) => (plots.isThinned ? null : line(...asked)) });
  const columns = (plot) => plots.isThinned && paintColumns(plot);
  const words = unit ? `, ${unit}` : "", [signal, errors] = plots.data();
  const upper = new uPlot({
    ...common, height: tall.signal, scales: { x, y: { range: (_, low, high) => air(low, high) } },
    axes: [hidden, axis(`${name}${words}`, { size: NUMBERS })],
    series: [{}, ...[css("--signal"), ...runs.map(({ colour }) => colour)].map(stroke)],
    hooks: hooks(columns, (plot) => plot === plots.upper && plots.onSignal()),
  }, signal, host);
  const strip = new uPlot({
    ...common, height: tall.errors, scales: { x, y: { range: (_, low, high) => around(low, high) } },
    axes: [hidden, axis(tall.errors < LOW ? "" : "error", { size: NUMBERS, space: 20, ...numbers() })],
    series: [{}, ...runs.map(({ colour }) => stroke(colour))],
    hooks: hooks(columns),
  }, errors, host);
  const rasters = runs.map((own, place) => {
    const isLast = place === runs.length - 1, isPopulation = own.neurons > 1;
    const rows = isPopulation ? [-0.8, own.neurons - 0.2] : own.isSigned ? [-1.25, 1.25] : [0, 1.25];
    const label = runs.length > 1 ? own.name[0] : isPopulation ? "neuron" : "spikes";
    return new uPlot({
      ...common, height: tall.spikes[place] + (isLast ? TIMES : 0), scales: { x, y: { range: () => rows } },
      axes: [isLast ? axis(`time, ${times.unit}`, { size: 20, gap: 1, ticks: { stroke: css("--grid"), size: 4 } }) : hidden,
        axis(label, { size: NUMBERS, ...numbers(isLast ? TIMES : 0), grid: { show: false }, splits: isPopulation ? undefined : () => (own.isSigned ? [-1, 0, 1] : [0, 1]) })],
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: hooks((plot) => paintSpikes(plot, plots.runs[place], plots)),
    }, [plots.view, [0, 0]], host);
  });
  return { upper, errors: strip, rasters };
}
