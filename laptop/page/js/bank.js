// What stands around the code of a flight: the filter before it, and the keyframes between its spikes.

import { at } from "./dom.js";

const first = { "low-pass": { corner: 80 }, "first-order": { corner: 80 }, notch: { centre: 100, q: 3 } };

/** Shows what a setting has. */
export function showBank({ filter, keyframe_ms: keyframes }) {
  at("filter").value = filter?.kind ?? "none";
  at("corner-field").hidden = !filter;
  at("q-field").hidden = filter?.kind !== "notch";
  for (const [id, value] of [["corner", filter?.corner ?? filter?.centre], ["q", filter?.q], ["keyframes", keyframes]]) {
    if (document.activeElement !== at(id)) at(id).value = value ?? "";
  }
}

/** Calls `change(what, part)` with what a user changes. */
export function listenToBank(change) {
  const filter = (kind) => {
    const number = (id, usual) => at(id).valueAsNumber || usual, usual = first[kind];
    if (kind === "none") return null;
    return kind === "notch" ? { kind, centre: number("corner", usual.centre), q: number("q", usual.q) } : { kind, corner: number("corner", usual.corner) };
  };
  at("filter").addEventListener("change", ({ target }) => change("filter", { filter: filter(target.value) }));
  for (const id of ["corner", "q"]) at(id).addEventListener("input", () => change(id, { filter: filter(at("filter").value) }));
  at("keyframes").addEventListener("input", ({ target }) => change("keyframes", { keyframe_ms: target.valueAsNumber || null }));
}
