// Renders the settings that are compared, and what came of them.

import { html, render } from "lit-html";
import { showBank } from "./bank.js";
import { at, css, fail } from "./dom.js";
import { axes, band, plots, spectrum } from "./drawings.js";
import { showFigures, showTiles } from "./figures.js";
import { mainParameter, parameters } from "./parameters.js";
import { options } from "./render-parts.js";
import { choiceOf, current, outcome, parametersOf, schemeOf, state } from "./state.js";
import { canFly, verdict } from "./verdict.js";

export const MOST = 4;
const COLOURS = ["--decoded", "--b", "--c", "--ink"];
const SAMPLES = ["f32", "i16", "q1.15", "q8.8", "i32", "q16.16"];
/** Schemes by need. */
const CARDS = [
  ["sod", "control loop"], ["sf", "slow signal"], ["asf", "jumps"], ["if", "an angle"], ["position", "a network"], ["tbr", "as a camera"],
];

/** Letters of a title that fit on a card. */
const LONGEST = 8;

export const letter = (place) => String.fromCharCode(65 + place);

/** What the views do when a user acts: `choose(place)`, `give(name, text)`, `hide(colour)`, `take(scheme)`. */
let acts;
export const whenActed = (given) => (acts = given);

function tab(setting, place) {
  const { settings } = state, isChosen = place === state.current;
  const step = (event) => {
    const to = { ArrowRight: place + 1, ArrowLeft: place - 1, Home: 0, End: settings.length - 1 }[event.key];
    if (settings[to]) acts.choose(to);
  };
  const { title } = schemeOf(setting), words = settings.length > 1 ? html`${letter(place)}<span class="away">: ${title}</span>` : title;
  return html`<button type="button" role="tab" id="tab-${place}" aria-controls="panel" aria-selected=${isChosen} tabindex=${isChosen ? 0 : -1}
    title=${title} data-colour=${COLOURS[place]} @click=${() => acts.choose(place)} @keydown=${step}>${words}</button>`;
}

function card([name, need]) {
  const scheme = state.schemes.find((own) => own.name === name), isChosen = current().scheme === name;
  const title = scheme.title.length > LONGEST ? name.toUpperCase() : scheme.title;
  return html`<button type="button" class="card" data-scheme=${name} aria-pressed=${isChosen} title="${scheme.words}: ${scheme.goodFor}" @click=${() => acts.take(name)}><b>${title}</b><span>${need}</span></button>`;
}

let shown = {}, showParameters = () => {};

/** The boxes of the current setting's parameters, made anew for another scheme, channel, unit or setting. */
function showBoxes(setting, scheme, unit) {
  const { recording } = state, place = state.current;
  if (shown.scheme !== scheme || shown.recording !== recording || shown.place !== place || shown.unit !== unit) {
    shown = { scheme, recording, place, unit };
    const { min, max } = recording;
    showParameters = parameters({ main: at("main-parameter"), host: at("parameters") }, scheme, { min, max, unit }, (name, text) => acts.give(name, text));
  }
  // While settings are wrong, the boxes keep what the last ones came to.
  shown.settings = answered(state.current)?.settings ?? shown.settings ?? {};
  showParameters({ given: parametersOf(setting, recording.field), settings: shown.settings });
}

/** The threshold of the current setting, if it has one in the signal's unit. */
function threshold(setting, scheme) {
  const main = mainParameter(scheme);
  if (main?.name !== "threshold" || main.unit !== "signal") return undefined;
  return Number(parametersOf(setting, state.recording.field).threshold ?? shown.settings[main.key]);
}

const entry = (words, colour) => html`<button type="button" aria-pressed=${!state.hidden.has(colour)} data-colour=${colour} @click=${() => acts.hide(colour)}>${words}</button>`;

/** What came of a setting as it is now: nothing if the last run was of another one. */
function answered(place) {
  const { recording: { runs, field }, settings } = state, { key, answer } = runs[place] ?? {};
  return key === JSON.stringify(choiceOf(settings[place], field)) ? answer : undefined;
}

/** The last picture of each setting, or the preview of one whose knob is dragged, as the drawings and figures take them. */
function coded() {
  const { settings, recording: { runs, preview } } = state;
  return settings.flatMap((setting, place) => {
    const { answer, scheme } = runs[place] ?? {};
    if (!answer) return [];
    // The picture of the setting before stays until the new one stands, but its figures are not those of this one.
    const isOld = !answered(place), { title, isSigned } = schemeOf({ scheme });
    const run = preview?.of === answer ? preview.run : answer;
    const more = { name: settings.length > 1 ? `${letter(place)} ${title}` : title, setting, colour: css(COLOURS[place]), variable: COLOURS[place], isSigned };
    return [Object.assign(run, more, { isPreview: isOld || run === preview?.run })];
  });
}

/** What a flight's file says of its link, which the page passes on. */
function linkNotes({ link }) {
  if (!link) return [];
  const { step_bits: bits, gathering, full_every: full, clock_ppm: clock } = link;
  return [`The flight file's link goes with these settings: step_bits ${bits}, gathering ${gathering} µs, full_every ${full} µs, clock_ppm ${clock}.`];
}

/** Why a channel that never changes is not coded. */
const flatness = ({ name, min }) => new Error(`${name} is ${min} in all its samples, which leaves nothing to code: choose another channel.`);

function showVerdict(setting) {
  const { recording } = state, answer = answered(state.current), chip = at("chip"), { error } = outcome();
  const { chip: words, tone = "", reason } = answer ? verdict(setting, answer) : { chip: error ? "Not coded" : "…", reason: error ? "These settings do not code this channel: see below the slider." : "" };
  chip.hidden = !recording;
  chip.textContent = words;
  chip.dataset.tone = tone;
  chip.setAttribute("aria-expanded", state.isVerdictOpen);
  at("verdict").hidden = !state.isVerdictOpen;
  at("verdict").textContent = reason;
}

export function showSettings() {
  const { recording, settings } = state, setting = current(), scheme = schemeOf(setting), { answer, error } = outcome();
  plots.look(recording);
  if (!recording) return;
  const { unit } = recording;
  render(settings.map(tab), at("tabs"));
  render(CARDS.map(card), at("cards"));
  at("panel").setAttribute("aria-labelledby", `tab-${state.current}`);
  at("remove").hidden = settings.length === 1;
  at("add").hidden = settings.length === MOST;
  [at("undo").disabled, at("redo").disabled] = [!state.canUndo, !state.canRedo];
  render(options(state.schemes.map(({ title, words, name }) => [name, `${title}: ${words}`]), setting.scheme), at("scheme"));
  render(options([...new Set([...SAMPLES, setting.sample])].map((name) => [name, name]), setting.sample), at("sample"));
  at("words").textContent = `${scheme.words}: ${scheme.goodFor}`.replaceAll("`", "");
  at("as-flown").hidden = !canFly(setting);
  showBoxes(setting, scheme, unit);
  showBank(setting);
  fail("error", error && recording.min === recording.max ? flatness(recording) : error);
  const { basis } = setting, scaled = basis ? [`Found on ${basis}; ranges, and thresholds of another quantity, are scaled to each axis's own signal: look at each.`] : [];
  render([...scaled, ...linkNotes(setting), ...(answer?.notes ?? [])].map((words) => html`<li>${words}</li>`), at("notes"));
  showVerdict(setting);
  const good = coded();
  render([entry("signal", "--signal"), ...good.map(({ name, variable, isPart }) => entry(`${name}, decoded${isPart ? " in part" : ""}`, variable))], at("legend"));
  showTiles(good.find((run) => run.setting === setting), recording, { sample: setting.sample, unit });
  showFigures(good, recording, unit);
  plots.setRuns(good, state.hidden);
  band.show(error ? undefined : threshold(setting, scheme), unit);
  spectrum.draw();
  axes.show(setting);
}
