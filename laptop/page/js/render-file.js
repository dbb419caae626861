// Renders which file and channel is looked at.

import { html, render } from "lit-html";
import { at, fail } from "./dom.js";
import { options } from "./render-parts.js";
import { state } from "./state.js";

/** As many channels as a list can offer to be found. */
const MOST_FOUND = 5000;
const OF_RECORDING = ["settings", "picture", "take", "search", "file-notes"];

const brief = (value) => Number(value.toPrecision(5));

function about({ reading, recording, opened }) {
  if (reading) {
    const { done, total } = reading;
    return total > 1 ? `reading … ${Math.round((100 * done) / total)} % of ${(total / 1e6).toFixed(0)} MB` : "reading …";
  }
  if (!recording) return "";
  const { name, samples, seconds, rate, min, max, unit } = recording;
  return `${opened.file}: ${name}, ${samples.toLocaleString("en")} samples` + (seconds ? ` in ${brief(seconds)} s, ${brief(rate)} a second` : "")
    + `, ${brief(min)} to ${brief(max)}${unit ? ` ${unit}` : ""}`;
}

let found;

/** Fills the list in which channels are found, anew for each file. */
function showFound(topics) {
  if (found === topics) return;
  found = topics;
  const all = topics.flatMap(({ name, fields }) => fields.map((own) => [name, own])).slice(0, MOST_FOUND);
  at("find-field").hidden = all.length < 9;
  render(all.map((own) => html`<option value=${own.filter(Boolean).join(" · ")} data-channel=${JSON.stringify(own)}></option>`), at("channels"));
}

export function showFile() {
  const { opened, dropped, channel, recording, fileError } = state, topics = opened?.topics ?? [];
  fail("file-error", fileError);
  at("damaged").hidden = !state.isDamaged;
  at("accept-cut").checked = state.acceptsCut;
  at("channel").hidden = !topics.length;
  at("of-files").hidden = dropped.length < 2;
  render(options(dropped.map(({ name }, place) => [place, name]), dropped.indexOf(opened?.given)), at("file-of"));
  at("topic-field").hidden = topics.length < 2 && !topics[0]?.name;
  render(options(topics.map(({ name, about: words }) => [name, words ? `${name} (${words})` : name]), channel.topic), at("topic"));
  const fields = topics.find(({ name }) => name === channel.topic)?.fields ?? [];
  render(options(fields.map((name) => [name, name]), channel.field), at("field"));
  showFound(topics);
  if (document.activeElement !== at("rate")) at("rate").value = channel.rate ?? "";
  at("rate-field").hidden = recording ? Boolean(recording.arrays.times) && !recording.uneven && !channel.rate : ![fileError?.parameter, fileError?.remedy].includes("rate") && !channel.rate;
  at("skip").checked = channel.skip ?? false;
  at("about").textContent = about(state);
  for (const id of OF_RECORDING) at(id).hidden = !recording;
  render([...(opened?.notes ?? []), ...(recording?.notes ?? [])].map((words) => html`<li>${words}</li>`), at("file-notes").querySelector("ul"));
}
