// Spectrum and histogram of the signal and of the errors, over what is in view.

import FFT from "fft.js";
import uPlot from "uplot";
import { at, css, element } from "./dom.js";

/** Samples of a window; windows lap by half and their power is averaged (Welch). */
const WINDOW = 2048;
/** The most samples that are looked at: the windows of a longer stretch lie apart. */
const MOST_WINDOWS = 256;
const BINS = 61;

/** Amplitude by frequency: the root of the mean power of Hann windows. */
export function amplitudes(values, start, end) {
  let size = WINDOW;
  while (size > end - start && size > 16) size /= 2;
  if (end - start < size) return [];
  const fft = new FFT(size), out = fft.createComplexArray(), sums = new Float64Array(size / 2);
  const hann = Float64Array.from({ length: size }, (_, place) => Math.sin((Math.PI * place) / size) ** 2);
  const windows = Math.min(MOST_WINDOWS, 1 + Math.floor((end - start - size) / (size / 2)));
  const stride = windows > 1 ? (end - start - size) / (windows - 1) : 0;
  for (let window = 0; window < windows; window++) {
    const own = values.subarray(start + Math.floor(window * stride), start + Math.floor(window * stride) + size);
    const mean = own.reduce((sum, value) => sum + value, 0) / size;
    fft.realTransform(out, own.map((value, place) => (value - mean) * hann[place]));
    for (let bin = 1; bin < size / 2; bin++) sums[bin] += out[2 * bin] ** 2 + out[2 * bin + 1] ** 2;
  }
  // A sine of amplitude 1 has the height 1: the mean of a Hann window is a half.
  return Array.from(sums.subarray(1), (sum) => (4 / size) * Math.sqrt(sum / windows));
}

export class Spectrum {
  #charts = [];
  #timer;

  constructor(host, plots) {
    [this.host, this.plots] = [host, plots];
  }

  drawSoon() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.draw(), 150);
  }

  draw() {
    clearTimeout(this.#timer);
    for (const chart of this.#charts) chart.destroy();
    this.#charts = [];
    if (at("spectrum-box").hidden || !this.plots.recording) return;
    const { recording, runs } = this.plots, [start, end] = this.plots.samples(), { values } = recording.arrays;
    const series = [{ name: "signal", colour: css("--signal"), values },
      ...runs.filter(({ isPreview }) => !isPreview).map(({ name, colour, arrays: { decoded, coded = values } }) => ({ name: `error of ${name}`, colour, values: decoded.map((value, place) => value - coded[place]) }))];
    const width = Math.max(240, this.host.clientWidth / 2 - 12);
    const chart = (title, label, unit, data, scales) => {
      const axis = (text) => ({ stroke: css("--ink"), grid: { stroke: css("--grid") }, ticks: { stroke: css("--grid") }, label: text, labelSize: 18, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif" });
      const host = element("figure");
      host.setAttribute("role", "img");
      host.setAttribute("aria-label", title);
      this.host.append(host);
      const made = new uPlot({
        width, height: 200, title: undefined, legend: { show: false }, cursor: { drag: { x: false } }, padding: [8, 12, 0, 0],
        scales: { x: { time: false }, ...scales }, axes: [axis(label), { ...axis(unit), size: 64 }],
        series: [{}, ...series.map(({ colour }) => ({ stroke: colour, width: 1.2, points: { show: false } }))],
      }, data, host);
      this.#charts.push(made);
    };
    this.host.textContent = "";
    const spectra = series.map((each) => amplitudes(each.values, start, end));
    if (spectra[0].length) {
      const step = (recording.rate ?? 1) / (2 * (spectra[0].length + 1));
      const floor = Math.max(1e-12, 1e-5 * Math.max(...spectra[0]));
      chart("Amplitude of the signal and of the errors by frequency", recording.rate ? "Hz" : "cycles a sample", recording.unit ? `amplitude, ${recording.unit}` : "amplitude",
        [spectra[0].map((_, bin) => (bin + 1) * step), ...spectra.map((own) => own.map((value) => Math.max(value, floor)))], { y: { distr: 3 } });
    }
    const errors = series.slice(1);
    const most = Math.max(1e-12, ...errors.map((each) => each.values.subarray(start, end).reduce((far, value) => Math.max(far, Math.abs(value)), 0)));
    const counts = series.map((each, place) => {
      if (!place) return Array(BINS).fill(null);
      const bins = Array(BINS).fill(0);
      for (let sample = start; sample < end; sample++) bins[Math.min(BINS - 1, Math.floor(((each.values[sample] / most + 1) / 2) * BINS))]++;
      return bins.map((count) => (100 * count) / (end - start));
    });
    if (errors.length) chart("Share of the samples by error", recording.unit ? `error, ${recording.unit}` : "error", "samples, %", [Array.from({ length: BINS }, (_, bin) => most * ((2 * bin + 1) / BINS - 1)), ...counts], {});
  }
}
