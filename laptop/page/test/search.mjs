// Searches in another thread.

import assert from "node:assert/strict";
import { accessible, drawer, enter, figure, opened, settled, text } from "./harness.mjs";

export const steps = {
  async "searches in another thread, and stops"() {
    const page = await opened();
    await page.selectOption("#scheme", "sod");
    await settled(page);
    await drawer(page, "#show-search");
    await enter(page, "#evaluations", "128");
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
    await enter(page, "#evaluations", "20000");
    await page.click("#tune-all");
    await page.waitForFunction(() => document.getElementById("bar").value > 0);
    await page.getByLabel("threshold, slider").press("ArrowLeft"); // the page answers meanwhile
    await settled(page);
    await page.click("#stop");
    await page.waitForSelector("#tune:enabled");
    assert.match(await page.textContent("#front-words"), /^Stopped/);
    await enter(page, "#evaluations", "16");
    await page.click("#advise");
    await page.waitForSelector("#advice:visible", { timeout: 300_000 });
    assert.match(await page.textContent("#advice"), /take \w+ in f32/);
    // Each axis has settings of its own.
    await settled(page);
    assert.match(await page.textContent("#notes"), /^Found on gyro_x; /);
    const parameters = (await text(page, "flight")).split("[[channel]]").slice(1).map((channel) => /parameters = (.*)/.exec(channel)?.[1]);
    assert.equal(parameters.length, 6);
    assert.notEqual(parameters[0], parameters[3]);
    await page.context().close();
  },
};
