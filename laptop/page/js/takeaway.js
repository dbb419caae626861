// What is taken away: constants, tables, pictures, a flight's file.

import { at, css, element } from "./dom.js";
import { openDrawer } from "./drawer.js";
import { axes, plots } from "./drawings.js";
import { changed, choiceOf, current, outcome, settingsKey, state } from "./state.js";
import { picture } from "./svg.js";

export function save(name, content, type) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

const choice = () => choiceOf(current(), state.recording.field);
const ask = (kind) => state.recording.library.ask({ ask: "export", kind, choice: choice() });

const inC = (toml) => `/* Save as roll.toml:\n\n${toml}\n   then

   spikewire emit c roll.toml -o roll

   writes a crate that makes the library for C with this very codec. */
#include "roll.h"

/* sw_roll_codec is the constant; bindings/c/README.md in the repository has the loop around it. */
`;

/** The settings of all axes that are drawn, or of the one channel, in one file for both ends, which says what is left out. */
async function flight() {
  const { recording } = state, own = choice(), { key, answer } = outcome();
  const shown = { field: recording.field, name: recording.name, parameters: key === JSON.stringify(own) && answer ? answer.asked : own.parameters };
  const { channels, left } = await axes.outcome(), { entries = {} } = current();
  const named = (channels.length ? channels : [shown]).map(({ field, ...channel }) => ({ ...channel, entry: entries[field] ?? null }));
  const { text } = await recording.library.ask({ ask: "flight", choice: own, rate: recording.rate, channels: named });
  return { words: left.map((words) => `# ${words}\n`).join("") + text, left: left.join("; ") };
}

const texts = {
  rust: { file: "spikes.rs", make: async () => (await ask("rust")).text },
  toml: { file: "spikes.toml", make: async () => (await ask("toml")).text },
  flight: { file: "flight.toml", make: flight },
  python: { file: "spikes.py", make: async () => (await ask("python")).text },
  c: { file: "spikes.c", make: async () => inC((await ask("toml")).text) },
  link: { file: "link.txt", make: () => location.href },
};
const files = {
  csv: async () => ["spikes.csv", (await ask("csv")).arrays.file, "text/csv"],
  es: async () => ["spikes.es", (await ask("es")).arrays.file, "application/octet-stream"],
  svg: () => {
    const colours = Object.fromEntries(["signal", "ink", "paper", "grid", "down"].map((name) => [name, css(`--${name}`)]));
    return ["spikes.svg", picture(plots, colours), "image/svg+xml"];
  },
  png: async () => ["spikes.png", await new Promise((done) => plots.canvas().toBlob(done)), "image/png"],
};

/** What is taken away hangs on the recording that it is of. */
async function takeAway({ text, save: kind }) {
  const { recording } = state, key = settingsKey();
  recording.takeError = undefined;
  try {
    if (kind) save(...(await files[kind]()));
    else {
      openDrawer("take");
      const made = await texts[text].make();
      recording.text = { file: texts[text].file, key, ...(made.words ? made : { words: made }) };
    }
  } catch (error) {
    recording.takeError = error;
  }
  changed();
}

async function copy() {
  at("out").select();
  const { text } = state.recording;
  try {
    await navigator.clipboard.writeText(text.words);
    text.copied = "copied";
  } catch {
    text.copied = "selected: your browser copies it with Ctrl-C";
  }
  changed();
}

export function listenToTakeaway() {
  for (const button of [at("flight-file"), ...at("exports").children]) button.addEventListener("click", () => takeAway(button.dataset));
  at("save").addEventListener("click", () => save(state.recording.text.file, state.recording.text.words, "text/plain"));
  at("copy").addEventListener("click", copy);
}
