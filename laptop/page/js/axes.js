// The axes of the sensor, each with its spikes by the settings that are open: one thread reads and codes them all, that of the
// recording itself if the log is large, so that a large log is in memory once.

import { css, element, fine, fixed } from "./dom.js";
import { groupOf, siblings } from "./channels.js";
import { Library } from "./library.js";
import { lowerBound, Pyramid } from "./pyramid.js";
import { choiceOf, loadRequest, openRequest, state } from "./state.js";
import { Times } from "./times.js";
import { noteUnit, unitOf } from "./units.js";

/** Longer recordings show one channel alone: each axis takes 24 bytes a sample. */
const MOST_SAMPLES = 3_000_000;
/** Bytes of a log from which on the thread of the recording has the axes as well. */
const LARGE = 24e6;
const HEIGHT = 34, RASTER = 8;

/** How axes are read: another rate is another recording. */
const keyOf = ({ topic, rate, skip }) => JSON.stringify([topic, rate, skip]);

export class Axes {
  #all = [];
  #library;
  #of;
  #setting;
  #running;

  constructor(host, plots) {
    [this.host, this.plots] = [host, plots];
  }

  /** What was open is gone. */
  forget() {
    const { recording } = state;
    if (this.#of && this.#of.opened === recording?.opened && this.#of.key === keyOf(recording.asked)) return;
    if (!this.#of?.isShared) this.#library?.stop();
    this.#library = this.#of = undefined;
    this.#all = [];
    this.host.textContent = "";
  }

  /** Runs a setting on the axes of the topic that is shown, and draws them. */
  show(setting) {
    const { recording } = state, { opened, topic, field: shown, asked } = recording;
    this.#setting = structuredClone(setting);
    if (recording.isBeginning) return;
    if (!this.#of) {
      const fields = recording.samples > MOST_SAMPLES ? [] : siblings(opened.topics, topic);
      const isShared = opened.files.some(({ size }) => size > LARGE);
      this.#of = { opened, key: keyOf(asked), asked, isShared, isOpen: isShared };
      // The recording itself has place 0 in its library.
      this.#all = (fields.length < 2 ? [] : fields).map((field, place) => ({ field, place: place + 1 }));
      if (this.#all.length) this.#library = isShared ? recording.library : new Library();
    }
    this.#strips(recording);
    for (const { field, button } of this.#all) button.setAttribute("aria-pressed", field === shown);
    // In a shared thread what is looked at goes first.
    if (this.#of.isShared && !recording.runs[state.current]) return;
    this.#running ??= this.#runAll().finally(() => (this.#running = undefined));
  }

  /** The strips below the names of their sensors, anew if what is known of these changed. */
  #strips(recording) {
    const titles = this.#all.map(({ field }) => {
      const unit = unitOf(recording, field);
      const rate = recording.uneven || !recording.rate ? "" : ` · ${fine(recording.rate)} Hz`;
      return `${groupOf(recording, field) > 0 ? "Acceleration" : "Turn rate"}${unit ? `, ${unit}` : ""}${rate}`;
    });
    if (this.titles === titles.join() && this.host.children.length) return;
    this.titles = titles.join();
    this.host.replaceChildren(...this.#all.flatMap((axis, place) => [
      ...(titles[place] === titles[place - 1] ? [] : [element("p", { className: "group", textContent: titles[place] })]),
      axis.button ?? this.#strip(axis),
    ]));
  }

  /** Runs the newest setting on one axis after the other, until all have it. */
  async #runAll() {
    while (true) {
      const all = this.#all, setting = this.#setting;
      for (const axis of all) {
        await this.#run(axis, this.#setting);
        if (all !== this.#all) break;
      }
      if (all === this.#all && JSON.stringify(setting) === JSON.stringify(this.#setting)) return;
    }
  }

  async #run(axis, setting) {
    const { opened, asked: channel } = this.#of, library = this.#library;
    try {
      if (!this.#of.isOpen) {
        await library.ask(openRequest(opened), { files: opened.files });
        if (library !== this.#library) return;
        this.#of.isOpen = true;
      }
      if (!axis.recording) {
        axis.recording = await library.ask(loadRequest(opened, { ...channel, field: axis.field }, axis.place));
        axis.times = new Times(axis.recording.samples, axis.recording.rate, axis.recording.arrays.times);
        axis.signal = new Pyramid(axis.recording.arrays.values);
        if (noteUnit(opened, channel.topic, axis.field, axis.recording.unit)) this.onUnit();
      }
      const choice = choiceOf(setting, axis.field), key = JSON.stringify(choice);
      if (axis.key === key) return;
      axis.answer = await library.ask({ ask: "run", choice, place: axis.place });
      [axis.key, axis.error] = [key, undefined];
      axis.decoded = new Pyramid(axis.answer.arrays.decoded);
      const { spikes, spikes_per_second: rate, rmse } = axis.answer.figures;
      axis.figures = `${rate === null ? `${fixed(spikes, 0)} spikes` : `${fixed(rate, 1)} spikes a second`}, RMSE ${fine(rmse)}`;
      axis.words.textContent = `${axis.field}: ${axis.figures}`;
    } catch (error) {
      if (error.isStopped) return;
      axis.answer = axis.key = undefined;
      axis.error = error;
      axis.words.textContent = `${axis.field}: ${error.message}`;
    }
    axis.button.title = axis.words.textContent;
    this.#draw(axis);
  }

  /** The strip of an axis: a button that opens its channel. */
  #strip(axis) {
    axis.words = element("span", { textContent: axis.field });
    axis.canvas = element("canvas");
    axis.button = element("button", { type: "button", className: "axis" });
    axis.button.append(axis.words, axis.canvas);
    axis.button.addEventListener("click", () => this.onChoice(axis.field));
    return axis.button;
  }

  draw() {
    for (const axis of this.#all) this.#draw(axis);
  }

  /** The part of the axis that the picture above shows. */
  #draw({ canvas, recording, answer, signal, decoded, times }) {
    const { view } = this.plots;
    const scale = devicePixelRatio, width = canvas.clientWidth * scale, height = HEIGHT * scale;
    Object.assign(canvas, { width, height });
    if (!recording || !answer || !view || !width) return;
    const context = canvas.getContext("2d");
    const start = times.first(view[0]), end = Math.max(start + 1, times.first(view[1] + times.step / 2));
    const [low, high] = signal.range(start, end), tall = height - RASTER * scale;
    const y = (value) => tall - 2 - ((value - low) / (high - low || 1)) * (tall - 4);
    const x = (sample) => Math.round(((times.at(sample) - view[0]) / (view[1] - view[0])) * width);
    for (const [pyramid, colour] of [[signal, "--signal"], [decoded, "--decoded"]]) {
      context.fillStyle = css(colour);
      let before;
      for (let column = 0; column < width; column++) {
        const from = start + Math.floor(((end - start) * column) / width);
        const [least, most] = pyramid.range(from, Math.max(from + 1, start + Math.floor(((end - start) * (column + 1)) / width)));
        const top = y(Math.max(most, before?.least ?? most)), bottom = y(Math.min(least, before?.most ?? least));
        context.fillRect(column, top - scale / 2, 1, bottom - top + scale);
        before = { least, most };
      }
    }
    const { sample, up } = answer.arrays, colours = [css("--down"), css("--ink")];
    let last = -1;
    for (let spike = lowerBound(sample, start); spike < sample.length && sample[spike] < end; spike++) {
      const place = x(sample[spike]);
      if (place === last) continue;
      last = place;
      context.fillStyle = colours[up[spike]];
      context.fillRect(place, tall, scale, RASTER * scale);
    }
  }

  /** The least and greatest value of each axis that was read, by its field. */
  get ranges() {
    return Object.fromEntries(this.#all.filter(({ signal }) => signal).map(({ field, signal, recording }) => [field, signal.range(0, recording.samples)]));
  }

  /** When all have run: each axis with what was asked of its parameters, for a flight's file, and in words those that are left out. */
  async outcome() {
    await this.#running;
    const { samples, opened, topic, field } = state.recording;
    if (samples > MOST_SAMPLES && siblings(opened.topics, topic).length > 1) return { channels: [], left: [`${field} alone: the other axes of a recording this long are not read`] };
    const isFlat = ({ signal, recording }) => signal && new Set(signal.range(0, recording.samples)).size === 1;
    const good = this.#all.filter((axis) => axis.answer && !isFlat(axis)), bad = this.#all.filter((axis) => !good.includes(axis));
    return {
      channels: good.map(({ field, recording: { name }, answer: { asked } }) => ({ field, name, parameters: asked })),
      left: bad.map((axis) => `${axis.field} ${isFlat(axis) ? "is flat" : `(${axis.error?.message ?? "not read"})`}: left out`),
    };
  }
}
