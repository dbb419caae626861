// The settings that are compared: their tabs, boxes and figures, and the runs behind them.

import { Axes } from "./axes.js";
import { at, css, element, fail, fine, whileBusy } from "./dom.js";
import { listenToBank, showBank } from "./bank.js";
import { showFigures } from "./figures.js";
import { History } from "./history.js";
import * as link from "./link.js";
import { parameters } from "./parameters.js";
import { Plots } from "./plots.js";
import { isPreviewed, preview } from "./preview.js";
import { channel, reopened } from "./recording.js";
import { Spectrum } from "./spectrum.js";
import { choiceOf, parametersOf, schemeOf, state } from "./state.js";
import { asFlown, verdict } from "./verdict.js";

const MOST = 4;
const COLOURS = ["--decoded", "--b", "--c", "--ink"];

export const plots = new Plots(at("plots"), { onRange: showRange, onCursor: showCursor });
export const axes = new Axes(at("axes"), plots);
const spectrum = new Spectrum(at("spectrum"), plots);
const history = new History();
let showParameters = () => {};

export const letter = (place) => String.fromCharCode(65 + place);

export function showRecording() {
  plots.setRecording(state.recording);
  showPanel();
  return update();
}

function showTabs() {
  const { settings, current } = state;
  const tabs = settings.map((setting, place) => {
    const tab = element("button", { type: "button", id: `tab-${place}`, textContent: `${letter(place)}: ${schemeOf(setting).title}`, tabIndex: place === current ? 0 : -1 });
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-selected", place === current);
    tab.setAttribute("aria-controls", "panel");
    tab.style.borderBottomColor = `var(${COLOURS[place]})`;
    tab.addEventListener("click", () => choose(place));
    tab.addEventListener("keydown", (event) => {
      const to = { ArrowRight: place + 1, ArrowLeft: place - 1, Home: 0, End: settings.length - 1 }[event.key];
      if (settings[to]) choose(to);
    });
    return tab;
  });
  at("tabs").replaceChildren(...tabs);
  at("panel").setAttribute("aria-labelledby", `tab-${current}`);
  at("remove").hidden = settings.length === 1;
  at("add").hidden = settings.length === MOST;
}

function choose(place) {
  state.current = place;
  showPanel();
  at(`tab-${place}`).focus();
}

function showPanel() {
  showTabs();
  const setting = state.settings[state.current], scheme = schemeOf(setting);
  at("scheme").value = setting.scheme;
  if (![...at("sample").options].some(({ value }) => value === setting.sample)) at("sample").append(new Option(setting.sample));
  at("sample").value = setting.sample;
  at("words").textContent = `${scheme.words}: ${scheme.goodFor}`.replaceAll("`", "");
  showParameters = parameters(at("parameters"), scheme, state.recording, (name, text) => {
    const given = parametersOf(setting, state.recording.field);
    if (text === undefined) delete given[name];
    else given[name] = text;
    update(`${state.current} ${name}`);
  });
  showBank(setting);
  at("as-flown").hidden = !scheme.flown;
  showOutcome();
}

/** What came of the current setting, beside its boxes. */
function showOutcome() {
  const { answer, error } = state.runs[state.current] ?? {};
  fail("error", error);
  at("notes").replaceChildren(...(answer?.notes ?? []).map((text) => element("li", { textContent: text })));
  const setting = state.settings[state.current];
  if (answer) showParameters({ given: parametersOf(setting, state.recording.field), settings: answer.settings });
  at("verdict").textContent = answer ? verdict(setting, answer)[1] : "";
}

let isRunning = false, isStale = false;

/** Takes a change, of which `what` names the box, and runs the settings that changed; while it does, more changes wait for one more run. */
export function update(what) {
  history.note(what, { settings: state.settings, current: state.current });
  showSteps();
  globalThis.history.replaceState(null, "", `#${link.write({ example: state.opened?.example, channel: channel(), settings: state.settings })}`);
  if (!isPreviewed(what)) return whileBusy(run);
  return preview(plots, (place, made) => plots.setRuns(plots.runs.map((own) => (own === state.runs[place].answer || own.preview === place ? { ...made, preview: place } : own))), () => whileBusy(run));
}

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
    for (const [place, setting] of [...state.settings].entries()) {
      const choice = choiceOf(setting, recording.field), key = JSON.stringify(choice);
      const last = state.runs[place];
      if (last?.key === key && last.recording === recording) continue;
      let outcome;
      try {
        outcome = { answer: await state.library.ask({ ask: "run", choice }) };
      } catch (error) {
        outcome = { error };
        if (error.isFatal) await reopened();
      }
      if (recording !== state.recording) break;
      state.runs[place] = { key, recording, ...outcome };
    }
    if (recording !== state.recording) isStale = true;
    else show();
  } while (isStale);
  isRunning = false;
}

/** Shows what came of the settings. */
export function show() {
  const { runs, settings, recording } = state;
  runs.length = settings.length;
  const good = [];
  settings.forEach((setting, place) => {
    const { answer } = runs[place] ?? {};
    if (!answer) return;
    const name = settings.length > 1 ? `${letter(place)} ${schemeOf(setting).title}` : schemeOf(setting).title;
    good.push(Object.assign(answer, { name, setting, colour: css(COLOURS[place]), variable: COLOURS[place], isSigned: schemeOf(setting).isSigned }));
  });
  plots.setRuns(good);
  const entry = (text, colour) => {
    const shown = element("button", { type: "button", textContent: text });
    shown.style.setProperty("--own", `var(${colour})`);
    shown.setAttribute("aria-pressed", !plots.hidden.has(colour));
    shown.addEventListener("click", () => {
      if (!plots.hidden.delete(colour)) plots.hidden.add(colour);
      shown.setAttribute("aria-pressed", !plots.hidden.has(colour));
      plots.draw();
    });
    return shown;
  };
  at("legend").replaceChildren(entry("signal", "--signal"), ...good.map(({ name, variable }) => entry(`${name}, decoded`, variable)));
  showFigures(good, recording);
  showOutcome();
  spectrum.draw();
  axes.show(settings[state.current]);
}

function showRange([start, end]) {
  const seconds = (sample) => `${Number(plots.times.at(sample).toPrecision(5))} ${plots.times.unit}`;
  at("in-view").textContent = `samples ${start} to ${end}` + (plots.times.unit === "s" ? `, ${seconds(start)} to ${seconds(Math.max(start, end - 1))}` : "");
  axes.draw();
  spectrum.drawSoon();
}

/** The values under the cursor, and how far they are from the marker. */
function showCursor(sample, marker) {
  const { recording, runs } = plots;
  const unit = recording.unit ? ` ${recording.unit}` : "";
  const time = (value) => `${fine(value)} ${plots.times.unit}`;
  const valueAt = (place) => recording.arrays.values[place];
  const of = (place) => [`${recording.name} ${fine(valueAt(place))}${unit}`, ...runs.map(({ name, pyramid, arrays }) => `${name} ${fine(pyramid.at(place) ?? NaN)}${unit} (off by ${fine((pyramid.at(place) ?? NaN) - (arrays.coded ?? recording.arrays.values)[place])})`)].join(" · ");
  const words = sample === undefined ? "" : `${time(plots.times.at(sample))}: ${of(sample)}`;
  const apart = sample === undefined || marker === undefined ? ""
    : ` · from the mark ${time(plots.times.at(sample) - plots.times.at(marker))}, ${fine(valueAt(sample) - valueAt(marker))}${unit}`;
  at("under").textContent = words + apart || "Point at the picture for values; click to set a mark.";
}

// --- What a user does to settings ---

export function take(scheme, given) {
  const { sample, filter, keyframe_ms: keyframes } = state.settings[state.current];
  change({ scheme, sample, parameters: { ...given }, filter, keyframe_ms: keyframes });
}

/** Takes a setting in the place of the current one. */
function change(setting) {
  state.settings[state.current] = setting;
  showPanel();
  update();
}

/** Takes a flight's file: each channel has its parameters there, any other those of the first. */
export const takeFlight = (file) => whileBusy(() => takeFlightNow(file));

async function takeFlightNow(file) {
  fail("file-error");
  try {
    const { channels, scheme, sample, filter, keyframeMs } = await state.library.ask({ ask: "read-flight", text: await file.text() });
    const own = Object.fromEntries(channels.map(({ source, parameters }) => [source, parameters]));
    state.settings[state.current] = { scheme, sample, parameters: channels[0].parameters, own, filter, keyframe_ms: keyframeMs };
    showPanel();
    await update();
  } catch (error) {
    fail("file-error", Object.assign(error, { message: `${file.name}: ${error.message}` }));
  }
}

function showSteps() {
  [at("undo").disabled, at("redo").disabled] = [!history.canUndo, !history.canRedo];
}

function step(by) {
  const before = history.step(by);
  if (!before) return;
  Object.assign(state, before);
  state.runs = [];
  showPanel();
  update();
}

export function listenToSettings() {
  at("scheme").addEventListener("change", ({ target }) => take(target.value, {}));
  at("sample").addEventListener("change", ({ target }) => { state.settings[state.current].sample = target.value; update(); });
  at("reset").addEventListener("click", () => take(state.settings[state.current].scheme, {}));
  at("add").addEventListener("click", () => {
    state.settings.push(structuredClone(state.settings[state.current]));
    choose(state.settings.length - 1);
    update();
  });
  at("remove").addEventListener("click", () => {
    state.settings.splice(state.current, 1);
    state.runs.splice(state.current, 1);
    choose(Math.min(state.current, state.settings.length - 1));
    update();
  });
  at("as-flown").addEventListener("click", () => change(asFlown(state.settings[state.current])));
  listenToBank((what, part) => {
    Object.assign(state.settings[state.current], part);
    showBank(state.settings[state.current]);
    update(`${state.current} ${what}`);
  });
  at("bandwidth").addEventListener("input", ({ target }) => {
    state.bandwidth = target.valueAsNumber || 4;
    if (state.recording) show();
  });
  at("undo").addEventListener("click", () => step(-1));
  at("redo").addEventListener("click", () => step(1));
  addEventListener("keydown", (event) => {
    const isText = event.target.matches?.("textarea, input[type=text], input[type=number]");
    if (!(event.ctrlKey || event.metaKey) || isText || !["z", "y", "Z"].includes(event.key)) return;
    event.preventDefault();
    step(event.key === "z" ? -1 : 1);
  });
  const views = { in: () => plots.zoom(0.5), out: () => plots.zoom(2), left: () => plots.pan(-0.25), right: () => plots.pan(0.25), all: () => plots.show(...plots.full) };
  for (const button of document.querySelectorAll("[data-view]")) button.addEventListener("click", views[button.dataset.view]);
  at("plots").addEventListener("keydown", (event) => {
    const view = { "+": "in", "=": "in", "-": "out", ArrowLeft: "left", ArrowRight: "right", 0: "all" }[event.key];
    if (!view) return;
    event.preventDefault();
    views[view]();
  });
  at("spectrum-box").addEventListener("toggle", () => spectrum.draw());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => state.recording && show());
}

/** Puts away the drawings of the last recording. */
export function forgetDrawings() {
  axes.forget();
}
