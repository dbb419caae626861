// Opens recordings and reads a channel of them.

import { at, element, fail, whileBusy } from "./dom.js";
import { wanted as inertial } from "./channels.js";
import { Library } from "./library.js";
import { Pyramid } from "./pyramid.js";
import { loadRequest, openRequest, state } from "./state.js";

const OF_RECORDING = ["settings", "picture", "take", "search"];
const acceptCut = () => at("accept-cut").checked;

let isReading = false;
/** Who shows a recording that was read, and who puts away what was made of the last one. */
let onRead = async () => {}, onForget = () => {};
export const whenRead = (read, forget) => ([onRead, onForget] = [read, forget]);

/** Puts away all that was made of the last recording. */
function forget() {
  state.recording = undefined;
  state.runs = [];
  at("about").textContent = "";
  for (const id of [...OF_RECORDING, "file-notes"]) at(id).hidden = true;
  onForget();
}

/** How far reading is. */
function reading({ done, total }) {
  at("about").textContent = total > 1 ? `reading … ${Math.round((100 * done) / total)} % of ${(total / 1e6).toFixed(0)} MB` : "reading …";
}

/** The file as the library reads it: text of two bytes a letter, as spreadsheets write it, becomes UTF-8. */
async function readable(file) {
  const [first, second, third, fourth] = new Uint8Array(await file.slice(0, 4).arrayBuffer());
  const isLittle = (first === 0xff && second === 0xfe) || (first && second === 0 && third && fourth === 0);
  const isBig = (first === 0xfe && second === 0xff) || (first === 0 && second && third === 0 && fourth);
  if (!isLittle && !isBig) return file;
  const text = new TextDecoder(isLittle ? "utf-16le" : "utf-16be").decode(await file.arrayBuffer());
  return new File([text], file.name);
}

/** Opens files or an example, and loads a channel of it: the wanted one, or a turn rate, or the first. */
export const open = (from, wanted) => whileBusy(() => openNow(from, wanted));

async function openNow({ files: given = [], example }, wanted = {}) {
  fail("file-error");
  if (isReading) {
    // What is read now is not wanted any more.
    state.library.stop();
    state.library = new Library();
  }
  isReading = true;
  const [named] = given, { library } = state;
  let files = given;
  try {
    files = await Promise.all(given.map(readable));
    if (library !== state.library) return;
    const answer = await library.ask(openRequest({ example, files }, acceptCut()), { files, onProgress: reading });
    state.opened = { ...answer, example, files };
    showTopics(wanted);
    await load();
  } catch (error) {
    if (error.isStopped) return;
    isReading = false;
    forget();
    at("channel").hidden = true;
    const isDamaged = error.remedy === "accept_cut" || acceptCut();
    at("damaged").hidden = !isDamaged;
    state.opened = isDamaged ? { files, topics: [] } : undefined;
    const name = named && error.file !== named.name ? `${named.name}: ` : "";
    fail("file-error", Object.assign(error, { message: name + error.message }));
  }
}

/** As many channels as a list can offer. */
const MOST_FOUND = 5000;

export function showTopics({ topic, field, rate, skip }) {
  const { topics } = state.opened;
  const all = topics.flatMap(({ name, fields }) => fields.map((own) => [name, own])).slice(0, MOST_FOUND);
  at("find-field").hidden = all.length < 9;
  at("channels").replaceChildren(...all.map((own) => {
    const option = element("option", { value: own.filter(Boolean).join(" · ") });
    option.dataset.channel = JSON.stringify(own);
    return option;
  }));
  at("damaged").hidden = !acceptCut();
  at("channel").hidden = false;
  at("topic").replaceChildren(...topics.map(({ name, about }) => new Option(about ? `${name} (${about})` : name, name)));
  at("topic-field").hidden = topics.length < 2 && !topics[0].name;
  const best = inertial(topics);
  at("topic").value = topics.some(({ name }) => name === topic) ? topic : best.topic;
  at("rate").value = rate ?? "";
  at("skip").checked = skip ?? false;
  showFields(field);
}

export function showFields(field) {
  const topic = state.opened.topics.find(({ name }) => name === at("topic").value) ?? state.opened.topics[0];
  at("field").replaceChildren(...topic.fields.map((name) => new Option(name, name)));
  at("field").value = topic.fields.includes(field) ? field : inertial([topic]).fields[0];
}

export const channel = () => ({ topic: at("topic").value, field: at("field").value, rate: at("rate").value, skip: at("skip").checked });

export const load = () => whileBusy(loadNow);

async function loadNow() {
  const { field, rate, topic, skip } = channel();
  fail("file-error");
  isReading = true;
  reading({ done: 0, total: 1 });
  try {
    state.recording = await state.library.ask(loadRequest({ topic, field, rate, skip }, acceptCut()), { onProgress: reading });
    isReading = false;
  } catch (error) {
    if (error.isStopped) return;
    isReading = false;
    forget();
    at("rate-field").hidden = !([error.parameter, error.remedy].includes("rate") || rate);
    fail("file-error", error);
    return;
  }
  const { recording, opened } = state, { values, times } = recording.arrays;
  at("rate-field").hidden = Boolean(times);
  const [min, max] = new Pyramid(values).range(0, values.length);
  Object.assign(recording, { min, max, topic, field, opened });
  const unit = recording.unit ? ` ${recording.unit}` : "";
  const brief = (value) => Number(value.toPrecision(5));
  at("about").textContent = `${opened.file}: ${recording.name}, ${recording.samples.toLocaleString("en")} samples`
    + (recording.seconds ? ` in ${brief(recording.seconds)} s, ${brief(recording.rate)} a second` : "")
    + `, ${brief(min)} to ${brief(max)}${unit}`;
  at("file-notes").hidden = false;
  at("file-notes").querySelector("ul").replaceChildren(...[...opened.notes, ...recording.notes].map((text) => element("li", { textContent: text })));
  for (const id of OF_RECORDING) at(id).hidden = false;
  state.runs = [];
  onForget();
  await onRead();
}

/** Reads the recording again after the library broke. */
export async function reopened() {
  const { library, opened: { example, files } } = state;
  await library.ask(openRequest({ example, files }, acceptCut()), { files });
  await library.ask(loadRequest(channel(), acceptCut()));
}
