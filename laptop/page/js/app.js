// The page: what its user drops, chooses and drags, and what the library makes of it.

import { at } from "./dom.js";
import { listenToDrawer, showDrawer } from "./drawer.js";
import { axes, plots } from "./drawings.js";
import { filesOf, together } from "./dropped.js";
import * as link from "./link.js";
import { board, connect, listenToLive, video, watch } from "./live.js";
import { goBack, loadChannel, open, reopen, whenRead } from "./recording.js";
import { showFile } from "./render-file.js";
import { showSearch, showTaken } from "./render-search.js";
import { showSettings } from "./render-settings.js";
import { endSearch, listenToSearch } from "./search.js";
import { listenToSettings, take, takeFlight, update } from "./settings.js";
import { changed, state, whenChanged } from "./state.js";
import { listenToTakeaway } from "./takeaway.js";
import { setAnswer, unitOf } from "./units.js";

// For whoever looks in the console, and for checks.
globalThis.spikewire = { plots, video, board };

let rendered;

/** Opens a channel that was found. */
function find(channel) {
  at("find").value = "";
  loadChannel(channel);
}

/** Shows the state, all of it. */
function render() {
  if (state.recording !== rendered) {
    rendered = state.recording;
    endSearch();
    axes.forget();
  }
  document.body.dataset.page = state.page;
  for (const button of document.querySelectorAll("[data-goes]")) {
    if (button.dataset.goes === state.page) button.setAttribute("aria-current", "page");
    else button.removeAttribute("aria-current");
  }
  showFile({ find });
  showDrawer();
  showSettings();
  showSearch(take);
  showTaken();
}

function go(page) {
  state.page = page;
  changed();
}

/** Takes files: a clip, what a board sent, a flight's file, or recordings. */
function takeFiles(files) {
  if (!files.length) return;
  const isClip = files[0].type.startsWith("video/"), isLink = files[0].name.endsWith(".link");
  go(isClip ? "video" : isLink ? "board" : "log");
  if (isClip) watch(files[0]);
  else if (isLink) connect(files[0]);
  else if (files.length === 1 && files[0].name.endsWith(".toml")) takeFlight(files[0]);
  else openFiles(together(files), files);
}

/** Opens files; the one that a link waits for, with the link's channel and settings. */
function openFiles(files, dropped) {
  state.dropped = files.length < dropped.length ? dropped : [];
  const { awaited } = state;
  state.awaited = undefined;
  if (awaited?.file !== files[0].name) return open({ files });
  [state.settings, state.current] = [awaited.settings, 0];
  return open({ files }, awaited.channel);
}

function openExample(example) {
  Object.assign(state, { dropped: [], awaited: undefined });
  return open({ example });
}

/** Reads the same file again, with what the user says about its table. */
function ofTable(part) {
  state.table = { ...state.table, ...part };
  if (state.asked) reopen();
}

function listenToFiles() {
  at("choose").addEventListener("change", ({ target }) => takeFiles([...target.files]));
  at("example").addEventListener("change", ({ target }) => {
    if (target.value) openExample(target.value);
    target.value = "";
  });
  at("file-of").addEventListener("change", ({ target }) => open({ files: [state.dropped[target.value]] }));
  at("find").addEventListener("input", changed);
  at("accept-cut").addEventListener("change", ({ target }) => {
    state.acceptsCut = target.checked;
    if (state.asked) reopen();
  });
  at("back").addEventListener("click", goBack);
  at("topic").addEventListener("change", ({ target }) => loadChannel({ topic: target.value, field: undefined }));
  at("field").addEventListener("change", ({ target }) => loadChannel({ field: target.value }));
  at("rate").addEventListener("change", ({ target }) => loadChannel({ rate: target.value }));
  at("skip").addEventListener("change", ({ target }) => loadChannel({ skip: target.checked }));
  at("time-unit").addEventListener("change", ({ target }) => ofTable({ timeUnit: target.value }));
  at("header").addEventListener("change", ({ target }) => ofTable({ header: target.value }));
  at("unit").addEventListener("change", ({ target }) => {
    const { recording } = state;
    setAnswer(recording, recording.field, target.value || undefined);
    recording.unit = unitOf(recording);
    plots.rebuild();
    update();
  });
  axes.onUnit = () => update();
  axes.onChoice = (field) => loadChannel({ field });
  addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over"); });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("over"); });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    filesOf(event.dataTransfer).then(takeFiles);
  });
  for (const button of document.querySelectorAll("[data-goes]")) button.addEventListener("click", () => go(button.dataset.goes));
  at("chip").addEventListener("click", () => {
    state.isVerdictOpen = !state.isVerdictOpen;
    changed();
  });
}

/** Takes the settings, the example and the channel that a link names behind `#`. */
function follow(hash) {
  const asked = link.read(hash);
  const known = asked.settings.filter(({ scheme }) => state.schemes.some(({ name }) => name === scheme));
  if (known.length) [state.settings, state.current] = [known, 0];
  const isHere = state.opened?.topics.length && (!asked.file || asked.file === state.opened.file);
  state.awaited = asked.file && !isHere ? { file: asked.file, channel: asked.channel, settings: structuredClone(state.settings) } : undefined;
  if (asked.example || !state.opened?.topics.length) return open({ example: asked.example ?? "flight" }, asked.channel);
  return isHere ? loadChannel(asked.channel) : update();
}

async function begin() {
  whenChanged(render);
  whenRead(update);
  listenToFiles();
  listenToDrawer();
  listenToSettings();
  listenToTakeaway();
  listenToSearch();
  listenToLive();
  try {
    ({ schemes: state.schemes, units: state.units } = await state.library.ask({ ask: "catalogue" }));
    addEventListener("hashchange", ({ newURL }) => follow(new URL(newURL).hash));
    await follow(location.hash);
  } catch (error) {
    state.fileError = error;
    changed();
  }
}

begin();
