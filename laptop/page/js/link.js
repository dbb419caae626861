// All settings in a link, and back.

/** The part of a link behind `#`. */
export function write({ example, channel, settings }) {
  const link = new URLSearchParams();
  if (example) link.set("example", example);
  for (const name of ["topic", "field", "rate"]) if (channel?.[name]) link.set(name, channel[name]);
  if (channel?.skip) link.set("skip", "1");
  for (const { scheme, sample, parameters } of settings) {
    link.append("s", new URLSearchParams({ "": `${scheme} ${sample}`, ...parameters }));
  }
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
  const channel = Object.fromEntries(["topic", "field", "rate"].map((name) => [name, link.get(name) ?? undefined]));
  return { example: link.get("example") ?? undefined, channel: { ...channel, skip: link.has("skip") }, settings };
}
