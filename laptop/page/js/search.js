// Searches, each in a thread of its own, to which the stop button puts an end.

import { at, fail } from "./dom.js";
import { draw as drawFront } from "./front.js";
import { Library } from "./library.js";
import { letter, take } from "./settings.js";
import { state } from "./state.js";

let searching;

async function search(work) {
  if (searching) return;
  fail("search-error");
  searching = new Library();
  for (const id of ["tune", "tune-all", "advise"]) at(id).disabled = true;
  at("working").hidden = false;
  at("bar").value = 0;
  at("done").textContent = "";
  at("advice").hidden = true;
  const { recording } = state;
  try {
    await searching.ask({ ask: "take", name: recording.name, rate: recording.rate, file: 0 }, { files: [new Blob([recording.arrays.values])] });
    await work(searching);
  } catch (error) {
    if (error.isStopped) at("front-words").textContent = `Stopped. ${at("front-words").textContent}`;
    else fail("search-error", error);
  }
  searching.stop();
  searching = undefined;
  for (const id of ["tune", "tune-all", "advise"]) at(id).disabled = false;
  at("working").hidden = true;
}

/** Ends a search of what is looked at no more, and puts away what it found. */
export function endSearch() {
  searching?.stop();
  at("front").textContent = at("front-words").textContent = "";
  at("advice").hidden = at("text").hidden = true;
}

const progress = (before, of, name) => ({ done, total, words }) => {
  at("bar").value = (before + done / total) / of;
  at("done").textContent = `${words ?? name}: ${done} of ${total} settings`;
};

async function tune(thread, names) {
  const fronts = [], refused = [], evaluations = Number(at("evaluations").value) || 300;
  const { sample } = state.settings[state.current];
  at("front").textContent = at("front-words").textContent = "";
  for (const [place, scheme] of names.entries()) {
    try {
      const choice = { scheme, sample, parameters: {} };
      fronts.push(await thread.ask({ ask: "front", choice, evaluations }, { onProgress: progress(place, names.length, scheme) }));
    } catch (error) {
      if (error.isStopped || names.length === 1 || error.isFatal) throw error;
      refused.push(error.message);
    }
    drawFront(at("front"), fronts, state.recording.unit, take);
    const dots = fronts.reduce((sum, { points }) => sum + points.length, 0);
    at("front-words").textContent = `${dots} settings that no other of their scheme beats, searched and scored on the whole recording. Click a dot to take it as setting ${letter(state.current)}.`
      + (refused.length ? ` Not: ${refused.join("; ")}.` : "");
  }
}

async function advise(thread) {
  const { sample } = state.settings[state.current], error = Number(at("max-rmse").value) || null;
  const request = { ask: "advise", sample, max_rmse: error, evaluations: Number(at("evaluations").value) || 300 };
  const { words, best, whyNot } = await thread.ask(request, { onProgress: progress(0, 1, "") });
  at("advice").textContent = words;
  at("advice").hidden = false;
  if (best) take(best.scheme, best.parameters);
  else fail("search-error", new Error(whyNot));
}

export function listenToSearch() {
  at("tune").addEventListener("click", () => search((thread) => tune(thread, [state.settings[state.current].scheme])));
  at("tune-all").addEventListener("click", () => search((thread) => tune(thread, state.schemes.map(({ name }) => name))));
  at("advise").addEventListener("click", () => search(advise));
  at("stop").addEventListener("click", () => searching?.stop());
}
