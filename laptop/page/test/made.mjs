// Files and links that the tests make.

import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { spikewire, work } from "./harness.mjs";

/** What a board of two addresses sends: keyframes now and then, and a frame that was damaged on its way. */
export function link() {
  const lines = ["tick,address,polarity"];
  const kept = [0, 0];
  for (let step = 0; step < 900; step++) {
    const tick = 1000 + step * 1000;
    if (step % 300 === 0) {
      kept.forEach((value, address) => {
        const bits = Buffer.alloc(4);
        bits.writeFloatBE(value);
        lines.push(`# keyframe=${tick},${address},${bits.toString("hex")},f32`);
      });
    }
    else if (step % 60 === 0) lines.push(`# heartbeat=${tick},0`); // which ends a frame
    const address = (step * 7) % 2, up = Math.sin(step / 40 + address) > 0;
    kept[address] = Math.fround(kept[address] + Math.fround(up ? 0.35 : -0.35));
    lines.push(`${tick},${address},${up ? 1 : -1}`);
  }
  const [events, file] = [join(work, "sent.csv"), join(work, "sent.link")];
  writeFileSync(events, `${lines.join("\n")}\n`);
  spikewire("convert", "--from", "csv", "--to", "link,period=1000,channels=4", events, "-o", file);
  const bytes = readFileSync(file);
  bytes[Math.floor(bytes.length / 2)] ^= 0x10;
  return bytes;
}

const number = (bits, value) => {
  const own = Buffer.alloc(bits / 8);
  if (bits === 64) own.writeBigUInt64LE(BigInt(value));
  else own.writeUIntLE(value, 0, bits / 8);
  return own;
};
const float = (value) => Buffer.from(new Float32Array([value]).buffer);
const double = (value) => Buffer.from(new Float64Array([value]).buffer);
const long = (bytes, bits = 32) => Buffer.concat([number(bits, Buffer.from(bytes).length), Buffer.from(bytes)]);
const wave = (sample, axis) => Math.sin(sample * 0.1 + axis);
const SAMPLES = 200;
const each = (make) => Array.from({ length: SAMPLES }, (_, sample) => make(sample));

/** A PX4 log: topics by name, each with its fields and what they are at a sample, behind the time. */
export function ulog(topics = { gyro: { fields: "float rate;", at: (sample) => float(Math.sin(sample * 0.1)) } }) {
  const message = (kind, content) => Buffer.concat([number(16, content.length), Buffer.from(kind), content]);
  const all = [Buffer.from("ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0", "latin1")];
  const named = Object.entries(topics);
  for (const [name, { fields }] of named) all.push(message("F", Buffer.from(`${name}:uint64_t timestamp;${fields}`)));
  named.forEach(([name], id) => all.push(message("A", Buffer.concat([number(8, 0), number(16, id), Buffer.from(name)]))));
  for (let sample = 0; sample < SAMPLES; sample++) {
    named.forEach(([, { at }], id) => all.push(message("D", Buffer.concat([number(16, id), number(64, 1_000_000 + sample * 5000), at(sample)]))));
  }
  return Buffer.concat(all);
}

/** The flight controller's topics in the order in which it logs them: a status first, the gyroscope late. */
export const px4 = () => ulog({
  actuator_outputs: { fields: "float[4] output;uint32_t noutputs;", at: (sample) => Buffer.concat([...[0, 1, 2, 3].map(() => float(1000 + sample)), number(32, 4)]) },
  actuator_armed: { fields: "bool armed;", at: () => number(8, 1) },
  sensor_combined: {
    fields: "float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;",
    at: (sample) => Buffer.concat([...[0, 1, 2].map((axis) => float(wave(sample, axis))), number(32, 5000), number(32, 0), ...[0, 1, 2].map((axis) => float(9 * wave(sample, axis))), number(32, 5000)]),
  },
});

/** A log of a newer one, with the raw gyroscope, what the filter makes of it, and what is wanted. */
export const px4Raw = () => {
  const axes = (sample) => [0, 1, 2].map((axis) => float(wave(sample, axis)));
  return ulog({
    vehicle_rates_setpoint: { fields: "float roll;float pitch;float yaw;", at: (sample) => Buffer.concat(axes(sample)) },
    sensor_gyro: {
      fields: "uint64_t timestamp_sample;uint32_t device_id;float x;float y;float z;float temperature;uint32_t error_count;",
      at: (sample) => Buffer.concat([number(64, 1_000_000 + sample * 5000), number(32, 7), ...axes(sample), float(40), number(32, 0)]),
    },
  });
};

const IMU = `std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
====
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
====
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
====
MSG: std_msgs/Header
`;
const START = 1_700_000_000;
const stamp = (sample) => Buffer.concat([number(32, START + Math.floor(sample / SAMPLES)), number(32, (sample % SAMPLES) * 5_000_000)]);
const imu = (sample) => {
  const three = [0, 1, 2].map((axis) => double(wave(sample, axis))), none = Array(9).fill(double(0));
  return Buffer.concat([...[0, 0, 0, 1].map(double), ...none, ...three, ...none, ...three, ...none]);
};

/** A ROS bag with a clock and an inertial sensor. */
export function bag() {
  const fields = (all) => Buffer.concat(Object.entries(all).map(([name, value]) => long(Buffer.concat([Buffer.from(`${name}=`), Buffer.from(value)]))));
  const record = (head, data) => Buffer.concat([long(fields(head)), long(data)]);
  const connection = (conn, topic, type, words) => record({ op: [7], conn: number(32, conn), topic }, fields({ topic, type, md5sum: "*", message_definition: words }));
  const message = (conn, sample, data) => record({ op: [2], conn: number(32, conn), time: stamp(sample) }, data);
  const content = Buffer.concat([
    connection(0, "/clock", "rosgraph_msgs/Clock", "time clock\n"),
    connection(1, "/imu/data", "sensor_msgs/Imu", `${IMU}uint32 seq\ntime stamp\nstring frame_id\n`),
    ...each((sample) => Buffer.concat([message(0, sample, stamp(sample)), message(1, sample, Buffer.concat([number(32, sample), stamp(sample), long("imu"), imu(sample)]))])),
  ]);
  return Buffer.concat([
    Buffer.from("#ROSBAG V2.0\n"), record({ op: [3], index_pos: number(64, 0), conn_count: number(32, 2), chunk_count: number(32, 1) }, " ".repeat(4027)),
    record({ op: [5], compression: "none", size: number(32, content.length) }, content),
  ]);
}

/** The same as ROS 2 records it. */
export function mcap() {
  const entry = (kind, ...parts) => { const all = Buffer.concat(parts); return Buffer.concat([Buffer.from([kind]), number(64, all.length), all]); };
  const schema = (id, name, words) => entry(3, number(16, id), long(name), long("ros2msg"), long(words));
  const topic = (id, name) => entry(4, number(16, id), number(16, id), long(name), long("cdr"), number(32, 0));
  const message = (id, sample, data) => {
    const time = number(64, BigInt(START) * 1_000_000_000n + BigInt(sample * 5_000_000));
    return entry(5, number(16, id), number(32, sample), time, time, Buffer.from([0, 1, 0, 0]), data);
  };
  const magic = Buffer.from("\x89MCAP0\r\n", "latin1");
  const time = "====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
  return Buffer.concat([
    magic, entry(1, long("ros2"), long("test")),
    schema(1, "rosgraph_msgs/msg/Clock", `builtin_interfaces/Time clock\n${time}`), topic(1, "/clock"),
    schema(2, "sensor_msgs/msg/Imu", `${IMU}builtin_interfaces/Time stamp\nstring frame_id\n${time}`), topic(2, "/imu/data"),
    ...each((sample) => Buffer.concat([message(1, sample, stamp(sample)), message(2, sample, Buffer.concat([stamp(sample), long("imu\0"), imu(sample)]))])),
    entry(15, number(32, 0)), entry(2, Buffer.alloc(20)), magic,
  ]);
}

/** A blackbox log of full frames alone, at 2000 a second, whose head tells the accelerometer's counts. */
export function blackbox(frames) {
  const fields = ["loopIteration", "time", ...[0, 1, 2].map((axis) => `gyroADC[${axis}]`), ...[0, 1, 2].map((axis) => `accSmooth[${axis}]`)];
  const head = Buffer.from(`H Product:Blackbox flight data recorder by Nicholas Sherlock\nH Data version:2\nH I interval:1\nH P interval:1/1\nH acc_1G:2048\nH Field I name:${fields}\nH Field I signed:0,0,1,1,1,1,1,1\nH Field I predictor:0,0,0,0,0,0,0,0\nH Field I encoding:1,1,0,0,0,0,0,0\nH Field P predictor:6,2,1,1,1,1,1,1\nH Field P encoding:9,0,0,0,0,0,0,0\n`);
  const bytes = Buffer.alloc(head.length + 32 * frames);
  let at = head.copy(bytes);
  const unsigned = (value) => {
    let rest = value;
    for (; rest > 127; rest = Math.floor(rest / 128)) bytes[at++] = (rest % 128) + 128;
    bytes[at++] = rest;
  };
  const signed = (value) => unsigned(value < 0 ? -2 * value - 1 : 2 * value);
  for (let frame = 0; frame < frames; frame++) {
    bytes[at++] = "I".charCodeAt(0);
    unsigned(frame);
    unsigned(1_000_000 + 500 * frame);
    for (const axis of [0, 1, 2]) signed(Math.round(100 * Math.sin(frame * 0.01 + axis)));
    for (const axis of [0, 1, 2]) signed(Math.round(1000 * Math.sin(frame * 0.01 + axis) + (axis === 2 ? 2048 : 0)));
  }
  return bytes.subarray(0, at);
}

/** A table as EuRoC's, whose names have commas, quotes and units. */
export const euroc = () => `"#timestamp [ns]","counter","w_RS_S_x [rad s^-1]","w_RS_S_y [rad s^-1]","w_RS_S_z [rad s^-1]","a_RS_S_x, raw [m s^-2]","a_RS_S_y, raw [m s^-2]","a_RS_S_z, ""raw"" [m s^-2]"\n`
  + each((sample) => `${sample * 5_000_000},${sample},${[0, 1, 2].map((axis) => wave(sample, axis)).join()},${[0, 1, 2].map((axis) => 9 * wave(sample, axis)).join()}\n`).join("");

/** A blackbox log that \`blackbox_decode\` made a table of. */
export const decoded = () => `loopIteration, time (us), axisP[0], axisP[1], axisP[2], gyroADC[0] (deg/s), gyroADC[1] (deg/s), gyroADC[2] (deg/s), motor[0]\n`
  + each((sample) => `${sample}, ${sample * 500}, 1, 2, 3, ${[0, 1, 2].map((axis) => Math.round(100 * wave(sample, axis))).join(", ")}, 1500\n`).join("");
