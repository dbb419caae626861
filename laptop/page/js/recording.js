// Opens recordings and reads a channel of them.

import { wanted as inertial } from "./channels.js";
import { whileBusy } from "./dom.js";
import { Library } from "./library.js";
import { Pyramid } from "./pyramid.js";
import { changed, loadRequest, openRequest, state } from "./state.js";

/** Who codes a recording that was read. */
let onRead = async () => {};
export const whenRead = (read) => (onRead = read);

const onProgress = (reading) => change({ reading });

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
export const open = (from, wanted) => whileBusy(() => openNow(from, wanted));

async function openNow({ files: given = [], example }, wanted = {}) {
  if (state.reading) {
    // What is read now is not wanted any more.
    state.library.stop();
    state.library = new Library();
  }
  const { library } = state;
  let files = given;
  change({ fileError: undefined, reading: { done: 0, total: 1 } });
  try {
    files = await Promise.all(given.map(readable));
    if (library !== state.library) return;
    const answer = await library.ask(openRequest({ example, files }), { files, onProgress });
    const isAnother = answer.file !== state.opened?.file;
    Object.assign(state, { opened: { ...answer, example, files }, isDamaged: state.acceptsCut && state.isDamaged, channel: channelOf(answer.topics, wanted) });
    if (isAnother) state.recording = undefined;
    await load();
  } catch (error) {
    if (error.isStopped) return;
    const isDamaged = error.remedy === "accept_cut" || state.acceptsCut, [named] = given;
    const name = named && error.file !== named.name ? `${named.name}: ` : "";
    change({
      reading: undefined, recording: undefined, isDamaged, opened: isDamaged ? { files, topics: [] } : undefined,
      fileError: Object.assign(error, { message: name + error.message }),
    });
  }
}

const topicOf = (topics, name) => topics.find((topic) => topic.name === name);

/** The channel that is wanted, as far as there is such a one. */
export function channelOf(topics, { topic, field, rate, skip }) {
  const own = topicOf(topics, topic) ?? topicOf(topics, inertial(topics).topic);
  return { topic: own.name, field: own.fields.includes(field) ? field : inertial([own]).fields[0], rate: rate ?? "", skip: skip ?? false };
}

/** Reads another channel of what is open. */
export function loadChannel(part) {
  state.channel = channelOf(state.opened.topics, { ...state.channel, ...part });
  return load();
}

export const load = () => whileBusy(loadNow);

async function loadNow() {
  const asked = state.channel, { opened, library } = state;
  change({ fileError: undefined, reading: { done: 0, total: 1 } });
  try {
    const recording = await library.ask(loadRequest(asked), { onProgress });
    const { values } = recording.arrays, [min, max] = new Pyramid(values).range(0, values.length);
    const { topic, field } = asked;
    change({ reading: undefined, recording: Object.assign(recording, { min, max, topic, field, opened, asked, runs: [] }) });
  } catch (error) {
    if (!error.isStopped) change({ reading: undefined, recording: undefined, fileError: error });
    return;
  }
  await onRead();
}

/** Reads the recording again after the library broke. */
export async function reopened() {
  const { library, opened } = state;
  await library.ask(openRequest(opened), { files: opened.files });
  await library.ask(loadRequest(state.channel));
}
