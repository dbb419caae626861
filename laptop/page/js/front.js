// Error against efficiency: every dot is a setting to click. Its labels are text beside the drawing.

import { element } from "./dom.js";

const [WIDTH, HEIGHT, AIR] = [640, 300, 8];
const make = (name, attributes, parent) => {
  const own = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) own.setAttribute(key, value);
  parent?.append(own);
  return own;
};
const short = (value) => String(Number(value.toPrecision(3)));

/** Draws fronts of schemes; `onChoice(scheme, parameters)` is told which dot was clicked. */
export function draw(host, fronts, unit, onChoice) {
  host.textContent = "";
  const all = fronts.flatMap(({ scheme, points }) => points.map((own) => ({ scheme, ...own })))
    .filter(({ rmse, efficiency }) => rmse > 0 && Number.isFinite(rmse) && efficiency > -100)
    .sort((a, b) => b.efficiency - a.efficiency || a.rmse - b.rmse);
  if (!all.length) return;
  const low = Math.max(-100, Math.min(90, Math.floor(Math.min(...all.map((own) => own.efficiency)) / 10) * 10));
  const errors = all.map((own) => Math.log10(own.rmse));
  const [least, most] = [Math.min(...errors) - 0.05, Math.max(...errors) + 0.05];
  const x = (efficiency) => AIR + ((efficiency - low) / (100 - low || 1)) * (WIDTH - 2 * AIR);
  const y = (rmse) => AIR + ((most - Math.log10(rmse)) / (most - least || 1)) * (HEIGHT - 2 * AIR);
  const svg = make("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "group", "aria-label": "Error against efficiency: each dot is a setting. Arrow keys go from dot to dot, Enter takes one." });
  const line = (x1, y1, x2, y2) => make("line", { x1, y1, x2, y2, stroke: "var(--grid)" }, svg);
  const labels = (className, all) => {
    const own = element("div", { className });
    own.append(...all.map((textContent) => element("span", { textContent })));
    return own;
  };
  const steps = (count) => Array.from({ length: count + 1 }, (_, step) => step / count);
  const percents = steps(5).map((part) => low + part * (100 - low)), rmses = steps(4).map((part) => 10 ** (most - part * (most - least)));
  for (const percent of percents) line(x(percent), AIR, x(percent), HEIGHT - AIR);
  for (const rmse of rmses) line(AIR, y(rmse), WIDTH - AIR, y(rmse));
  host.append(
    element("p", { className: "of-rows", textContent: unit ? `RMSE, ${unit}` : "RMSE" }), labels("rows", rmses.map(short)), svg,
    labels("columns", percents.map(short)), element("p", { className: "of-columns", textContent: "samples without a spike, %" }),
  );
  let best = Infinity;
  const dots = all.map((own, place) => {
    const isBest = own.rmse < best;
    if (isBest) best = own.rmse;
    const words = `${own.scheme}: ${own.efficiency.toFixed(1)} % without a spike, RMSE ${short(own.rmse)}`;
    const dot = make("circle", {
      cx: x(own.efficiency), cy: y(own.rmse), r: isBest ? 5 : 3.5, fill: isBest ? "var(--decoded)" : "var(--edge)",
      role: "button", tabindex: place === 0 ? 0 : -1, "aria-label": words,
    }, svg);
    make("title", {}, dot).textContent = words;
    const take = () => onChoice(own.scheme, own.parameters);
    dot.addEventListener("click", take);
    dot.addEventListener("keydown", (event) => {
      const to = { ArrowRight: place - 1, ArrowUp: place - 1, ArrowLeft: place + 1, ArrowDown: place + 1 }[event.key];
      if (event.key === "Enter" || event.key === " ") take();
      else if (dots[to]) {
        dot.setAttribute("tabindex", -1);
        dots[to].setAttribute("tabindex", 0);
        dots[to].focus();
      } else return;
      event.preventDefault();
    });
    return dot;
  });
}
