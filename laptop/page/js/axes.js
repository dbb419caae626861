// The other axes of the sensor: each with its spikes by the settings that are open, below the channel that is looked at.

import { css, element, fine, fixed } from "./dom.js";
import { siblings } from "./channels.js";
import { Library } from "./library.js";
import { lowerBound, Pyramid } from "./pyramid.js";
import { choiceOf, loadRequest, openRequest, state } from "./state.js";
import { Times } from "./times.js";

/** Longer recordings show one channel alone: each axis takes 24 bytes a sample. */
const MOST_SAMPLES = 3_000_000;
const HEIGHT = 56, RASTER = 12;

/** How axes are read: another rate is another recording. */
const keyOf = ({ topic, rate, skip }) => JSON.stringify([topic, rate, skip]);

export class Axes {
  #all = [];
  #of;
  #setting;
  #running;

  constructor(host, plots) {
    [this.host, this.plots] = [host, plots];
  }

  /** What was open is gone. */
  forget() {
    if (this.#of && this.#of.opened === state.opened && this.#of.key === keyOf(state.channel)) return;
    for (const { library } of this.#all) library.stop();
    this.#all = [];
    this.#of = undefined;
    this.host.textContent = "";
  }

  /** Runs a setting on the axes of the topic that is open, and draws them. */
  show(setting) {
    const { opened, recording } = state, { topic, field: shown, asked } = recording;
    this.#setting = structuredClone(setting);
    if (!opened || recording.samples > MOST_SAMPLES) return;
    if (!this.#of) {
      const fields = siblings(opened.topics, topic);
      this.#of = { opened, key: keyOf(asked), asked };
      this.#all = fields.length < 2 ? [] : fields.map((field) => ({ field, library: new Library() }));
      this.host.replaceChildren(...this.#all.map((axis) => this.#strip(axis)));
    }
    for (const { field, button } of this.#all) button.setAttribute("aria-pressed", field === shown);
    this.#running ??= this.#runAll().finally(() => (this.#running = undefined));
  }

  async #runAll() {
    let done, all;
    do {
      [done, all] = [JSON.stringify(this.#setting), this.#all];
      await Promise.all(all.map((axis) => this.#run(axis, JSON.parse(done))));
    } while (done !== JSON.stringify(this.#setting) || all !== this.#all);
  }

  async #run(axis, setting) {
    try {
      if (!axis.recording) {
        const { opened, asked: channel } = this.#of;
        await axis.library.ask(openRequest(opened), { files: opened.files });
        axis.recording = await axis.library.ask(loadRequest({ ...channel, field: axis.field }));
        axis.times = new Times(axis.recording.samples, axis.recording.rate, axis.recording.arrays.times);
        axis.signal = new Pyramid(axis.recording.arrays.values);
      }
      const choice = choiceOf(setting, axis.field), key = JSON.stringify(choice);
      if (axis.key === key) return this.#draw(axis);
      axis.answer = await axis.library.ask({ ask: "run", choice });
      axis.key = key;
      axis.decoded = new Pyramid(axis.answer.arrays.decoded);
      const { spikes, spikes_per_second: rate, rmse } = axis.answer.figures;
      axis.words.textContent = `${axis.field}: ${rate === null ? `${fixed(spikes, 0)} spikes` : `${fixed(rate, 1)} spikes a second`}, RMSE ${fine(rmse)}`;
    } catch (error) {
      if (error.isStopped) return;
      axis.answer = axis.key = undefined;
      axis.error = error;
      axis.words.textContent = `${axis.field}: ${error.message}`;
    }
    this.#draw(axis);
  }

  /** The strip of an axis: a button that opens its channel. */
  #strip(axis) {
    axis.words = element("span", { className: "quiet", textContent: axis.field });
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
      channels: good.map(({ recording: { name }, answer: { asked } }) => ({ name, parameters: asked })),
      left: bad.map((axis) => `${axis.field} ${isFlat(axis) ? "is flat" : `(${axis.error?.message ?? "not read"})`}: left out`),
    };
  }
}
