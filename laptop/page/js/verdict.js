// Does it fly? The simulated flights of docs/loop.md show it of just these settings, and of no coarser ones.

import { groupOf, siblings } from "./channels.js";
import { fine, fixed } from "./dom.js";
import { parametersOf, schemeOf, state } from "./state.js";
import { isInertial, scaleOf } from "./units.js";

/** Samples a second of the slowest loop that flew. */
const SLOWEST = 250;
/** The type of the samples that flew. */
const TYPE = "f32";
/** Texts hold six digits: nothing farther off is the same number. */
const isSame = (own, flown) => (typeof flown === "number" ? Math.abs(Number(own) - flown) <= 2e-5 * Math.abs(flown) : own === String(flown));

/** An error of more than so many thresholds, or of half of the signal, is that of a signal too steep for the code. */
const THRESHOLDS = 5, LEAST_SNR = 6;

/** The parameters with which a scheme flew on an axis, in the log's unit; undefined where that is not known. */
function flownOn({ flown, parameters }, field) {
  const { recording } = state, group = groupOf(recording, field), scale = scaleOf(recording, field);
  if (group === undefined || scale === undefined) return undefined;
  const inUnit = (name) => parameters.find((own) => own.name === name)?.unit === "signal";
  return Object.fromEntries(Object.entries(flown.groups[group]).map(([name, value]) => [name, inUnit(name) ? value * scale : value]));
}

/** The axes of the sensor that is looked at. */
function axes() {
  const { opened, topic, field } = state.recording;
  return [...new Set([field, ...siblings(opened.topics, topic)])];
}

/** How badly a code serves the very log that is looked at; nothing if it does not. */
function here({ spikes, snr, rmse }, { threshold }) {
  if (!spikes) return "on this log it sends no spike";
  if (rmse > THRESHOLDS * threshold) return `on this log it does not follow: the error is ${fixed(rmse / threshold, 0)} times the threshold`;
  return snr !== null && snr < LEAST_SNR ? `on this log the error is ${fixed(100 * 10 ** (-snr / 20), 0)} % of the signal` : "";
}

/** How the parameters of an axis differ from those that flew, in words. */
function differences(setting, field, given) {
  const scheme = schemeOf(setting);
  const group = flownOn(scheme, field);
  if (!group) return [`a known unit of ${field}`];
  const words = ([name, value]) => {
    const own = given[name], isCoarser = name === "threshold" && Number(own) > value;
    return `${name} ${typeof value === "number" ? fine(value) : value}${isCoarser ? ` where this is coarser` : ""}${field === state.recording.field ? "" : ` on ${field}`}`;
  };
  const more = Object.keys(parametersOf(setting, field)).filter((name) => !(name in group));
  return [...Object.entries(group).filter(([name, value]) => !isSame(given[name], value)).map(words), ...more.map((name) => `no ${name} on ${field}`)];
}

/** The verdict on a setting with what came of it: the words of the chip, its tone, and the reason. */
export function verdict(setting, { settings, figures }) {
  const scheme = schemeOf(setting), { flown, name, parameters } = scheme, { recording } = state, { field } = recording;
  if (!isInertial(recording, field)) return { chip: "Nothing to fly", reason: `${field} is no axis of a gyroscope or an accelerometer: nothing flew with it.` };
  if (!flown) return { chip: "Not flown", reason: `${name} was not flown on a drone whose rotors shake it.` };
  if (flown.objection) return { chip: "Does not fly", tone: "bad", reason: `${name} ${flown.objection}.` };
  const group = flownOn(scheme, field);
  if (!group) return { chip: "Unit unknown", reason: `${name} flew in rad/s and m/s²; the unit of this channel is not known: choose it below the axes.` };
  const keyOf = (own) => parameters.find((each) => each.name === own)?.key ?? own;
  const used = Object.fromEntries(Object.keys(group).map((own) => [own, settings[keyOf(own)]]));
  const differ = axes().flatMap((axis) => differences(setting, axis, axis === field ? used : parametersOf(setting, axis)));
  const { filter, keyframe_ms: keyframes, link = {} } = setting, corner = filter?.kind === "low-pass" ? filter.corner : null;
  if (setting.sample !== TYPE) differ.push(`samples of ${TYPE}`);
  if (flown.low_pass === null ? filter : corner !== flown.low_pass) differ.push(flown.low_pass === null ? "no filter" : `a low-pass of ${flown.low_pass} Hz`);
  if (!isSame(keyframes, flown.keyframe_ms)) differ.push(`keyframes every ${flown.keyframe_ms} ms`);
  if (link.gathering) differ.push("events sent at once");
  if (link.step_bits) differ.push("no step bits");
  if (recording.uneven) differ.push("samples at an even rate");
  else if (!(recording.rate >= 0.99 * SLOWEST)) differ.push(`${SLOWEST} samples a second or more`);
  const far = `${fine(flown.beside)} times the error without a code`;
  if (differ.length) return { chip: "Not as flown", reason: `${name} flew, with ${far}, but with ${differ.join(", ")}.` };
  const fault = here(figures, group);
  return {
    chip: fault ? "Flew so in simulation, but not this log" : "Flew so in simulation", tone: fault ? "bad" : "good",
    reason: `No simulated flight with just these settings was lost, with ${far}${fault ? `; but ${fault}` : ""}.`,
  };
}

/** Whether a scheme can be set as it flew on the channel that is shown: its unit is known, and its rate allows the filter. */
export function canFly(setting) {
  const scheme = schemeOf(setting), { rate, uneven, field } = state.recording, { flown } = scheme;
  if (!flown || !flownOn(scheme, field)) return false;
  return flown.low_pass === null || (!uneven && rate > 2 * flown.low_pass);
}

/** The setting with which its scheme flew, on all axes of the sensor. Where no unit is known it waits for one. */
export function asFlown(setting) {
  const scheme = schemeOf(setting), { flown } = scheme, { sample } = setting;
  if (!canFly(setting)) return { scheme: setting.scheme, sample, parameters: {}, isFlown: true };
  const texts = (own) => Object.fromEntries(Object.entries(flownOn(scheme, own) ?? {}).map(([name, value]) => [name, typeof value === "number" ? String(Number(value.toPrecision(6))) : value]));
  return {
    scheme: setting.scheme, sample, parameters: {}, isFlown: true, own: Object.fromEntries(axes().map((own) => [own, texts(own)])),
    filter: flown.low_pass === null ? null : { kind: "low-pass", corner: flown.low_pass }, keyframe_ms: flown.keyframe_ms,
  };
}
