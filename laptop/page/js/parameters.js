// Fields and sliders of a scheme's parameters, as the catalogue describes them.

const STEPS = 1000;

/** A number as short as its slider is fine. */
const short = (value) => String(Number(value.toPrecision(4)));

/** Between which values a slider goes, on a signal from `min` to `max`. */
function bounds({ slider, unit, name }, { min, max }) {
  const range = max - min || 1;
  let { low, high } = slider;
  if (slider.of === "around") {
    const from = name === "max" ? max : min;
    return [from + low * range, from + high * range];
  }
  return unit === "signal" ? [low * range, high * range] : [low, high];
}

/** Where on its slider a value is, and back. */
function scale(parameter, signal) {
  const [low, high] = bounds(parameter, signal);
  const { of, isLog } = parameter.slider;
  if (of === "whole") return { low, high, place: Number, value: (place) => String(Math.round(place)) };
  const part = isLog
    ? { place: (value) => Math.log(value / low) / Math.log(high / low), value: (part) => low * (high / low) ** part }
    : { place: (value) => (value - low) / (high - low), value: (part) => low + (high - low) * part };
  return {
    low: 0, high: STEPS,
    place: (value) => STEPS * part.place(Number(value)),
    value: (place) => short(part.value(place / STEPS)),
  };
}

/** The parameter that a scheme has its one slider for: the threshold, or else the first that has a slider. */
export const mainParameter = ({ parameters }) => parameters.find(({ name, slider }) => name === "threshold" && slider) ?? parameters.find(({ slider }) => slider);

/**
 * Fills `main` with the main parameter of a scheme and `host` with the others. `signal` has `min`, `max` and `unit`; `onChange(name, text)` is told
 * what a user gives, and an undefined text where it is taken back. Returns a function that shows values.
 */
export function parameters({ main, host }, scheme, signal, onChange) {
  main.textContent = host.textContent = "";
  const first = mainParameter(scheme);
  const shown = scheme.parameters.map((own) => {
    const id = `parameter-${own.name}`;
    const box = (own === first ? main : host).appendChild(Object.assign(document.createElement("div"), { className: "parameter" }));
    const label = Object.assign(document.createElement("label"), { htmlFor: id, textContent: own.name });
    const unit = own.unit === "signal" ? signal.unit : own.unit;
    if (unit) label.append(Object.assign(document.createElement("span"), { className: "quiet", textContent: `, ${unit}` }));
    const help = Object.assign(document.createElement("p"), { className: "quiet", id: `${id}-help`, textContent: own.help.replaceAll("`", "") });
    let field, slider, scaled;
    if (own.kind === "choice") {
      field = document.createElement("select");
      for (const word of own.words) field.append(new Option(word, word));
    } else {
      field = Object.assign(document.createElement("input"), { type: own.kind === "flag" ? "checkbox" : "text", placeholder: own.example, spellcheck: false, autocomplete: "off" });
      if (own.kind === "number" || own.kind === "count") field.inputMode = "decimal";
    }
    field.id = id;
    field.setAttribute("aria-describedby", help.id);
    box.append(label, field);
    if (own.slider) {
      scaled = scale(own, signal);
      slider = Object.assign(document.createElement("input"), { type: "range", min: scaled.low, max: scaled.high, step: 1 });
      slider.setAttribute("aria-label", `${own.name}, slider`);
      slider.addEventListener("input", () => {
        field.value = scaled.value(slider.valueAsNumber);
        slider.setAttribute("aria-valuetext", field.value);
        onChange(own.name, field.value);
      });
      box.append(slider);
    }
    box.append(help);
    field.addEventListener(own.kind === "flag" || own.kind === "choice" ? "change" : "input", () => {
      const text = own.kind === "flag" ? (field.checked ? "true" : "") : field.value.trim();
      onChange(own.name, text === "" ? undefined : text);
    });
    return ({ given, settings }) => {
      const found = own.kind === "filter" ? "" : (settings[own.key] ?? "");
      const text = given[own.name] ?? (own.kind === "number" && found !== "" ? String(Number(Number(found).toPrecision(6))) : found);
      if (own.kind === "flag") field.checked = text === "true";
      else if (document.activeElement !== field) field.value = text;
      if (own.kind === "filter" && settings.taps) field.title = `${settings.taps.split(",").length} taps`;
      if (slider && document.activeElement !== slider && text !== "") {
        slider.value = scaled.place(text);
        slider.setAttribute("aria-valuetext", text);
      }
    };
  });
  return (values) => shown.forEach((show) => show(values));
}
