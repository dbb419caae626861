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

/** The first place of a sorted array, from `low` on, whose value is at least `value`. */
export function lowerBound(array, value, low = 0, high = array.length) {
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (array[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
