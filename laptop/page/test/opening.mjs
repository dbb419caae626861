// Files: every kind of log, the channel that it opens on, and what is refused.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { choose, compare, DATA, drawer, drop, enter, exported, LOGS, opened, settled, spikewire, text, work } from "./harness.mjs";
import { bag, decoded, euroc, mcap, px4, px4Raw, ulog } from "./made.mjs";

export const steps = {
  async "opens ten logs of seven formats on their gyroscope"() {
    const page = await opened();
    const made = { "px4.ulg": px4(), "newer.ulg": px4Raw(), "one.ulg": ulog(), "imu.bag": bag(), "imu.mcap": mcap(), "euroc.csv": Buffer.from(euroc()), "decoded.csv": Buffer.from(decoded()) };
    let right = 0;
    for (const [name, topic, field, axes] of [
      ["hexarotor.csv", "", "gyro_x", 6], ["euroc.csv", "", "w_RS_S_x [rad s^-1]", 6], ["decoded.csv", "", "gyroADC[0] (deg/s)", 3],
      ["px4.ulg", "sensor_combined", "gyro_rad[0]", 6], ["newer.ulg", "sensor_gyro", "x", 3], ["one.ulg", "gyro", "rate", 0],
      ["log.bin", "IMU", "GyrX", 2], ["log.tlog", "RAW_IMU", "xgyro", 6], ["imu.bag", "/imu/data", "angular_velocity.x", 6],
      ["imu.mcap", "/imu/data", "angular_velocity.x", 6], ["log.bbl", "main", "gyroADC[0]", 3],
    ]) {
      const bytes = made[name] ?? readFileSync(name === "hexarotor.csv" ? join(DATA, name) : join(LOGS, name));
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
