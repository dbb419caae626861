// Makes one file of the page: style, scripts and the library, packed, within. So it opens from a disk as well.
// usage: node build.mjs MODULE.wasm OUTPUT.html, with NODE_PATH where npm installed

import { compress, init } from "@bokuweb/zstd-wasm";
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const [module, output] = process.argv.slice(2);
const own = (name) => fileURLToPath(new URL(name, import.meta.url));
// Zstandard sees the whole library, whose codes are much alike; gzip sees 32 kB of it, and makes it a third larger.
await init();
const packed = Buffer.from(compress(readFileSync(module), 22));
const library = packed.toString("base64");

async function bundle(entry, define = {}) {
  const made = await build({ entryPoints: [own(entry)], bundle: true, minify: true, format: "iife", target: "es2022", write: false, define });
  return made.outputFiles[0].text;
}

const worker = await bundle("js/worker.js");
const script = (await bundle("js/app.js", { WASM: JSON.stringify(library), WORKER: JSON.stringify(worker) })).replaceAll("</script", "<\\/script");
const style = await bundle("style.css");
// The browser runs this script and takes this style, and no others that find their way into the page.
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const html = readFileSync(own("index.html"), "utf8")
  .replace("STYLE-HASH", hash(style)).replace("SCRIPT-HASH", hash(script))
  .replace("/*STYLE*/", () => style).replace("/*SCRIPT*/", () => script);
writeFileSync(output, html);
console.log(`${output}: ${html.length} bytes, ${gzipSync(html).length} packed by gzip; the library ${readFileSync(module).length}, packed ${packed.length}`);
