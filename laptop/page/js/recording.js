// Opens recordings and reads a channel of them.

import { whileBusy } from "./dom.js";
import { Library } from "./library.js";
import { Pyramid } from "./pyramid.js";
import { changed, loadRequest, openRequest, state } from "./state.js";
import { noteUnit, unitOf } from "./units.js";

/** Bytes of a file whose beginning is shown while the whole is read, and bytes of that beginning. */
const LARGE = 24e6, BEGINNING = 2e6;

/** Who codes a recording that was read. */
let onRead = async () => {};
export const whenRead = (read) => (onRead = read);

function change(part) {
  Object.assign(state, part);
  changed();
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
export const open = (from, wanted) => {
  state.table = {};
  return whileBusy(() => openNow(from, wanted));
};

/** Opens the same once more, with other options. */
export const reopen = () => whileBusy(() => openNow(state.asked, state.asked.wanted));

/** The recording that is shown, or the one before it if a beginning is shown. */
function standing() {
  let { recording } = state;
  while (recording?.isBeginning) recording = recording.before;
  return recording;
}

/** Ends a library, unless the recording that stands lives in it. */
function leave(library) {
  if (library !== standing()?.library) library.stop();
}

/** Shows a recording in the place of the one before; beginnings, and the one that they stood for, are gone. */
function stand(recording) {
  for (let before = state.recording; before; before = before.before) {
    if (before.library !== recording?.library) before.library.stop();
  }
  change({ reading: undefined, recording });
}

/** Shows what stood before a beginning again, and why the whole cannot stand. */
function refuse(fileError, more = {}) {
  const before = standing();
  for (let own = state.recording; own !== before; own = own.before) own.library.stop();
  change({ reading: undefined, recording: before, fileError, ...more });
}

/** Reads a channel of what is open in a library. */
async function read(library, request, { opened, asked, onProgress }) {
  const recording = await library.ask(request, { onProgress }), { values } = recording.arrays;
  const [min, max] = new Pyramid(values).range(0, values.length), { topic, field } = asked;
  noteUnit(opened, topic, field, recording.unit);
  Object.assign(recording, { min, max, topic, field, opened, asked, library, runs: [] });
  recording.unit = unitOf(recording);
  return recording;
}

/** Shows the beginning of a large file, dimmed, while the whole is read; nothing of one whose beginning cannot be read by itself. */
async function showBeginning([file, ...others], wanted, isWanted) {
  if (!file || others.length || file.size < LARGE) return;
  const library = new Library();
  try {
    const bytes = new Uint8Array(await file.slice(0, BEGINNING).arrayBuffer());
    // A table's last line would be cut; a log's last message is cut anyway.
    const part = new File([bytes.subarray(0, bytes.lastIndexOf(10) + 1 || bytes.length)], file.name), { table } = state;
    const answer = await library.ask({ ...openRequest({ files: [part], table }), accept_cut: true }, { files: [part] });
    const opened = { ...answer, files: [part], table }, asked = channelOf(answer, wanted);
    const recording = await read(library, { ...loadRequest(opened, asked), accept_cut: true }, { opened, asked });
    if (!isWanted()) return library.stop();
    return change({ recording: Object.assign(recording, { isBeginning: true, before: state.recording }) });
  } catch {
    return library.stop();
  }
}

async function openNow({ files: given = [], example }, wanted = {}) {
  // What is read now is not wanted any more; what is shown keeps its library until the new one stands.
  const isFree = !state.reading && state.library !== standing()?.library;
  if (!isFree) leave(state.library);
  const library = isFree ? state.library : new Library();
  Object.assign(state, { library, asked: { files: given, example, wanted } });
  const onProgress = (reading) => library === state.library && change({ reading });
  change({ fileError: undefined, reading: { done: 0, total: 1 } });
  try {
    const files = await Promise.all(given.map(readable));
    showBeginning(files, wanted, () => library === state.library && state.reading);
    const answer = await library.ask(openRequest({ example, files, table: state.table }), { files, onProgress });
    if (library !== state.library) return;
    if (!answer.topics.some(({ fields }) => fields.length)) throw new Error("it has no channel of numbers beside times and counts: open another file, or say the header line");
    Object.assign(state, { opened: { ...answer, example, files, table: state.table }, isDamaged: state.acceptsCut && state.isDamaged, channel: channelOf(answer, wanted) });
    await load();
  } catch (error) {
    if (error.isStopped || library !== state.library) return;
    const [named] = given;
    const name = named && error.file !== named.name ? `${named.name}: ` : "";
    refuse(Object.assign(error, { message: name + error.message }), { opened: undefined, isDamaged: error.remedy === "accept_cut" || state.acceptsCut });
  }
}

/** Goes back to the recording that is still shown: its channel is read again, as another one may have been read in its library. */
export function goBack() {
  const { recording, library } = state;
  if (!recording) return;
  leave(library);
  const { opened, asked } = recording, { example, files } = opened;
  change({ library: recording.library, opened, channel: asked, asked: { example, files, wanted: asked }, table: opened.table, fileError: undefined, isDamaged: false, dropped: [] });
  return load();
}

const topicOf = (topics, name) => topics.find((topic) => topic.name === name);

/** The channel that is wanted, as far as there is such a one. */
export function channelOf({ topics, first }, { topic, field, rate, skip }) {
  const own = topicOf(topics, topic) ?? topicOf(topics, first);
  return { topic: own.name, field: own.fields.includes(field) ? field : own.first, rate: rate ?? "", skip: skip ?? false };
}

/** Reads another channel of what is open. */
export function loadChannel(part) {
  if (!state.opened) return undefined;
  state.channel = channelOf(state.opened, { ...state.channel, ...part });
  return load();
}

export const load = () => whileBusy(loadNow);

async function loadNow() {
  const asked = state.channel, { opened, library } = state;
  const onProgress = (reading) => library === state.library && change({ reading: { ...reading, field: asked.field } });
  change({ fileError: undefined, reading: { done: 0, total: 1 } });
  try {
    const recording = await read(library, loadRequest(opened, asked), { opened, asked, onProgress });
    if (library !== state.library) return;
    stand(recording);
  } catch (error) {
    if (!error.isStopped && library === state.library) refuse(error);
    return;
  }
  await onRead();
}

/** Reads the recording again after its library broke. */
export async function restored({ library, opened, asked }) {
  await library.ask(openRequest(opened), { files: opened.files });
  await library.ask(loadRequest(opened, asked));
}
