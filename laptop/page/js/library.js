// The library in threads of its own, so that the page never waits.

import { decompress } from "fzstd";

/** The library's module, unpacked and compiled once for all threads. */
const compiled = WebAssembly.compile(decompress(Uint8Array.from(atob(WASM), (letter) => letter.charCodeAt(0))));

const source = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));

const stopped = () => Object.assign(new Error("stopped"), { isStopped: true });

export class Library {
  #worker = new Worker(source);
  #waiting = new Map();
  #next = 0;
  #isStopped = false;
  #ready = compiled.then((wasm) => this.#worker.postMessage({ wasm }));

  constructor() {
    this.#worker.onmessage = ({ data: { id, answer, error, progress, arrays } }) => {
      const own = this.#waiting.get(id);
      if (!own) return;
      if (progress) return own.onProgress?.(progress, arrays);
      this.#waiting.delete(id);
      if (error === undefined) own.resolve(answer);
      else own.reject(Object.assign(new Error(error.message), error));
    };
    this.#worker.onerror = (event) => {
      for (const own of this.#waiting.values()) own.reject(new Error(event.message));
      this.#waiting.clear();
    };
  }

  /** Hands over bytes of a board that is listened to; none at its end. */
  feed(bytes) {
    this.#worker.postMessage({ bytes });
  }

  /** Asks; `onProgress` is told how far long work is. */
  async ask(request, { files, onProgress } = {}) {
    await this.#ready;
    if (this.#isStopped) throw stopped();
    return new Promise((resolve, reject) => {
      const id = this.#next++;
      this.#waiting.set(id, { resolve, reject, onProgress });
      this.#worker.postMessage({ id, request, files });
    });
  }

  /** Ends the thread; what it was asked fails as stopped. */
  stop() {
    this.#isStopped = true;
    this.#worker.terminate();
    for (const own of this.#waiting.values()) own.reject(stopped());
    this.#waiting.clear();
  }
}
