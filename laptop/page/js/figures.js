// The figures of the settings beside each other.

import { at, element, fine, fixed } from "./dom.js";
import { state } from "./state.js";
import { verdict } from "./verdict.js";

/** How late a value is behind its sample, by filter and code: in ms where the rate is known, else in samples. */
const late = ({ latency, filterDelay }, rate) => (latency + (filterDelay ?? 0)) * (rate ? 1000 / rate : 1);

const instructions = ({ instructions: count, is_bound: isBound }) => (count === null ? "not measured" : `${isBound ? "at most " : ""}${fixed(count, 1)}`);

/** Fills the table: a column a setting, each with what came of it. */
export function showFigures(good, { unit: given, rate }) {
  const unit = given ? `, ${given}` : "";
  const rows = [
    ["Samples without a spike, %", ({ figures: { efficiency, spikes, samples } }) => (efficiency < 0 ? `${fixed(spikes / samples, 2)} spikes a sample` : fixed(efficiency, 2))],
    [`RMSE${unit}`, ({ figures }) => fine(figures.rmse)],
    ["Signal to noise, dB", ({ figures }) => fixed(figures.snr, 2)],
    ["Spikes", ({ figures }) => fixed(figures.spikes, 0)],
    ["Spikes a second", ({ figures }) => fixed(figures.spikes_per_second, 1)],
    ["Bytes a second, with keyframes", ({ linkBytesPerSecond }) => fixed(linkBytesPerSecond, 1)],
    ["Bytes of RAM a channel", ({ costs }) => fixed(costs.ram, 0)],
    ["Instructions a sample, Cortex-M4F", ({ costs }) => instructions(costs)],
    ["Instructions a sample, Cortex-M0", ({ costsWithoutFpu }) => instructions(costsWithoutFpu)],
    [rate ? "Late by, ms" : "Late by, samples", (run) => fixed(late(run, rate), 1)],
    [`Phase at ${state.bandwidth} Hz, °`, (run) => (rate ? fixed(0.36 * state.bandwidth * late(run, rate), 1) : "–")],
    ["Does it fly?", (run) => verdict(run.setting, run)[0]],
  ];
  const table = at("figures"), { caption } = table;
  const head = element("thead"), body = element("tbody");
  head.insertRow().append(element("th", { textContent: "Figure", scope: "col" }), ...good.map(({ name }) => element("th", { textContent: name, scope: "col" })));
  for (const [name, value] of rows) {
    const row = body.insertRow();
    row.append(element("th", { textContent: name, scope: "row" }));
    // Of what is previewed no figure of the whole is known yet.
    for (const run of good) row.insertCell().textContent = run.isPreview ? "…" : value(run);
  }
  table.replaceChildren(caption, head, body);
}
