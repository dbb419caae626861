// The browser, the laptop program and the page that the tests hold against each other. `cargo verify page` says where they are.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium, firefox } from "playwright-core";

export const { PAGE, LOGS, SPIKEWIRE, DATA, PICTURES } = process.env;
export const work = mkdtempSync(join(tmpdir(), "page-"));
export const spikewire = (...args) => execFileSync(SPIKEWIRE, args, { stdio: ["ignore", "pipe", "pipe"], maxBuffer: 1 << 28 });
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const url = pathToFileURL(PAGE).href;

/** The style by which Playwright waits for a picture in Firefox, and which the page's policy refuses. */
const WAITS = createHash("sha256").update("body {}").digest("base64");

/** Which browser it is, and what it said that it should not. */
export let engine;
export const said = [];
let browsers = {};

/** How each browser is started: Firefox by WebDriver BiDi, whose preferences take the place of media and permissions. */
const engines = {
  chromium: (executablePath) => chromium.launch({ executablePath, args: ["--no-sandbox", "--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream"] }),
  firefox: (executablePath, theme) => firefox.launch({
    executablePath, channel: "moz-firefox",
    firefoxUserPrefs: {
      "layout.css.prefers-color-scheme.content-override": theme === "dark" ? 0 : 1,
      "media.navigator.permission.disabled": true, "media.navigator.streams.fake": true,
    },
  }),
};

/** Closes the last browser, and lets the tests use this one. */
export async function use(name) {
  await end();
  engine = name;
}

export async function end() {
  for (const browser of Object.values(browsers)) await (await browser).close();
  browsers = {};
}

/** The browser in a theme; Chromium's contexts can have any. */
function browser(theme) {
  const path = execFileSync("which", [process.env[engine.toUpperCase()]]).toString().trim();
  return (browsers[engine === "firefox" ? theme : ""] ??= engines[engine](path, theme));
}

/** Step-forward with the parameters that the signal tells, in place of the bank that flew: its figures are easy to say. */
const PLAIN = "#s=%3Dsf%2Bf32";

/** Opens the page anew; with everything unfolded, unless it is wanted as it opens. */
export async function opened({ colorScheme = "light", isMobile, isFolded, ...options } = {}, hash = PLAIN, before = undefined) {
  const own = engine === "firefox" ? { colorScheme: null, reducedMotion: null, forcedColors: null, contrast: null } : { colorScheme, isMobile };
  const context = await (await browser(colorScheme)).newContext({ acceptDownloads: true, ...options, ...own });
  const page = await context.newPage();
  if (before) await page.addInitScript(before);
  if (engine === "firefox") await page.addInitScript(() => {
    const create = URL.createObjectURL;
    URL.createObjectURL = (blob) => create.call(URL, (globalThis.blob = blob));
  });
  const note = (words) => words.includes(WAITS) || said.push(words);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && note(message.text()));
  page.on("pageerror", (error) => note(String(error)));
  page.on("request", (request) => {
    const asked = request.url();
    if (!asked.startsWith(url) && !/^(blob|data):/.test(asked)) said.push(`a request off the page: ${asked}`);
  });
  await page.goto(url + hash);
  await settled(page);
  if (!isFolded) await unfold(page);
  return page;
}

/** Opens all that is folded. */
export const unfold = (page) => page.evaluate(() => { for (const own of document.querySelectorAll("details")) own.open = true; });

/** Opens the part below the picture whose button this is. */
export async function drawer(page, button) {
  if ((await page.getAttribute(button, "aria-expanded")) !== "true") await page.click(button);
}

/** Goes to another page of the page. */
export const go = (page, name) => page.click(`[data-goes=${name}]`);

/** Says the unit of the sensor, which the page asks for where no log tells it. */
export async function say(page, unit) {
  await page.selectOption("#unit", unit);
  await settled(page);
}

/** Waits until the page has computed what was asked. */
export async function settled(page) {
  await page.waitForTimeout(30);
  await page.waitForFunction(() => document.body.dataset.busy === "no", null, { timeout: 120_000 });
}

/** Chooses files by their paths. */
export async function choose(page, files) {
  await page.setInputFiles("#choose", files);
  await settled(page);
}

/** Gives a number to its box; Firefox's driver would append it. */
export const enter = (page, box, value) => page.locator(box).evaluate((own, given) => {
  own.value = given;
  for (const event of ["input", "change"]) own.dispatchEvent(new Event(event, { bubbles: true }));
}, String(value));

/** Drops files on the page: each a name and bytes. */
export async function drop(page, ...files) {
  const encoded = files.map(({ name, bytes, type = "" }) => [name, Buffer.from(bytes).toString("base64"), type]);
  await page.evaluate((all) => {
    const data = new DataTransfer();
    for (const [name, text, type] of all) data.items.add(new File([Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))], name, { type }));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
  }, encoded);
  await settled(page);
}

/** The file that a click saves. Of Firefox the driver hears of no download, so that the page's own blob is read. */
export async function saved(page, button) {
  if (engine === "firefox") {
    await page.evaluate(() => (globalThis.blob = undefined));
    await page.click(button);
    await page.waitForFunction(() => globalThis.blob);
    return Buffer.from(await page.evaluate(async () => [...new Uint8Array(await globalThis.blob.arrayBuffer())]));
  }
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
  return readFileSync(await download.path());
}

export async function exported(page, kind) {
  await drawer(page, "#more-formats");
  return saved(page, `[data-save=${kind}]`);
}

export async function text(page, kind) {
  await page.evaluate(() => (document.getElementById("out").value = ""));
  if (kind !== "flight") await drawer(page, "#more-formats");
  await page.click(`[data-text=${kind}]`);
  await page.waitForSelector("#take-error:visible, #text:visible");
  await page.waitForFunction(() => document.getElementById("out").value !== "" || document.getElementById("take-error").textContent);
  assert.equal(await page.textContent("#take-error"), "");
  return page.inputValue("#out");
}

/** The row of a figure, in whichever unit. */
export const figure = (page, name) => page.evaluate((own) => {
  const row = [...document.querySelectorAll("#figures tbody tr")].find(({ cells: [head] }) => head.textContent === own || head.textContent.startsWith(`${own}, `));
  return row ? [...row.cells].slice(1).map(({ textContent }) => textContent).join(" ") : "";
}, name);

/** The spikes that are drawn, as lines of the program's table. */
const drawn = (page) => page.evaluate(() => {
  const { arrays: { sample, neuron, slot, up }, slots } = globalThis.spikewire.plots.runs[0];
  const lines = [];
  for (let at = 0; at < sample.length; at++) lines.push([sample[at] * slots + slot[at], neuron[at], up[at] ? 1 : -1].join());
  return lines.sort();
});

/** The spikes in the picture, in the exported table and out of the program are the same. */
export async function compare(page, input, ...channel) {
  const toml = join(work, "own.toml");
  writeFileSync(toml, await text(page, "toml"));
  const own = (await exported(page, "csv")).toString();
  const theirs = spikewire("encode", "--params", toml, ...channel, input).toString();
  assert.equal(own, theirs);
  const lines = theirs.split("\n").filter((line) => /^\d/.test(line)).map((line) => line.split(",").slice(0, 3).join());
  assert.deepEqual(await drawn(page), lines.sort());
  assert.equal(Number((await figure(page, "Spikes")).replaceAll(",", "")), lines.length);
  return lines.length;
}

/** axe-core finds nothing, and leaves nothing undecided. */
export async function accessible(page, what) {
  await page.evaluate(axe);
  const { violations, incomplete } = await page.evaluate(() => globalThis.axe.run());
  const told = (all) => all.map((own) => [own.id, own.nodes.map((node) => `${node.html.slice(0, 200)} ${node.any.map((check) => check.message).join()}`)]);
  assert.deepEqual({ violations: told(violations), undecided: told(incomplete) }, { violations: [], undecided: [] }, what);
}

export const picture = async (page, name, options = {}) => PICTURES && page.screenshot({ path: join(PICTURES, `${name}-${engine}.png`), caret: "initial", ...options });

/** No two visible things lie on each other, and none is cut off at the window's side: texts, controls, pictures and the labels in them. */
export async function apart(page, what) {
  const found = await page.evaluate(() => {
    /** The part of a box that its ancestors do not clip. */
    const visible = (element, { left, top, right, bottom }) => {
      if (!element.checkVisibility({ visibilityProperty: true })) return undefined;
      for (let own = element; own; own = own.parentElement) {
        const style = getComputedStyle(own);
        if (style.clipPath === "inset(50%)") return undefined;
        if (own === document.body || style.overflow === "visible") continue;
        const clip = own.getBoundingClientRect();
        [left, top, right, bottom] = [Math.max(left, clip.left), Math.max(top, clip.top), Math.min(right, clip.right), Math.min(bottom, clip.bottom)];
      }
      return right - left > 1 && bottom - top > 1 ? { left, top, right, bottom } : undefined;
    };
    const boxes = [];
    const add = (element, name, box) => { const seen = visible(element, box); if (seen) boxes.push({ element, name, ...seen }); };
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = texts.nextNode(); node; node = texts.nextNode()) {
      if (!node.data.trim() || node.parentElement.closest("script, style, option, title, noscript, select, textarea")) continue;
      const range = document.createRange();
      range.selectNodeContents(node);
      // A line of text is as high as its letters: lines of one paragraph may touch.
      for (const box of range.getClientRects()) {
        const air = node.parentElement.closest("svg") ? 0 : 0.15 * box.height;
        add(node.parentElement, `“${node.data.trim().slice(0, 40)}”`, { left: box.left, right: box.right, top: box.top + air, bottom: box.bottom - air });
      }
    }
    for (const element of document.querySelectorAll("button, .button, input, select, textarea, progress, .u-wrap, canvas, #front svg")) {
      if (element.tagName === "CANVAS" && element.closest(".u-wrap")) continue;
      add(element, `${element.tagName.toLowerCase()}#${element.id || element.className}`, element.getBoundingClientRect());
    }
    const faults = [];
    for (const [place, one] of boxes.entries()) {
      if (one.left < -1 || one.right > document.documentElement.clientWidth + 1) faults.push(`${one.name} is cut off: ${one.left.toFixed()} to ${one.right.toFixed()} of ${document.documentElement.clientWidth}`);
      for (const other of boxes.slice(place + 1)) {
        if (one.element.contains(other.element) || other.element.contains(one.element)) continue;
        const wide = Math.min(one.right, other.right) - Math.max(one.left, other.left), high = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
        if (wide > 1 && high > 1) faults.push(`${one.name} on ${other.name}: ${wide.toFixed()} x ${high.toFixed()}`);
      }
    }
    return { faults, count: boxes.length };
  });
  assert.deepEqual(found.faults, [], what);
  assert(found.count > 50, `${what}: ${found.count} boxes`);
}
