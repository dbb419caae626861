// The figures of the settings: four of the current one, and all of them beside each other.

import { html, render } from "lit-html";
import { at, element, fine, fixed } from "./dom.js";
import { state } from "./state.js";

/** How late a value is behind its sample, by filter and code: in ms where the rate is known, else in samples. */
const late = ({ latency, filterDelay }, rate) => (latency + (filterDelay ?? 0)) * (rate ? 1000 / rate : 1);
const phase = (run, rate) => 0.36 * state.bandwidth * late(run, rate);

const instructions = ({ instructions: count, is_bound: isBound }) => (count === null ? "not measured" : `${isBound ? "at most " : ""}${fixed(count, 1)}`);

/** The clock of the core whose share is shown, in Hz, at one instruction a cycle. */
const CLOCK = 168e6;
/** Bytes of a lean raw frame beside its sample: a start, a number and a checksum. */
const FRAME = 4;

/** Bytes a second of one channel's raw frames, one each period, with samples of a type such as `f32` or `q8.8`. */
function rawBytes(rate, type) {
  const bits = type.match(/\d+/g).reduce((sum, part) => sum + Number(part), 0);
  return rate * (FRAME + bits / 8);
}

/** A share in percent, to three digits. */
const percent = (share) => (Number.isFinite(share) ? `${Number((100 * share).toPrecision(3))} %` : "–");

/** The four figures of what came of a setting; none of a preview but those that its knob does not change. */
export function showTiles(run, { rate: measured, uneven }, { sample, unit }) {
  const rate = uneven ? undefined : measured;
  const share = run && rate && run.costs.instructions !== null ? (run.costs.instructions * rate) / CLOCK : NaN;
  const isKnown = run && !run.isPreview;
  const whole = (value) => (isKnown ? value : run ? "…" : "–");
  const tiles = [
    ["Bytes a second", whole(fixed(run?.linkBytesPerSecond, 0)), rate ? `raw frames: ${fixed(rawBytes(rate, sample), 0)}` : uneven ? "the rate is not sure" : "the rate is unknown"],
    [`Error${unit ? `, ${unit}` : ""}`, whole(fine(run?.figures.rmse)), isKnown ? `${fixed(run.figures.snr, 1)} dB` : " "],
    ["Late by", run ? `${fixed(late(run, rate), 1)} ${rate ? "ms" : "samples"}` : "–", run && rate ? `${fixed(phase(run, rate), 1)}° at ${state.bandwidth} Hz` : " "],
    ["Share of the core", percent(share), "M4F at 168 MHz"],
  ];
  render(tiles.map(([name, value, words]) => html`<div><dt>${name}</dt><dd>${value}</dd><dd>${words}</dd></div>`), at("tiles"));
}

/** Fills the table: a column a setting, each with what came of it. */
export function showFigures(good, { rate: measured, uneven }, given) {
  const unit = given ? `, ${given}` : "", rate = uneven ? undefined : measured;
  const rows = [
    ["Samples without a spike, %", ({ figures: { efficiency, spikes, samples } }) => (efficiency < 0 ? `${fixed(spikes / samples, 2)} spikes a sample` : fixed(efficiency, 2))],
    [`RMSE${unit}`, ({ figures }) => fine(figures.rmse)],
    ["Signal to noise, dB", ({ figures }) => fixed(figures.snr, 2)],
    ["Spikes", ({ figures }) => fixed(figures.spikes, 0)],
    ["Spikes a second", ({ figures }) => fixed(figures.spikes_per_second, 1)],
    ["Bytes a second, with keyframes", ({ linkBytesPerSecond }) => fixed(linkBytesPerSecond, 1)],
    ["Bytes a second, raw frames", ({ setting }) => fixed(rate && rawBytes(rate, setting.sample), 1)],
    ["Bytes of RAM a channel", ({ costs }) => fixed(costs.ram, 0)],
    ["Instructions a sample, Cortex-M4F", ({ costs }) => instructions(costs)],
    ["Instructions a sample, Cortex-M0", ({ costsWithoutFpu }) => instructions(costsWithoutFpu)],
    [rate ? "Late by, ms" : "Late by, samples", (run) => fixed(late(run, rate), 1)],
    [`Phase at ${state.bandwidth} Hz, °`, (run) => (rate ? fixed(phase(run, rate), 1) : "–")],
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
