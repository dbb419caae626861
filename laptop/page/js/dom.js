// The few words that every part of the page uses to reach its elements.

export const at = (id) => document.getElementById(id);
export const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
export const element = (name, attributes = {}) => Object.assign(document.createElement(name), attributes);

/** Boxes of settings that are no parameters of schemes. */
const BOXES = { time_unit: "time-unit", header: "header", loop_bandwidth: "bandwidth", accept_cut: "accept-cut", skip_non_finite: "skip", rate: "rate", topic: "topic", field: "field", column: "field", sample: "sample", max_rmse: "max-rmse", evaluations: "evaluations" };

/** Shows an error, or none, and marks the box of the setting at fault. */
export function fail(id, error) {
  at(id).textContent = error?.message ?? "";
  at(id).hidden = !error;
  for (const marked of document.querySelectorAll(`[aria-errormessage="${id}"]`)) {
    marked.removeAttribute("aria-invalid");
    marked.removeAttribute("aria-errormessage");
  }
  const box = error?.parameter && at(BOXES[error.parameter] ?? `parameter-${error.parameter}`);
  box?.setAttribute("aria-invalid", "true");
  box?.setAttribute("aria-errormessage", id);
}

let busy = 0;

/** Marks the page as busy while some work is under way. */
export async function whileBusy(work) {
  busy++;
  document.body.dataset.busy = "yes";
  try {
    return await work();
  } finally {
    if (--busy === 0) {
      document.body.dataset.busy = "no";
      document.body.dataset.ready ??= performance.now().toFixed(0);
    }
  }
}

/** A number with separators and this many digits behind the point; a dash where there is none. */
export const fixed = (value, digits) => (value === null || value === undefined || Number.isNaN(value) ? "–" : value.toLocaleString("en", { maximumFractionDigits: digits }));
/** A number of four digits; a dash where there is none. */
export const fine = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "–");
