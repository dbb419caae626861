// A clip or the camera as an event camera would see it, live.

import { Library } from "./library.js";

const MOST = 320; // columns: as many as the small cameras of drones have

export class Video {
  #library;
  #video = Object.assign(document.createElement("video"), { muted: true, playsInline: true, loop: true });
  #stream;
  #running = 0;

  /** Draws frame and events side by side; `onFigures(text)` is told events a frame and a second. */
  constructor(canvas, onFigures) {
    [this.canvas, this.onFigures] = [canvas, onFigures];
    this.threshold = 10;
  }

  /** Starts with a file, or with the camera if there is none. */
  async start(file) {
    this.stop();
    const running = ++this.#running;
    this.#library ??= new Library();
    const video = this.#video;
    if (file) {
      video.src = URL.createObjectURL(file);
    } else {
      if (!navigator.mediaDevices) throw new Error("this browser lets no page from here use a camera");
      this.#stream = await navigator.mediaDevices.getUserMedia({ video: { width: { ideal: MOST } } });
      video.srcObject = this.#stream;
    }
    await new Promise((resolve, reject) => {
      video.onloadeddata = resolve;
      video.onerror = () => reject(new Error("this browser cannot decode the video"));
    });
    await video.play();
    this.#run(running);
  }

  stop() {
    this.#running++;
    this.#video.pause();
    if (this.#video.src) URL.revokeObjectURL(this.#video.src);
    this.#video.removeAttribute("src");
    this.#video.srcObject = null;
    for (const track of this.#stream?.getTracks() ?? []) track.stop();
    this.#stream = undefined;
  }

  /** The events of a frame: its grey levels, and for each pixel 2 for brighter, 1 for darker, or 0. */
  async encode(width, height, grey, isFirst) {
    const request = { ask: "frame", width, height, threshold: this.threshold, is_first: isFirst, file: 0 };
    this.#library ??= new Library();
    return this.#library.ask(request, { files: [new Blob([grey])] });
  }

  async #run(running) {
    const video = this.#video, { canvas } = this;
    const part = Math.min(1, MOST / video.videoWidth);
    const [width, height] = [video.videoWidth, video.videoHeight].map((own) => Math.max(1, Math.round(own * part)));
    Object.assign(canvas, { width: 2 * width, height });
    const context = canvas.getContext("2d", { willReadFrequently: true });
    const next = () => new Promise((done) => (video.requestVideoFrameCallback ? video.requestVideoFrameCallback(done) : requestAnimationFrame(done)));
    let threshold, events = [];
    while (true) {
      await next();
      if (running !== this.#running) return;
      context.drawImage(video, 0, 0, width, height);
      const image = context.getImageData(0, 0, width, height), { data } = image;
      const grey = new Uint8Array(width * height);
      for (let at = 0; at < grey.length; at++) grey[at] = (2126 * data[4 * at] + 7152 * data[4 * at + 1] + 722 * data[4 * at + 2]) / 10_000;
      let answer;
      try {
        answer = await this.encode(width, height, grey, threshold !== this.threshold);
      } catch (error) {
        this.onFigures(error.message);
        return this.stop();
      }
      threshold = this.threshold;
      if (running !== this.#running) return;
      for (let at = 0; at < grey.length; at++) {
        const [red, green, blue] = [[20, 22, 26], [240, 117, 133], [86, 180, 233]][answer.arrays.pixels[at]];
        data[4 * at] = red;
        data[4 * at + 1] = green;
        data[4 * at + 2] = blue;
      }
      context.putImageData(image, width, 0);
      const now = performance.now();
      events = [...events.filter(([time]) => time > now - 1000), [now, answer.events]];
      const sum = events.reduce((all, [, own]) => all + own, 0);
      this.onFigures(`${width} × ${height}: ${answer.events.toLocaleString("en")} events in this frame, ${sum.toLocaleString("en")} in the last second, of ${events.length} frames`);
    }
  }
}
