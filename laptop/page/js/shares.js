// What the axes of a sensor share of a setting, and what each has of its own.

import { siblings } from "./channels.js";
import { parametersOf, schemeOf, shareOf, state } from "./state.js";
import { asFlown, canFly } from "./verdict.js";

const text = (value) => String(Number(value.toPrecision(6)));

/** A setting for the channels that are open: another log has the bank that flew anew, and nothing of what was set for the axes of the one before. */
export function suited(setting) {
  const { opened, topic, field } = state.recording, fields = siblings(opened.topics, topic);
  // A link or a file may bring the bank to a page that does not know the unit.
  if (setting.isFlown && (canFly(setting) || !fields.some((own) => setting.own?.[own]))) return asFlown(setting);
  if (!setting.own || [field, ...fields].some((own) => setting.own[own])) return setting;
  const { own, basis, ...rest } = setting;
  return rest;
}

/** Gives a parameter of a channel, or takes it back where the text is undefined. */
export function give(setting, field, name, given) {
  const parameters = { ...parametersOf(setting, field) };
  if (given === undefined) delete parameters[name];
  else parameters[name] = given;
  delete setting.isFlown;
  if (setting.own?.[field]) setting.own[field] = parameters;
  else setting[shareOf(field)] = parameters;
}

/**
 * Parameters that were found on one channel, for the axes beside it, whose ranges are `ranges`, by name: where a code's
 * range is, each axis has its own; what is in the signal's unit is scaled for axes of another quantity. Axes whose range is
 * not known have what their own signal tells, if they are of another quantity.
 */
export function fitted(setting, given, ranges) {
  const { field, min, max } = state.recording, { parameters } = schemeOf(setting), share = shareOf(field);
  const scaled = (own) => {
    const [low, high] = ranges[own], factor = (high - low) / (max - min || 1), isOther = shareOf(own) !== share;
    return Object.fromEntries(Object.entries(given).map(([name, value]) => {
      const { slider, unit } = parameters.find((each) => each.name === name) ?? {}, numbers = value.split(",").map(Number);
      if (unit !== "signal" || !numbers.every(Number.isFinite)) return [name, value];
      if (slider?.of === "around" || numbers.length > 1) return [name, numbers.map((each) => text(low + (each - min) * factor)).join()];
      return [name, isOther ? text(value * factor) : value];
    }));
  };
  const others = ranges[field] ? Object.keys(ranges).filter((own) => own !== field) : [];
  const own = Object.fromEntries([[field, { ...given }], ...others.map((each) => [each, scaled(each)])]);
  return { ...setting, parameters: {}, [share]: { ...given }, ...(others.length ? { own, basis: field } : {}) };
}
