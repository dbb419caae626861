// What the page shows: one state. Parts change it and call `changed`, upon which all of it is rendered.

import { groupOf } from "./channels.js";
import { Library } from "./library.js";

/**
 * The setting that the page opens with: the bank that flew, where the unit is known. Its parameters are those of all channels but accelerations, which have `forces`:
 * they are of another unit and size. Channels that differ have their parameters in `own`, by name. A setting that a flight's
 * file brought has that file's `link`, and its `entries` of the channels, by name.
 */
export const FIRST = { scheme: "sod", sample: "f32", parameters: {}, isFlown: true };

export const state = {
  /** The library with the file that was opened last; a recording keeps the one that read it. */
  library: new Library(),
  /** The catalogue's schemes, and the units of a gyroscope and of an accelerometer. */
  schemes: [], units: [[], []],
  /** The file that was opened last: { file, example, topics, files, notes }; files that came together, of which one is open. */
  opened: undefined,
  dropped: [],
  /** What a user asked to open last, to try again with other options: { files, example, wanted }. */
  asked: undefined,
  /** The channel that is asked for: { topic, field, rate, skip }. */
  channel: {},
  /** What the user says about a table: { timeUnit, header }. */
  table: {},
  /** Whether the whole messages of a damaged log are taken, and whether that log is damaged. */
  acceptsCut: false, isDamaged: false,
  /** How far reading is, { done, total, field }, and why it failed. */
  reading: undefined, fileError: undefined,
  /** What a link names that is not here: { file, channel, settings }. */
  awaited: undefined,
  /**
   * The channel that was read. All that was made of it hangs on it, and goes with it: `runs`, `preview`, `found`, `text`.
   * It stays, dimmed, until another one stands in its place.
   */
  recording: undefined,
  /** The settings that are compared, and the one whose tab is open. */
  settings: [structuredClone(FIRST)],
  current: 0,
  canUndo: false, canRedo: false,
  /** The loop's bandwidth in Hz, at which the phase is told. */
  bandwidth: 4,
  /** The colours of the series that are hidden. */
  hidden: new Set(),
  /** How far a search is: { share, words }. */
  searching: undefined,
  /** The part of the page that is open below the picture, by its id. */
  drawer: undefined,
  page: "log", isVerdictOpen: false,
};

/** Whether the recording that is shown is not the one that was asked for. */
export const isDimmed = () => Boolean(state.recording && (state.reading || state.fileError));

let render = () => {};
export const whenChanged = (then) => (render = then);
export const changed = () => render();

export const schemeOf = (setting) => state.schemes.find(({ name }) => name === setting.scheme) ?? state.schemes[0];
export const current = () => state.settings[state.current];
/** What came of the current setting: { key, answer } or { key, error }. */
export const outcome = () => state.recording?.runs[state.current] ?? {};

/** Which parameters of a setting are for a channel that has none of its own. */
export const shareOf = (field) => (state.recording && groupOf(state.recording, field) > 0 ? "forces" : "parameters");

/** The parameters of a channel: its own, or those of all of its quantity. */
export const parametersOf = (setting, field) => setting.own?.[field] ?? setting[shareOf(field)] ?? {};

/** What the settings are now: what was made of others is stale. */
export const settingsKey = () => JSON.stringify([state.settings, state.current]);

/** A setting on a channel, as the library takes it. */
export const choiceOf = (setting, field) => ({
  scheme: setting.scheme, sample: setting.sample, parameters: parametersOf(setting, field),
  filter: setting.filter ?? null, keyframe_ms: setting.keyframe_ms ?? null, link: setting.link ?? null,
});

/** What the user says about a table, as the library takes it. */
const ofTable = ({ timeUnit, header }) => ({ time_unit: timeUnit || null, header: Number(header) || null });

/** The request that opens a file or an example. */
export const openRequest = ({ example, files, table }) =>
  example ? { ask: "example", name: example } : { ask: "open", names: files.map(({ name }) => name), accept_cut: state.acceptsCut, ...ofTable(table) };

/** The request that reads a channel of what is open to a place in the library. */
export const loadRequest = ({ table }, { topic, field, rate, skip }, place = 0) =>
  ({ ask: "load", place, topic: topic || null, field, rate: Number(rate) || null, skip_non_finite: skip ?? false, accept_cut: state.acceptsCut, ...ofTable(table) });
