// A thread with the library: answers one request after the other.

import { start } from "./wasm.js";

let wasm, started, id;
/** Bytes of a board, an empty piece at the end, and who waits for them. */
const heard = [];
let wake = () => {};

async function pull(most) {
  while (heard.length === 0) await new Promise((done) => (wake = done));
  const piece = heard.shift();
  if (piece.length > most) heard.unshift(piece.subarray(most));
  return piece.subarray(0, most);
}

onmessage = async ({ data }) => {
  if (data.wasm) {
    wasm = data.wasm;
    return;
  }
  if (data.bytes) {
    heard.push(data.bytes);
    wake();
    return;
  }
  const buffers = (arrays) => Object.values(arrays).map((array) => array.buffer);
  try {
    started ??= start(wasm, (progress, arrays = {}) => postMessage({ id, progress, arrays }, buffers(arrays)), pull);
    const ask = await started;
    id = data.id;
    const answer = await ask(data.request, data.files);
    postMessage({ id, answer }, buffers(answer.arrays));
  } catch (error) {
    // After a panic the library starts anew, without a recording.
    if (error.isFatal) started = undefined;
    postMessage({ id: data.id, error: { ...error, message: error.message } });
  }
};
