// The part of the page below the picture: spectrum, search, or what is taken away; one at a time.

import { at } from "./dom.js";
import { changed, state } from "./state.js";

/** Each part with the button that opens it. */
const PARTS = { "spectrum-box": "show-spectrum", search: "show-search", take: "more-formats" };

export function openDrawer(id) {
  state.drawer = id;
  changed();
}

export function showDrawer() {
  at("drawer").hidden = !state.drawer;
  for (const [id, button] of Object.entries(PARTS)) {
    at(id).hidden = state.drawer !== id;
    at(button).setAttribute("aria-expanded", state.drawer === id);
  }
}

export function listenToDrawer() {
  for (const [id, button] of Object.entries(PARTS)) at(button).addEventListener("click", () => openDrawer(state.drawer === id ? undefined : id));
}
