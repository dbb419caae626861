// When samples are.

import { lowerBound } from "./pyramid.js";

/** Times in seconds where these are known, else the numbers of samples. */
export class Times {
  constructor(count, rate, times) {
    [this.count, this.rate, this.times] = [count, rate, times];
    this.unit = times || rate ? "s" : "sample";
    this.step = 1 / (rate ?? 1);
  }
  at(sample) {
    if (sample >= this.count) return this.at(this.count - 1) + (sample - this.count + 1) * this.step;
    return this.times ? this.times[sample] : sample * this.step;
  }
  /** The first sample at a time or later. */
  first(time) {
    const sample = this.times ? lowerBound(this.times, time) : Math.ceil(time / this.step - 1e-9);
    return Math.max(0, Math.min(this.count, sample));
  }
}
