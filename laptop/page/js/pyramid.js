// The lowest and highest value of any stretch of a long series, in few steps.

const BLOCK = 256;

export class Pyramid {
  constructor(values) {
    this.values = values;
    const blocks = Math.ceil(values.length / BLOCK);
    this.low = new Float64Array(blocks);
    this.high = new Float64Array(blocks);
    for (let block = 0; block < blocks; block++) {
      let low = Infinity, high = -Infinity;
      const end = Math.min((block + 1) * BLOCK, values.length);
      for (let at = block * BLOCK; at < end; at++) {
        const value = values[at];
        if (value < low) low = value;
        if (value > high) high = value;
      }
      this.low[block] = low;
      this.high[block] = high;
    }
  }

  at(sample) {
    return this.values[sample];
  }

  /** The lowest and highest of the samples from `start` to before `end`. */
  range(start, end) {
    let low = Infinity, high = -Infinity;
    const see = (lows, highs, from, to) => {
      for (let at = from; at < to; at++) {
        if (lows[at] < low) low = lows[at];
        if (highs[at] > high) high = highs[at];
      }
    };
    const first = Math.ceil(start / BLOCK), last = Math.floor(end / BLOCK);
    if (first >= last) {
      see(this.values, this.values, start, end);
    } else {
      see(this.values, this.values, start, first * BLOCK);
      see(this.low, this.high, first, last);
      see(this.values, this.values, last * BLOCK, end);
    }
    return [low, high];
  }
}

/** What a preview decoded: pieces of `length` samples, each `stride` behind the last; nothing is known between them. */
export class Pieces {
  constructor(values, { from, stride, length }) {
    Object.assign(this, { values, from, stride, length });
    this.count = values.length / Math.max(1, length);
  }

  at(sample) {
    const piece = Math.floor((sample - this.from) / this.stride), place = sample - this.from - piece * this.stride;
    return piece >= 0 && piece < this.count && place < this.length ? this.values[piece * this.length + place] : null;
  }

  /** The lowest and highest of what is known from `start` to before `end`, or of the piece before. */
  range(start, end) {
    let low = Infinity, high = -Infinity;
    const first = Math.max(0, Math.floor((start - this.from) / this.stride)), last = Math.min(this.count - 1, Math.floor((end - 1 - this.from) / this.stride));
    for (let piece = first; piece <= last; piece++) {
      const begin = this.from + piece * this.stride;
      const stop = Math.min(this.length, end - begin);
      for (let at = Math.min(Math.max(0, start - begin), stop - 1); at < stop; at++) {
        const value = this.values[piece * this.length + at];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    return low <= high ? [low, high] : [null, null];
  }
}

/** The first place of a sorted array, from `low` on, whose value is at least `value`. */
export function lowerBound(array, value, low = 0, high = array.length) {
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (array[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
