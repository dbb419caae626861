// What a knob does while it is dragged: only what is in view is coded, the whole when it rests.

import { Pieces } from "./pyramid.js";
import { changed, choiceOf, current, outcome, state } from "./state.js";

/** Recordings with fewer samples are coded as a whole within a moment. */
const LONG = 200_000;
/** Samples that are coded for a picture, and those before it from which the code comes into step. */
const MOST = 150_000, LEAD = 2_000;
/** Columns of pixels that share a piece of a long view: to start a code takes as long as to code some thousand samples. */
const COLUMNS = 3;
/** How long a knob rests, in ms, before the whole recording is coded. */
const REST = 400;

let timer, isRunning = false, isStale = false;

/** Whether a change is to be previewed: of a long recording, by a knob. */
export const isPreviewed = (what) => what !== undefined && state.recording?.samples > LONG && Boolean(outcome().answer);

/** Codes what is in view, hangs it on the recording in the place of the last run, and calls `then` when no more changes come. */
export async function preview(plots, then) {
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
      const { recording } = state, { answer } = outcome(), own = choiceOf(current(), recording.field);
      // What was found in the whole signal holds for its parts.
      const choice = { ...own, parameters: { ...answer.asked, ...own.parameters } };
      const [start, end] = plots.samples(), from = Math.max(0, start - LEAD);
      const made = await recording.library.ask({ ask: "preview", choice, from, to: end, pieces: Math.ceil(plots.columns() / COLUMNS), most: MOST });
      if (answer !== outcome().answer) break;
      recording.preview = { of: answer, run: { ...answer, isPreview: true, isPart: made.length < made.stride, neurons: made.neurons, slots: made.slots, arrays: made.arrays, pyramid: new Pieces(made.arrays.decoded, made), errors: new Pieces(made.arrays.errors, made) } };
      changed();
    } while (isStale);
  } catch {
    // The run of the whole says what is wrong.
  }
  isRunning = false;
}
