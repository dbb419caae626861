// What is taken away: constants, tables, pictures, a flight's file.

import { at, css, element, fail } from "./dom.js";
import { axes, plots } from "./settings.js";
import { choiceOf, state } from "./state.js";
import { picture } from "./svg.js";

export function save(name, content, type) {
  const url = URL.createObjectURL(new Blob([content], { type }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

const current = () => state.settings[state.current];
const choice = () => choiceOf(current(), state.recording.field);
const ask = (kind) => state.library.ask({ ask: "export", kind, choice: choice() });

const inC = (toml) => `/* Save as roll.toml:\n\n${toml}\n   then

   spikewire emit c roll.toml -o roll

   writes a crate that makes the library for C with this very codec. */
#include "roll.h"

/* sw_roll_codec is the constant; bindings/c/README.md in the repository has the loop around it. */
`;

/** The settings of all axes that are drawn, or of the one channel, in one file for both ends. */
async function flight() {
  const { recording, runs } = state;
  const shown = { name: recording.name, parameters: runs[state.current]?.answer?.asked ?? choice().parameters };
  const channels = axes.channels.length ? axes.channels : [shown];
  return (await state.library.ask({ ask: "flight", choice: choice(), rate: recording.rate, channels })).text;
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

async function takeAway({ text, save: kind }) {
  fail("error");
  try {
    if (kind) return save(...(await files[kind]()));
    at("out").value = await texts[text].make();
    at("text").hidden = false;
    at("save").dataset.name = texts[text].file;
    at("copied").textContent = "";
  } catch (error) {
    fail("error", error);
    at("error").scrollIntoView({ block: "nearest" });
  }
}

export function listenToTakeaway() {
  for (const button of at("exports").children) button.addEventListener("click", () => takeAway(button.dataset));
  at("save").addEventListener("click", ({ target }) => save(target.dataset.name, at("out").value, "text/plain"));
  at("copy").addEventListener("click", async () => {
    at("out").select();
    try {
      await navigator.clipboard.writeText(at("out").value);
      at("copied").textContent = "copied";
    } catch {
      at("copied").textContent = "selected: your browser copies it with Ctrl-C";
    }
  });
}
