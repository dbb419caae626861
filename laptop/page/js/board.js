// A board on a serial port: what it sends, as it comes.

import { Library } from "./library.js";
import { canWait } from "./wasm.js";

const WINDOW = 10e6; // µs that the picture shows
const COLOURS = ["--signal", "--decoded", "--b", "--c", "--ink", "--down"];
const [WIDTH, HEIGHT, SIGNAL, LEFT] = [960, 360, 240, 70];

/** Why this browser listens to no board, or does not play a file; nothing if it does. */
export function whyNot(isFile = false) {
  if (!isFile && !navigator.serial) return "this browser reads no serial port; Chromium, Chrome and Edge on a computer do, and “spikewire listen”";
  if (!canWait) return "this browser's WebAssembly cannot wait for bytes; Chromium does from version 137 on";
  return "";
}

/** Lets the user choose a port, and opens it. */
export async function serialPort(baudRate) {
  const port = await navigator.serial.requestPort().catch((error) => {
    throw error.name === "NotFoundError" ? new Error("no port was chosen") : error;
  });
  await port.open({ baudRate });
  return port;
}

export class Board {
  #stop = () => {};
  #values = new Map(); // of each address: [time, value, isExact]
  #spikes = []; // [time, address, isUp]
  #now; // the latest tick, which wraps after 32 bits, and the time that it stands for
  #isDirty = false;

  /** Draws on a canvas; `onFigures(text)` is told the counts. */
  constructor(canvas, onFigures) {
    [this.canvas, this.onFigures] = [canvas, onFigures];
  }

  stop() {
    this.#stop();
  }

  /** Listens to what `open` opens, a port or a file with `readable`, until it ends or is stopped; returns what should be known, in words. */
  async listen(open, options, onStart) {
    const port = await open();
    const library = new Library(), parts = { spikes: [], values: [] };
    this.#values.clear();
    [this.#spikes, this.#now] = [[], undefined];
    let isOver = false, reader, failed;
    this.#stop = () => {
      isOver = true;
      reader?.cancel().catch(() => {});
    };
    const request = { ask: "listen", ...options };
    const onProgress = (counts, arrays) => {
      for (const [name, own] of Object.entries(parts)) own.push(arrays[name]);
      this.#take(arrays);
      this.onFigures(words(counts, this.#values));
    };
    const answered = library.ask(request, { onProgress }).catch((error) => {
      failed = error;
      this.#stop();
    });
    onStart();
    let fault;
    // After noise the port goes on with another stream; without a port there is none.
    while (!isOver && port.readable) {
      reader = port.readable.getReader();
      try {
        while (true) {
          const { value, done } = await reader.read();
          if (done) break;
          library.feed(value);
        }
        isOver = true;
      } catch (error) {
        fault = error;
      }
      reader.releaseLock();
    }
    library.feed(new Uint8Array());
    const answer = await answered;
    library.stop();
    await port.close?.().catch(() => {});
    if (failed) throw failed;
    this.files = Object.fromEntries(Object.entries(parts).map(([name, own]) => [name, new Blob(own)]));
    if (answer.wrong) throw new Error(answer.wrong);
    return [...(answer.rounding ?? []), ...answer.words.trim().split("\n"), ...(fault ? [`the port said: ${fault.message}`] : [])];
  }

  /** Ticks as times that do not wrap. */
  #time(tick) {
    if (this.#now === undefined) this.#now = { tick, time: tick };
    const time = this.#now.time + ((tick - this.#now.tick) | 0);
    if (time > this.#now.time) this.#now = { tick, time };
    return time;
  }

  #take({ spikeTicks, spikeAddresses, ups, ticks, addresses, numbers, exact }) {
    spikeTicks.forEach((tick, at) => this.#spikes.push([this.#time(tick), spikeAddresses[at], ups[at]]));
    ticks.forEach((tick, at) => {
      if (!this.#values.has(addresses[at])) this.#values.set(addresses[at], []);
      this.#values.get(addresses[at]).push([this.#time(tick), numbers[at], exact[at]]);
    });
    const start = (this.#now?.time ?? 0) - WINDOW;
    const recent = (all) => all.slice(Math.max(0, all.findIndex(([time]) => time >= start)));
    this.#spikes = recent(this.#spikes);
    for (const [address, all] of this.#values) this.#values.set(address, recent(all));
    if (!this.#isDirty) requestAnimationFrame(() => this.#draw());
    this.#isDirty = true;
  }

  #draw() {
    this.#isDirty = false;
    const context = this.canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    const css = (name) => style.getPropertyValue(name).trim();
    const end = this.#now?.time ?? 0;
    const x = (time) => LEFT + (1 - (end - time) / WINDOW) * (WIDTH - LEFT);
    context.fillStyle = css("--paper");
    context.fillRect(0, 0, WIDTH, HEIGHT);
    context.font = "13px sans-serif";
    context.textAlign = "right";
    let [low, high] = [Infinity, -Infinity];
    for (const all of this.#values.values()) for (const [, value] of all) [low, high] = [Math.min(low, value), Math.max(high, value)];
    if (!(low < high)) [low, high] = [low - 1, low + 1];
    const y = (value) => SIGNAL - 15 - ((value - low) / (high - low)) * (SIGNAL - 30);
    [...this.#values].forEach(([, all], place) => {
      context.strokeStyle = css(COLOURS[place % COLOURS.length]);
      for (const isExact of [1, 0]) {
        context.setLineDash(isExact ? [] : [2, 4]); // estimates are dotted
        context.beginPath();
        for (let at = 1; at < all.length; at++) {
          if (all[at][2] !== isExact) continue;
          context.moveTo(x(all[at - 1][0]), y(all[at - 1][1]));
          context.lineTo(x(all[at][0]), y(all[at - 1][1]));
          context.lineTo(x(all[at][0]), y(all[at][1]));
        }
        context.stroke();
      }
    });
    context.setLineDash([]);
    context.fillStyle = css("--ink");
    if (this.#values.size) for (const value of [low, high]) context.fillText(String(Number(value.toPrecision(4))), LEFT - 6, y(value) + 4);
    const rows = [...new Set(this.#spikes.map(([, address]) => address))].sort((a, b) => a - b);
    const row = (HEIGHT - SIGNAL) / Math.max(1, rows.length);
    for (const [time, address, isUp] of this.#spikes) {
      context.fillStyle = css(isUp ? "--ink" : "--down");
      context.fillRect(x(time), SIGNAL + rows.indexOf(address) * row + (isUp ? 0 : row / 2), 1, Math.max(1, row / 2 - 1));
    }
    context.fillStyle = css("--ink");
    if (row >= 12) rows.forEach((address, place) => context.fillText(String(address), LEFT - 6, SIGNAL + (place + 0.5) * row + 4));
  }
}

function words({ bytes, spikes, frames, lost, skipped }, values) {
  const all = [...values].map(([address, own]) => `${address}: ${Number(own.at(-1)[1].toPrecision(4))}`);
  const count = (number) => number.toLocaleString("en");
  return `${count(bytes)} bytes, ${count(frames)} frames, ${count(lost)} lost, ${count(skipped)} bytes skipped, ${count(spikes)} spikes`
    + (all.length ? `; values ${all.join(", ")}` : "");
}
