// What must never be wrong without a word: costs, rates, searches, links, and what flew.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { choose, DATA, drawer, drop, enter, figure, opened, settled, spikewire, text, work } from "./harness.mjs";
import { decoded } from "./made.mjs";

const flight = readFileSync(join(DATA, "hexarotor.csv"), "utf8").trim().split("\n");
const number = async (page, name) => Number((await figure(page, name)).replaceAll(",", ""));

/** A sine of 1.5 Hz at 800 samples a second that arrive in packets of 8, 10 ms apart. */
const bursts = () => `time,gyro_x\n${Array.from({ length: 16_000 }, (_, at) => `${(Math.floor(at / 8) * 0.01 + (at % 8) * 0.00005).toFixed(6)},${Math.sin((2 * Math.PI * 1.5 * at) / 800).toFixed(6)}`).join("\n")}\n`;

/** The built-in flight, with two seconds left out and with units. */
const withGap = () => [flight[0].replace(/(gyro_.)/g, "$1 (rad/s)"), ...flight.slice(1).filter((_, at) => at < 1000 || at > 1400)].join("\n");

export const steps = {
  async "counts keyframes after the last spike, and beside raw frames"() {
    const page = await opened();
    await page.selectOption("#scheme", "sod");
    const bytes = async (threshold, keyframes) => {
      await enter(page, "#parameter-threshold", threshold);
      await enter(page, "#keyframes", keyframes);
      await settled(page);
      return number(page, "Bytes a second, with keyframes");
    };
    const silent = await bytes(20, 1000), often = await bytes(20, 200), rare = await bytes(9.2, 1000);
    assert.equal(await number(page, "Spikes") < 10, true);
    assert(silent > 4 && silent <= rare, `${silent} bytes a second at 20, ${rare} at 9.2`);
    assert(often > 3 * silent, `${often} bytes a second with five times the keyframes of ${silent}`);
    const raw = await number(page, "Bytes a second, raw frames"), { rate } = await page.evaluate(() => globalThis.spikewire.plots.recording);
    assert(Math.abs(raw - 8 * rate) < 0.1, `${raw}`);
    assert.match(await page.textContent("#tiles"), new RegExp(`raw frames: ${Math.round(8 * rate).toLocaleString("en")}`));
    await page.context().close();
  },

  async "says both rates of bursts, and asks before it relies on one"() {
    const page = await opened();
    await drop(page, { name: "bursts.csv", bytes: Buffer.from(bursts()) });
    assert.match(await page.textContent("#about"), / 800 a second through the length, but 20000 by the median step: say the samples a second/);
    assert.deepEqual([await figure(page, "Bytes a second, with keyframes"), await page.isVisible("#rate-field")], ["–", true]);
    assert.match(await page.textContent("#tiles"), /the rate is not sure/);
    await page.click("#flight-file");
    await page.waitForFunction(() => document.getElementById("take-error").textContent);
    assert.match(await page.textContent("#take-error"), /800\.00 Hz by samples through length, 20000\.00 Hz by the median step/);
    await page.selectOption("#filter", "low-pass");
    await settled(page);
    assert.match(await page.textContent("#error"), /by the median step/);
    await page.selectOption("#filter", "none");
    await settled(page);
    await drawer(page, "#show-search");
    await enter(page, "#evaluations", 16);
    await page.click("#advise");
    await page.waitForFunction(() => document.getElementById("search-error").textContent);
    assert.match(await page.textContent("#search-error"), /by the median step/);
    await enter(page, "#rate", 800);
    await settled(page);
    assert.match(await page.textContent("#about"), / 800 a second, /);
    assert.match(await text(page, "flight"), /period = 1250/);
    await page.context().close();
  },

  async "asks for the unit of time and the header line as the program does"() {
    const page = await opened();
    const table = `timestamp,x\n${Array.from({ length: 400 }, (_, at) => `${1000 + 4 * at},${at % 7}`).join("\n")}\n`;
    await drop(page, { name: "ts.csv", bytes: Buffer.from(table) });
    assert.match(await page.textContent("#file-error"), /times of column `timestamp` in µs would be 250000\.00 samples a second; “unit of time” says their unit/);
    await page.selectOption("#time-unit", "ms");
    await settled(page);
    assert.equal(await page.textContent("#file-error"), "");
    assert.match(await page.textContent("#about"), /^ts\.csv: x, 400 samples in 1\.596 s, 250 a second/);
    const above = "a,b\n9,9\nx,y\n1,2\n3,4\n5,1\n";
    await drop(page, { name: "above.csv", bytes: Buffer.from(above) });
    assert.notEqual(await page.textContent("#file-error"), "");
    await enter(page, "#header", 3);
    await settled(page);
    assert.deepEqual([await page.textContent("#file-error"), await page.locator("#field option").allTextContents()], ["", ["x", "y"]]);
    assert.match(await page.textContent("#about"), /^above\.csv: x, 3 samples/);
    // Another file is read by itself again.
    await drop(page, { name: "plain.csv", bytes: Buffer.from("x\n1\n2\n") });
    assert.match(await page.textContent("#about"), /^plain\.csv: x, 2 samples/);
    await page.context().close();
  },

  async "answers which scheme as the program does, for this loop and behind this filter"() {
    const page = await opened(), gap = join(work, "gap.csv"), degrees = join(work, "degrees.csv");
    writeFileSync(gap, withGap());
    writeFileSync(degrees, decoded());
    const answers = new Set();
    for (const [file, column, bandwidth] of [[gap, "gyro_x (rad/s)", "4"], [gap, "gyro_x (rad/s)", "30"], [gap, "gyro_x (rad/s)", ""], [degrees, "gyroADC[0] (deg/s)", "4"], [join(DATA, "vtol_at_rest.csv"), "gyro_x", "4"]]) {
      await choose(page, file);
      await page.selectOption("#filter", "notch");
      await enter(page, "#bandwidth", bandwidth);
      await settled(page);
      await drawer(page, "#show-search");
      await enter(page, "#evaluations", 16);
      await page.click("#advise");
      await page.waitForSelector("#advise:enabled", { timeout: 300_000 });
      await settled(page);
      const given = bandwidth ? ["--loop-bandwidth", bandwidth] : [];
      let theirs;
      try {
        theirs = spikewire("advise", file, "--column", column, "--evaluations", "16", ...given).toString().trim();
      } catch (error) {
        theirs = error.stdout.toString().trim();
      }
      const ours = (await page.textContent("#advice")).trim();
      assert.equal(ours, theirs, `${file} at ${bandwidth} Hz`);
      answers.add(ours);
      // The filter that is set is the one that the search had.
      if (/^.*take \w/m.test(ours)) {
        const isFiltered = /of the filtered signal/.test(ours);
        assert.equal(await page.inputValue("#filter"), isFiltered ? "low-pass" : "none", ours);
      }
    }
    assert.equal(answers.size, 5);
    await page.context().close();
  },

  async "says whose file a link is of, and waits for it"() {
    const page = await opened(), own = `time_us,gyro_x (rad/s)\n${Array.from({ length: 900 }, (_, at) => `${at * 2000},${Math.sin(at / 30).toFixed(4)}`).join("\n")}\n`;
    await drop(page, { name: "mine.csv", bytes: Buffer.from(own) });
    await page.selectOption("#scheme", "tbr");
    await settled(page);
    await enter(page, "#parameter-threshold", 0.0625);
    await settled(page);
    const figures = await page.textContent("#figures"), link = await text(page, "link");
    const other = await opened({}, new URL(link).hash);
    assert.match(await other.textContent("#notice"), /^This link was made from mine\.csv, which it does not hold: .* Until then they are shown on hexarotor\.csv\.$/);
    assert.match(await other.textContent("#about"), /^hexarotor\.csv/);
    await drop(other, { name: "mine.csv", bytes: Buffer.from(own) });
    assert.deepEqual([await other.isVisible("#notice"), await other.textContent("#figures")], [false, figures]);
    // A link of an example needs no file.
    const example = await opened();
    const plain = await opened({}, new URL(await text(example, "link")).hash);
    assert.equal(await plain.isVisible("#notice"), false);
    for (const each of [page, other, example, plain]) await each.context().close();
  },

  async "calls nothing flown that is coarser, or of another code, axis or type"() {
    const page = await opened({}, "");
    // Twice as fast, with units that are told: it opens as it flew.
    const units = flight[0].replace(/(gyro_.)/g, "$1 (rad/s)").replace(/(accel_.)/g, "$1 (m/s^2)");
    await drop(page, { name: "fast.csv", bytes: Buffer.from([units, ...flight.slice(1).map((line, at) => line.replace(/^\d+/, 2000 * at))].join("\n")) });
    const chip = () => page.textContent("#chip");
    assert.equal(await chip(), "Flew so in simulation");
    assert.deepEqual([await page.inputValue("#scheme"), await page.inputValue("#corner"), await page.inputValue("#keyframes")], ["sod", "80", "200"]);
    const flown = Number(await page.inputValue("#parameter-threshold"));
    for (const [factor, words] of [[1.015, /coarser/], [1.0005, /coarser/], [0.99, /threshold 0\.09315[,.]/]]) {
      await enter(page, "#parameter-threshold", flown * factor);
      await settled(page);
      assert.equal(await chip(), "Not as flown", `${factor}`);
      assert.match(await page.textContent("#verdict"), words);
    }
    await page.click("#as-flown");
    await settled(page);
    assert.equal(await chip(), "Flew so in simulation");
    await page.selectOption("#sample", "q16.16");
    await settled(page);
    assert.equal(await chip(), "Not as flown");
    await page.click("#undo");
    await settled(page);
    // Another axis is coarser: the bank is not the one that flew, on whichever axis one looks.
    await page.locator(".axis").nth(2).click();
    await settled(page);
    await enter(page, "#parameter-threshold", 0.2);
    await settled(page);
    await page.locator(".axis").nth(0).click();
    await settled(page);
    assert.equal(await chip(), "Not as flown");
    assert.match(await page.textContent("#verdict"), /threshold 0\.09315 where this is coarser on gyro_z/);
    await page.click("#as-flown");
    await settled(page);
    // A flight's file may say more than the settings that flew.
    const toml = await text(page, "flight");
    for (const [more, words] of [["gathering = 1000", /events sent at once/], ["step_bits = 2", /no step bits/]]) {
      await drop(page, { name: "more.toml", bytes: Buffer.from(toml.replace("clock_ppm", `${more}\nclock_ppm`)) });
      assert.deepEqual([await chip(), words.test(await page.textContent("#verdict"))], ["Not as flown", true], more);
    }
    await drop(page, { name: "start.toml", bytes: Buffer.from(toml.replaceAll(", threshold =", ", start = 0.0, threshold =")) });
    assert.deepEqual([await chip(), /no start on gyro_x/.test(await page.textContent("#verdict"))], ["Not as flown", true]);
    await drop(page, { name: "same.toml", bytes: Buffer.from(toml) });
    assert.equal(await chip(), "Flew so in simulation");
    // While another code is under way, the verdict and the figures of the one before are gone.
    const during = await page.evaluate(() => {
      const scheme = document.getElementById("scheme"), seen = [];
      for (const name of ["sf", "sod"]) {
        scheme.value = name;
        scheme.dispatchEvent(new Event("change", { bubbles: true }));
        seen.push(document.getElementById("chip").textContent, document.querySelector("#figures td").textContent);
      }
      return seen;
    });
    assert.deepEqual(during, ["…", "…", "…", "…"]);
    await settled(page);
    assert.equal(await chip(), "Not as flown");
    await page.context().close();
  },
};
