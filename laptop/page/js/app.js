// The page: what its user drops, chooses and drags, and what the library makes of it.

import { Board, whyNot } from "./board.js";
import { Library } from "./library.js";
import { draw as drawFront } from "./front.js";
import * as link from "./link.js";
import { parameters } from "./parameters.js";
import { Plots } from "./plots.js";
import { Pyramid } from "./pyramid.js";
import { picture } from "./svg.js";
import { Video } from "./video.js";

const at = (id) => document.getElementById(id);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const element = (name, attributes = {}) => Object.assign(document.createElement(name), attributes);
const MOST = 4;
const COLOURS = ["--decoded", "--b", "--c", "--ink"];
const SAMPLES = ["f32", "i16", "q1.15", "q8.8", "i32", "q16.16"];
const OF_RECORDING = ["settings", "picture", "take", "search"];
const FIRST = { scheme: "sf", sample: "f32", parameters: {} };

let library = new Library();
const plots = new Plots(at("plots"), showRange);
// For whoever looks in the console, and for checks.
const video = new Video(at("events"), (text) => (at("video-figures").textContent = text));
const board = new Board(at("heard"), (text) => (at("board-figures").textContent = text));
globalThis.spikewire = { plots, video, board };
let schemes = [];
let opened; // { file, example, topics, files }
let recording; // what was loaded
let settings = [structuredClone(FIRST)];
let runs = []; // of each setting: { key, answer } or { key, error }
let current = 0;
let showParameters = () => {};

/** Boxes of settings that are no parameters of schemes. */
const BOXES = { accept_cut: "accept-cut", skip_non_finite: "skip", rate: "rate", topic: "topic", field: "field", column: "field", sample: "sample", max_rmse: "max-rmse", evaluations: "evaluations" };

/** Shows an error, or none, and marks the box of the setting at fault. */
function fail(id, error) {
  at(id).textContent = error?.message ?? "";
  at(id).hidden = !error;
  for (const own of document.querySelectorAll(`[aria-errormessage="${id}"]`)) {
    own.removeAttribute("aria-invalid");
    own.removeAttribute("aria-errormessage");
  }
  const box = error?.parameter && at(BOXES[error.parameter] ?? `parameter-${error.parameter}`);
  box?.setAttribute("aria-invalid", "true");
  box?.setAttribute("aria-errormessage", id);
}

// --- The recording ---

let isReading = false;

/** Puts away all that was made of the last recording. */
function forget() {
  searching?.stop();
  recording = undefined;
  runs = [];
  at("about").textContent = at("front").textContent = at("front-words").textContent = "";
  for (const id of [...OF_RECORDING, "file-notes", "advice", "text"]) at(id).hidden = true;
}

/** How far reading is. */
function reading({ done, total }) {
  at("about").textContent = total > 1 ? `reading … ${Math.round((100 * done) / total)} % of ${(total / 1e6).toFixed(0)} MB` : "reading …";
}

let busy = 0;

/** Marks the page as busy while some work is under way. */
async function whileBusy(work) {
  busy++;
  document.body.dataset.busy = "yes";
  try {
    return await work();
  } finally {
    if (--busy === 0) {
      document.body.dataset.busy = "no";
      document.body.dataset.ready ??= performance.now().toFixed(0);
    }
  }
}

/** Opens files or an example, and loads a channel of it: the wanted one, or the first. */
const open = (from, wanted) => whileBusy(() => openNow(from, wanted));

/** The file as the library reads it: text of two bytes a letter, as spreadsheets write it, becomes UTF-8. */
async function readable(file) {
  const [first, second, third, fourth] = new Uint8Array(await file.slice(0, 4).arrayBuffer());
  const isLittle = (first === 0xff && second === 0xfe) || (first && second === 0 && third && fourth === 0);
  const isBig = (first === 0xfe && second === 0xff) || (first === 0 && second && third === 0 && fourth);
  if (!isLittle && !isBig) return file;
  const text = new TextDecoder(isLittle ? "utf-16le" : "utf-16be").decode(await file.arrayBuffer());
  return new File([text], file.name);
}

async function openNow({ files: given = [], example }, wanted = {}) {
  fail("file-error");
  if (isReading) {
    // What is read now is not wanted any more.
    library.stop();
    library = new Library();
  }
  isReading = true;
  const [named] = given, own = library;
  let files = given;
  try {
    files = await Promise.all(given.map(readable));
    if (own !== library) return;
    const request = example ? { ask: "example", name: example } : { ask: "open", names: files.map((own) => own.name), accept_cut: at("accept-cut").checked };
    const answer = await library.ask(request, { files, onProgress: reading });
    opened = { ...answer, example, files };
    showTopics(wanted);
    await load();
  } catch (error) {
    if (error.isStopped) return;
    isReading = false;
    forget();
    at("channel").hidden = true;
    const isDamaged = error.remedy === "accept_cut" || at("accept-cut").checked;
    at("damaged").hidden = !isDamaged;
    opened = isDamaged ? { files, topics: [] } : undefined;
    const name = named && error.file !== named.name ? `${named.name}: ` : "";
    fail("file-error", Object.assign(error, { message: name + error.message }));
  }
}

function showTopics({ topic, field, rate, skip }) {
  at("damaged").hidden = !at("accept-cut").checked;
  at("channel").hidden = false;
  at("topic").replaceChildren(...opened.topics.map((own) => new Option(own.about ? `${own.name} (${own.about})` : own.name, own.name)));
  at("topic-field").hidden = opened.topics.length < 2 && !opened.topics[0].name;
  if (topic && opened.topics.some((own) => own.name === topic)) at("topic").value = topic;
  at("rate").value = rate ?? "";
  at("skip").checked = skip ?? false;
  showFields(field);
}

function showFields(field) {
  const { fields } = opened.topics.find((own) => own.name === at("topic").value) ?? opened.topics[0];
  at("field").replaceChildren(...fields.map((own) => new Option(own, own)));
  if (fields.includes(field)) at("field").value = field;
}

const channel = () => ({ topic: at("topic").value, field: at("field").value, rate: at("rate").value, skip: at("skip").checked });

const load = () => whileBusy(loadNow);

async function loadNow() {
  const { topic, field, rate, skip } = channel();
  fail("file-error");
  searching?.stop();
  isReading = true;
  reading({ done: 0, total: 1 });
  try {
    const request = { ask: "load", topic: topic || null, field, rate: Number(rate) || null, skip_non_finite: skip, accept_cut: at("accept-cut").checked };
    recording = await library.ask(request, { onProgress: reading });
    isReading = false;
  } catch (error) {
    if (error.isStopped) return;
    isReading = false;
    forget();
    at("rate-field").hidden = !([error.parameter, error.remedy].includes("rate") || rate);
    fail("file-error", error);
    return;
  }
  const { values, times } = recording.arrays;
  at("rate-field").hidden = Boolean(times);
  const [min, max] = new Pyramid(values).range(0, values.length);
  Object.assign(recording, { min, max });
  const unit = recording.unit ? ` ${recording.unit}` : "";
  const brief = (value) => Number(value.toPrecision(5));
  at("about").textContent = `${opened.file}: ${recording.name}, ${recording.samples.toLocaleString("en")} samples`
    + (recording.seconds ? ` in ${brief(recording.seconds)} s, ${brief(recording.rate)} a second` : "")
    + `, ${brief(min)} to ${brief(max)}${unit}`;
  at("file-notes").hidden = false;
  at("file-notes").querySelector("ul").replaceChildren(...[...opened.notes, ...recording.notes].map((text) => element("li", { textContent: text })));
  for (const id of OF_RECORDING) at(id).hidden = false;
  runs = [];
  at("front").textContent = at("front-words").textContent = "";
  at("advice").hidden = at("text").hidden = true;
  plots.setRecording(recording);
  showPanel();
  await update();
}

// --- Settings ---

const schemeOf = (setting) => schemes.find((own) => own.name === setting.scheme) ?? schemes[0];
const letter = (place) => String.fromCharCode(65 + place);

function showTabs() {
  const tabs = settings.map((own, place) => {
    const tab = element("button", { type: "button", id: `tab-${place}`, textContent: `${letter(place)}: ${schemeOf(own).title}`, tabIndex: place === current ? 0 : -1 });
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
  current = place;
  showPanel();
  at(`tab-${place}`).focus();
}

function showPanel() {
  showTabs();
  const setting = settings[current], scheme = schemeOf(setting);
  at("scheme").value = setting.scheme;
  if (![...at("sample").options].some((own) => own.value === setting.sample)) at("sample").append(new Option(setting.sample));
  at("sample").value = setting.sample;
  at("words").textContent = `${scheme.words}: ${scheme.goodFor}`.replaceAll("`", "");
  showParameters = parameters(at("parameters"), scheme, recording, (name, text) => {
    if (text === undefined) delete setting.parameters[name];
    else setting.parameters[name] = text;
    update();
  });
  showOutcome();
}

/** What came of the current setting, beside its fields. */
function showOutcome() {
  const { answer, error } = runs[current] ?? {};
  fail("error", error);
  at("notes").replaceChildren(...(answer?.notes ?? []).map((text) => element("li", { textContent: text })));
  if (answer) showParameters({ given: settings[current].parameters, settings: answer.settings });
}

let isRunning = false, isStale = false;

/** Runs the settings that changed; while it does, more changes wait for one more run. */
const update = () => whileBusy(updateNow);

async function updateNow() {
  history.replaceState(null, "", `#${link.write({ example: opened?.example, channel: channel(), settings })}`);
  if (isRunning) {
    isStale = true;
    return;
  }
  isRunning = true;
  do {
    isStale = false;
    const own = recording;
    if (!own) break;
    for (const [place, setting] of [...settings].entries()) {
      const key = JSON.stringify(setting);
      if (runs[place]?.key === key && runs[place].recording === own) continue;
      let outcome;
      try {
        outcome = { answer: await library.ask({ ask: "run", choice: setting }) };
      } catch (error) {
        outcome = { error };
        if (error.isFatal) isStale = await reopened();
      }
      if (own !== recording) break;
      runs[place] = { key, recording: own, ...outcome };
    }
    if (own !== recording) isStale = true;
    else show();
  } while (isStale);
  isRunning = false;
}

/** Reads the recording again after the library broke. */
async function reopened() {
  const { example, files } = opened, { topic, field, rate, skip } = channel();
  await library.ask(example ? { ask: "example", name: example } : { ask: "open", names: files.map((own) => own.name), accept_cut: at("accept-cut").checked }, { files });
  await library.ask({ ask: "load", topic: topic || null, field, rate: Number(rate) || null, skip_non_finite: skip, accept_cut: at("accept-cut").checked });
  return false;
}

function show() {
  runs.length = settings.length;
  const good = [];
  settings.forEach((setting, place) => {
    const { answer } = runs[place] ?? {};
    if (!answer) return;
    const name = settings.length > 1 ? `${letter(place)} ${schemeOf(setting).title}` : schemeOf(setting).title;
    good.push(Object.assign(answer, { name, colour: css(COLOURS[place]), variable: COLOURS[place], isSigned: schemeOf(setting).isSigned }));
  });
  plots.setRuns(good);
  const entry = (text, colour) => {
    const own = element("span", { textContent: text });
    own.style.setProperty("--own", `var(${colour})`);
    return own;
  };
  at("legend").replaceChildren(entry("signal", "--signal"), ...good.map((own) => entry(`${own.name}, decoded`, own.variable)));
  showFigures(good);
  showOutcome();
}

const fixed = (value, digits) => (value === null || value === undefined || Number.isNaN(value) ? "–" : value.toLocaleString("en", { maximumFractionDigits: digits }));
const fine = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "–");

function showFigures(good) {
  const unit = recording.unit ? `, ${recording.unit}` : "";
  const rows = [
    ["Samples without a spike, %", ({ figures }) => fixed(figures.efficiency, 2)],
    [`RMSE${unit}`, ({ figures }) => fine(figures.rmse)],
    ["Signal to noise, dB", ({ figures }) => fixed(figures.snr, 2)],
    ["Spikes", ({ figures }) => fixed(figures.spikes, 0)],
    ["Spikes a second", ({ figures }) => fixed(figures.spikes_per_second, 1)],
    ["Bytes a second on the link", (own) => fixed(own.linkBytesPerSecond, 1)],
    ["Bytes of RAM a channel", ({ costs }) => fixed(costs.ram, 0)],
    ["Instructions a sample, Cortex-M4F", ({ costs }) => (costs.instructions === null ? "not measured" : `${costs.is_bound ? "at most " : ""}${fixed(costs.instructions, 1)}`)],
    ["Latency, samples", ({ latency }) => fixed(latency, 0)],
  ];
  const table = at("figures"), { caption } = table;
  const head = element("thead"), body = element("tbody");
  head.insertRow().append(element("th", { textContent: "Figure", scope: "col" }), ...good.map((own) => element("th", { textContent: own.name, scope: "col" })));
  for (const [name, value] of rows) {
    const row = body.insertRow();
    row.append(element("th", { textContent: name, scope: "row" }));
    for (const own of good) row.insertCell().textContent = value(own);
  }
  table.replaceChildren(caption, head, body);
}

function showRange([start, end]) {
  const seconds = (sample) => `${Number(plots.times.at(sample).toPrecision(5))} ${plots.times.unit}`;
  at("in-view").textContent = `samples ${start} to ${end}` + (plots.times.unit === "s" ? `, ${seconds(start)} to ${seconds(Math.max(start, end - 1))}` : "");
}

// --- What is taken away ---

function save(name, content, type) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

const ask = (kind) => library.ask({ ask: "export", kind, choice: settings[current] });
const inC = (toml) => `/* Save as roll.toml:\n\n${toml}\n   then

   spikewire emit c roll.toml -o roll

   writes a crate that makes the library for C with this very codec. */
#include "roll.h"

/* sw_roll_codec is the constant; bindings/c/README.md in the repository has the loop around it. */
`;
const texts = {
  rust: { file: "spikes.rs", make: async () => (await ask("rust")).text },
  toml: { file: "spikes.toml", make: async () => (await ask("toml")).text },
  python: { file: "spikes.py", make: async () => (await ask("python")).text },
  c: { file: "spikes.c", make: async () => inC((await ask("toml")).text) },
  link: { file: "link.txt", make: () => location.href },
};
const files = {
  csv: async () => ["spikes.csv", (await ask("csv")).arrays.file, "text/csv"],
  es: async () => ["spikes.es", (await ask("es")).arrays.file, "application/octet-stream"],
  svg: () => {
    const colours = Object.fromEntries(["signal", "ink", "paper", "grid", "down"].map((name) => [name, css(`--${name}`)]));
    return ["spikes.svg", picture(plots, colours), "image/svg+xml"];
  },
  png: async () => ["spikes.png", await new Promise((done) => plots.canvas().toBlob(done)), "image/png"],
};

async function takeAway({ text, save: kind }) {
  fail("error");
  try {
    if (kind) return save(...(await files[kind]()));
    at("out").value = await texts[text].make();
    at("text").hidden = false;
    at("save").dataset.name = texts[text].file;
    at("copied").textContent = "";
  } catch (error) {
    fail("error", error);
    at("error").scrollIntoView({ block: "nearest" });
  }
}

// --- Search ---

let searching;

/** Runs a search in a thread of its own, to which the stop button puts an end. */
async function search(work) {
  if (searching) return;
  fail("search-error");
  searching = new Library();
  for (const id of ["tune", "tune-all", "advise"]) at(id).disabled = true;
  at("working").hidden = false;
  at("bar").value = 0;
  at("done").textContent = "";
  at("advice").hidden = true;
  try {
    await searching.ask({ ask: "take", name: recording.name, rate: recording.rate, file: 0 }, { files: [new Blob([recording.arrays.values])] });
    await work(searching);
  } catch (error) {
    if (error.isStopped) at("front-words").textContent = `Stopped. ${at("front-words").textContent}`;
    else fail("search-error", error);
  }
  searching.stop();
  searching = undefined;
  for (const id of ["tune", "tune-all", "advise"]) at(id).disabled = false;
  at("working").hidden = true;
}

const progress = (before, of, name) => ({ done, total, words: said }) => {
  at("bar").value = (before + done / total) / of;
  at("done").textContent = `${said ?? name}: ${done} of ${total} settings`;
};

function take(scheme, given) {
  settings[current] = { scheme, sample: settings[current].sample, parameters: { ...given } };
  showPanel();
  update();
}

async function tune(thread, names) {
  const fronts = [], refused = [], evaluations = Number(at("evaluations").value) || 300;
  const { sample } = settings[current];
  at("front").textContent = at("front-words").textContent = "";
  for (const [place, scheme] of names.entries()) {
    try {
      const choice = { scheme, sample, parameters: {} };
      fronts.push(await thread.ask({ ask: "front", choice, evaluations }, { onProgress: progress(place, names.length, scheme) }));
    } catch (error) {
      if (error.isStopped || names.length === 1 || error.isFatal) throw error;
      refused.push(error.message);
    }
    drawFront(at("front"), fronts, recording.unit, take);
    const dots = fronts.reduce((sum, own) => sum + own.points.length, 0);
    at("front-words").textContent = `${dots} settings that no other of their scheme beats, searched and scored on the whole recording. Click a dot to take it as setting ${letter(current)}.`
      + (refused.length ? ` Not: ${refused.join("; ")}.` : "");
  }
}

async function advise(thread) {
  const { sample } = settings[current], error = Number(at("max-rmse").value) || null;
  const request = { ask: "advise", sample, max_rmse: error, evaluations: Number(at("evaluations").value) || 300 };
  const { words: said, best, whyNot } = await thread.ask(request, { onProgress: progress(0, 1, "") });
  at("advice").textContent = said;
  at("advice").hidden = false;
  if (best) take(best.scheme, best.parameters);
  else fail("search-error", new Error(whyNot));
}

// --- Video ---

async function watch(file) {
  fail("video-error");
  try {
    await video.start(file);
    at("events").hidden = at("end").hidden = false;
    at("video").scrollIntoView({ block: "nearest" });
  } catch (error) {
    fail("video-error", new Error(`${file?.name ?? "camera"}: ${error.message}`));
  }
}

function endVideo() {
  video.stop();
  at("end").hidden = true;
}

// --- A board ---

async function connect() {
  fail("board-error", whyNot() && new Error(whyNot()));
  if (whyNot() || at("connect").disabled) return;
  at("connect").disabled = true;
  try {
    let choice = null;
    if (at("meaning").value === "values") {
      const { answer, error } = runs[current] ?? {};
      if (!answer) throw error ?? new Error("there are no settings to decode by");
      choice = { ...settings[current], parameters: answer.asked };
    }
    const thresholds = at("thresholds").value.split(",").filter((own) => own.trim()).map(Number);
    if (thresholds.some(Number.isNaN)) throw new Error(`thresholds ${at("thresholds").value}: not numbers with commas between`);
    const options = { choice, thresholds: choice ? thresholds : [], slot_ticks: at("slot-ticks").valueAsNumber || null };
    const onStart = () => {
      at("heard").hidden = at("hang-up").hidden = false;
      at("board-files").hidden = true;
    };
    at("board-words").textContent = (await board.listen(at("baud").valueAsNumber, options, onStart)).join("; ");
    at("board-files").hidden = false;
  } catch (error) {
    fail("board-error", error);
  }
  at("connect").disabled = false;
  at("hang-up").hidden = true;
}

// --- What a user does ---

function listen() {
  at("choose").addEventListener("change", ({ target }) => {
    if (target.files.length) open({ files: [...target.files] });
  });
  for (const own of document.querySelectorAll("[data-example]")) own.addEventListener("click", () => open({ example: own.dataset.example }));
  at("accept-cut").addEventListener("change", () => opened && open(opened, channel()));
  at("topic").addEventListener("change", () => { showFields(); load(); });
  for (const id of ["field", "rate", "skip"]) at(id).addEventListener("change", load);
  addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over"); });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("over"); });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    const files = [...event.dataTransfer.files];
    if (files[0]?.type.startsWith("video/")) watch(files[0]);
    else if (files.length) open({ files });
  });
  at("scheme").addEventListener("change", ({ target }) => take(target.value, {}));
  at("sample").addEventListener("change", ({ target }) => { settings[current].sample = target.value; update(); });
  at("reset").addEventListener("click", () => take(settings[current].scheme, {}));
  at("add").addEventListener("click", () => {
    settings.push(structuredClone(settings[current]));
    choose(settings.length - 1);
    update();
  });
  at("remove").addEventListener("click", () => {
    settings.splice(current, 1);
    runs.splice(current, 1);
    choose(Math.min(current, settings.length - 1));
    update();
  });
  const views = { in: () => plots.zoom(0.5), out: () => plots.zoom(2), left: () => plots.pan(-0.25), right: () => plots.pan(0.25), all: () => plots.show(...plots.full) };
  for (const own of document.querySelectorAll("[data-view]")) own.addEventListener("click", views[own.dataset.view]);
  at("plots").addEventListener("keydown", (event) => {
    const view = { "+": "in", "=": "in", "-": "out", ArrowLeft: "left", ArrowRight: "right", 0: "all" }[event.key];
    if (!view) return;
    event.preventDefault();
    views[view]();
  });
  for (const own of at("exports").children) own.addEventListener("click", () => takeAway(own.dataset));
  at("save").addEventListener("click", ({ target }) => save(target.dataset.name, at("out").value, "text/plain"));
  at("copy").addEventListener("click", async () => {
    at("out").select();
    try {
      await navigator.clipboard.writeText(at("out").value);
      at("copied").textContent = "copied";
    } catch {
      at("copied").textContent = "selected: your browser copies it with Ctrl-C";
    }
  });
  at("tune").addEventListener("click", () => search((thread) => tune(thread, [settings[current].scheme])));
  at("tune-all").addEventListener("click", () => search((thread) => tune(thread, schemes.map((own) => own.name))));
  at("advise").addEventListener("click", () => search(advise));
  at("clip").addEventListener("change", ({ target }) => target.files.length && watch(target.files[0]));
  at("camera").addEventListener("click", () => watch());
  at("end").addEventListener("click", endVideo);
  at("levels").addEventListener("input", ({ target }) => { video.threshold = target.valueAsNumber; at("level").textContent = target.value; });
  at("connect").addEventListener("click", connect);
  at("hang-up").addEventListener("click", () => board.stop());
  for (const own of document.querySelectorAll("[data-heard]")) own.addEventListener("click", () => save(`${own.dataset.heard}.csv`, board.files[own.dataset.heard], "text/csv"));
  if (whyNot()) at("board-words").textContent = `Not here: ${whyNot()}.`;
  at("stop").addEventListener("click", () => searching?.stop());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => recording && show());
}

/** Takes the settings, the example and the channel that a link names behind `#`. */
async function follow(hash) {
  const asked = link.read(hash);
  const known = asked.settings.filter((own) => schemes.some((scheme) => scheme.name === own.scheme));
  if (known.length) [settings, current] = [known, 0];
  if (asked.example || !opened?.topics.length) return open({ example: asked.example ?? "flight" }, asked.channel);
  showTopics(asked.channel);
  return load();
}

async function begin() {
  listen();
  try {
    ({ schemes } = await library.ask({ ask: "catalogue" }));
    at("scheme").replaceChildren(...schemes.map((own) => new Option(`${own.title}: ${own.words}`, own.name)));
    at("sample").replaceChildren(...SAMPLES.map((own) => new Option(own)));
    addEventListener("hashchange", ({ newURL }) => follow(new URL(newURL).hash));
    await follow(location.hash);
  } catch (error) {
    fail("file-error", error);
  }
}

begin();
