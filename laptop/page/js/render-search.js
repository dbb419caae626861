// Renders what was searched, and what is taken away.

import { at, fail } from "./dom.js";
import { draw as drawFront } from "./front.js";
import { letter } from "./render-settings.js";
import { settingsKey, state } from "./state.js";

let drawn;

/** The words below a front. */
function words({ fronts, refused, isStopped }) {
  const dots = fronts.reduce((sum, { points }) => sum + points.length, 0);
  return (isStopped ? "Stopped. " : "")
    + (dots ? `${dots} settings that no other of their scheme beats, searched and scored on the whole recording. Click a dot to take it as setting ${letter(state.current)}.` : "")
    + (refused.length ? ` Not: ${refused.join("; ")}.` : "");
}

/** `onChoice(scheme, parameters)` is told which dot was clicked. */
export function showSearch(onChoice) {
  const { searching, recording } = state, found = recording?.found ?? { fronts: [], refused: [] };
  for (const id of ["tune", "tune-all", "advise"]) at(id).disabled = Boolean(searching);
  at("working").hidden = !searching;
  at("bar").value = searching?.share ?? 0;
  at("done").textContent = searching?.words ?? "";
  fail("search-error", found.error);
  const key = JSON.stringify(found.fronts);
  if (key !== drawn) drawFront(at("front"), found.fronts, recording?.unit, onChoice);
  drawn = key;
  at("front-words").textContent = words(found);
  at("advice").hidden = !found.advice;
  at("advice").textContent = found.advice ?? "";
}

export function showTaken() {
  const { text: made, takeError } = state.recording ?? {}, text = made?.key === settingsKey() ? made : undefined;
  at("text").hidden = !text;
  at("out").value = text?.words ?? "";
  at("save").dataset.name = text?.file ?? "";
  at("copied").textContent = [text?.left, text?.copied].filter(Boolean).join("; ");
  fail("take-error", takeError);
}
