// Parts that several views share.

import { html } from "lit-html";
import { live } from "lit-html/directives/live.js";

/** Options of a list: each a value and its words. */
export const options = (all, chosen) => all.map(([value, words]) => html`<option .value=${String(value)} .selected=${live(value === chosen)}>${words}</option>`);
