// The page: what its user drops, chooses and drags, and what the library makes of it.

import { at, fail } from "./dom.js";
import { filesOf, offer } from "./dropped.js";
import * as link from "./link.js";
import { board, listenToLive, video, watch } from "./live.js";
import { channel, load, open, showFields, showTopics, whenRead } from "./recording.js";
import { endSearch, listenToSearch } from "./search.js";
import { forgetDrawings, listenToSettings, plots, showRecording, takeFlight } from "./settings.js";
import { state } from "./state.js";
import { listenToTakeaway } from "./takeaway.js";

const SAMPLES = ["f32", "i16", "q1.15", "q8.8", "i32", "q16.16"];

// For whoever looks in the console, and for checks.
globalThis.spikewire = { plots, video, board };

let dropped = [];

/** Takes files: a clip, a flight's file, or recordings. */
function take(files) {
  if (!files.length) return;
  if (files[0].type.startsWith("video/")) watch(files[0]);
  else if (files.length === 1 && files[0].name.endsWith(".toml")) takeFlight(files[0]);
  else open({ files: offer(dropped = files) });
}

/** Opens the channel whose name was found. */
function find({ target }) {
  const [topic, field] = JSON.parse([...at("channels").children].find(({ value }) => value === target.value)?.dataset.channel ?? "[]");
  if (field === undefined) return;
  target.value = "";
  at("topic").value = topic;
  showFields(field);
  load();
}

function listenToFiles() {
  at("choose").addEventListener("change", ({ target }) => {
    take([...target.files]);
  });
  for (const button of document.querySelectorAll("[data-example]")) button.addEventListener("click", () => { offer([]); open({ example: button.dataset.example }); });
  at("file-of").addEventListener("change", ({ target }) => open({ files: [dropped[target.value]] }));
  at("find").addEventListener("input", find);
  at("accept-cut").addEventListener("change", () => state.opened && open(state.opened, channel()));
  at("topic").addEventListener("change", () => { showFields(); load(); });
  for (const id of ["field", "rate", "skip"]) at(id).addEventListener("change", load);
  addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over"); });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("over"); });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    filesOf(event.dataTransfer).then(take);
  });
}

/** Takes the settings, the example and the channel that a link names behind `#`. */
async function follow(hash) {
  const asked = link.read(hash);
  const known = asked.settings.filter(({ scheme }) => state.schemes.some(({ name }) => name === scheme));
  if (known.length) [state.settings, state.current] = [known, 0];
  if (asked.example || !state.opened?.topics.length) return open({ example: asked.example ?? "flight" }, asked.channel);
  showTopics(asked.channel);
  return load();
}

async function begin() {
  whenRead(showRecording, () => { endSearch(); forgetDrawings(); });
  listenToFiles();
  listenToSettings();
  listenToTakeaway();
  listenToSearch();
  listenToLive();
  try {
    ({ schemes: state.schemes } = await state.library.ask({ ask: "catalogue" }));
    at("scheme").replaceChildren(...state.schemes.map(({ title, words, name }) => new Option(`${title}: ${words}`, name)));
    at("sample").replaceChildren(...SAMPLES.map((name) => new Option(name)));
    addEventListener("hashchange", ({ newURL }) => follow(new URL(newURL).hash));
    await follow(location.hash);
  } catch (error) {
    fail("file-error", error);
  }
}

begin();
