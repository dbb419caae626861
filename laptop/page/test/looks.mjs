// What a visitor sees: all in one window, readable in every theme and size.

import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { accessible, apart, DATA, drawer, enter, figure, go, opened, PAGE, picture, settled, text, unfold } from "./harness.mjs";
import { amplitudes } from "../js/spectrum.js";

/** Windows that show all of it without scrolling, and smaller ones. */
const WHOLE = { wide: { width: 1440, height: 900 }, low: { width: 1280, height: 720 }, huge: { width: 1920, height: 1080 } };
const SIZES = {
  wide: { viewport: WHOLE.wide },
  low: { viewport: WHOLE.low },
  small: { viewport: { width: 1024, height: 768 } },
  tablet: { viewport: { width: 820, height: 1180 } },
  phone: { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true },
};

export const steps = {
  async "is ready soon, with a flight and nothing asked of the network"() {
    const page = await opened();
    const ready = await page.evaluate(() => Number(document.body.dataset.ready));
    console.log(`  ready after ${ready} ms; ${statSync(PAGE).size} bytes`);
    assert.match(await page.textContent("#about"), /gyro_x, 3,627 samples/);
    assert(statSync(PAGE).size <= 1_500_000, "1.5 MB at most");
    await page.context().close();
  },

  async "fills one window without scrolling, almost half of it with the chart"() {
    for (const [name, viewport] of Object.entries(WHOLE)) {
      const page = await opened({ viewport, isFolded: true }, "");
      await axesDrawn(page);
      const { stack, scrolls } = await page.evaluate(() => {
        const { width, height, top, bottom } = document.getElementById("stack").getBoundingClientRect();
        const charts = [...document.querySelectorAll("#plots .uplot")].map((own) => own.getBoundingClientRect());
        return {
          stack: { area: width * height, top, bottom, least: Math.min(...charts.map((own) => own.height)), end: Math.max(...charts.map((own) => own.bottom)) },
          scrolls: [document.documentElement, ...document.querySelectorAll("#rail, #settings")].filter((own) => own.scrollHeight > own.clientHeight + 1).map((own) => own.id || "page"),
        };
      });
      const share = stack.area / (viewport.width * viewport.height);
      console.log(`  ${viewport.width} x ${viewport.height}: the chart takes ${(100 * share).toFixed(0)} % of the window`);
      assert(share >= 0.45, `${name}: ${share}`);
      assert.deepEqual(scrolls, [], name);
      assert(stack.end <= stack.bottom + 1 && stack.least > 40, `${name}: charts end at ${stack.end} of ${stack.bottom}, the lowest has ${stack.least}`);
      for (const id of ["parameter-threshold", "cards", "filter", "keyframes", "tiles", "plots", "under", "chip", "flight-file", "axes"]) {
        const { y, height } = await page.locator(`#${id}`).boundingBox();
        assert(y >= 0 && y + height <= viewport.height, `${id} from ${y} to ${y + height} in a window of ${viewport.width} x ${viewport.height}`);
      }
      // One time axis for all, shown once, below a signal that is as wide as everything else.
      assert.equal(await page.evaluate(() => globalThis.spikewire.plots.all.filter((own) => own.axes[0].label).length), 1);
      // No number stands on another one, however low the strips are.
      if (name === "low") {
        const crowded = () => page.evaluate(() => globalThis.spikewire.plots.all.slice(1).flatMap((own) => {
          const axis = own.axes[1], places = (axis._values ?? []).map((words, at) => words && own.valToPos(axis._splits[at], "y")).filter((at) => at !== "").sort((a, b) => a - b);
          return places.filter((at, place) => place && at - places[place - 1] < 10);
        }));
        for (const scheme of ["sf", "grf", "hsa"]) {
          await page.click("#add");
          await page.selectOption("#scheme", scheme);
          await settled(page);
        }
        assert.deepEqual(await crowded(), []);
        await drawer(page, "#show-spectrum");
        await page.waitForTimeout(300);
        assert.deepEqual(await crowded(), []);
      }
      await page.context().close();
    }
  },

  async "has slider and chart in view together on a phone, with the values at a tap below them"() {
    const page = await opened({ ...SIZES.phone, isFolded: true }, "");
    await axesDrawn(page);
    const box = (id) => page.locator(id).boundingBox(), { height } = SIZES.phone.viewport;
    const stack = await box("#stack"), slider = await box("#main-parameter input[type=range]");
    assert(stack.y >= 0 && stack.height > 0.45 * height && slider.y + slider.height <= height, `chart from ${stack.y} to ${stack.y + stack.height}, slider to ${slider.y + slider.height}`);
    const signal = await page.locator("#plots .u-over").first().boundingBox();
    await page.mouse.click(signal.x + 100, signal.y + 50);
    await page.waitForSelector(".cursor");
    const table = await box(".cursor"), plots = await box("#plots");
    assert(table.y >= plots.y + plots.height && table.x >= 0 && table.x + table.width <= SIZES.phone.viewport.width, JSON.stringify(table));
    await apart(page, "a tap on a phone");
    await accessible(page, "a tap on a phone");
    await picture(page, "tap", { fullPage: true });
    await page.context().close();
  },

  async "drags the threshold on the signal, zooms in the overview, and shows values under the pointer"() {
    const page = await opened({ viewport: WHOLE.wide });
    await axesDrawn(page);
    const flight = join(DATA, "hexarotor.csv");
    const threshold = async () => Number(await page.inputValue("#parameter-threshold")), before = await threshold();
    const band = await page.locator(".band").boundingBox(), spikes = await figure(page, "Spikes");
    await page.mouse.move(band.x + 200, band.y);
    await page.mouse.down();
    await page.mouse.move(band.x + 200, band.y - band.height / 2, { steps: 4 });
    await page.mouse.up();
    await settled(page);
    const after = await threshold(), grown = await page.locator(".band").boundingBox();
    assert(Math.abs(after / before - 2) < 0.15, `${before} to ${after}`);
    assert(Math.abs(grown.height / band.height - 2) < 0.15, `${band.height} to ${grown.height}`);
    assert.notEqual(await figure(page, "Spikes"), spikes);
    assert.match(await page.textContent(".band"), new RegExp(`± ${after} rad/s`));
    await page.click("#undo");
    await settled(page);
    assert.equal(await threshold(), before);
    const overview = await page.locator("#overview").boundingBox();
    const brush = async (from, to) => {
      await page.mouse.move(overview.x + from, overview.y + 20);
      await page.mouse.down();
      await page.mouse.move(overview.x + to, overview.y + 20, { steps: 4 });
      await page.mouse.up();
    };
    const view = () => page.evaluate(() => globalThis.spikewire.plots.view);
    await brush(200, 400);
    const [left, right] = await view(), length = right - left;
    assert(left > 1 && length > 2 && length < 10, `${left} to ${right}`);
    await brush(300, 350);
    assert(Math.abs((await view())[1] - (await view())[0] - length) < 1e-6 && (await view())[0] > left + 0.5, "the brush moves what is in view");
    await page.locator("#overview").dblclick();
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
    assert(under.includes(`gyro_x ${short(value)} rad/s`) && /from the mark [\d.]+ s/.test(under), under);
    const first = (place) => cursor(page, place).then((cells) => cells.map(Number));
    assert.equal((await first("gyro_x"))[0], Number(short(value)));
    assert.equal((await first("SF, decoded"))[0], Number(short(decoded)));
    assert.equal((await first("SF, error"))[0], Number(short(decoded - value)));
    // Another axis is opened from its strip.
    await page.locator(".axis").nth(4).click();
    await page.waitForTimeout(50);
    await settled(page);
    assert.match(await page.textContent("#about"), /accel_y, 3,627 samples/);
    assert.equal(await page.locator(".axis").nth(4).getAttribute("aria-pressed"), "true");
    const count = Number((await figure(page, "Spikes a second")).replaceAll(",", ""));
    await page.waitForFunction((own) => document.querySelectorAll(".axis span")[4].textContent.includes(`: ${own.toLocaleString("en")} spikes a second`), count);
    // Power at a frequency where there is some, and an error whose shares are a whole.
    await drawer(page, "#show-spectrum");
    await page.waitForSelector("#spectrum canvas");
    assert.equal(await page.locator("#spectrum canvas").count(), 2);
    await accessible(page, "six axes and a spectrum");
    await page.context().close();
    const sine = Float64Array.from({ length: 4096 }, (_, at) => 3 * Math.sin((2 * Math.PI * at) / 16));
    const heights = amplitudes(sine, 0, sine.length);
    const peak = heights.indexOf(Math.max(...heights));
    assert.equal((peak + 1) / (2 * (heights.length + 1)), 1 / 16);
    assert(Math.abs(heights[peak] - 3) < 0.02, `a sine of 3 has the height ${heights[peak]}`);
  },

  async "moves cursor and mark with the keyboard, and tells all series and their differences"() {
    const page = await opened({ viewport: WHOLE.low });
    await page.click("#add");
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await enter(page, "#parameter-threshold", 0.1);
    await settled(page);
    const at = () => page.evaluate(() => {
      const { pointed, mark, view, runs, recording: { arrays: { values } } } = globalThis.spikewire.plots;
      const series = [values, ...runs.map(({ arrays: { decoded } }) => decoded)];
      const spikes = runs.map(({ arrays: { sample, up } }) => [...sample].reduce((sum, own, place) => (own >= mark && own < pointed ? sum + (up[place] ? 1 : -1) : sum), 0));
      return { pointed, mark, view, values: series.map((own) => own[pointed]), marked: series.map((own) => own[mark]), spikes };
    });
    const press = async (...keys) => { for (const key of keys) await page.keyboard.press(key); };
    await page.focus("#plots");
    await press("+", "+", "+");
    const { view } = await at();
    await press("ArrowRight", "Shift+ArrowRight");
    const { pointed } = await at();
    assert((await at()).view[0] > view[0] && pointed > 0);
    await press("Shift+ArrowRight", "Shift+ArrowLeft", "Shift+ArrowRight");
    assert.equal((await at()).pointed, pointed + 1, "one sample where few are in view");
    await press("Enter");
    for (let step = 0; step < 40; step++) await press("Shift+ArrowRight");
    const { mark, values, marked, spikes, ...own } = await at();
    assert.deepEqual([mark, own.pointed], [pointed + 1, pointed + 41]);
    const short = (number) => String(Number(number.toPrecision(4)));
    for (const [place, name] of ["gyro_x", "A SF, decoded", "B SoD, decoded"].entries()) {
      assert.deepEqual(await cursor(page, name), [values[place], marked[place], values[place] - marked[place]].map(short), name);
    }
    assert.deepEqual(await cursor(page, "B SoD, error"), [values[2] - values[0], marked[2] - marked[0], values[2] - values[0] - (marked[2] - marked[0])].map(short));
    for (const [place, name] of ["A SF, spikes", "B SoD, spikes"].entries()) assert.equal((await cursor(page, name))[2].replace("+", ""), String(spikes[place]), name);
    assert(spikes[1] !== 0, "spikes between mark and cursor");
    assert.match(await page.textContent(".cursor thead"), /cursor[\d.]+ s\s*mark[\d.]+ s\s*difference[\d.]+ s/);
    await apart(page, "a cursor");
    await accessible(page, "a cursor");
    await picture(page, "cursor");
    // It stays when the knob moves, goes out of view with the view, and comes back with the next step.
    await enter(page, "#parameter-threshold", 0.3);
    await settled(page);
    assert.deepEqual([(await at()).pointed, await page.isVisible(".cursor")], [own.pointed, true]);
    await page.focus("#plots");
    await press("0", "Escape");
    assert.deepEqual([(await at()).pointed, (await at()).mark, await page.locator(".cursor").count()], [undefined, undefined, 0]);
    await page.keyboard.press("Control+z");
    await settled(page);
    assert.notEqual(await page.inputValue("#parameter-threshold"), "0.3");
    await page.context().close();
  },

  async "is clean for everybody: five sizes, light and dark, nothing on anything else, nothing undecided"() {
    for (const [size, options] of Object.entries(SIZES)) for (const colorScheme of ["light", "dark"]) {
      const page = await opened({ ...options, colorScheme, isFolded: true }, ""), what = `${size}, ${colorScheme}`;
      assert.equal(await page.evaluate(() => matchMedia("(prefers-color-scheme: dark)").matches), colorScheme === "dark");
      const looked = async (at) => {
        // A line that the edge of a list cuts has no contrast that axe can decide.
        await page.evaluate(() => (document.getElementById("settings").scrollTop = 1e6));
        await apart(page, `${what}, ${at}`);
        await accessible(page, `${what}, ${at}`);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert(wide <= options.viewport.width, `${what}, ${at}: ${wide} wide`);
        await picture(page, `page-${size}-${colorScheme}-${at.replaceAll(" ", "-")}`, { fullPage: true });
      };
      await axesDrawn(page);
      await looked("as it opens");
      // All that can be shown: four settings, everything unfolded, and each part below the picture.
      for (const scheme of ["sf", "grf", "hsa"]) {
        await page.click("#add");
        await page.selectOption("#scheme", scheme);
        await settled(page);
      }
      await unfold(page);
      await page.click("#tab-0");
      await page.click("#chip");
      await drawer(page, "#show-spectrum");
      await axesDrawn(page);
      await looked("compared");
      await drawer(page, "#show-search");
      await enter(page, "#evaluations", "64");
      await page.click("#tune");
      await page.waitForSelector("#front circle");
      await page.waitForSelector("#tune:enabled");
      await looked("searched");
      await text(page, "rust");
      await enter(page, "#parameter-threshold", "-1");
      await settled(page);
      await looked("wrong");
      await go(page, "board");
      await page.click("#connect");
      await page.waitForSelector("#board-error:visible");
      await accessible(page, `${what}, a board`);
      await go(page, "help");
      await accessible(page, `${what}, help`);
      await page.context().close();
    }
  },
};

/** The cells of a series in the table at the cursor: at the cursor, at the mark, and between the two. */
const cursor = (page, name) => page.evaluate((own) => {
  const row = [...document.querySelectorAll(".cursor tbody tr")].find(({ cells: [head] }) => head.textContent === own);
  return row ? [...row.cells].slice(1).map(({ textContent }) => textContent) : [];
}, name);

/** All six axes are coded by the settings. */
async function axesDrawn(page) {
  await page.waitForFunction(() => document.querySelectorAll(".axis span").length === 6 && [...document.querySelectorAll(".axis span")].every((words) => /:/.test(words.textContent)));
}
