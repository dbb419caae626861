// Renders which file and channel is looked at.

import { html, render } from "lit-html";
import { at, fail } from "./dom.js";
import { options } from "./render-parts.js";
import { isDimmed, state } from "./state.js";
import { answer, choices, isAsked } from "./units.js";

/** As many channels as a search shows. */
const MOST_FOUND = 200;
/** Boxes that an error asks for, which are then shown. */
const OF_READING = ["time_unit", "header", "rate", "skip_non_finite", "field", "column", "topic"];

const brief = (value) => String(Number(value.toPrecision(4)));

/** The rate as it is known: two, if the times of the recording contradict themselves. */
function rateWords({ rate, uneven }) {
  if (!rate) return "";
  return uneven ? ` ${brief(uneven.throughLength)} a second through the length, but ${brief(uneven.byMedian)} by the median step: say the samples a second` : ` ${brief(rate)} a second`;
}

function about({ reading, recording, asked }) {
  if (reading) {
    // A log is read twice: for what it holds, and for the channel.
    const { done, total } = reading, file = asked?.files[0]?.name ?? "", name = reading.field ? `${reading.field} of ${file}` : file;
    const shown = recording?.isBeginning ? ", of which the beginning is shown" : "";
    return total > 1 ? `reading ${name} … ${Math.round((100 * done) / total)} % of ${(total / 1e6).toFixed(0)} MB${shown}` : `reading ${name} …${shown}`;
  }
  if (!recording) return "";
  const { name, samples, seconds, min, max, unit, gaps, opened: { file } } = recording;
  return `${file}: ${name}, ${samples.toLocaleString("en")} sample${samples === 1 ? "" : "s"}` + (seconds ? ` in ${brief(seconds)} s,${rateWords(recording)}` : "")
    + (gaps.length ? `, ${gaps.length} gap${gaps.length === 1 ? "" : "s"}` : "") + `, ${min === max ? `flat at ${brief(min)}` : `${brief(min)} to ${brief(max)}`}${unit ? ` ${unit}` : ""}`;
}

/** What stands where a link's file is not here, or where a file was refused. */
function notice({ awaited, recording, fileError, opened }) {
  if (fileError && recording) return `The picture is still that of ${recording.opened.file}.`;
  return awaited ? `This link was made from ${awaited.file}, which it does not hold: open that file to see its settings on it. Until then they are shown on ${opened?.file ?? "an example"}.` : "";
}

/** `acts.find(channel)` opens a channel of the list. */
function showFound(topics, find) {
  const part = at("find").value.trim().toLowerCase(), isSought = part !== "";
  at("found").hidden = !isSought;
  if (!isSought) return render("", at("found"));
  const all = topics.flatMap(({ name, fields, units }) => fields.map((field, place) => ({ topic: name, field, unit: units[place] })));
  const words = ({ topic, field }) => [topic, field].filter(Boolean).join(" · ");
  const good = all.filter((channel) => words(channel).toLowerCase().includes(part)).slice(0, MOST_FOUND);
  render(good.length ? good.map((channel) => html`<li><button type="button" title=${words(channel)} @click=${() => find(channel)}>${words(channel)}${channel.unit ? `, ${channel.unit.name}` : ""}</button></li>`)
    : html`<li class="quiet">no channel has “${part}” in its name</li>`, at("found"));
}

export function showFile({ find }) {
  const { opened, dropped, channel, recording, fileError, table } = state, topics = opened?.topics ?? [];
  const isTable = topics.length ? topics[0].name === "" && topics.length === 1 : Boolean(fileError) && !state.isDamaged;
  fail("file-error", fileError);
  at("damaged").hidden = !state.isDamaged;
  at("accept-cut").checked = state.acceptsCut;
  at("back-box").hidden = !isDimmed() || Boolean(state.reading && !fileError);
  at("back").textContent = recording ? `Back to ${recording.opened.file}` : "";
  const words = notice(state);
  at("notice").hidden = !words;
  at("notice").textContent = words;
  at("channel").hidden = !topics.length && !fileError;
  at("of-files").hidden = dropped.length < 2;
  render(options(dropped.map(({ name }, place) => [place, name]), dropped.indexOf(state.asked?.files[0])), at("file-of"));
  at("topic-field").hidden = topics.length < 2 && !topics[0]?.name;
  render(options(topics.map(({ name, about: more }) => [name, more ? `${name} (${more})` : name]), channel.topic), at("topic"));
  const fields = topics.find(({ name }) => name === channel.topic)?.fields ?? [];
  render(options(fields.map((name) => [name, name]), channel.field), at("field"));
  showFound(topics, find);
  const asks = [fileError?.parameter, fileError?.remedy];
  if (document.activeElement !== at("rate")) at("rate").value = channel.rate ?? "";
  at("rate-field").hidden = recording && !fileError ? Boolean(recording.arrays.times) && !recording.uneven && !channel.rate : !asks.includes("rate") && !channel.rate;
  at("skip").checked = channel.skip ?? false;
  for (const box of document.querySelectorAll(".of-table")) box.hidden = !isTable;
  at("time-unit").value = table.timeUnit ?? "";
  if (document.activeElement !== at("header")) at("header").value = table.header ?? "";
  if (recording?.uneven || asks.some((own) => OF_READING.includes(own)) || (fileError && isTable)) at("reading").open = true;
  at("unit-field").hidden = !isAsked();
  if (isAsked()) render(options([["", "choose …"], ...choices(recording, recording.field).map((unit) => [unit, unit])], answer(recording, recording.field) ?? ""), at("unit"));
  at("about").textContent = at("about").title = about(state);
  document.body.classList.toggle("dimmed", isDimmed());
  for (const id of ["picture", "settings"]) [at(id).hidden, at(id).inert] = [!recording, isDimmed()];
  at("axes").inert = isDimmed();
  for (const id of ["flight-file", "more-formats"]) at(id).disabled = !recording || isDimmed();
  const notes = new Set([...(opened?.notes ?? []), ...(recording && opened === recording.opened ? recording.notes : [])]);
  render([...notes].map((note) => html`<li>${note}</li>`), at("file-notes"));
}
