// Error against efficiency: every dot is a setting to click.

const [WIDTH, HEIGHT, LEFT, BOTTOM] = [720, 340, 76, 52];
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
  const x = (efficiency) => LEFT + ((efficiency - low) / (100 - low || 1)) * (WIDTH - LEFT - 12);
  const y = (rmse) => 10 + ((most - Math.log10(rmse)) / (most - least || 1)) * (HEIGHT - BOTTOM - 10);
  const svg = make("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "group", "aria-label": "Error against efficiency: each dot is a setting. Arrow keys go from dot to dot, Enter takes one." }, host);
  const line = (x1, y1, x2, y2) => make("line", { x1, y1, x2, y2, stroke: "var(--grid)" }, svg);
  const text = (words, at, more) => (make("text", { x: at[0], y: at[1], ...more }, svg).textContent = words);
  for (let percent = low; percent <= 100; percent += (100 - low) / 5) {
    line(x(percent), 10, x(percent), HEIGHT - BOTTOM);
    text(short(percent), [x(percent), HEIGHT - BOTTOM + 22], { "text-anchor": "middle" });
  }
  for (let step = 0; step <= 4; step++) {
    const rmse = 10 ** (least + ((most - least) * step) / 4);
    line(LEFT, y(rmse), WIDTH - 12, y(rmse));
    text(short(rmse), [LEFT - 6, y(rmse) + 4], { "text-anchor": "end" });
  }
  text("samples without a spike, %", [(LEFT + WIDTH) / 2, HEIGHT - 8], { "text-anchor": "middle" });
  text(unit ? `RMSE, ${unit}` : "RMSE", [14, HEIGHT / 2 - 18], { transform: `rotate(-90 14 ${HEIGHT / 2 - 18})`, "text-anchor": "middle" });
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
