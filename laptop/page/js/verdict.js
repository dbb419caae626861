// Does it fly? What the simulated flights of docs/loop.md show of just these settings.

import { groupOf, siblings } from "./channels.js";
import { fine, fixed } from "./dom.js";
import { schemeOf, state } from "./state.js";

/** In which units some logs are, by the names of their fields: how many of them are 1 rad/s or 1 m/s²; undefined where nobody knows. */
const UNITS = [[/gyroADC|gyroUnfilt|deg/, 180 / Math.PI], [/^[xyz]gyro$/, 1000], [/^[xyz]acc$/, 1000 / 9.80665], [/accSmooth/, undefined]];

/** The parameters with which a scheme flew on an axis, in the log's unit; none where that is not known. */
function flownOn({ flown, parameters }, field) {
  const [, scale] = UNITS.find(([name]) => name.test(field)) ?? [undefined, 1];
  if (scale === undefined) return {};
  const inUnit = (name) => parameters.find((own) => own.name === name)?.unit === "signal";
  return Object.fromEntries(Object.entries(flown.groups[groupOf(state.recording, field)]).map(([name, value]) => [name, inUnit(name) ? value * scale : value]));
}

/** Samples a second of the slowest loop that flew. */
const SLOWEST = 250;
const isNear = (own, flown) => (typeof flown === "number" ? Math.abs(Number(own) - flown) <= 0.02 * Math.abs(flown) : own === String(flown));

/** An error is told that is more than so many thresholds, as of a signal that is too steep for the code, or half of the signal. */
const THRESHOLDS = 5, LEAST_SNR = 6;

/** How badly a code serves the very log that is looked at; nothing if it does not. */
function here({ spikes, snr, rmse }, { threshold }) {
  if (!spikes) return "on this log it sends no spike";
  if (rmse > THRESHOLDS * threshold) return `on this log it does not follow: the error is ${fixed(rmse / threshold, 0)} times the threshold`;
  return snr !== null && snr < LEAST_SNR ? `on this log the error is ${fixed(100 * 10 ** (-snr / 20), 0)} % of the signal` : "";
}

/** The words for the figures, and the reason. */
export function verdict(setting, { settings, figures }) {
  const { flown, name, parameters } = schemeOf(setting);
  if (!flown) return ["not flown", `${name} was not flown on a drone whose rotors shake it.`];
  if (flown.objection) return ["no", `${name} ${flown.objection}.`];
  const group = flownOn(schemeOf(setting), state.recording.field);
  if (!Object.keys(group).length) return ["not known", `${name} flew in rad/s and m/s²; the unit of this channel is not known.`];
  const { filter, keyframe_ms: keyframes } = setting, corner = filter?.kind === "low-pass" ? filter.corner : null;
  const differ = Object.entries(group).filter(([own, value]) => !isNear(settings[parameters.find((each) => each.name === own)?.key ?? own], value))
    .map(([own, value]) => `${own} ${typeof value === "number" ? fine(value) : value}`);
  if (flown.low_pass === null ? filter : corner !== flown.low_pass) differ.push(flown.low_pass === null ? "no filter" : `a low-pass of ${flown.low_pass} Hz`);
  if (!isNear(keyframes, flown.keyframe_ms)) differ.push(`keyframes every ${flown.keyframe_ms} ms`);
  if (state.recording.rate < 0.99 * SLOWEST) differ.push(`${SLOWEST} samples a second or more`);
  const far = `${fine(flown.beside)} times the error without a code`;
  if (differ.length) return ["not known", `${name} flew, with ${far}, but with ${differ.join(", ")}.`];
  const fault = here(figures, group);
  return [fault ? "in simulation; here see below" : "in simulation", `No simulated flight with just these settings was lost, with ${far}${fault ? `; but ${fault}` : ""}.`];
}

/** The setting with which its scheme flew, on all axes of the sensor. */
export function asFlown(setting) {
  const scheme = schemeOf(setting), { flown } = scheme, { opened, topic, field } = state.recording;
  const texts = (own) => Object.fromEntries(Object.entries(flownOn(scheme, own)).map(([name, value]) => [name, typeof value === "number" ? String(Number(value.toPrecision(6))) : value]));
  const fields = [...new Set([field, ...siblings(opened.topics, topic)])];
  return {
    scheme: setting.scheme, sample: setting.sample, parameters: {}, isFlown: true, own: Object.fromEntries(fields.map((own) => [own, texts(own)])),
    filter: flown.low_pass === null ? null : { kind: "low-pass", corner: flown.low_pass }, keyframe_ms: flown.keyframe_ms,
  };
}
