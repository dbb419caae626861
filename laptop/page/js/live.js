// What comes live: a clip or a camera as events, and a board on a serial port.

import { Board, serialPort, whyNot } from "./board.js";
import { at, fail } from "./dom.js";
import { choiceOf, current, outcome, state } from "./state.js";
import { save } from "./takeaway.js";
import { Video } from "./video.js";

export const video = new Video(at("events"), (text) => (at("video-figures").textContent = text));
export const board = new Board(at("heard"), (text) => (at("board-figures").textContent = text));

export async function watch(file) {
  fail("video-error");
  try {
    await video.start(file);
    at("events").hidden = at("end").hidden = false;
  } catch (error) {
    fail("video-error", new Error(`${file?.name ?? "camera"}: ${error.message}`));
  }
}

function endVideo() {
  video.stop();
  at("end").hidden = true;
}

/** Listens to a board, or plays a file of what one sent. */
export async function connect(file) {
  const why = whyNot(Boolean(file));
  fail("board-error", why && new Error(why));
  if (why || at("connect").disabled) return;
  at("connect").disabled = true;
  try {
    let choice = null;
    if (at("meaning").value === "values") {
      const { answer, error } = outcome();
      if (!answer) throw error ?? new Error("there are no settings to decode by");
      choice = { ...choiceOf(current(), state.recording.field), parameters: answer.asked };
    }
    const thresholds = at("thresholds").value.split(",").filter((text) => text.trim()).map(Number);
    if (thresholds.some(Number.isNaN)) throw new Error(`thresholds ${at("thresholds").value}: not numbers with commas between`);
    const options = { choice, thresholds: choice ? thresholds : [], slot_ticks: at("slot-ticks").valueAsNumber || null };
    const onStart = () => {
      at("heard").hidden = at("hang-up").hidden = false;
      at("board-files").hidden = true;
    };
    at("board-words").textContent = (await board.listen(() => (file ? { readable: file.stream() } : serialPort(at("baud").valueAsNumber)), options, onStart)).join("; ");
    at("board-files").hidden = false;
  } catch (error) {
    fail("board-error", error);
  }
  at("connect").disabled = false;
  at("hang-up").hidden = true;
}

export function listenToLive() {
  at("clip").addEventListener("change", ({ target }) => target.files.length && watch(target.files[0]));
  at("camera").addEventListener("click", () => watch());
  at("end").addEventListener("click", endVideo);
  at("levels").addEventListener("input", ({ target }) => { video.threshold = target.valueAsNumber; at("level").textContent = target.value; });
  at("connect").addEventListener("click", () => connect());
  at("hang-up").addEventListener("click", () => board.stop());
  for (const button of document.querySelectorAll("[data-heard]")) button.addEventListener("click", () => save(`${button.dataset.heard}.csv`, board.files[button.dataset.heard], "text/csv"));
  if (whyNot()) at("board-words").textContent = `Not here: ${whyNot()}.`;
}
