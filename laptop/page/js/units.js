// Units of inertial sensors: told by the log, by the names of its fields, or by the user, who is asked once.

import { groupOf } from "./channels.js";
import { state } from "./state.js";

/** How many of a unit are 1 rad/s or 1 m/s². Counts have no scale. */
const PER_SI = { "rad/s": 1, "deg/s": 180 / Math.PI, "mrad/s": 1000, "m/s²": 1, g: 1 / 9.80665, mg: 1000 / 9.80665 };
const CHOICES = [["rad/s", "deg/s", "counts"], ["m/s²", "g", "counts"]];
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

/** The units among which a user chooses for a channel. */
export const choices = (recording, field) => CHOICES[sensorOf(recording, field)];

export const answer = (recording, field) => answered()[sensorOf(recording, field)];

export function setAnswer(recording, field, unit) {
  answered()[sensorOf(recording, field)] = unit;
  try {
    localStorage.setItem(STORED, JSON.stringify(answers));
  } catch {
    // It holds until the page is closed.
  }
}

/** The unit that the log or the name of its field tells. One that no such sensor has, as m/s read out of m s^-2, is none. */
export function toldUnit(recording, field) {
  const { opened, topic } = recording, isSensor = isInertial(recording, field);
  const own = opened.topics.find(({ name }) => name === topic), units = [field === recording.field ? recording.told : "", own?.units[own.fields.indexOf(field)]];
  const unit = units.find((each) => each && (!isSensor || each in PER_SI));
  if (unit || !isSensor) return unit;
  return opened.example || SI.test(opened.file) ? CHOICES[sensorOf(recording, field)][0] : undefined;
}

/** How many of a channel's unit are 1 rad/s or 1 m/s²; undefined where that is not known. */
export const scaleOf = (recording, field) => PER_SI[toldUnit(recording, field) ?? answer(recording, field)];

/** The unit in which the figures of the recording are shown; empty if it is unknown. */
export const unitOf = (recording) => {
  const { field } = recording, unit = toldUnit(recording, field) ?? (isInertial(recording, field) ? answer(recording, field) : "");
  return unit ?? "";
};

/** Whether a channel is an axis of a gyroscope or an accelerometer, by its name. */
export const isInertial = (recording, field) => groupOf(recording, field) !== undefined;

/** Whether the user is to say the unit of the channel that is shown. */
export const isAsked = () => {
  const { recording } = state;
  return Boolean(recording) && isInertial(recording, recording.field) && !toldUnit(recording, recording.field);
};
