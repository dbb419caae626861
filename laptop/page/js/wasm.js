// The other side of src/host.rs: starts the library and asks it.

/** Bytes after which the page hears how far reading is. */
const STEP = 1 << 24;
const KINDS = [Float64Array, Uint32Array, Uint16Array, Uint8Array];

/** Whether a call can wait in its middle, as listening to a board does. */
export const canWait = "Suspending" in WebAssembly;

/** Starts the library; `onProgress` is told how far long work is, `pull(most)` promises bytes of a board. */
export async function start(wasm, onProgress, pull) {
  let files = [];
  let answered, arrays, panic, told = 0;
  const memory = () => instance.exports.memory.buffer;
  const text = (at, length) => new TextDecoder().decode(new Uint8Array(memory(), at, length));
  const instance = await WebAssembly.instantiate(wasm, {
    page: {
      answer: (at, length) => (answered = JSON.parse(text(at, length))),
      array(name, length, kind, at, bytes) {
        // A copy: memory may move, and the array goes to another thread.
        arrays[text(name, length)] = new KINDS[kind](memory().slice(at, at + bytes));
      },
      progress(at, length) {
        const told = arrays;
        arrays = {};
        onProgress(JSON.parse(text(at, length)), told);
      },
      panicked: (at, length) => (panic = text(at, length)),
      size: (file) => files[file].size,
      read(file, place, at, length) {
        try {
          if (place >= told + STEP || place < told) onProgress({ done: (told = place), total: files[file].size });
          const bytes = bytesOf(files[file], place, Math.min(length, files[file].size - place));
          new Uint8Array(memory(), at).set(bytes);
          return bytes.length;
        } catch {
          return -1;
        }
      },
      board: canWait ? new WebAssembly.Suspending(async (at, length) => {
        const bytes = await pull(length);
        new Uint8Array(memory(), at).set(bytes);
        return bytes.length;
      }) : () => -1,
    },
  });

  /** Asks; `given` are the files that the request names. Throws errors in words, with the parameter, file and remedy that the library names. */
  return async function ask(request, given) {
    if (given) files = given;
    [answered, arrays] = [undefined, {}];
    const { call } = instance.exports;
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    try {
      const at = instance.exports.allocate(bytes.length);
      new Uint8Array(memory(), at).set(bytes);
      if (request.ask === "listen" && canWait) await WebAssembly.promising(call)(at, bytes.length);
      else call(at, bytes.length);
    } catch (error) {
      const broken = new Error(
        panic ? `the library failed, which is an error of its own: ${panic}`
          : `the browser gives no more memory for this recording (${error.message})`,
      );
      broken.isFatal = true;
      throw broken;
    }
    if (answered.error !== undefined) throw Object.assign(new Error(answered.error.message), answered.error);
    return { ...answered, arrays };
  };
}

/** Part of a file, read when it is needed: a log of a gigabyte is never in memory as a whole. */
function bytesOf(file, place, length) {
  if (length <= 0) return new Uint8Array();
  return new Uint8Array(new FileReaderSync().readAsArrayBuffer(file.slice(place, place + length)));
}
