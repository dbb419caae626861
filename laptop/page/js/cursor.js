// The values under the cursor and at the mark: a table on the signal, and the time below the picture.

import { html, render } from "lit-html";
import { at, element, fine } from "./dom.js";
import { lowerBound } from "./pyramid.js";

const box = element("div", { className: "cursor" });
/** Windows in which the table would hide the signal: there it stands below the picture. */
const narrow = matchMedia("(max-width: 59.99rem)");
const signed = (count) => (count > 0 ? `+${count}` : String(count));

/** Spikes of a run from a sample to before another one: less the downward ones where a code has such. */
function spikes({ arrays: { sample, up }, isSigned, isPart }, from, to) {
  if (isPart) return "–";
  let count = 0;
  const end = lowerBound(sample, to);
  for (let spike = lowerBound(sample, from); spike < end; spike++) count += isSigned && !up[spike] ? -1 : 1;
  return isSigned ? signed(count) : String(count);
}

/** The series that are drawn, each with its cells: at the cursor, and with a mark there and between the two. */
function rows({ recording: { name, arrays: { values } }, runs, pointed, mark }) {
  const cells = (value) => {
    const here = value(pointed);
    if (mark === undefined) return [fine(here ?? NaN)];
    const there = value(mark);
    return [here, there, here === null || there === null ? null : here - there].map((own) => fine(own ?? NaN));
  };
  const count = (run) => {
    const here = spikes(run, pointed, pointed + 1);
    return mark === undefined ? [here] : [here, spikes(run, mark, mark + 1), spikes(run, Math.min(mark, pointed), Math.max(mark, pointed))];
  };
  return [
    { words: name, colour: "--signal", cells: cells((sample) => values[sample]) },
    ...runs.flatMap((run) => [
      { words: `${run.name}, decoded`, colour: run.variable, cells: cells((sample) => run.pyramid.at(sample)) },
      { words: `${run.name}, error`, colour: run.variable, cells: cells((sample) => run.errors.at(sample)) },
      { words: `${run.name}, spikes`, colour: run.variable, cells: count(run) },
    ]),
  ];
}

/** Shows the table on the side of the signal where the cursor is not, or below the picture. */
function showTable(plots) {
  const { upper, pointed, mark, times, recording: { unit } } = plots;
  if (pointed === undefined || !upper) return box.remove();
  const host = narrow.matches ? at("below") : upper.over;
  if (box.parentElement !== host) host.append(box);
  const time = times.at(pointed);
  box.dataset.side = time > (plots.view[0] + plots.view[1]) / 2 ? "left" : "right";
  const heads = mark === undefined ? [time] : [time, times.at(mark), time - times.at(mark)];
  const words = ["cursor", "mark", "difference"];
  return render(html`<table><caption class="away">Values${unit ? ` in ${unit}` : ""}</caption>
    <thead><tr><th scope="col">${unit}</th>${heads.map((own, place) => html`<th scope="col">${words[place]}<br>${fine(own)} ${times.unit}</th>`)}</tr></thead>
    <tbody>${rows(plots).map(({ words: name, colour, cells }) => html`<tr><th scope="row" data-colour=${colour}>${name}</th>${cells.map((cell) => html`<td>${cell}</td>`)}</tr>`)}</tbody></table>`, box);
}

/** Shows the sample under the cursor and how far it is from the mark. */
export function showCursor(plots) {
  const { recording: { name, unit: given, arrays: { values } }, pointed, mark, times } = plots;
  const unit = given ? ` ${given}` : "", time = (value) => `${fine(value)} ${times.unit}`;
  const apart = mark === undefined ? "" : ` · from the mark ${time(times.at(pointed) - times.at(mark))}, ${fine(values[pointed] - values[mark])}${unit}`;
  at("under").textContent = pointed === undefined ? "Point at the picture for values; click to set a mark." : `${time(times.at(pointed))}: ${name} ${fine(values[pointed])}${unit}${apart}`;
  showTable(plots);
}
