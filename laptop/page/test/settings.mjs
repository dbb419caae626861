// Settings: their figures against the program, steps back and forth, links and files.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { accessible, choose, compare, DATA, drop, exported, figure, opened, picture, PICTURES, settled, spikewire, text, work } from "./harness.mjs";

export const steps = {
  async "takes steps back and forth, and a flight's file both ways"() {
    const page = await opened();
    const first = await page.innerText("#figures");
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await page.fill("#parameter-threshold", "0.25");
    await settled(page);
    const changed = await page.innerText("#figures");
    await page.click("#undo");
    await settled(page);
    await page.click("#undo");
    await settled(page);
    assert.equal(await page.innerText("#figures"), first);
    assert.equal(await page.isDisabled("#undo"), true);
    await page.keyboard.press("Control+y");
    await settled(page);
    await page.click("#redo");
    await settled(page);
    assert.equal(await page.innerText("#figures"), changed);
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

  async "gives the program's spikes in every scheme and sample type"() {
    const page = await opened();
    const flight = join(DATA, "hexarotor.csv");
    const schemes = await page.locator("#scheme option").evaluateAll((all) => all.map((own) => own.value));
    assert(schemes.length >= 25);
    let spikes = 0;
    for (const scheme of schemes) {
      await page.selectOption("#scheme", scheme);
      await settled(page);
      assert.equal(await page.isVisible("#error"), false, `${scheme}: ${await page.textContent("#error")}`);
      spikes += await compare(page, flight, "--column", "gyro_x");
    }
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
    const figures = await page.innerText("#figures");
    const link = await text(page, "link");
    await accessible(page, "four settings");
    const other = await opened({}, new URL(link).hash);
    assert.equal(await other.innerText("#figures"), figures);
    if (PICTURES) await pictured(other);
    // Pasted into a page that is open: at an example, and with a file of one's own.
    const pasted = async (hash) => {
      await page.evaluate((own) => (location.hash = own), hash);
      await page.waitForTimeout(50);
      await settled(page);
    };
    await page.click("[data-example=paper]");
    await page.waitForFunction(() => /signal\.csv/.test(document.getElementById("about").textContent));
    await settled(page);
    await pasted(new URL(link).hash);
    assert.match(await page.textContent("#about"), /gyro_x, 3,627 samples/);
    assert.equal(await page.innerText("#figures"), figures);
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
  await page.setViewportSize({ width: 1280, height: 900 });
  await page.click("#tab-0");
  await page.fill("#parameter-threshold", "0.35");
  await settled(page);
  await page.evaluate(() => globalThis.spikewire.plots.show(11.6, 12.9));
  await page.mouse.move(0, 0);
  await page.evaluate(() => document.activeElement.blur());
  await page.waitForTimeout(1500);
  await page.screenshot({ path: join(PICTURES, "page.png") });
}

