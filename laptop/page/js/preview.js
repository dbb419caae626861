// What a knob does while it is dragged: only what is in view is coded, the whole when it rests.

import { Pieces } from "./pyramid.js";
import { choiceOf, state } from "./state.js";

/** Recordings with fewer samples are coded as a whole within a moment. */
const LONG = 200_000;
/** Samples that are coded for a picture, and those before it from which the code comes into step. */
const MOST = 150_000, LEAD = 2_000;
/** How long a knob rests, in ms, before the whole recording is coded. */
const REST = 400;

let timer, isRunning = false, isStale = false;

/** Whether a change is to be previewed: of a long recording, by a knob. */
export const isPreviewed = (what) => what !== undefined && state.recording?.samples > LONG && Boolean(state.runs[state.current]?.answer);

/** Codes what is in view for `show(run)`, and calls `then` when no more changes come. */
export async function preview(plots, show, then) {
  clearTimeout(timer);
  timer = setTimeout(then, REST);
  if (isRunning) {
    isStale = true;
    return;
  }
  isRunning = true;
  try {
    do {
      isStale = false;
      const { recording, current, runs, settings } = state, { answer } = runs[current];
      const own = choiceOf(settings[current], recording.field);
      // What was found in the whole signal holds for its parts.
      const choice = { ...own, parameters: { ...answer.asked, ...own.parameters } };
      const [start, end] = plots.samples(), from = Math.max(0, start - LEAD);
      const made = await state.library.ask({ ask: "preview", choice, from, to: end, pieces: plots.columns(), most: MOST });
      if (recording !== state.recording || answer !== state.runs[current]?.answer) break;
      show(current, { ...answer, neurons: made.neurons, slots: made.slots, arrays: made.arrays, pyramid: new Pieces(made.arrays.decoded, made) });
    } while (isStale);
  } catch {
    // The run of the whole says what is wrong.
  }
  isRunning = false;
}
