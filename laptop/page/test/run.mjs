// Runs all tests in every browser that is there, or those whose name has the words of the argument.

import assert from "node:assert/strict";
import { steps as banks } from "./banks.mjs";
import { end, said, use } from "./harness.mjs";
import { steps as live } from "./live.mjs";
import { steps as long } from "./long.mjs";
import { steps as looks } from "./looks.mjs";
import { steps as opening } from "./opening.mjs";
import { steps as search } from "./search.mjs";
import { steps as settings } from "./settings.mjs";
import { steps as truth } from "./truth.mjs";

const only = process.argv[2] ?? "";
let failed = 0;
for (const engine of (process.env.ENGINES ?? "chromium firefox").split(" ")) {
  await use(engine);
  for (const [name, step] of Object.entries({ ...looks, ...truth, ...opening, ...settings, ...banks, ...search, ...live, ...long })) {
    if (!name.includes(only)) continue;
    const start = Date.now();
    try {
      await step();
      assert.deepEqual(said.splice(0), [], "what the browser said");
      console.log(`ok      ${engine}: ${name}, ${((Date.now() - start) / 1000).toFixed(1)} s`);
    } catch (error) {
      failed++;
      said.splice(0);
      console.log(`FAILED  ${engine}: ${name}\n${error.stack}`);
    }
  }
}
await end();
process.exit(failed ? 1 : 0);
