// All settings in a link, and back.

/** Parts of a setting that a link holds as one. */
const OF_BANK = ["filter", "keyframe_ms", "forces", "isFlown", "link", "entries"];

/** The part of a link behind `#`; of a file of one's own it holds the name, and no sample. */
export function write({ example, file, channel, settings }) {
  const link = new URLSearchParams();
  if (example) link.set("example", example);
  else if (file) link.set("file", file);
  for (const name of ["topic", "field", "rate"]) if (channel?.[name]) link.set(name, channel[name]);
  if (channel?.skip) link.set("skip", "1");
  settings.forEach(({ scheme, sample, parameters, own = {}, ...bank }, place) => {
    link.append("s", new URLSearchParams({ "": `${scheme} ${sample}`, ...parameters }));
    for (const [field, given] of Object.entries(own)) link.append("own", new URLSearchParams({ "": `${place} ${field}`, ...given }));
    const given = OF_BANK.filter((name) => bank[name]).map((name) => [name, bank[name]]);
    if (given.length) link.append("bank", `${place} ${JSON.stringify(Object.fromEntries(given))}`);
  });
  return link.toString();
}

/** The same from a link; what is missing there is undefined. */
export function read(hash) {
  const link = new URLSearchParams(hash.replace(/^#/, ""));
  const settings = link.getAll("s").slice(0, 4).map((text) => {
    const { "": first = "", ...parameters } = Object.fromEntries(new URLSearchParams(text));
    const [scheme, sample = "f32"] = first.split(" ");
    return { scheme, sample, parameters };
  });
  for (const text of link.getAll("own")) {
    const { "": first = "", ...given } = Object.fromEntries(new URLSearchParams(text)), [, place, field] = /^(\d) (.*)$/.exec(first) ?? [];
    if (settings[place]) settings[place].own = { ...settings[place].own, [field]: given };
  }
  for (const text of link.getAll("bank")) {
    const given = JSON.parse(text.slice(2));
    for (const name of settings[text[0]] ? OF_BANK : []) settings[text[0]][name] = given[name];
  }
  const channel = Object.fromEntries(["topic", "field", "rate"].map((name) => [name, link.get(name) ?? undefined]));
  return { example: link.get("example") ?? undefined, file: link.get("file") ?? undefined, channel: { ...channel, skip: link.has("skip") }, settings };
}
