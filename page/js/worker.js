// A thread with the library: answers one request after the other.

import { start } from "./wasm.js";

let wasm, started, id;

onmessage = async ({ data }) => {
  if (data.wasm) {
    wasm = data.wasm;
    return;
  }
  try {
    started ??= start(wasm, (progress) => postMessage({ id, progress }));
    const ask = await started;
    id = data.id;
    const answer = ask(data.request, data.files);
    postMessage({ id, answer }, Object.values(answer.arrays).map((array) => array.buffer));
  } catch (error) {
    // After a panic the library starts anew, without a recording.
    if (error.isFatal) started = undefined;
    postMessage({ id: data.id, error: error.message, isFatal: error.isFatal });
  }
};
