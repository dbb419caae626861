// Banks: that each axis has settings of its own, on another log too, and what is said of those left out.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { DATA, drawer, drop, enter, opened, say, settled, text } from "./harness.mjs";
import { euroc, px4 } from "./made.mjs";

const [head, ...rows] = readFileSync(join(DATA, "hexarotor.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
const own = head.slice(1);

/** The built-in flight, twice as fast, each value put through `change(value, column, row)`. */
const flight = (change = (value) => value, names = head) => Buffer.from([names, ...rows.map((row, at) => [2000 * at, ...row.slice(1).map((value, column) => change(value, column, at))])].map((row) => row.join()).join("\n"));

/** The channels of a flight's file: each its name and its numbers. */
const channels = (toml) => toml.split("[[channel]]").slice(1).map((part) => ({
  source: /name = "(.*)"/.exec(part)?.[1], ...Object.fromEntries([...part.matchAll(/\b(\w+) = (-?[\d.]+(?:e-?\d+)?)/g)].map(([, name, value]) => [name, Number(value)])),
}));
const thresholds = async (page) => channels(await text(page, "flight")).map(({ threshold }) => Number(threshold.toPrecision(3)));

const panels = (page, wanted) => page.waitForFunction((words) => {
  const all = [...document.querySelectorAll(".axis span")];
  return all.length && all.every(({ textContent }) => new RegExp(words).test(textContent));
}, wanted, { timeout: 20_000 }).catch(async () => assert.fail((await page.locator(".axis span").allTextContents()).join("; ")));

export const steps = {
  async "sets the bank that flew anew on another log"() {
    const page = await opened();
    await drop(page, { name: "first.csv", bytes: flight() });
    await page.selectOption("#scheme", "sod");
    await settled(page);
    // No log of such names tells its unit: the page asks once for each sensor.
    assert.equal(await page.isVisible("#as-flown"), false);
    await say(page, "rad/s");
    await page.locator(".axis").nth(3).click();
    await settled(page);
    await say(page, "m/s²");
    await page.locator(".axis").nth(0).click();
    await settled(page);
    await page.click("#as-flown");
    await settled(page);
    const flown = await thresholds(page);
    await drop(page, { name: "euroc.csv", bytes: Buffer.from(euroc()) });
    // Its header is quoted, and says nanoseconds.
    assert.match(await page.textContent("#about"), /200 a second/);
    assert.deepEqual(await thresholds(page), flown);
    assert(flown[3] > 20 * flown[0] && flown[5] > 3 * flown[3], flown.join());
    // What was set by hand is not for the axes of another log.
    await enter(page, "#parameter-threshold", 0.5);
    await settled(page);
    await drop(page, { name: "first.csv", bytes: flight() });
    const reset = await thresholds(page);
    assert(reset.every((own) => own !== 0.5) && new Set(reset).size === 6, reset.join());
    await page.context().close();
  },

  async "says of what flew whether it serves this log"() {
    const page = await opened();
    const units = head.map((name) => (name.startsWith("gyro") ? `${name} (rad/s)` : name.startsWith("accel") ? `${name} (m/s^2)` : name));
    for (const [factor, chip, words] of [[1, /^Flew so in simulation$/, /No simulated flight with just these settings was lost, with [\d.]+ times the error without a code\.$/],
      [100, /^Flew so in simulation, but not this log$/, /; but on this log it does not follow: the error is \d+ times the threshold\.$/], [1e-3, /^Flew so in simulation, but not this log$/, /on this log it sends no spike/]]) {
      await drop(page, { name: "own.csv", bytes: flight((value) => factor * value, units) });
      await page.selectOption("#scheme", "sod");
      await settled(page);
      await page.click("#as-flown");
      await settled(page);
      assert.match(await page.textContent("#chip"), chip);
      assert.match(await page.textContent("#verdict"), words);
    }
    await page.context().close();
  },

  async "fits what a search found on one axis to the others"() {
    const page = await opened();
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await panels(page, "spikes a second");
    await drawer(page, "#show-search");
    await enter(page, "#evaluations", 64);
    await page.click("#tune");
    await page.waitForSelector("#front circle");
    await page.waitForSelector("#tune:enabled");
    await page.locator("#front circle").nth(3).press("Enter");
    await settled(page);
    const span = (place) => { const all = rows.map((row) => Number(row[place + 1])); return Math.max(...all) - Math.min(...all); };
    const found = channels(await text(page, "flight"));
    assert.deepEqual(found.map(({ source }) => source), own);
    for (const [place, { threshold }] of found.entries()) {
      const wanted = found[0].threshold * (place < 3 ? 1 : span(place) / span(0));
      assert(Math.abs(threshold / wanted - 1) < 1e-4, `${own[place]}: ${threshold}, not ${wanted}`);
    }
    assert.match(await page.textContent("#notes"), /^Found on gyro_x; /);
    // A threshold that is set by hand on turn rates is none of accelerations.
    await page.click("#reset");
    await settled(page);
    const before = await thresholds(page);
    await enter(page, "#parameter-threshold", 0.25);
    await settled(page);
    assert.deepEqual(await thresholds(page), [0.25, 0.25, 0.25, ...before.slice(3)]);
    // The ranges of a code that has them are those of each axis.
    await page.selectOption("#scheme", "position");
    await settled(page);
    await drawer(page, "#show-search");
    await page.click("#tune");
    await page.waitForSelector("#front circle");
    await page.waitForSelector("#tune:enabled");
    await page.locator("#front circle").first().press("Enter");
    await settled(page);
    const ranges = channels(await text(page, "flight"));
    assert.equal(new Set(ranges.map(({ min, max }) => `${min} ${max}`)).size, 6, JSON.stringify(ranges));
    await page.context().close();
  },

  async "takes a flight's file whose channels are named with their topic"() {
    const page = await opened();
    await drop(page, { name: "px4.ulg", bytes: px4() });
    await page.selectOption("#scheme", "sod");
    await settled(page);
    const toml = await text(page, "flight"), all = await thresholds(page);
    assert.equal(new Set(all).size > 1 && all.length, 6, all.join());
    await page.selectOption("#scheme", "hsa");
    await settled(page);
    const named = toml.replace(/^name = "(.*)"$/gm, (line, name) => `${line}\nsource = "sensor_combined.${name}"`).replaceAll(/threshold = ([\d.]+)/g, (_, value) => `threshold = ${2 * value}`);
    await drop(page, { name: "flight.toml", bytes: Buffer.from(named) });
    assert.equal(await page.textContent("#file-error"), "");
    const taken = await thresholds(page);
    assert(taken.every((value, place) => Math.abs(value / all[place] - 2) < 0.01), `${all}; ${taken}`);
    await page.context().close();
  },

  async "hides a text that is no more that of the settings"() {
    const page = await opened();
    assert.match(await text(page, "toml"), /threshold = /);
    await enter(page, "#parameter-threshold", 0.125);
    assert.equal(await page.isVisible("#text"), false);
    await settled(page);
    assert.match(await text(page, "toml"), /threshold = 0\.125/);
    await page.click("#undo");
    assert.deepEqual([await page.isVisible("#text"), await page.inputValue("#out")], [false, ""]);
    await settled(page);
    await page.click("#redo");
    assert.match(await page.inputValue("#out"), /threshold = 0\.125/);
    await page.context().close();
  },

  async "takes a rate by hand for all axes, and names an axis that is left out"() {
    const page = await opened();
    const table = (change = (value) => value) => Buffer.from([own, ...rows.map((row) => row.slice(1).map(change))].map((row) => row.join()).join("\n"));
    await drop(page, { name: "untimed.csv", bytes: table() });
    await page.selectOption("#filter", "low-pass");
    await panels(page, "known rate");
    await enter(page, "#rate", 400);
    await settled(page);
    await panels(page, "spikes a second");
    assert.equal(channels(await text(page, "flight")).length, 6);
    assert.equal(await page.textContent("#copied"), "");
    await drop(page, { name: "flat.csv", bytes: table((value, column) => (column === 1 ? 0 : value)) });
    await enter(page, "#rate", 400);
    await settled(page);
    const toml = await text(page, "flight");
    assert.match(toml, /^# gyro_y is flat: left out\n/);
    assert.equal(channels(toml).length, 5);
    assert.equal(await page.textContent("#copied"), "gyro_y is flat: left out");
    await page.context().close();
  },
};
