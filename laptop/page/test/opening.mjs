// Files: every kind of log, the channel that it opens on, and what is refused.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { choose, compare, DATA, drawer, drop, enter, exported, LOGS, opened, settled, spikewire, text, work } from "./harness.mjs";
import { bag, blackbox, decoded, euroc, mcap, px4, px4Raw, ulog } from "./made.mjs";

export const steps = {
  async "opens sixteen logs of nine formats on their gyroscope"() {
    const page = await opened();
    const made = { "px4.ulg": px4(), "newer.ulg": px4Raw(), "one.ulg": ulog(), "imu.bag": bag(), "imu.mcap": mcap(), "euroc.csv": Buffer.from(euroc()), "decoded.csv": Buffer.from(decoded()), "acc.bbl": blackbox(4000) };
    let right = 0;
    for (const [name, topic, field, axes] of [
      ["hexarotor.csv", "", "gyro_x", 6], ["vtol_at_rest.csv", "", "gyro_x", 6], ["euroc.csv", "", "w_RS_S_x [rad s^-1]", 6], ["decoded.csv", "", "gyroADC[0] (deg/s)", 3],
      ["px4.ulg", "sensor_combined", "gyro_rad[0]", 6], ["newer.ulg", "sensor_gyro", "x", 3], ["one.ulg", "gyro", "rate", 0],
      ["log.bin", "IMU", "GyrX", 2], ["log.log", "IMU", "GyrX", 2], ["log.db3", "/imu", "rate", 0], ["log.tlog", "RAW_IMU", "xgyro", 6], ["imu.bag", "/imu/data", "angular_velocity.x", 6],
      ["imu.mcap", "/imu/data", "angular_velocity.x", 6], ["log.bbl", "main", "gyroADC[0]", 3],
      ["acc.bbl", "main", "gyroADC[0]", 6], ["log.bag", "/imu", "rate", 0],
    ]) {
      const bytes = made[name] ?? readFileSync(join(name.endsWith(".csv") ? DATA : LOGS, name));
      await drop(page, { name, bytes });
      assert.equal(await page.textContent("#file-error"), "", name);
      assert.deepEqual([await page.inputValue("#topic"), await page.inputValue("#field")], [topic, field], name);
      assert.match(await page.textContent("#about"), new RegExp(`^${name.replace(".", "\\.")}: .*samples`));
      await page.waitForFunction((count) => document.querySelectorAll(".axis").length === count, axes).catch(() => assert.fail(`${name}: not ${axes} axes`));
      right++;
    }
    console.log(`  ${right} of ${right} on a turn rate`);
    await page.context().close();
  },

  async "takes a folder and several files, of which one is looked at, and finds channels by their names"() {
    const page = await opened();
    await drop(page, { name: "a.csv", bytes: "one,two\n1,2\n2,3\n" }, { name: "b.csv", bytes: euroc() });
    assert.match(await page.textContent("#about"), /^a\.csv: one/);
    await page.selectOption("#file-of", { label: "b.csv" });
    await settled(page);
    assert.match(await page.textContent("#about"), /^b\.csv: w_RS_S_x/);
    await drop(page, { name: "px4.ulg", bytes: px4() });
    assert.equal(await page.isVisible("#of-files"), false);
    await page.fill("#find", "output[");
    assert.deepEqual(await page.locator("#found button").allTextContents(), [0, 1, 2, 3].map((own) => `actuator_outputs · output[${own}]`));
    await page.fill("#find", "nothing");
    assert.match(await page.textContent("#found"), /no channel has “nothing” in its name/);
    await page.fill("#find", "OUTPUT[2]");
    await page.locator("#found button").click();
    await settled(page);
    assert.deepEqual([await page.inputValue("#topic"), await page.inputValue("#field")], ["actuator_outputs", "output[2]"]);
    assert.match(await page.textContent("#about"), /output\[2\], 200 samples/);
    // What a folder's entry gives, as browsers hand it over at a drop.
    await page.evaluate(() => {
      const entry = (name) => ({ isFile: true, name, file: (done) => done(new File(["x\n1\n2\n"], name)) });
      let rest = [[entry("d.csv"), entry("c.csv")], []];
      const folder = { isDirectory: true, createReader: () => ({ readEntries: (done) => done(rest.shift()) }) };
      const event = new Event("drop", { bubbles: true, cancelable: true });
      event.dataTransfer = { items: [{ webkitGetAsEntry: () => folder }], files: [] };
      document.body.dispatchEvent(event);
    });
    await settled(page);
    assert.match(await page.textContent("#about"), /^c\.csv: x, 2 samples/);
    assert.deepEqual(await page.locator("#file-of option").allTextContents(), ["c.csv", "d.csv"]);
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

  async "shows the beginning of a large log within three seconds, and keeps the picture before a slow one"() {
    const page = await opened();
    const seen = () => page.evaluate(() => {
      const { recording } = globalThis.spikewire.plots;
      return { about: document.getElementById("about").textContent, samples: recording.samples, name: recording.name, isBeginning: Boolean(recording.isBeginning), isInert: document.getElementById("settings").inert, isDimmed: document.body.classList.contains("dimmed") };
    });
    const large = join(work, "large.bbl"), slow = join(work, "slow.csv"), refused = join(work, "refused.csv");
    writeFileSync(large, blackbox(1_500_000));
    await page.setInputFiles("#choose", large);
    await page.waitForFunction(() => globalThis.spikewire.plots.recording.isBeginning && document.getElementById("about").textContent.includes("%"), null, { timeout: 3000 });
    const beginning = await seen();
    assert.match(beginning.about, /^reading large\.bbl … \d+ % of \d+ MB, of which the beginning is shown$/);
    assert.deepEqual([beginning.name, beginning.isInert, beginning.isDimmed], ["gyroADC[0]", true, true]);
    assert(beginning.samples > 50_000 && beginning.samples < 1_500_000, `${beginning.samples} samples of the beginning`);
    await settled(page);
    const whole = await seen();
    assert.deepEqual([whole.samples, whole.isBeginning, whole.isInert, whole.isDimmed], [1_500_000, false, false, false]);
    // A table that is slow: the picture before it stays, dimmed.
    const lines = (count) => `rate\n${Array.from({ length: count }, (_, at) => (at % 1000) / 7).join("\n")}\n`;
    writeFileSync(slow, lines(1_200_000));
    await page.setInputFiles("#choose", slow);
    await page.waitForFunction(() => document.getElementById("about").textContent.startsWith("reading slow.csv"), null, { timeout: 3000 });
    const during = await seen();
    assert.deepEqual([during.samples, during.isBeginning, during.isInert, during.isDimmed], [1_500_000, false, true, true]);
    await settled(page);
    assert.match((await seen()).about, /^slow\.csv: rate, 1,200,000 samples/);
    // A large one that is refused at its end: its beginning goes again.
    writeFileSync(refused, `${lines(2_000_000)}word\n`);
    await page.setInputFiles("#choose", refused);
    await page.waitForFunction(() => globalThis.spikewire.plots.recording.isBeginning);
    await settled(page);
    assert.match(await page.textContent("#file-error"), /refused\.csv.*`word` is not a number/);
    assert.match(await page.textContent("#notice"), /^The picture is still that of slow\.csv\.$/);
    assert.deepEqual([(await seen()).samples, (await seen()).isDimmed], [1_200_000, true]);
    await page.click("#back");
    await settled(page);
    assert.deepEqual([(await seen()).samples, (await seen()).isDimmed], [1_200_000, false]);
    await page.context().close();
  },

  async "knows the size of each unit as the program does"() {
    const page = await opened({}, "");
    // The head of a blackbox log tells how many counts are 1 g: it opens as it flew, on all six axes.
    await drop(page, { name: "acc.bbl", bytes: blackbox(20_000) });
    await page.waitForFunction(() => document.getElementById("chip").textContent.startsWith("Flew so in simulation"), null, { timeout: 30_000 }).catch(async () => assert.fail(await page.textContent("#verdict")));
    assert.deepEqual(await page.locator("#axes .group").allTextContents(), ["Turn rate, deg/s · 2000 Hz", "Acceleration, g/2048 · 2000 Hz"]);
    await page.locator(".axis").nth(4).click();
    await settled(page);
    assert.equal(Number(await page.inputValue("#parameter-threshold")), Number(((2.5603598560838168 / 9.80665) * 2048).toPrecision(6)));
    assert.equal(await page.isVisible("#unit-field"), false);
    for (const [unit, perSi, isRate] of [["rad/s", 1, true], ["deg/s", 180 / Math.PI, true], ["m/s^2", 1, false], ["g", 1 / 9.80665, false], ["mg", 1000 / 9.80665, false]]) {
      const names = ["x", "y", "z"].map((axis) => `${isRate ? "gyro" : "accel"}_${axis} (${unit})`);
      await drop(page, { name: "unit.csv", bytes: Buffer.from(`time_us,${names}\n${Array.from({ length: 900 }, (_, at) => `${at * 2000},${[0, 1, 2].map((axis) => perSi * 20 * Math.sin(at / 30 + axis)).join()}`).join("\n")}\n`) });
      assert.equal(Number(await page.inputValue("#parameter-threshold")), Number(((isRate ? 0.09314549722916148 : 2.5603598560838168) * perSi).toPrecision(6)), unit);
      assert.equal(await page.isVisible("#unit-field"), false, unit);
    }
    await page.context().close();
  },

  async "says what is wrong with a file, and goes on"() {
    const page = await opened();
    const whole = readFileSync(join(LOGS, "log.mcap"));
    // Everything that can be made of a recording is there before the first refusal.
    await text(page, "flight");
    await drawer(page, "#show-search");
    await enter(page, "#evaluations", 32);
    await page.click("#tune");
    await page.waitForSelector("#front circle");
    await page.waitForSelector("#tune:enabled");
    for (const [name, buffer, words] of [
      ["empty.csv", Buffer.from(""), /empty/],
      ["ragged.csv", Buffer.from("a,b\n1,2\n3,4,5\n"), /ragged\.csv/],
      ["words.csv", Buffer.from("a,b\nx,y\nz,w\n"), /words\.csv/],
      ["noise.bin", Buffer.from(Array.from({ length: 4096 }, (_, at) => (at * 7919) % 251)), /noise\.bin/],
      ["table.parquet", Buffer.from("PAR1xxxxxxxxxxxxxxxxxxxx"), /Parquet/],
      ["cut.mcap", whole.subarray(0, whole.length / 2), /damaged log/],
      ["cut.ulg", ulog().subarray(0, 900), /damaged log/],
    ]) {
      await drop(page, { name, bytes: buffer });
      const error = await page.textContent("#file-error");
      assert.match(error, words, `${name}: ${error}`);
      assert(await page.isVisible("#file-error"));
      // The picture of the recording before stays, dimmed and under its own name, and nothing of it can be changed; a table of words shows its own channels, to choose another.
      assert.match(await page.textContent("#notice"), /^The picture is still that of hexarotor\.csv\.$/, name);
      assert.match(await page.textContent("#about"), /^hexarotor\.csv: gyro_x/, name);
      assert.deepEqual(await page.evaluate(() => [...["picture", "settings"].map((id) => document.getElementById(id).inert), document.body.classList.contains("dimmed")]), [true, true, true], name);
      assert.equal(await page.isDisabled("#flight-file"), true, name);
      if (name === "words.csv") assert.deepEqual(await page.locator("#field option").allTextContents(), ["a", "b"]);
    }
    // Back, and all is as it was.
    const figures = await page.textContent("#figures");
    await page.click("#back");
    await settled(page);
    assert.deepEqual([await page.textContent("#file-error"), await page.isVisible("#notice"), await page.isDisabled("#flight-file")], ["", false, false]);
    assert.equal(await page.textContent("#figures"), figures);
    await drop(page, { name: "cut.ulg", bytes: ulog().subarray(0, 900) });
    await page.check("#accept-cut");
    await page.waitForFunction(() => /cut\.ulg/.test(document.getElementById("about").textContent));
    await settled(page);
    assert.equal(await page.textContent("#file-error"), "");
    await page.selectOption("#example", "paper");
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
    assert.equal(await page.evaluate(() => document.getElementById("picture").inert), true);
    await page.selectOption("#field", "rate, raw");
    await page.waitForTimeout(50);
    await settled(page);
    assert.equal(await page.evaluate(() => document.getElementById("picture").inert), false);
    assert.equal(await page.textContent("#file-error"), "");
    // A flat channel, a single sample, and a file without a channel: a sentence, and the page goes on.
    for (const [name, bytes, id, words] of [
      ["flat.csv", "x\n1\n1\n1\n", "error", /^x is 1 in all its samples, .* choose another channel/], ["one.csv", "x\n5\n", "error", /^x is 5 in all its samples/],
      ["none.csv", "time_us\n1\n2\n", "file-error", /^none\.csv: it has no channel of numbers .* open another file/],
    ]) {
      await drop(page, { name, bytes: Buffer.from(bytes) });
      assert.match(await page.textContent(`#${id}`), words);
    }
    await page.context().close();
  },
};
