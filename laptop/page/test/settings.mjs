// Settings: their figures against the program, steps back and forth, links and files.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { accessible, choose, compare, DATA, drop, engine, enter, exported, figure, opened, picture, PICTURES, say, settled, spikewire, text, work } from "./harness.mjs";
import { decoded } from "./made.mjs";

export const steps = {
  async "takes steps back and forth, and a flight's file both ways"() {
    const page = await opened();
    const first = await page.textContent("#figures");
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await page.fill("#parameter-threshold", "0.25");
    await settled(page);
    const changed = await page.textContent("#figures");
    await page.click("#undo");
    await settled(page);
    await page.click("#undo");
    await settled(page);
    assert.equal(await page.textContent("#figures"), first);
    assert.equal(await page.isDisabled("#undo"), true);
    await page.keyboard.press("Control+y");
    await settled(page);
    await page.click("#redo");
    await settled(page);
    assert.equal(await page.textContent("#figures"), changed);
    assert.equal(await page.isDisabled("#redo"), true);
    await page.waitForFunction(() => [...document.querySelectorAll(".axis span")].every((words) => /spikes a second/.test(words.textContent)));
    const toml = await text(page, "flight");
    assert.equal(toml.match(/\[\[channel\]\]/g).length, 6, toml);
    assert.match(toml, /scheme = "sod"/);
    // The program takes it, and codes the six as the page does.
    const file = join(work, "flight.toml");
    writeFileSync(file, toml);
    const lines = spikewire("encode", "--flight", file, join(DATA, "hexarotor.csv")).toString().split("\n").filter((line) => /^\d/.test(line));
    assert.equal(String(lines.filter((line) => line.split(",")[1] === "0").length), (await figure(page, "Spikes")).replaceAll(",", ""));
    // And the page takes one.
    await page.selectOption("#scheme", "hsa");
    await settled(page);
    writeFileSync(file, toml.replaceAll("0.25", "0.5"));
    await choose(page, file);
    assert.equal(await page.textContent("#file-error"), "");
    assert.equal(await page.inputValue("#scheme"), "sod");
    assert.equal(await page.inputValue("#parameter-threshold"), "0.5");
    await drop(page, { name: "flight.toml", bytes: Buffer.from("version = 1\nscheme = 5\n") });
    assert.match(await page.textContent("#file-error"), /flight\.toml: /);
    await page.context().close();
  },

  async "writes a flight's file with all that the one it was opened with says"() {
    const page = await opened();
    const names = ["roll", "pitch", "yaw"], fields = ["gyro_x", "gyro_y", "gyro_z"];
    const channel = (name, place) => `\n[[channel]]\nname = "${name}"\nsource = "${fields[place]}"\nunit = "rad/s"\nparameters = { spikes = 4, start = 0, threshold = 0.${place + 1} }\n`;
    const given = `version = 1\nscheme = "sod"\nsample = "f32"\nperiod = 5038 # µs\nkeyframe_every = 37 # samples\nclock_ppm = 15000\nstep_bits = 4\ngathering = 2500 # µs\nfull_every = 250000 # µs\n${names.map(channel).join("")}`;
    const drops = async (toml) => {
      await drop(page, { name: "flight.toml", bytes: Buffer.from(toml) });
      await page.waitForFunction(() => document.querySelectorAll(".axis span").length === 6 && [...document.querySelectorAll(".axis span")].every((words) => /spikes a second/.test(words.textContent)));
    };
    /** A file without the axes that the first one did not have. */
    const withoutForces = (toml) => `${toml.replace(/\[\[channel\]\]\nname = "accel[^[]*/g, "").trimEnd()}\n`;
    const written = async () => withoutForces(await text(page, "flight"));
    await drops(given);
    assert.equal(await written(), given);
    assert.match(await page.textContent("#notes"), /step_bits 4, gathering 2500 µs, full_every 250000 µs, clock_ppm 15000/);
    assert.equal(await page.inputValue("#parameter-start"), "0");
    // The program reads the same flight from both: a receiver of the one takes frames of the other.
    const [before, after] = ["before.toml", "after.toml"].map((name) => join(work, name));
    writeFileSync(before, given);
    writeFileSync(after, await written());
    const encoded = (file) => spikewire("encode", "--flight", file, join(DATA, "hexarotor.csv")).toString();
    assert.equal(encoded(after).replaceAll(after, before), encoded(before));
    // A link brings all of it, other settings leave it, and a code without steps has no numbers of them.
    const link = await text(page, "link"), other = await opened({}, new URL(link).hash);
    await other.waitForFunction(() => document.querySelectorAll(".axis span").length === 6 && [...document.querySelectorAll(".axis span")].every((words) => /spikes a second/.test(words.textContent)));
    assert.equal(withoutForces(await text(other, "flight")), given);
    await other.context().close();
    await page.selectOption("#scheme", "grf");
    await settled(page);
    const grf = await text(page, "flight");
    assert.match(grf, /clock_ppm = 15000\ngathering = 2500 # µs\nfull_every = 250000 # µs\n[^]*name = "roll"\nsource = "gyro_x"/);
    assert.doesNotMatch(grf, /step_bits/);
    // Samples in counts are not what the page codes.
    await drop(page, { name: "counts.toml", bytes: Buffer.from(given.replace('unit = "rad/s"', 'unit = "rad/s"\ncounts = 1000.0')) });
    assert.match(await page.textContent("#file-error"), /^counts\.toml: roll has 1000 counts in a unit/);
    await page.context().close();
  },

  async "sets the bank that flew, says so, and filters as the program does"() {
    const page = await opened();
    // The loops that flew have 250 samples a second at least.
    const [head, ...lines] = readFileSync(join(DATA, "hexarotor.csv"), "utf8").trim().split("\n"), flight = join(work, "fast.csv");
    writeFileSync(flight, [head, ...lines.map((line, sample) => line.replace(/^\d+/, 2000 * sample)), ""].join("\n"));
    await choose(page, flight);
    const chip = () => page.textContent("#chip");
    await say(page, "rad/s");
    await page.locator(".axis").nth(3).click();
    await settled(page);
    await say(page, "m/s²");
    await page.locator(".axis").nth(0).click();
    await settled(page);
    await page.selectOption("#scheme", "bernoulli");
    await settled(page);
    assert.equal(await chip(), "Not flown");
    assert.equal(await page.isVisible("#as-flown"), false);
    await page.selectOption("#scheme", "sf");
    await settled(page);
    assert.equal(await chip(), "Does not fly");
    await page.selectOption("#scheme", "sod");
    await settled(page);
    assert.equal(await chip(), "Not as flown");
    assert.match(await page.textContent("#verdict"), /threshold 0\.09315 where this is coarser, .*a low-pass of 80 Hz, keyframes every 200 ms/);
    const bytes = Number((await figure(page, "Bytes a second, with keyframes")).replaceAll(",", ""));
    await page.click("#as-flown");
    await settled(page);
    assert.equal(await chip(), "Flew so in simulation");
    assert.deepEqual([await page.inputValue("#filter"), await page.inputValue("#corner"), await page.inputValue("#keyframes")], ["low-pass", "80", "200"]);
    const late = Number(await figure(page, "Late by, ms"));
    assert(late > 0, `${late} ms`);
    await enter(page, "#keyframes", 20);
    await settled(page);
    const more = Number((await figure(page, "Bytes a second, with keyframes")).replaceAll(",", ""));
    assert.equal(await chip(), "Not as flown");
    await enter(page, "#keyframes", 200);
    await settled(page);
    const own = Number((await figure(page, "Bytes a second, with keyframes")).replaceAll(",", ""));
    assert(more > own + 400 && own > bytes, `${bytes}, ${own}, ${more} bytes`);
    // The program behind the same filter: the spikes in the picture, in its table and in the page's.
    const toml = await text(page, "flight"), file = join(work, "flown.toml");
    assert.match(toml, /filter = \{ corner = 80\.0, kind = "low-pass" \}/);
    assert.equal((toml.match(/threshold = 0\.0931/g) ?? []).length, 3, toml);
    assert.equal((toml.match(/threshold = 2\.56/g) ?? []).length, 2, toml);
    assert.match(toml, /threshold = 8\.45/);
    writeFileSync(file, toml);
    const rows = (bytes, address) => bytes.toString().split("\n").filter((line) => /^\d/.test(line) && (address === undefined || line.split(",")[1] === address));
    const theirs = spikewire("encode", "--flight", file, flight);
    assert.deepEqual(rows(await exported(page, "csv"), "0"), rows(theirs, "0"));
    assert.equal(String(rows(theirs, "0").length), (await figure(page, "Spikes")).replaceAll(",", ""));
    await page.locator(".axis").nth(5).click();
    await settled(page);
    assert.equal(Number(await page.inputValue("#parameter-threshold")).toPrecision(3), "8.46");
    assert.equal(await chip(), "Flew so in simulation");
    assert.equal(String(rows(theirs, "5").length), (await figure(page, "Spikes")).replaceAll(",", ""));
    // All of it is in a link, and in the file.
    const figures = await page.textContent("#figures"), link = await text(page, "link");
    const other = await opened();
    await choose(other, flight);
    await other.evaluate((hash) => (location.hash = hash), new URL(link).hash);
    await settled(other);
    // The settings of the link stand as they are, and the unit is asked for here too.
    const numbers = (words) => words.replace("RMSE, m/s²", "RMSE");
    assert.equal(await other.textContent("#figures"), numbers(figures));
    await say(other, "m/s²");
    assert.equal(await other.textContent("#figures"), figures);
    await other.selectOption("#scheme", "hsa");
    await other.selectOption("#filter", "none");
    await settled(other);
    await choose(other, file);
    assert.equal(await other.textContent("#figures"), figures);
    // In a log of degrees the thresholds are degrees.
    await drop(other, { name: "decoded.csv", bytes: decoded() });
    await other.selectOption("#scheme", "sod");
    await settled(other);
    await other.click("#as-flown");
    await settled(other);
    assert.equal(await other.inputValue("#parameter-threshold"), "5.33684");
    await other.context().close();
    await page.context().close();
  },

  async "gives the program's spikes in every scheme and sample type"() {
    const page = await opened();
    const flight = join(DATA, "hexarotor.csv");
    const schemes = await page.locator("#scheme option").evaluateAll((all) => all.map((own) => own.value));
    assert(schemes.length >= 25);
    let spikes = 0, several = 0;
    for (const scheme of schemes) {
      await page.selectOption("#scheme", scheme);
      await settled(page);
      assert.equal(await page.isVisible("#error"), false, `${scheme}: ${await page.textContent("#error")}`);
      spikes += await compare(page, flight, "--column", "gyro_x");
      several += / spikes a sample$/.test(await figure(page, "Samples without a spike, %"));
      assert.doesNotMatch(await figure(page, "Samples without a spike, %"), /-/, scheme);
    }
    assert(several > 0, "no scheme with several spikes a sample");
    for (const sample of ["q8.8", "q16.16", "q1.15"]) {
      await page.selectOption("#scheme", "sf");
      await page.selectOption("#sample", sample);
      await settled(page);
      spikes += await compare(page, flight, "--column", "gyro_x");
    }
    console.log(`  ${schemes.length} schemes, ${spikes} spikes`);
    await page.context().close();
  },

  async "moves the picture with the slider and the field, and takes nonsense in words"() {
    const page = await opened();
    const shown = () => page.evaluate(() => globalThis.spikewire.plots.canvas().toDataURL());
    const [before, spikes] = [await shown(), await figure(page, "Spikes")];
    await page.getByLabel("threshold, slider").focus();
    for (let step = 0; step < 40; step++) await page.keyboard.press("ArrowLeft");
    await settled(page);
    assert.notEqual(await figure(page, "Spikes"), spikes);
    assert.notEqual(await shown(), before);
    await page.fill("#parameter-threshold", "0.1");
    await settled(page);
    assert.equal(await text(page, "toml"), 'scheme = "sf"\nsample = "f32"\nthreshold = 0.1\n');
    assert.match(await text(page, "rust"), /^pub static GYRO_X: .*StepForward<f32> = .*0\.1\d*\);\n$/);
    assert.equal(await text(page, "python"), 'import spikewire as sw\n\nscheme = sw.StepForward(threshold=0.1, sample="f32")\n');
    for (const [given, words] of [["abc", /is not a number/], ["-1", /threshold/]]) {
      await page.fill("#parameter-threshold", given);
      await settled(page);
      assert.match(await page.textContent("#error"), words);
      assert.equal(await page.getAttribute("#parameter-threshold", "aria-invalid"), "true");
    }
    await page.click("#reset");
    await settled(page);
    assert.equal(await figure(page, "Spikes"), spikes);
    await page.focus("#plots");
    await page.keyboard.press("+");
    assert.match(await page.textContent("#in-view"), /^samples 894 to 2718, 4.6044 s to 13.803 s$/);
    assert.match((await exported(page, "svg")).toString(), /^<svg [^]*<\/svg>\n$/);
    assert.equal((await exported(page, "png")).subarray(1, 4).toString(), "PNG");
    await page.context().close();
  },

  async "compares settings, and keeps them in a link"() {
    const page = await opened();
    await page.click("#add");
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await page.fill("#parameter-threshold", "0.25");
    await settled(page);
    await page.click("#add");
    await page.selectOption("#scheme", "grf");
    await settled(page);
    await page.click("#add");
    await page.selectOption("#scheme", "hsa");
    await page.selectOption("#sample", "q8.8");
    await settled(page);
    assert.equal(await page.isVisible("#add"), false);
    // A series is hidden and shown again by its name.
    const shown = () => page.evaluate(() => globalThis.spikewire.plots.data()[0].slice(1).map((own) => own.some((value) => value !== null)));
    await page.locator("#legend button").nth(1).click();
    assert.deepEqual(await shown(), [true, false, true, true, true]);
    await page.locator("#legend button").nth(1).click();
    assert.deepEqual(await shown(), [true, true, true, true, true]);
    const figures = await page.textContent("#figures");
    const link = await text(page, "link");
    await accessible(page, "four settings");
    const other = await opened({}, new URL(link).hash);
    assert.equal(await other.textContent("#figures"), figures);
    if (PICTURES && engine === "chromium") await pictured(other);
    // Pasted into a page that is open: at an example, and with a file of one's own.
    const pasted = async (hash) => {
      await page.evaluate((own) => (location.hash = own), hash);
      await page.waitForTimeout(50);
      await settled(page);
    };
    await page.selectOption("#example", "paper");
    await page.waitForFunction(() => /signal\.csv/.test(document.getElementById("about").textContent));
    await settled(page);
    await pasted(new URL(link).hash);
    assert.match(await page.textContent("#about"), /gyro_x, 3,627 samples/);
    assert.equal(await page.textContent("#figures"), figures);
    await drop(page, { name: "own.csv", bytes: Buffer.from("a,b\n0,0\n1,5\n0,9\n") });
    await pasted("field=b&s=%3Dsf%2Bf32%26threshold%3D3");
    assert.match(await page.textContent("#about"), /^own\.csv: b, 3 samples/);
    assert.equal(await page.inputValue("#parameter-threshold"), "3");
    assert.equal(await figure(page, "Spikes"), "2");
    await page.context().close();
    await other.context().close();
  },
};

/** The picture of the documentation: two of the settings, and their spikes. */
async function pictured(page) {
  for (const setting of [3, 2]) {
    await page.click(`#tab-${setting}`);
    await page.click("#remove");
    await settled(page);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
  await page.evaluate(() => { for (const own of document.querySelectorAll("details")) own.open = false; });
  await page.click("#tab-0");
  await page.fill("#parameter-threshold", "0.35");
  await settled(page);
  await page.evaluate(() => globalThis.spikewire.plots.show(11.6, 12.9));
  await page.mouse.move(0, 0);
  await page.evaluate(() => document.activeElement.blur());
  await page.waitForTimeout(1500);
  await page.screenshot({ path: join(PICTURES, "page.png") });
}

