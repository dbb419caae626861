// Searches in a thread of their own, to which the stop button puts an end.

import { at } from "./dom.js";
import { Library } from "./library.js";
import { take } from "./settings.js";
import { changed, choiceOf, current, loadRequest, openRequest, state } from "./state.js";

let thread;

/** Runs a search of the recording, on which hangs what it finds. */
async function search(work) {
  if (thread) return;
  const { recording } = state, found = { fronts: [], refused: [] };
  thread = new Library();
  recording.found = found;
  state.searching = { share: 0, words: "" };
  changed();
  try {
    // Read as it was for the page, with its times and its unit: the search answers as the program does.
    const { opened, asked } = recording;
    await thread.ask(openRequest(opened), { files: opened.files });
    await thread.ask(loadRequest(opened, asked));
    await work(found);
  } catch (error) {
    if (error.isStopped) found.isStopped = true;
    else found.error = error;
  }
  thread.stop();
  thread = state.searching = undefined;
  changed();
}

/** Ends the search of a recording that is looked at no more. */
export const endSearch = () => thread?.stop();

/** Milliseconds between two looks at the progress: thousands of settings a second would leave the page no time for anything else. */
const OFTEN = 150;
let shownAt = 0;

const onProgress = (before, of, name) => ({ done, total, words }) => {
  state.searching = { share: (before + done / total) / of, words: `${words ?? name}: ${done} of ${total} settings` };
  if (performance.now() - shownAt < OFTEN) return;
  shownAt = performance.now();
  changed();
};

async function tune(found, names) {
  const { recording } = state, evaluations = Number(at("evaluations").value) || 300, { sample } = current();
  for (const [place, scheme] of names.entries()) {
    try {
      const choice = { ...choiceOf(current(), recording.field), scheme, sample, parameters: {} };
      found.fronts.push(await thread.ask({ ask: "front", choice, evaluations }, { onProgress: onProgress(place, names.length, scheme) }));
    } catch (error) {
      if (error.isStopped || names.length === 1 || error.isFatal) throw error;
      found.refused.push(error.message);
    }
    changed();
  }
}

async function advise(found) {
  const request = {
    ask: "advise", sample: current().sample, max_rmse: Number(at("max-rmse").value) || null,
    loop_bandwidth: at("bandwidth").valueAsNumber || null, evaluations: Number(at("evaluations").value) || 300,
  };
  const { words, best, whyNot } = await thread.ask(request, { onProgress: onProgress(0, 1, "") });
  found.advice = words;
  if (best) take(best.scheme, best.parameters, best.filter);
  else found.error = new Error(whyNot);
}

export function listenToSearch() {
  at("tune").addEventListener("click", () => search((found) => tune(found, [current().scheme])));
  at("tune-all").addEventListener("click", () => search((found) => tune(found, state.schemes.map(({ name }) => name))));
  at("advise").addEventListener("click", () => search(advise));
  at("stop").addEventListener("click", () => thread?.stop());
}
