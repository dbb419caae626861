// What the page shows: one place, read by all of its parts.

import { Library } from "./library.js";

/** The setting that the page opens with. Channels that differ have their parameters in `own`, by name. */
export const FIRST = { scheme: "sf", sample: "f32", parameters: {} };

export const state = {
  library: new Library(),
  /** The catalogue's schemes. */
  schemes: [],
  /** What is open: { file, example, topics, files, notes }. */
  opened: undefined,
  /** The channel that was read. */
  recording: undefined,
  /** The settings that are compared, and the one whose tab is open. */
  settings: [structuredClone(FIRST)],
  current: 0,
  /** The loop's bandwidth in Hz, at which the phase is told. */
  bandwidth: 4,
  /** What came of each setting: { key, answer } or { key, error }. */
  runs: [],
};

export const schemeOf = (setting) => state.schemes.find(({ name }) => name === setting.scheme) ?? state.schemes[0];

/** The parameters of a channel: its own, or those of all. */
export const parametersOf = (setting, field) => setting.own?.[field] ?? setting.parameters;

/** A setting on a channel, as the library takes it. */
export const choiceOf = (setting, field) => ({
  scheme: setting.scheme, sample: setting.sample, parameters: parametersOf(setting, field),
  filter: setting.filter ?? null, keyframe_ms: setting.keyframe_ms ?? null,
});

/** The request that opens a file or an example. */
export const openRequest = ({ example, files }, acceptCut) =>
  example ? { ask: "example", name: example } : { ask: "open", names: files.map(({ name }) => name), accept_cut: acceptCut };

/** The request that reads a channel. */
export const loadRequest = ({ topic, field, rate, skip }, acceptCut) =>
  ({ ask: "load", topic: topic || null, field, rate: Number(rate) || null, skip_non_finite: skip, accept_cut: acceptCut });
