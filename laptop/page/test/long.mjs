// Ten million samples.

import assert from "node:assert/strict";
import { figure, opened, settled } from "./harness.mjs";

export const steps = {
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
    // A knob shows what it does long before the whole is coded again, of the whole and of a part.
    const dragged = () => page.evaluate(async () => {
      const { plots } = globalThis.spikewire, slider = document.querySelector("#main-parameter input[type=range]"), previews = [];
      const drawn = async (before) => {
        while (plots.runs[0] === before) await new Promise(requestAnimationFrame);
        return plots.runs[0];
      };
      let start, run = plots.runs[0];
      for (let step = 0; step < 10; step++) {
        start = performance.now();
        slider.valueAsNumber -= 10;
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        run = await drawn(run);
        if (!run.isPreview || !document.getElementById("figures").textContent.includes("…")) throw new Error("not a preview");
        previews.push(performance.now() - start);
      }
      run = await drawn(run);
      return { preview: previews.sort((a, b) => a - b)[5], whole: performance.now() - start, spikes: run.figures.spikes };
    });
    for (const part of [1, 0.01]) {
      await page.evaluate((own) => globalThis.spikewire.plots.zoom(own), part);
      const { preview, whole, spikes } = await dragged();
      await settled(page);
      assert.equal(Number((await figure(page, "Spikes")).replaceAll(",", "")), spikes);
      console.log(`  with ${100 * part} % in view a knob is drawn after ${preview.toFixed()} ms, the whole after ${whole.toFixed()} ms`);
      assert(preview < whole / 4, `${preview} ms, ${whole} ms`);
    }
    await page.evaluate(() => globalThis.spikewire.plots.show(...globalThis.spikewire.plots.full));
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
