// The drawings of a recording, and the words on the part in view.

import { Axes } from "./axes.js";
import { Band } from "./band.js";
import { showCursor } from "./cursor.js";
import { at } from "./dom.js";
import { Overview } from "./overview.js";
import { Plots } from "./plots.js";
import { Spectrum } from "./spectrum.js";

/** Called with the threshold to which the band on the signal is dragged. */
let onThreshold;
export const whenThreshold = (then) => (onThreshold = then);

export const plots = new Plots(at("plots"), { onRange: showRange, onCursor: () => showCursor(plots), onSignal: () => band.draw() });
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
