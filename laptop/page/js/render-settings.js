// Renders the settings that are compared, and what came of them.

import { html, render } from "lit-html";
import { showBank } from "./bank.js";
import { at, css, fail } from "./dom.js";
import { axes, plots, spectrum } from "./drawings.js";
import { showFigures } from "./figures.js";
import { parameters } from "./parameters.js";
import { options } from "./render-parts.js";
import { current, outcome, parametersOf, schemeOf, state } from "./state.js";
import { verdict } from "./verdict.js";

export const MOST = 4;
const COLOURS = ["--decoded", "--b", "--c", "--ink"];
const SAMPLES = ["f32", "i16", "q1.15", "q8.8", "i32", "q16.16"];

export const letter = (place) => String.fromCharCode(65 + place);

/** What the views do when a user acts: `choose(place)`, `give(name, text)`, `hide(colour)`. */
let acts;
export const whenActed = (given) => (acts = given);

function tab(setting, place) {
  const { settings } = state, isChosen = place === state.current;
  const step = (event) => {
    const to = { ArrowRight: place + 1, ArrowLeft: place - 1, Home: 0, End: settings.length - 1 }[event.key];
    if (settings[to]) acts.choose(to);
  };
  return html`<button type="button" role="tab" id="tab-${place}" aria-controls="panel" aria-selected=${isChosen} tabindex=${isChosen ? 0 : -1}
    data-colour=${COLOURS[place]} @click=${() => acts.choose(place)} @keydown=${step}>${letter(place)}: ${schemeOf(setting).title}</button>`;
}

let shown = {}, showParameters = () => {};

/** The boxes of the current setting's parameters, made anew for another scheme, channel or setting. */
function showBoxes(setting, scheme) {
  const { recording } = state, place = state.current;
  if (shown.scheme !== scheme || shown.recording !== recording || shown.place !== place) {
    shown = { scheme, recording, place };
    showParameters = parameters(at("parameters"), scheme, recording, (name, text) => acts.give(name, text));
  }
  // While settings are wrong, the boxes keep what the last ones came to.
  shown.settings = outcome().answer?.settings ?? shown.settings ?? {};
  showParameters({ given: parametersOf(setting, recording.field), settings: shown.settings });
}

const entry = (words, colour) => html`<button type="button" aria-pressed=${!state.hidden.has(colour)} data-colour=${colour} @click=${() => acts.hide(colour)}>${words}</button>`;

/** The settings that were coded, or the preview of one whose knob is dragged, as the drawings and figures take them. */
function coded() {
  const { settings, recording: { runs, preview } } = state;
  return settings.flatMap((setting, place) => {
    const { answer } = runs[place] ?? {}, { title, isSigned } = schemeOf(setting);
    if (!answer) return [];
    return [Object.assign(preview?.of === answer ? preview.run : answer, { name: settings.length > 1 ? `${letter(place)} ${title}` : title, setting, colour: css(COLOURS[place]), variable: COLOURS[place], isSigned })];
  });
}

export function showSettings() {
  const { recording, settings } = state, setting = current(), scheme = schemeOf(setting), { answer, error } = outcome();
  plots.look(recording);
  if (!recording) return;
  render(settings.map(tab), at("tabs"));
  at("panel").setAttribute("aria-labelledby", `tab-${state.current}`);
  at("remove").hidden = settings.length === 1;
  at("add").hidden = settings.length === MOST;
  [at("undo").disabled, at("redo").disabled] = [!state.canUndo, !state.canRedo];
  render(options(state.schemes.map(({ title, words, name }) => [name, `${title}: ${words}`]), setting.scheme), at("scheme"));
  render(options([...new Set([...SAMPLES, setting.sample])].map((name) => [name, name]), setting.sample), at("sample"));
  at("words").textContent = `${scheme.words}: ${scheme.goodFor}`.replaceAll("`", "");
  at("as-flown").hidden = !scheme.flown;
  showBoxes(setting, scheme);
  showBank(setting);
  fail("error", error);
  const { basis } = setting, scaled = basis ? [`Found on ${basis}; ranges, and thresholds of another quantity, are scaled to each axis's own signal: look at each.`] : [];
  render([...scaled, ...(answer?.notes ?? [])].map((words) => html`<li>${words}</li>`), at("notes"));
  at("verdict").textContent = answer && recording.preview?.of !== answer ? verdict(setting, answer)[1] : "";
  const good = coded();
  render([entry("signal", "--signal"), ...good.map(({ name, variable, isPart }) => entry(`${name}, decoded${isPart ? " in part" : ""}`, variable))], at("legend"));
  showFigures(good, recording);
  plots.setRuns(good, state.hidden);
  spectrum.draw();
  axes.show(setting);
}
