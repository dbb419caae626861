// Undo and redo: every state of the settings, as text.

const MOST = 200;
/** Changes of one box within this time, in ms, are one: a slider that is dragged. */
const TOGETHER = 600;

export class History {
  #states = [];
  #place = -1;
  #last = { what: undefined, time: 0 };

  /** Notes a state after a change of `what`. */
  note(what, state) {
    const text = JSON.stringify(state), now = performance.now();
    if (text === this.#states[this.#place]) return;
    const isSame = what !== undefined && what === this.#last.what && now - this.#last.time < TOGETHER && this.#place > 0;
    if (!isSame) this.#place++;
    this.#states.splice(this.#place, Infinity, text);
    if (this.#states.length > MOST) this.#states.shift(), this.#place--;
    this.#last = { what, time: now };
  }

  get canUndo() { return this.#place > 0; }
  get canRedo() { return this.#place + 1 < this.#states.length; }

  /** The state before, or after by a step of 1; undefined where there is none. */
  step(by) {
    const text = this.#states[this.#place + by];
    if (text === undefined) return undefined;
    this.#place += by;
    this.#last = { what: undefined, time: 0 };
    return JSON.parse(text);
  }
}
