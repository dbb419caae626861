// The lowest and highest value of any stretch of a long series, in few steps.

const BLOCK = 256;

/** The lower and the higher of two ranges. */
const joined = ([a, b], [c, d]) => [Math.min(a, c), Math.max(b, d)];

/** A series of values or, if a second one is given, of its distances from that one, which take no memory of their own. */
export class Pyramid {
  constructor(values, from) {
    Object.assign(this, { values, from });
    const blocks = Math.ceil(values.length / BLOCK);
    this.low = new Float64Array(blocks);
    this.high = new Float64Array(blocks);
    for (let block = 0; block < blocks; block++) {
      [this.low[block], this.high[block]] = this.each(block * BLOCK, Math.min((block + 1) * BLOCK, values.length));
    }
  }

  at(sample) {
    return this.from ? this.values[sample] - this.from[sample] : this.values[sample];
  }

  /** The lowest and highest of some samples, looked at one by one. */
  each(start, end) {
    const { values, from } = this;
    let low = Infinity, high = -Infinity;
    for (let at = start; at < end; at++) {
      const value = from ? values[at] - from[at] : values[at];
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return [low, high];
  }

  /** The lowest and highest of the samples from `start` to before `end`. */
  range(start, end) {
    const first = Math.ceil(start / BLOCK), last = Math.floor(end / BLOCK);
    if (first >= last) return this.each(start, end);
    let low = Infinity, high = -Infinity;
    for (let block = first; block < last; block++) {
      if (this.low[block] < low) low = this.low[block];
      if (this.high[block] > high) high = this.high[block];
    }
    return joined(joined(this.each(start, first * BLOCK), [low, high]), this.each(last * BLOCK, end));
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
