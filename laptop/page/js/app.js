// The page: what its user drops, chooses and drags, and what the library makes of it.

import { at } from "./dom.js";
import { axes, plots } from "./drawings.js";
import { filesOf, together } from "./dropped.js";
import * as link from "./link.js";
import { board, connect, listenToLive, video, watch } from "./live.js";
import { loadChannel, open, whenRead } from "./recording.js";
import { showFile } from "./render-file.js";
import { showSearch, showTaken } from "./render-search.js";
import { showSettings } from "./render-settings.js";
import { endSearch, listenToSearch } from "./search.js";
import { listenToSettings, take, takeFlight, update } from "./settings.js";
import { changed, state, whenChanged } from "./state.js";
import { listenToTakeaway } from "./takeaway.js";

// For whoever looks in the console, and for checks.
globalThis.spikewire = { plots, video, board };

let rendered;

/** Shows the state, all of it. */
function render() {
  if (state.recording !== rendered) {
    rendered = state.recording;
    endSearch();
    axes.forget();
  }
  showFile();
  showSettings();
  showSearch(take);
  showTaken();
}

/** Takes files: a clip, what a board sent, a flight's file, or recordings. */
function takeFiles(files) {
  if (!files.length) return;
  if (files[0].type.startsWith("video/")) watch(files[0]);
  else if (files[0].name.endsWith(".link")) connect(files[0]);
  else if (files.length === 1 && files[0].name.endsWith(".toml")) takeFlight(files[0]);
  else openFiles(together(files), files);
}

function openFiles(files, dropped) {
  state.dropped = files.length < dropped.length ? dropped : [];
  return open({ files });
}

/** Opens the channel whose name was found. */
function find({ target }) {
  const option = [...at("channels").children].find(({ value }) => value === target.value);
  if (!option) return;
  target.value = "";
  const [topic, field] = JSON.parse(option.dataset.channel);
  loadChannel({ topic, field });
}

function listenToFiles() {
  at("choose").addEventListener("change", ({ target }) => takeFiles([...target.files]));
  for (const button of document.querySelectorAll("[data-example]")) {
    button.addEventListener("click", () => {
      state.dropped = [];
      open({ example: button.dataset.example });
    });
  }
  at("file-of").addEventListener("change", ({ target }) => open({ files: [state.dropped[target.value]] }));
  at("find").addEventListener("input", find);
  at("accept-cut").addEventListener("change", ({ target }) => {
    state.acceptsCut = target.checked;
    if (state.opened) open(state.opened, state.channel);
  });
  at("topic").addEventListener("change", ({ target }) => loadChannel({ topic: target.value, field: undefined }));
  at("field").addEventListener("change", ({ target }) => loadChannel({ field: target.value }));
  at("rate").addEventListener("change", ({ target }) => loadChannel({ rate: target.value }));
  at("skip").addEventListener("change", ({ target }) => loadChannel({ skip: target.checked }));
  axes.onChoice = (field) => loadChannel({ field });
  addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over"); });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("over"); });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    filesOf(event.dataTransfer).then(takeFiles);
  });
}

/** Takes the settings, the example and the channel that a link names behind `#`. */
function follow(hash) {
  const asked = link.read(hash);
  const known = asked.settings.filter(({ scheme }) => state.schemes.some(({ name }) => name === scheme));
  if (known.length) [state.settings, state.current] = [known, 0];
  if (asked.example || !state.opened?.topics.length) return open({ example: asked.example ?? "flight" }, asked.channel);
  return loadChannel(asked.channel);
}

async function begin() {
  whenChanged(render);
  whenRead(update);
  listenToFiles();
  listenToSettings();
  listenToTakeaway();
  listenToSearch();
  listenToLive();
  try {
    ({ schemes: state.schemes } = await state.library.ask({ ask: "catalogue" }));
    addEventListener("hashchange", ({ newURL }) => follow(new URL(newURL).hash));
    await follow(location.hash);
  } catch (error) {
    state.fileError = error;
    changed();
  }
}

begin();
