// Sensors on SPI or I2C as their master sees them: registers, FIFO, status and the interrupt line. The samples are a recording's, or
// a signal with noise, in counts; each is kept with its time.

/// Six channels at a time in seconds: rates about x, y, z, then accelerations along them. Different on every axis.
function signal(t, noise) {
  const wave = (amplitude, hertz, phase) => amplitude * Math.sin(2 * Math.PI * hertz * t + phase);
  const rates = [wave(3000, 1.3, 0), wave(2000, 2.1, 1), wave(1000, 0.7, 2)];
  const accelerations = [wave(800, 3.1, 0), wave(600, 1.9, 1), 2048 + wave(400, 2.3, 2)];
  return [...rates, ...accelerations].map((value) => Math.round(value) + noise());
}

class Sensor {
  constructor(period) {
    this.period = period;
    this.samples = [];
    this.reads = 0;
    this.noise = 12345;
    this.pulse = -Infinity;
    this.last = [0, 0, 0, 0, 0, 0];
    this.powerOn(0);
  }

  powerOff() {
    this.isOn = false;
  }

  powerOn(now) {
    this.isOn = true;
    this.next = now + this.period;
    this.reset();
  }

  /// Goes on to this time in ns; returns the level of INT1.
  advance(now) {
    while (this.next <= now) {
      if (this.isOn && this.isSampling) this.sample(this.next);
      this.next += this.period;
    }
    return this.isOn && now - this.pulse < 10_000;
  }

  /// Takes the samples from a recording from now on: lines of a time in s, three rates in rad/s and three accelerations in m/s².
  /// A sample stands until the recording's next one, and the last one for ever.
  fly(recording) {
    this.recording = recording.trim().split("\n").map((line) => line.split(",").map(Number));
    this.row = 0;
  }

  /// The counts of the recording at this time in ns, in the full scale that is configured.
  recorded(at) {
    const rows = this.recording;
    while (this.row + 1 < rows.length && rows[this.row + 1][0] * 1e9 <= at) this.row += 1;
    const [rate, acceleration] = this.fullScale;
    const scales = Array.from({ length: 6 }, (_, axis) => (axis < 3 ? (rate * Math.PI) / 180 : acceleration * 9.80665) / 32768);
    return scales.map((scale, axis) => Math.max(-32768, Math.min(32767, Math.round(rows[this.row][1 + axis] / scale))));
  }

  take(at) {
    const noise = () => ((this.noise = (Math.imul(this.noise, 1664525) + 1013904223) >>> 0) >>> 30) - 2;
    const fresh = this.recording ? this.recorded(at) : signal(at / 1e9, noise);
    if (!this.isFrozen) this.last = fresh.map((count, axis) => (this.isHalfFrozen && axis >= 3 ? this.last[axis] : count));
    this.samples.push(`${Math.round(at / 1e3)},${this.last.join(",")}`);
    return this.last;
  }

  select() {
    this.at = 0;
  }

  deselect() {}

  /// The byte on MISO for one on MOSI; undefined if the sensor does not drive the line.
  transfer(byte, now) {
    if (!this.isOn) return undefined;
    return this.answer(byte, this.at++, now);
  }
}

/// BMI323, by its data sheet (BST-BMI323-DS000) and the vendor's driver (boschsensortec/BMI323_SensorAPI, `bmi323_defs.h`):
/// words of 16 bits, a dummy byte before those that are read, I2C until chip select has risen once.
export class Bmi323 extends Sensor {
  constructor() {
    super(1e9 / 800);
  }

  reset() {
    this.words = new Uint16Array(128);
    this.words[0x00] = 0x0043; // CHIP_ID
    this.words[0x02] = 0x0001; // STATUS: por_detected
    this.words.fill(0x8000, 0x03, 0x09); // no data yet
    this.words[0x20] = 0x0028; // ACC_CONF
    this.words[0x21] = 0x0048; // GYR_CONF
    this.isSpi = false;
  }

  /// Both sensors in high performance at 800 Hz, data-ready of the gyroscope on INT1, which is on.
  get isConfigured() {
    const [accelerometer, gyroscope] = [this.words[0x20], this.words[0x21]];
    return accelerometer === 0x703b && gyroscope === 0x704b && this.words[0x3b] >> 8 === 1 && (this.words[0x38] & 5) === 5;
  }

  get isSampling() {
    return this.words[0x21] >> 12 === 7 && this.words[0x20] >> 12 === 7;
  }

  /// In °/s and g, as GYR_CONF and ACC_CONF have them.
  get fullScale() {
    return [125 << ((this.words[0x21] >> 4) & 7), 2 << ((this.words[0x20] >> 4) & 7)];
  }

  sample(at) {
    const [rx, ry, rz, ax, ay, az] = this.take(at);
    this.words.set([ax, ay, az, rx, ry, rz], 0x03);
    this.words[0x02] |= 0xc0; // drdy_gyr, drdy_acc
    if (this.words[0x3b] >> 8 === 1 && this.words[0x38] & 4) this.pulse = at;
  }

  deselect() {
    if (this.isOn) this.isSpi = true;
  }

  answer(byte, at) {
    if (at === 0) [this.address, this.isRead, this.bytes] = [byte & 0x7f, byte & 0x80, []];
    if (!this.isSpi) return undefined;
    if (at === 0) return 0;
    if (!this.isRead) {
      this.bytes.push(byte);
      if (this.bytes.length === 2) this.write(this.address, this.bytes[0] | (this.bytes[1] << 8));
      return 0;
    }
    if (at === 1) return 0;
    const register = (this.address + ((at - 2) >> 1)) & 0x7f;
    if (at % 2 === 0) this.held = this.words[register];
    if (at % 2 === 0 && register === 0x02) this.words[0x02] = 0; // clears on read
    if (at % 2 === 0 && register === 0x08) this.reads += 1;
    return at % 2 === 0 ? this.held & 0xff : this.held >> 8;
  }

  write(register, word) {
    if (register === 0x7e && word === 0xdeaf) this.reset();
    else if (register >= 0x20 && register < 0x7e) this.words[register] = word;
  }
}

/// ICM-42688-P, by its data sheet (DS-000347, section 14) and Betaflight's driver (`accgyro_spi_icm426xx.c`): a FIFO of 2048
/// bytes in packets of 16, a status that a read clears and a flush does not.
export class Icm42688p extends Sensor {
  constructor() {
    super(1e9 / 8000);
    this.identity = 0x47; // WHO_AM_I
  }

  reset() {
    this.bytes = new Uint8Array(128);
    this.bytes.set([0x91], 0x4d);
    this.bytes.set([0x10], 0x64);
    this.bytes.set([0x06, 0x06], 0x4f);
    this.bytes.set([0x10], 0x2d); // INT_STATUS: reset done
    for (let axis = 0; axis < 6; axis++) this.bytes.set([0x80, 0x00], 0x1f + 2 * axis); // no data yet
    this.fifo = [];
  }

  get isConfigured() {
    const inFifo = { 0x4f: 0x03, 0x50: 0x03, 0x5f: 0x27, 0x60: 0x80, 0x16: 0x40, 0x65: 0x04 };
    // Read from its registers: at whatever rate, the same of both.
    const inRegisters = { 0x16: 0x00, 0x50: this.bytes[0x4f] };
    const expected = { 0x4e: 0x0f, ...(this.bytes[0x16] === 0 ? inRegisters : inFifo) };
    return Object.entries(expected).every(([register, value]) => this.bytes[register] === value);
  }

  get isSampling() {
    return this.bytes[0x4e] === 0x0f;
  }

  /// In °/s and g, as GYRO_CONFIG0 and ACCEL_CONFIG0 have them.
  get fullScale() {
    return [2000 / (1 << (this.bytes[0x4f] >> 5)), 16 / (1 << (this.bytes[0x50] >> 5))];
  }

  sample(at) {
    const [rx, ry, rz, ax, ay, az] = this.take(at);
    [ax, ay, az, rx, ry, rz].forEach((count, axis) => this.bytes.set([(count >> 8) & 0xff, count & 0xff], 0x1f + 2 * axis));
    this.bytes[0x2d] |= 0x08; // DATA_RDY
    if (this.bytes[0x16] >> 6 !== 1) return;
    const packet = new DataView(new ArrayBuffer(16));
    packet.setUint8(0, 0x68);
    [ax, ay, az, rx, ry, rz].forEach((count, axis) => packet.setInt16(1 + 2 * axis, count));
    this.fifo.push(...new Uint8Array(packet.buffer));
    if (this.fifo.length > 2048) {
      this.fifo.splice(0, 16);
      this.bytes[0x2d] |= 0x02; // FIFO_FULL
    }
    // For each packet above the watermark.
    if (this.fifo.length < this.bytes[0x60]) return;
    this.bytes[0x2d] |= 0x04;
    if (this.bytes[0x65] & 0x04) this.pulse = at;
  }

  answer(byte, at) {
    if (at === 0) {
      [this.address, this.isRead] = [byte & 0x7f, byte & 0x80];
      return 0;
    }
    const register = this.address < 0x30 && this.address + at - 1 >= 0x30 && this.isRead ? 0x30 : this.address + at - 1;
    if (!this.isRead) {
      this.write(register, byte);
      return 0;
    }
    if (register === 0x2d) {
      const status = this.bytes[0x2d];
      this.bytes[0x2d] = 0;
      this.count = this.fifo.length;
      return status;
    }
    if (register === 0x2e) return this.count >> 8;
    if (register === 0x2f) return this.count & 0xff;
    if (register === 0x30) {
      if (at === 4) this.reads += 1;
      return this.fifo.length > 0 ? this.fifo.shift() : 0xff;
    }
    return register === 0x75 ? this.identity : this.bytes[register];
  }

  write(register, value) {
    if (register === 0x11 && value & 1) this.reset();
    else if (register === 0x4b && value & 2) this.fifo = [];
    else this.bytes[register] = value;
    // GYRO_CONFIG0: 8 kHz, 4, 2 or 1. The accelerometer's is the same, or nobody has configured it.
    if (register === 0x4f) this.period = { 3: 125e3, 4: 250e3, 5: 500e3, 6: 1e6 }[value & 15] ?? this.period;
  }
}

/// BMI088 on I2C, by its data sheet (BST-BMI088-DS001): two dies, each with an address, and the rates' pulse on INT3.
export class Bmi088 extends Sensor {
  constructor() {
    super(1e9 / 1000);
  }

  reset() {
    this.dies = { 0x18: this.fresh(0x18), 0x69: this.fresh(0x69) };
  }

  fresh(die) {
    const bytes = new Uint8Array(128);
    if (die === 0x18) {
      bytes[0x00] = 0x1e; // ACC_CHIP_ID
      bytes.set([0xa8, 0x01], 0x40); // ACC_CONF, ACC_RANGE
      bytes[0x7c] = 0x03; // ACC_PWR_CONF: suspended
    } else {
      bytes[0x00] = 0x0f; // GYRO_CHIP_ID
      bytes[0x10] = 0x80; // GYRO_BANDWIDTH: 2000 Hz
      bytes[0x16] = 0x0f; // INT3_INT4_IO_CONF
    }
    return bytes;
  }

  /// ±24 g at 1600 Hz, ±2000 °/s at 1000 Hz, data-ready on INT3: push-pull, active high.
  get isConfigured() {
    const has = (die, settings) => Object.entries(settings).every(([register, value]) => this.dies[die][register] === value);
    return has(0x18, { 0x7c: 0, 0x7d: 4, 0x40: 0x8c, 0x41: 3 }) && has(0x69, { 0x0f: 0, 0x10: 0x82, 0x15: 0x80, 0x16: 1, 0x18: 1 });
  }

  get isSampling() {
    return this.dies[0x69][0x10] === 0x82;
  }

  /// In °/s and g, as GYRO_RANGE and ACC_RANGE have them.
  get fullScale() {
    return [2000 / (1 << (this.dies[0x69][0x0f] & 7)), 3 << (this.dies[0x18][0x41] & 3)];
  }

  sample(at) {
    const [rx, ry, rz, ax, ay, az] = this.take(at);
    const set = (die, first, counts) =>
      counts.forEach((count, axis) => this.dies[die].set([count & 0xff, (count >> 8) & 0xff], first + 2 * axis));
    set(0x69, 0x02, [rx, ry, rz]);
    if (this.dies[0x18][0x7d] === 4 && this.dies[0x18][0x7c] === 0) set(0x18, 0x12, [ax, ay, az]);
    if (this.dies[0x69][0x15] === 0x80 && this.dies[0x69][0x18] & 1) this.pulse = at;
  }

  /// The address with its direction; says whether a die acknowledges.
  begin(byte) {
    this.die = byte >> 1;
    if (!(byte & 1)) this.register = undefined;
    return this.isOn && this.die in this.dies;
  }

  put(byte) {
    if (!this.isOn) return false;
    if (this.register === undefined) this.register = byte & 0x7f;
    else this.write(this.register++, byte);
    return true;
  }

  get() {
    if (!this.isOn) return -1;
    if (this.register === 0x17) this.reads += 1;
    return this.dies[this.die][this.register++ & 0x7f];
  }

  write(register, value) {
    const isAccelerometer = this.die === 0x18;
    if (register === (isAccelerometer ? 0x7e : 0x14) && value === 0xb6) this.dies[this.die] = this.fresh(this.die);
    else this.dies[this.die][register] = !isAccelerometer && register === 0x10 ? value | 0x80 : value; // that bit is always 1
  }
}
