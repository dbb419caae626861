// Drives the page in a browser, against the laptop program. `cargo verify page` says where both are.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { wanted } from "./js/channels.js";
import { amplitudes } from "./js/spectrum.js";

const { PAGE, LOGS, SPIKEWIRE, BROWSER, DATA, PICTURES } = process.env;
const work = mkdtempSync(join(tmpdir(), "page-"));
const spikewire = (...args) => execFileSync(SPIKEWIRE, args, { stdio: ["ignore", "pipe", "pipe"], maxBuffer: 1 << 28 });
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const url = pathToFileURL(PAGE).href;
const executablePath = execFileSync("which", [BROWSER]).toString().trim();
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream"] });
const said = [];

async function opened(options = {}, hash = "", before = undefined) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  if (before) await page.addInitScript(before);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && said.push(message.text()));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("request", (request) => {
    const own = request.url();
    if (!own.startsWith(url) && !/^(blob|data):/.test(own)) said.push(`a request off the page: ${own}`);
  });
  await page.goto(url + hash);
  await settled(page);
  return page;
}

/** Waits until the page has computed what was asked. */
async function settled(page) {
  await page.waitForFunction(() => document.body.dataset.busy === "no", null, { timeout: 120_000 });
}

async function choose(page, files) {
  await page.setInputFiles("#choose", files);
  await page.waitForTimeout(50);
  await settled(page);
}

async function exported(page, kind) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(`[data-save=${kind}]`)]);
  return readFileSync(await download.path());
}

async function text(page, kind) {
  await page.evaluate(() => (document.getElementById("out").value = ""));
  await page.click(`[data-text=${kind}]`);
  await page.waitForFunction(() => document.getElementById("out").value !== "");
  return page.inputValue("#out");
}

const figure = async (page, name) => (await page.locator("#figures tr", { has: page.getByRole("rowheader", { name, exact: true }) }).locator("td").allTextContents()).join(" ");

/** The spikes that are drawn, as lines of the program's table. */
const drawn = (page) => page.evaluate(() => {
  const { arrays: { sample, neuron, slot, up }, slots } = globalThis.spikewire.plots.runs[0];
  const lines = [];
  for (let at = 0; at < sample.length; at++) lines.push([sample[at] * slots + slot[at], neuron[at], up[at] ? 1 : -1].join());
  return lines.sort();
});

/** The spikes in the picture, in the exported table and out of the program are the same. */
async function compare(page, input, ...channel) {
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

/** No finding of weight. */
async function accessible(page, what) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  const grave = violations.filter((own) => ["serious", "critical"].includes(own.impact));
  assert.deepEqual(grave.map((own) => [own.id, own.nodes.map((node) => node.html)]), [], what);
}

const steps = {
  async "is ready soon, with a flight and nothing asked of the network"() {
    const page = await opened();
    const ready = await page.evaluate(() => Number(document.body.dataset.ready));
    console.log(`  ready after ${ready} ms; ${statSync(PAGE).size} bytes`);
    assert.match(await page.textContent("#about"), /gyro_x, 3,627 samples/);
    await page.context().close();
  },

  async "opens a log on the turn rates, by the names that each kind of log has"() {
    const three = (name) => [0, 1, 2].map((axis) => `${name}[${axis}]`);
    const xyz = (name) => ["x", "y", "z"].map((axis) => `${name}${axis}`);
    for (const [topics, topic, fields] of [
      [[{ name: "actuator_outputs", count: 9, fields: three("output") },
        { name: "sensor_combined", count: 30, fields: [...three("gyro_rad"), "gyro_integral_dt", ...three("accelerometer_m_s2"), "accelerometer_clipping"] },
        { name: "sensor_gyro", count: 90, fields: ["timestamp_sample", "device_id", ...xyz(""), "temperature"] }], "sensor_combined", [...three("gyro_rad"), ...three("accelerometer_m_s2")]],
      [[{ name: "sensor_accel", count: 90, fields: xyz("") }, { name: "sensor_gyro", count: 90, fields: ["device_id", ...xyz("")] },
        { name: "vehicle_rates_setpoint", count: 90, fields: ["roll", "pitch", "yaw"] }], "sensor_gyro", xyz("")],
      [[{ name: "/clock", count: 9, fields: ["clock"] }, { name: "/imu", count: 90, fields: ["header.seq", ...xyz("orientation."), ...xyz("angular_velocity."), ...xyz("linear_acceleration.")] }],
        "/imu", [...xyz("angular_velocity."), ...xyz("linear_acceleration.")]],
      [[{ name: "", fields: ["loopIteration", "time", ...three("axisP"), ...three("gyroADC"), ...three("gyroUnfilt"), ...three("accSmooth")] }], "", [...three("gyroADC"), ...three("accSmooth")]],
      [[{ name: "ATT", count: 9, fields: ["DesRoll", "Roll"] }, { name: "IMU", count: 90, fields: ["TimeUS", ...["X", "Y", "Z"].map((axis) => `Gyr${axis}`), ...["X", "Y", "Z"].map((axis) => `Acc${axis}`), "T"] }],
        "IMU", ["GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"]],
      [[{ name: "", fields: ["#timestamp [ns]", ...["x", "y", "z"].map((axis) => `w_RS_S_${axis} [rad s^-1]`), ...["x", "y", "z"].map((axis) => `a_RS_S_${axis} [m s^-2]`)] }],
        "", [...["x", "y", "z"].map((axis) => `w_RS_S_${axis} [rad s^-1]`), ...["x", "y", "z"].map((axis) => `a_RS_S_${axis} [m s^-2]`)]],
      [[{ name: "", fields: ["timestamp", "alpha"] }], "", ["alpha"]],
    ]) assert.deepEqual(wanted(topics), { topic, fields }, JSON.stringify(topics));
  },

  async "shows all of it in one window, six axes, and values under the pointer"() {
    for (const viewport of [{ width: 1440, height: 900 }, { width: 1024, height: 768 }]) {
      const page = await opened({ viewport });
      await page.waitForFunction(() => document.querySelectorAll(".axis span").length === 6 && [...document.querySelectorAll(".axis span")].every((words) => /spikes a second/.test(words.textContent)));
      for (const id of ["parameter-threshold", "figures", "plots", "under"]) {
        const { y, height } = await page.locator(`#${id}`).boundingBox();
        assert(y >= 0 && y + height <= viewport.height, `${id} from ${y} to ${y + height} in a window of ${viewport.width} x ${viewport.height}`);
      }
      if (PICTURES) await page.screenshot({ path: join(PICTURES, `page-${viewport.width}.png`) });
      await page.context().close();
    }
    const page = await opened({ viewport: { width: 1440, height: 900 } });
    const flight = join(DATA, "hexarotor.csv");
    const plot = await page.locator("#plots .u-over").first().boundingBox();
    await page.mouse.move(plot.x + plot.width / 2, plot.y + 20);
    await page.mouse.down();
    await page.mouse.up();
    await page.mouse.move(plot.x + plot.width / 2 + 100, plot.y + 20);
    const { sample, value, decoded } = await page.evaluate(() => {
      const { pointed, recording, runs } = globalThis.spikewire.plots;
      return { sample: pointed, value: recording.arrays.values[pointed], decoded: runs[0].arrays.decoded[pointed] };
    });
    const written = Number(readFileSync(flight, "utf8").trim().split("\n").slice(1)[sample].split(",")[1]);
    assert.equal(value, written);
    const short = (number) => String(Number(number.toPrecision(4)));
    const under = await page.textContent("#under");
    assert(under.includes(`gyro_x ${short(value)}`) && under.includes(` ${short(decoded)}`) && /from the mark [\d.]+ s/.test(under), under);
    // Another axis is opened from its strip.
    await page.locator(".axis").nth(4).click();
    await page.waitForTimeout(50);
    await settled(page);
    assert.match(await page.textContent("#about"), /accel_y, 3,627 samples/);
    assert.equal(await page.locator(".axis").nth(4).getAttribute("aria-pressed"), "true");
    const count = Number((await figure(page, "Spikes a second")).replaceAll(",", ""));
    await page.waitForFunction((own) => document.querySelectorAll(".axis span")[4].textContent.includes(`: ${own.toLocaleString("en")} spikes a second`), count);
    // Power at a frequency where there is some, and an error whose shares are a whole.
    await page.click("#spectrum-box summary");
    await page.waitForSelector("#spectrum canvas");
    assert.equal(await page.locator("#spectrum canvas").count(), 2);
    await accessible(page, "six axes and a spectrum");
    await page.context().close();
    const sine = Float64Array.from({ length: 4096 }, (_, sample) => 3 * Math.sin((2 * Math.PI * sample) / 16));
    const heights = amplitudes(sine, 0, sine.length);
    const peak = heights.indexOf(Math.max(...heights));
    assert.equal((peak + 1) / (2 * (heights.length + 1)), 1 / 16);
    assert(Math.abs(heights[peak] - 3) < 0.02, `a sine of 3 has the height ${heights[peak]}`);
  },

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
    await choose(page, { name: "flight.toml", mimeType: "application/toml", buffer: Buffer.from("version = 1\nscheme = 5\n") });
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

  async "reads every kind of log as the program does"() {
    const page = await opened();
    const log = (name) => join(LOGS, name);
    writeFileSync(log("log.ulg"), ulog());
    for (const [name, topic, field] of [
      ["log.bag", "/imu", "rate"], ["log.mcap", "/imu", "rate"], ["log.db3", "/imu", "rate"],
      ["log.bbl", null, "gyroADC[0]"], ["log.ulg", "gyro", "rate"],
    ]) {
      await choose(page, log(name));
      assert.equal(await page.textContent("#file-error"), "", name);
      const found = await page.locator("#topic").inputValue();
      // It opens on a turn rate, and not on a counter or a time.
      assert.equal(await page.inputValue("#field"), field, name);
      await page.selectOption("#field", field);
      await page.waitForTimeout(50);
      await settled(page);
      const own = topic === null ? [] : ["--topic", topic];
      if (topic !== null) assert.equal(found, topic);
      await compare(page, log(name), ...(own.length ? own : ["--topic", found]), "--field", field);
    }
    // Dropped, not chosen; and with another name of the column.
    const bytes = [...readFileSync(join(DATA, "vtol_at_rest.csv"))];
    await page.evaluate((all) => {
      const data = new DataTransfer();
      data.items.add(new File([new Uint8Array(all)], "rest.csv"));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
    }, bytes);
    await page.waitForFunction(() => /rest\.csv/.test(document.getElementById("about").textContent));
    await settled(page);
    await compare(page, join(DATA, "vtol_at_rest.csv"), "--column", "gyro_x");
    // As spreadsheets write text: two bytes a letter.
    const wide = Buffer.from(`\ufeff${readFileSync(join(DATA, "vtol_at_rest.csv"), "utf8")}`, "utf16le");
    for (const [name, own] of [["little.csv", wide], ["big.csv", Buffer.from(wide).swap16()]]) {
      writeFileSync(log(name), own);
      await choose(page, log(name));
      assert.equal(await page.textContent("#file-error"), "", name);
      await page.selectOption("#field", "gyro_x");
      await settled(page);
      await compare(page, log(name), "--column", "gyro_x");
    }
    const events = join(work, "events.es");
    writeFileSync(join(work, "own.csv"), await exported(page, "csv"));
    spikewire("convert", "--from", "csv", "--to", "es", join(work, "own.csv"), "-o", events);
    assert((await exported(page, "es")).equals(readFileSync(events)));
    await page.context().close();
  },

  async "says what is wrong with a file, and goes on"() {
    const page = await opened();
    const whole = readFileSync(join(LOGS, "log.mcap"));
    for (const [name, buffer, words] of [
      ["empty.csv", Buffer.from(""), /empty/],
      ["numbers.csv", Buffer.from("1,2\n3,4\n"), /header/],
      ["words.csv", Buffer.from("a,b\nx,y\nz,w\n"), /words\.csv/],
      ["noise.bin", Buffer.from(Array.from({ length: 4096 }, (_, at) => (at * 7919) % 251)), /noise\.bin/],
      ["table.parquet", Buffer.from("PAR1xxxxxxxxxxxxxxxxxxxx"), /Parquet/],
      ["cut.mcap", whole.subarray(0, whole.length / 2), /damaged log/],
      ["cut.ulg", ulog().subarray(0, 900), /damaged log/],
    ]) {
      await choose(page, { name, mimeType: "application/octet-stream", buffer });
      assert.match(await page.textContent("#file-error"), words, name);
      assert(await page.isVisible("#file-error"));
      // Nothing of the recording before stands under the name of this one; a table of words shows its own channels, to choose another.
      const isTable = name === "words.csv";
      if (isTable) assert.deepEqual(await page.locator("#field option").allTextContents(), ["a", "b"]);
      for (const id of ["about", ...(isTable ? [] : ["channel"]), "file-notes", "settings", "picture", "take", "search"]) assert.equal(await page.isVisible(`#${id}`) && await page.innerText(`#${id}`) !== "", false, `${name}: ${id}`);
    }
    await page.check("#accept-cut");
    await page.waitForFunction(() => /cut\.ulg/.test(document.getElementById("about").textContent));
    await settled(page);
    assert.equal(await page.textContent("#file-error"), "");
    await page.click("[data-example=paper]");
    await page.waitForFunction(() => /signal\.csv/.test(document.getElementById("about").textContent));
    await settled(page);
    const paper = join(work, "paper.csv");
    spikewire("signal", "--seconds", "15", "-o", paper);
    await compare(page, paper, "--column", "signal");
    // A channel that is no signal, and back; a name with a comma is one name.
    const halves = join(work, "halves.csv");
    writeFileSync(halves, '"rate, raw",word\n0,a\n1,b\n0,c\n');
    await choose(page, halves);
    assert.deepEqual(await page.locator("#field option").allTextContents(), ["rate, raw", "word"]);
    assert.match(await page.textContent("#about"), /^halves\.csv: rate, raw, 3 samples/);
    await compare(page, halves, "--column", "rate, raw");
    await page.selectOption("#field", "word");
    await page.waitForTimeout(50);
    await settled(page);
    assert.match(await page.textContent("#file-error"), /`a` is not a number/);
    assert.equal(await page.isVisible("#picture"), false);
    await page.selectOption("#field", "rate, raw");
    await page.waitForTimeout(50);
    await settled(page);
    assert.equal(await page.isVisible("#picture"), true);
    assert.equal(await page.textContent("#file-error"), "");
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
    await choose(page, { name: "own.csv", mimeType: "text/csv", buffer: Buffer.from("a,b\n0,0\n1,5\n0,9\n") });
    await pasted("field=b&s=%3Dsf%2Bf32%26threshold%3D3");
    assert.match(await page.textContent("#about"), /^own\.csv: b, 3 samples/);
    assert.equal(await page.inputValue("#parameter-threshold"), "3");
    assert.equal(await figure(page, "Spikes"), "2");
    await page.context().close();
    await other.context().close();
  },

  async "searches in another thread, and stops"() {
    const page = await opened();
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await page.fill("#evaluations", "128");
    await page.click("#tune");
    await page.waitForSelector("#front circle");
    await page.waitForSelector("#tune:enabled");
    const dot = page.locator("#front circle").nth(4);
    const [, efficiency, rmse] = /: ([\d.]+) % without a spike, RMSE ([\d.]+)/.exec(await dot.getAttribute("aria-label"));
    await dot.press("Enter");
    await settled(page);
    assert.equal(Number(await figure(page, "Samples without a spike, %")).toFixed(1), efficiency);
    assert.equal(Number(Number(await figure(page, "RMSE")).toPrecision(3)), Number(rmse));
    await accessible(page, "a front");
    await page.fill("#evaluations", "20000");
    await page.click("#tune-all");
    await page.waitForFunction(() => document.getElementById("bar").value > 0);
    await page.getByLabel("threshold, slider").press("ArrowLeft"); // the page answers meanwhile
    await settled(page);
    await page.click("#stop");
    await page.waitForSelector("#tune:enabled");
    assert.match(await page.textContent("#front-words"), /^Stopped/);
    await page.fill("#evaluations", "16");
    await page.click("#advise");
    await page.waitForSelector("#advice:visible", { timeout: 300_000 });
    assert.match(await page.textContent("#advice"), /take \w+ in f32/);
    await page.context().close();
  },

  async "shows a clip and a camera as events, those of the program"() {
    const page = await opened();
    const [width, height] = [16, 12];
    const frames = [0, 1, 2, 3].map((frame) => Array.from({ length: width * height }, (_, at) => (at * 7 + frame * ((at * 5) % 23)) % 256));
    frames.forEach((own, at) => writeFileSync(join(work, `frame-${at}.pgm`), Buffer.concat([Buffer.from(`P5 ${width} ${height} 255\n`), Buffer.from(own)])));
    const events = join(work, "events.csv");
    spikewire("frames", ...frames.map((_, at) => join(work, `frame-${at}.pgm`)), "--threshold", "10", "-o", events);
    const theirs = readFileSync(events, "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
    const ticks = [...new Set(theirs.map(([tick]) => tick))];
    const ours = await page.evaluate(async ([frames, width, height]) => {
      const all = [];
      for (const [at, grey] of frames.entries()) {
        const { arrays: { pixels } } = await globalThis.spikewire.video.encode(width, height, new Uint8Array(grey), at === 0);
        pixels.forEach((own, place) => own && all.push([at, place % width, Math.floor(place / width), own === 2 ? 1 : -1]));
      }
      return all;
    }, [frames, width, height]);
    assert(ours.length > 100);
    assert.deepEqual(ours, theirs.map(([tick, ...rest]) => [ticks.indexOf(tick) + 1, ...rest]));
    const live = () => page.waitForFunction(() => /[1-9][\d,]* events in this frame/.test(document.getElementById("video-figures").textContent));
    const cleared = () => page.evaluate(() => (document.getElementById("video-figures").textContent = ""));
    await page.click("#camera");
    await live();
    await accessible(page, "a camera");
    await page.click("#end");
    await cleared();
    await page.evaluate(async () => {
      const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 48 }), context = canvas.getContext("2d");
      const parts = [], recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: "video/webm" });
      recorder.ondataavailable = ({ data }) => parts.push(data);
      recorder.start();
      for (let at = 0; at < 30; at++) {
        context.fillStyle = "black";
        context.fillRect(0, 0, 64, 48);
        context.fillStyle = "white";
        context.fillRect(at, 10, 20, 20);
        await new Promise((done) => setTimeout(done, 33));
      }
      recorder.stop();
      await new Promise((done) => (recorder.onstop = done));
      const data = new DataTransfer();
      data.items.add(new File(parts, "clip.webm", { type: "video/webm" }));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
    });
    await live();
    await page.click("#end");
    await page.setInputFiles("#clip", { name: "no.webm", mimeType: "video/webm", buffer: Buffer.from("no video") });
    await page.waitForSelector("#video-error:visible");
    assert.match(await page.textContent("#video-error"), /no\.webm: this browser cannot decode/);
    await page.context().close();
  },

  async "listens to a board as the program does, or says why not"() {
    const without = await opened();
    await without.evaluate(() => Object.defineProperty(navigator, "serial", { value: undefined }));
    await without.click("#connect");
    assert.match(await without.textContent("#board-error"), /reads no serial port/);
    await without.context().close();

    const page = await opened({}, "", fakeSerial);
    const bytes = link();
    const captured = join(work, "captured.link"), toml = join(work, "sender.toml");
    writeFileSync(captured, bytes);
    const heard = async (kind) => {
      const [download] = await Promise.all([page.waitForEvent("download"), page.click(`[data-heard=${kind}]`)]);
      return readFileSync(await download.path(), "utf8");
    };
    const listened = async (speaks) => {
      await page.evaluate((own) => (globalThis.speaks = own), [...speaks]);
      await page.click("#connect");
      await page.waitForSelector("#board-files:visible, #board-error:visible");
      assert.equal(await page.textContent("#board-error"), "");
    };
    let values = 0;
    for (const [scheme, settings, more] of [
      ["sf", { threshold: "0.35" }, []],
      ["sf", { threshold: "0.35" }, ["--thresholds", "0.35,0.2"]],
      ["grf", { neurons: "4", min: "-2", max: "2" }, []],
    ]) {
      await page.selectOption("#scheme", scheme);
      await settled(page);
      for (const [name, value] of Object.entries(settings)) await page.fill(`#parameter-${name}`, value);
      await settled(page);
      await page.fill("#thresholds", more[1] ?? "");
      await listened(bytes);
      writeFileSync(toml, await text(page, "toml"));
      const theirs = spikewire("listen", captured, "--params", toml, ...more).toString();
      assert.equal(await heard("values"), theirs, scheme);
      assert.equal(await heard("spikes"), spikewire("convert", "--from", "link", "--to", "csv", captured).toString());
      assert.match(theirs, /,exact\n[^]*,estimate\n|,estimate\n[^]*,exact\n/, scheme);
      assert.match(await page.textContent("#board-words"), /1 lost in 1 gaps/);
      assert.equal(await page.evaluate(() => globalThis.asked.baudRate), 921600);
      values += theirs.split("\n").length - 2;
    }
    console.log(`  ${values} values of ${bytes.length} bytes in three ways`);
    await accessible(page, "a board");
    await page.selectOption("#scheme", "grf-slots");
    await settled(page);
    await page.click("#connect");
    await page.waitForFunction(() => /grf-slots needs the length of/.test(document.getElementById("board-error").textContent));
    // Amid the stream: what came is shown, and the port is closed when the user stops.
    await page.selectOption("#meaning", "spikes");
    await page.evaluate(() => (globalThis.stays = true));
    await page.click("#connect");
    await page.waitForFunction((length) => document.getElementById("board-figures").textContent.startsWith(`${length.toLocaleString("en")} bytes`), bytes.length);
    await page.click("#hang-up");
    await page.waitForSelector("#board-files:visible");
    assert.equal(await page.evaluate(() => globalThis.isClosed), true);
    await page.evaluate(() => ([globalThis.stays, globalThis.speaks] = [false, Array(500).fill(65)]));
    await page.click("#connect");
    await page.waitForSelector("#board-error:visible");
    assert.match(await page.textContent("#board-error"), /the board: no link frame in the 500 bytes/);
    await page.evaluate(() => (globalThis.speaks = undefined));
    await page.click("#connect");
    await page.waitForFunction(() => /no port was chosen/.test(document.getElementById("board-error").textContent));
    await page.context().close();
  },

  async "is clean for everybody: light, dark, and a phone"() {
    for (const [name, options] of Object.entries({
      light: { viewport: { width: 1280, height: 800 } },
      dark: { viewport: { width: 1280, height: 800 }, colorScheme: "dark" },
      phone: { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 },
    })) {
      const page = await opened(options);
      await page.fill("#parameter-threshold", "0.35");
      await settled(page);
      await accessible(page, name);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      const { width } = options.viewport;
      assert(wide <= width, `${name}: ${wide} wide on ${width}`);
      if (PICTURES) await page.screenshot({ path: join(PICTURES, `page-${name}.png`), fullPage: true });
      await page.context().close();
    }
  },

  async "pans through ten million samples"() {
    const page = await opened();
    const start = Date.now();
    await page.evaluate(() => {
      const parts = ["rate\n"];
      for (let block = 0; block < 100; block++) {
        let text = "";
        for (let at = 0; at < 100_000; at++) text += `${(Math.sin(at * 0.01) * 3 + Math.sin(at * 0.37 + block)).toFixed(3)}\n`;
        parts.push(text);
      }
      const data = new DataTransfer();
      data.items.add(new File(parts, "long.csv"));
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
    });
    await page.waitForFunction(() => /long\.csv: rate, 10,000,000/.test(document.getElementById("about").textContent), null, { timeout: 240_000 });
    const read = Date.now() - start;
    await settled(page);
    const coded = Date.now() - start - read;
    const frames = await page.evaluate(async () => {
      const { plots } = globalThis.spikewire;
      const all = [];
      for (const factor of [0.5, 0.05]) {
        plots.zoom(factor);
        const begin = performance.now();
        for (let frame = 0; frame < 30; frame++) {
          plots.pan(0.01);
          await new Promise(requestAnimationFrame);
        }
        all.push(30_000 / (performance.now() - begin));
      }
      return all.map((own) => own.toFixed(0));
    });
    console.log(`  made and read in ${read} ms, coded and drawn in ${coded} ms, panned at ${frames.join(" and ")} frames a second`);
    await page.context().close();
  },
};

/** In the browser: a serial port that gives the bytes of `speaks` in odd pieces. */
function fakeSerial() {
  const port = {
    async open(options) {
      globalThis.asked = options;
      globalThis.isClosed = false;
      const bytes = Uint8Array.from(globalThis.speaks);
      let place = 0;
      this.readable = new ReadableStream({
        pull(controller) {
          const end = place + 1 + (place % 97);
          if (place < bytes.length) controller.enqueue(bytes.slice(place, end));
          else if (!globalThis.stays) controller.close();
          place = end;
        },
      });
    },
    async close() {
      if (this.readable.locked) throw new Error("still read");
      globalThis.isClosed = true;
    },
  };
  const requestPort = async () => {
    if (!globalThis.speaks) throw new DOMException("No port selected by the user.", "NotFoundError");
    return port;
  };
  Object.defineProperty(navigator, "serial", { value: { requestPort } });
}

/** What a board of two addresses sends: keyframes now and then, and a frame that was damaged on its way. */
function link() {
  const lines = ["tick,address,polarity"];
  const kept = [0, 0];
  for (let step = 0; step < 900; step++) {
    const tick = 1000 + step * 1000;
    if (step % 300 === 0) {
      kept.forEach((value, address) => {
        const bits = Buffer.alloc(4);
        bits.writeFloatBE(value);
        lines.push(`# keyframe=${tick},${address},${bits.toString("hex")},f32`);
      });
    }
    else if (step % 60 === 0) lines.push(`# heartbeat=${tick},0`); // which ends a frame
    const address = (step * 7) % 2, up = Math.sin(step / 40 + address) > 0;
    kept[address] = Math.fround(kept[address] + Math.fround(up ? 0.35 : -0.35));
    lines.push(`${tick},${address},${up ? 1 : -1}`);
  }
  const [events, file] = [join(work, "sent.csv"), join(work, "sent.link")];
  writeFileSync(events, `${lines.join("\n")}\n`);
  spikewire("convert", "--from", "csv", "--to", "link,period=1000,channels=4", events, "-o", file);
  const bytes = readFileSync(file);
  bytes[Math.floor(bytes.length / 2)] ^= 0x10;
  return bytes;
}

/** A PX4 log of one topic. */
function ulog() {
  const message = (kind, content) => {
    const head = Buffer.alloc(3);
    head.writeUInt16LE(content.length);
    head.write(kind, 2);
    return Buffer.concat([head, content]);
  };
  const all = [Buffer.from("ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0", "latin1"), message("F", Buffer.from("gyro:uint64_t timestamp;float rate;")), message("A", Buffer.from("\0\0\0gyro", "latin1"))];
  for (let at = 0; at < 200; at++) {
    const content = Buffer.alloc(14);
    content.writeBigUInt64LE(BigInt(1_000_000 + at * 5000), 2);
    content.writeFloatLE(Math.sin(at * 0.1), 10);
    all.push(message("D", content));
  }
  return Buffer.concat(all);
}

let failed = 0;
const only = process.argv[2];
for (const [name, step] of Object.entries(steps)) {
  if (only && !name.includes(only)) continue;
  const start = Date.now();
  try {
    await step();
    assert.deepEqual(said.splice(0), [], "what the browser said");
    console.log(`ok      ${name}, ${((Date.now() - start) / 1000).toFixed(1)} s`);
  } catch (error) {
    failed++;
    console.log(`FAILED  ${name}\n${error.stack}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
