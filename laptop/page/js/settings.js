// What a user does to the settings that are compared, and the runs that follow.

import { listenToBank } from "./bank.js";
import { at, whileBusy } from "./dom.js";
import { axes, plots, whenThreshold } from "./drawings.js";
import { History } from "./history.js";
import * as link from "./link.js";
import { isPreviewed, preview } from "./preview.js";
import { restored } from "./recording.js";
import { whenActed } from "./render-settings.js";
import { fitted, give as giveTo, suited } from "./shares.js";
import { changed, choiceOf, current, isDimmed, state } from "./state.js";
import { asFlown } from "./verdict.js";

const history = new History();

/** Takes a change, of which `what` names the box, and runs the settings that changed. */
export function update(what) {
  suit();
  history.note(what, { settings: state.settings, current: state.current });
  return follow(what);
}

function suit() {
  if (state.recording) state.settings = state.settings.map(suited);
}

/** Shows the settings as they are now, in the page and in its link, and runs them. */
function follow(what) {
  [state.canUndo, state.canRedo] = [history.canUndo, history.canRedo];
  globalThis.history.replaceState(null, "", `#${link.write({ example: state.awaited ? undefined : state.opened?.example, file: state.awaited?.file ?? state.opened?.file, channel: state.channel, settings: state.settings })}`);
  changed();
  return isPreviewed(what) ? preview(plots, () => whileBusy(run)) : whileBusy(run);
}

let isRunning = false, isStale = false;

/** Runs the settings that have no outcome yet; while it does, more changes wait for one more run. */
async function run() {
  if (isRunning) {
    isStale = true;
    return;
  }
  isRunning = true;
  do {
    isStale = false;
    const { recording } = state;
    if (!recording) break;
    const { library } = recording;
    for (const [place, setting] of [...state.settings].entries()) {
      const choice = choiceOf(setting, recording.field), key = JSON.stringify(choice);
      if (recording.runs[place]?.key === key) continue;
      let outcome;
      try {
        outcome = { answer: await library.ask({ ask: "run", choice }) };
      } catch (error) {
        outcome = { error };
        if (error.isStopped) break;
        if (error.isFatal) await restored(recording);
      }
      recording.runs[place] = { key, scheme: setting.scheme, ...outcome };
      if (recording !== state.recording) break;
    }
    if (recording !== state.recording) isStale = true;
    else recording.runs.length = state.settings.length;
    changed();
  } while (isStale);
  isRunning = false;
}

/** Takes a setting in the place of the current one. */
export function replace(setting) {
  state.settings[state.current] = setting;
  return update();
}

/** The parts of a setting around its code, which another scheme takes over: those of a bank that flew are that bank's alone. */
const sharedBy = ({ isFlown, filter, keyframe_ms, link, entries }) => (isFlown ? {} : { filter, keyframe_ms, link, entries });

/** Takes a scheme with the parameters that a search found on the channel that is open behind this filter, for all axes, or with none. */
export function take(scheme, given, filter = sharedBy(current()).filter) {
  const setting = { scheme, sample: current().sample, parameters: {}, ...sharedBy(current()), filter };
  return replace(given ? fitted(setting, given, axes.ranges) : setting);
}

/** Takes a flight's file: each channel has its parameters there, other turn rates those of the first. */
export const takeFlight = (file) => whileBusy(async () => {
  state.fileError = undefined;
  try {
    const { channels, scheme, sample, filter, keyframeMs, link: ofLink } = await state.library.ask({ ask: "read-flight", text: await file.text() });
    // The program names a log's channels with their topic.
    const { topic } = state.channel, field = (source) => (topic && source.startsWith(`${topic}.`) ? source.slice(topic.length + 1) : source);
    const own = Object.fromEntries(channels.map(({ entry, parameters }) => [field(entry.source), parameters]));
    const entries = Object.fromEntries(channels.map(({ entry }) => [field(entry.source), entry]));
    await replace({ scheme, sample, parameters: channels[0].parameters, own, filter, keyframe_ms: keyframeMs, link: ofLink, entries });
  } catch (error) {
    state.fileError = Object.assign(error, { message: `${file.name}: ${error.message}` });
    changed();
  }
});

function choose(place) {
  state.current = place;
  changed();
  at(`tab-${place}`).focus();
}

/** A parameter as a user gives it, or undefined where it is taken back. */
function give(name, text) {
  giveTo(current(), state.recording.field, name, text);
  update(`${state.current} ${name}`);
}

function hide(colour) {
  if (!state.hidden.delete(colour)) state.hidden.add(colour);
  changed();
}

function step(by) {
  const before = history.step(by);
  if (!before) return;
  Object.assign(state, before);
  suit();
  if (state.recording) state.recording.runs = [];
  follow();
}

const VIEWS = { in: () => plots.zoom(0.5), out: () => plots.zoom(2), left: () => plots.pan(-0.25), right: () => plots.pan(0.25), all: () => plots.show(...plots.full) };
/** Keys of the picture; an equals sign is a plus without shift. */
const VIEW_KEYS = { "+": VIEWS.in, "=": VIEWS.in, "-": VIEWS.out, ArrowLeft: VIEWS.left, ArrowRight: VIEWS.right, 0: VIEWS.all, Enter: () => plots.setMark(), Escape: () => plots.clearCursor() };
/** Keys with shift, which a plus needs on many keyboards. */
const CURSOR_KEYS = { "+": VIEWS.in, ArrowLeft: () => plots.step(-1), ArrowRight: () => plots.step(1) };

function listenToView() {
  for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", VIEWS[button.dataset.view]);
  at("plots").addEventListener("keydown", (event) => {
    const act = (event.shiftKey ? CURSOR_KEYS : VIEW_KEYS)[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    if (!state.recording) return;
    plots.runs = [];
    changed();
  });
}

export function listenToSettings() {
  whenActed({ choose, give, hide, take });
  whenThreshold((value) => give("threshold", String(Number(value.toPrecision(4)))));
  at("scheme").addEventListener("change", ({ target }) => take(target.value));
  at("sample").addEventListener("change", ({ target }) => replace({ ...current(), sample: target.value }));
  at("reset").addEventListener("click", () => take(current().scheme));
  at("as-flown").addEventListener("click", () => replace(asFlown(current())));
  listenToBank((what, part) => {
    Object.assign(current(), part);
    delete current().isFlown;
    update(`${state.current} ${what}`);
  });
  at("bandwidth").addEventListener("input", ({ target }) => {
    state.bandwidth = target.valueAsNumber || 4;
    changed();
  });
  at("add").addEventListener("click", () => {
    state.settings.push(structuredClone(current()));
    choose(state.settings.length - 1);
    update();
  });
  at("remove").addEventListener("click", () => {
    state.settings.splice(state.current, 1);
    state.recording?.runs.splice(state.current, 1);
    choose(Math.min(state.current, state.settings.length - 1));
    update();
  });
  at("undo").addEventListener("click", () => step(-1));
  at("redo").addEventListener("click", () => step(1));
  addEventListener("keydown", (event) => {
    const isText = isDimmed() || event.target.matches?.("textarea, input[type=text], input[type=number], input[type=search]");
    if (!(event.ctrlKey || event.metaKey) || isText || !["z", "y", "Z"].includes(event.key)) return;
    event.preventDefault();
    step(event.key === "z" ? -1 : 1);
  });
  listenToView();
}
