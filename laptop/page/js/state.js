// What the page shows: one place, read by all of its parts.

import { Library } from "./library.js";

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
  /** What came of each setting: { key, answer } or { key, error }. */
  runs: [],
};

export const schemeOf = (setting) => state.schemes.find(({ name }) => name === setting.scheme) ?? state.schemes[0];

/** The request that opens a file or an example. */
export const openRequest = ({ example, files }, acceptCut) =>
  example ? { ask: "example", name: example } : { ask: "open", names: files.map(({ name }) => name), accept_cut: acceptCut };

/** The request that reads a channel. */
export const loadRequest = ({ topic, field, rate, skip }, acceptCut) =>
  ({ ask: "load", topic: topic || null, field, rate: Number(rate) || null, skip_non_finite: skip, accept_cut: acceptCut });
