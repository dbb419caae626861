// Units of inertial sensors: told by the log, by the names of its fields, or by the user, who is asked once.

import { groupOf } from "./channels.js";
import { state } from "./state.js";

/** Counts have no size that a user could know. */
const COUNTS = { name: "counts" };
/** PX4's logs and the page's examples are in SI units. */
const SI = /\.ulg$/;
const STORED = "spikewire units";

let answers;

/** What the user answered before, by sensor. A page from a disk may have no storage. */
function answered() {
  try {
    answers ??= JSON.parse(localStorage.getItem(STORED) ?? "{}");
  } catch {
    answers ??= {};
  }
  return answers;
}

const sensorOf = (recording, field) => (groupOf(recording, field) > 0 ? 1 : 0);

/** The units among which a user chooses for a channel, each as the library has it: { name, perSi, isRate }. */
const unitsOf = (recording, field) => [...state.units[sensorOf(recording, field)], COUNTS];

/** Their names. */
export const choices = (recording, field) => unitsOf(recording, field).map(({ name }) => name);

/** The name of the unit that the user answered. */
export const answer = (recording, field) => answered()[sensorOf(recording, field)];

export function setAnswer(recording, field, unit) {
  answered()[sensorOf(recording, field)] = unit;
  try {
    localStorage.setItem(STORED, JSON.stringify(answers));
  } catch {
    // It holds until the page is closed.
  }
}

/** Notes the unit of a channel that was read, which a log's head may tell; returns whether it is news. */
export function noteUnit(opened, topic, field, unit) {
  opened.unitsRead ??= {};
  const key = `${topic} ${field}`, isNews = opened.unitsRead[key]?.name !== unit?.name;
  opened.unitsRead[key] = unit;
  return isNews;
}

/** The unit that the log or the name of its field shows. One that no such sensor has, as m/s read out of m s^-2, is none. */
function unitInLog(recording, field) {
  const { opened, topic } = recording, isSensor = isInertial(recording, field), isRate = sensorOf(recording, field) === 0;
  const own = opened.topics.find(({ name }) => name === topic), units = [opened.unitsRead?.[`${topic} ${field}`], own?.units[own.fields.indexOf(field)]];
  const unit = units.find((each) => each && (!isSensor || (each.perSi && each.isRate === isRate)));
  if (unit || !isSensor) return unit;
  return opened.example || SI.test(opened.file) ? unitsOf(recording, field)[0] : undefined;
}

/** The unit that the log shows, or the one that the user answered. */
const known = (recording, field) =>
  unitInLog(recording, field) ?? (isInertial(recording, field) ? unitsOf(recording, field).find(({ name }) => name === answer(recording, field)) : undefined);

/** How many of a channel's unit are 1 rad/s or 1 m/s²; undefined where that is not known. */
export const scaleOf = (recording, field) => known(recording, field)?.perSi ?? undefined;

/** The name of the unit of a channel; empty if it is unknown. */
export const unitOf = (recording, field = recording.field) => known(recording, field)?.name ?? "";

/** Whether a channel is an axis of a gyroscope or an accelerometer, by its name. */
export const isInertial = (recording, field) => groupOf(recording, field) !== undefined;

/** Whether the user is to say the unit of the channel that is shown. */
export const isAsked = () => {
  const { recording } = state;
  return Boolean(recording) && isInertial(recording, recording.field) && !unitInLog(recording, recording.field);
};
