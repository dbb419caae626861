// What comes live: frames of a clip or a camera, and a board at a port.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { accessible, drop, enter, go, opened, saved, settled, spikewire, text, work } from "./harness.mjs";
import { link } from "./made.mjs";

export const steps = {
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
    await go(page, "video");
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
    await go(without, "board");
    await without.click("#connect");
    assert.match(await without.textContent("#board-error"), /reads no serial port/);
    await without.context().close();

    const page = await opened({}, "", fakeSerial);
    const bytes = link();
    const captured = join(work, "captured.link"), toml = join(work, "sender.toml");
    writeFileSync(captured, bytes);
    const heard = async (kind) => (await saved(page, `[data-heard=${kind}]`)).toString();
    const listened = async (speaks) => {
      await page.evaluate((own) => (globalThis.speaks = own), [...speaks]);
      await go(page, "board");
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
      for (const [name, value] of Object.entries(settings)) await enter(page, `#parameter-${name}`, value);
      await settled(page);
      await enter(page, "#thresholds", more[1] ?? "");
      await listened(bytes);
      await go(page, "log");
      writeFileSync(toml, await text(page, "toml"));
      await go(page, "board");
      const theirs = spikewire("listen", captured, "--params", toml, ...more).toString();
      assert.equal(await heard("values"), theirs, scheme);
      assert.equal(await heard("spikes"), spikewire("convert", "--from", "link", "--to", "csv", captured).toString());
      assert.match(theirs, /,exact\n[^]*,estimate\n|,estimate\n[^]*,exact\n/, scheme);
      assert.match(await page.textContent("#board-words"), /1 lost in 1 gaps/);
      assert.equal(await page.evaluate(() => globalThis.asked.baudRate), 921600);
      values += theirs.split("\n").length - 2;
      await go(page, "log");
    }
    // A file of the same bytes says the same.
    await go(page, "board");
    const port = await saved(page, "[data-heard=values]");
    await page.selectOption("#meaning", "spikes");
    await drop(page, { name: "captured.link", bytes });
    await page.waitForFunction(() => /1 lost in 1 gaps/.test(document.getElementById("board-words").textContent) && document.getElementById("connect").disabled === false);
    assert.equal(await heard("spikes"), spikewire("convert", "--from", "link", "--to", "csv", captured).toString());
    await page.selectOption("#meaning", "values");
    await drop(page, { name: "captured.link", bytes });
    await page.waitForFunction(() => document.getElementById("connect").disabled === false);
    assert((await saved(page, "[data-heard=values]")).equals(port));
    console.log(`  ${values} values of ${bytes.length} bytes in three ways`);
    await accessible(page, "a board");
    await go(page, "log");
    await page.selectOption("#scheme", "grf-slots");
    await settled(page);
    await go(page, "board");
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

