// What a visitor sees: all in one window, readable in every theme and size.

import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { accessible, apart, DATA, enter, figure, opened, PAGE, picture, settled, text } from "./harness.mjs";
import { amplitudes } from "../js/spectrum.js";

export const steps = {
  async "is ready soon, with a flight and nothing asked of the network"() {
    const page = await opened();
    const ready = await page.evaluate(() => Number(document.body.dataset.ready));
    console.log(`  ready after ${ready} ms; ${statSync(PAGE).size} bytes`);
    assert.match(await page.textContent("#about"), /gyro_x, 3,627 samples/);
    assert(statSync(PAGE).size <= 1_500_000, "1.5 MB at most");
    await page.context().close();
  },

  async "shows all of it in one window, six axes, and values under the pointer"() {
    for (const viewport of [{ width: 1440, height: 900 }, { width: 1024, height: 768 }]) {
      const page = await opened({ viewport });
      await axesDrawn(page);
      for (const id of ["parameter-threshold", "figures", "plots", "under"]) {
        const { y, height } = await page.locator(`#${id}`).boundingBox();
        assert(y >= 0 && y + height <= viewport.height, `${id} from ${y} to ${y + height} in a window of ${viewport.width} x ${viewport.height}`);
      }
      await picture(page, `page-${viewport.width}`);
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

  async "is clean for everybody: three sizes, light and dark, nothing on anything else, nothing undecided"() {
    for (const [size, options] of Object.entries({
      wide: { viewport: { width: 1440, height: 900 } },
      low: { viewport: { width: 1024, height: 768 } },
      phone: { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true },
    })) for (const colorScheme of ["light", "dark"]) {
      const page = await opened({ ...options, colorScheme }), what = `${size}, ${colorScheme}`;
      assert.equal(await page.evaluate(() => matchMedia("(prefers-color-scheme: dark)").matches), colorScheme === "dark");
      const looked = async (at) => {
        await apart(page, `${what}, ${at}`);
        await accessible(page, `${what}, ${at}`);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert(wide <= options.viewport.width, `${what}, ${at}: ${wide} wide`);
        await picture(page, `page-${size}-${colorScheme}-${at}`, { fullPage: true });
      };
      await axesDrawn(page);
      await looked("as it opens");
      // All that can be shown at once: four settings, spectra, a front, a constant, and errors.
      for (const scheme of ["sod", "grf", "hsa"]) {
        await page.click("#add");
        await page.selectOption("#scheme", scheme);
        await settled(page);
      }
      await page.click("#spectrum-box summary");
      await text(page, "rust");
      await page.click("#tab-0");
      await enter(page, "#evaluations", "64");
      await page.click("#tune");
      await page.waitForSelector("#front circle");
      await page.waitForSelector("#tune:enabled");
      await page.fill("#parameter-threshold", "-1");
      await settled(page);
      await page.click("#connect");
      await page.waitForSelector("#board-error:visible");
      await axesDrawn(page);
      await looked("with all of it");
      await page.context().close();
    }
  },
};

/** All six axes are coded by the settings. */
async function axesDrawn(page) {
  await page.waitForFunction(() => document.querySelectorAll(".axis span").length === 6 && [...document.querySelectorAll(".axis span")].every((words) => /RMSE/.test(words.textContent) || /:/.test(words.textContent)));
}
