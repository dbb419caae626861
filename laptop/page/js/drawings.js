// The drawings of a recording, and the words on the part in view and below the pointer.

import { Axes } from "./axes.js";
import { Band } from "./band.js";
import { at, fine } from "./dom.js";
import { Overview } from "./overview.js";
import { Plots } from "./plots.js";
import { Spectrum } from "./spectrum.js";

/** Called with the threshold to which the band on the signal is dragged. */
let onThreshold;
export const whenThreshold = (then) => (onThreshold = then);

export const plots = new Plots(at("plots"), { onRange: showRange, onCursor: showCursor, onSignal: () => band.draw() });
export const axes = new Axes(at("axes"), plots);
export const spectrum = new Spectrum(at("spectrum"), plots);
export const overview = new Overview(at("overview"), plots);
export const band = new Band(plots, (threshold) => onThreshold(threshold));

function showRange([start, end]) {
  const seconds = (sample) => `${Number(plots.times.at(sample).toPrecision(5))} ${plots.times.unit}`;
  at("in-view").textContent = `samples ${start} to ${end}` + (plots.times.unit === "s" ? `, ${seconds(start)} to ${seconds(Math.max(start, end - 1))}` : "");
  axes.draw();
  overview.draw();
  spectrum.drawSoon();
}

/** The values under the cursor, and how far they are from the marker. */
function showCursor(sample, marker) {
  const { recording: { name, unit: given, arrays: { values } }, runs, times } = plots;
  const unit = given ? ` ${given}` : "", time = (value) => `${fine(value)} ${times.unit}`;
  const ofRun = (run, place) => `${run.name} ${fine(run.pyramid.at(place) ?? NaN)}${unit} (off by ${fine(run.errors.at(place) ?? NaN)})`;
  const all = (place) => [`${name} ${fine(values[place])}${unit}`, ...runs.map((run) => ofRun(run, place))].join(" · ");
  const words = sample === undefined ? "" : `${time(times.at(sample))}: ${all(sample)}`;
  const apart = sample === undefined || marker === undefined ? "" : ` · from the mark ${time(times.at(sample) - times.at(marker))}, ${fine(values[sample] - values[marker])}${unit}`;
  at("under").textContent = words + apart || "Point at the picture for values; click to set a mark.";
}
