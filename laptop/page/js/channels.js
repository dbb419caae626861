// Which channels a flight's log was opened for: the gyroscope's and the accelerometer's axes, found by their names and rates.

/** How the axes of each sensor are called, behind their topic and a dot. */
const GYRO = /gyr|angular_?velocity|angular_?rate|rotation_?rate|body_?rate|(^|[._/\s])(w|omega)_?([a-z_]*_)?[xyz]($|[\s[_(,])/;
const ACCEL = /acc(el|smooth|adc|[xyz_.[]|$)|linear_?acceleration|specific_?force|(^|[._/\s])a_?([a-z_]*_)?[xyz]($|[\s[_(,])|[xyz]acc$/;
/** What has such a name and is not what the sensor said. */
const OTHER = /header|seq$|iteration|counter|time|stamp|setpoint|desired|target|bias|varian|integral|clip|temp|device|error|_dt|scale|offset|status|flag|saturat|calib|thrust|unfilt|noise|std|samples|priority|health|_sp\b/;
const OTHER_TOPIC = /setpoint|bias|status|fifo|selection|debug|calib|health|allocat/;
/** How the three axes of a sensor end, or begin. */
const AXES = [/[._/]x\b|x$|\[0\]|roll|[._]p$|^x(gyro|acc)/, /[._/]y\b|y$|\[1\]|pitch|[._]q$|^y(gyro|acc)/, /[._/]z\b|z$|\[2\]|yaw|[._]r$|^z(gyro|acc)/];

/** The fields of one sensor, in the order of its axes, as many as there are; one where no axis is named. */
function axes(topic, sensor) {
  if (OTHER_TOPIC.test(topic.name.toLowerCase())) return [];
  const named = topic.fields.filter((field) => {
    const name = `${topic.name}.${field}`.toLowerCase();
    return sensor.test(name) && !OTHER.test(field.toLowerCase());
  });
  const found = AXES.map((axis) => named.find((field) => axis.test(field.toLowerCase())));
  const apart = [...new Set(found.filter(Boolean))];
  return apart.length > 1 ? apart : named.slice(0, 1);
}

/** The inertial fields of a topic: turn rates first. */
const inertial = (topic) => {
  const [gyro, accel] = [axes(topic, GYRO), axes(topic, ACCEL)];
  // A topic that is itself named after one sensor has the fields of that one alone.
  return gyro.length === 3 && accel.length === 3 && gyro[0] !== accel[0] ? [...gyro, ...accel] : gyro.length >= accel.length ? gyro : accel;
};

/** How much a topic speaks for itself: six axes before three, turn rates before accelerations, then how often it came. */
function weight(topic, found) {
  if (!found.length) return 0;
  const isGyro = GYRO.test(`${topic.name}.${found[0]}`.toLowerCase());
  return (found.length >= 3 ? 4 : 1) + (found.length === 6 ? 2 : 0) + (isGyro ? 1 : 0) + 0.9 * (1 - 1 / (1 + (topic.count ?? 0)));
}

/** The topic and the fields that one opens a log for; the first field of all where no name tells. */
export function wanted(topics) {
  const all = topics.map((topic) => ({ topic, fields: inertial(topic) })).map((each) => ({ ...each, weight: weight(each.topic, each.fields) }));
  const best = all.reduce((a, b) => (b.weight > a.weight ? b : a));
  return best.weight ? { topic: best.topic.name, fields: best.fields } : { topic: topics[0].name, fields: [topics[0].fields.find((field) => !OTHER.test(field.toLowerCase())) ?? topics[0].fields[0]] };
}

/** The inertial fields of this topic, to be drawn beside each other. */
export const siblings = (topics, name) => inertial(topics.find((topic) => topic.name === name) ?? topics[0]);

/** Banks have parameters for turn rates (0), for sideways forces (1), and for the force along the thrust (2); for no other channel. */
export function groupOf({ opened, topic }, field) {
  const fields = siblings(opened.topics, topic), place = fields.indexOf(field), name = `${topic}.${field}`.toLowerCase();
  if (fields.length === 6 && place >= 0) return place < 3 ? 0 : place < 5 ? 1 : 2;
  const isNamed = (GYRO.test(name) || ACCEL.test(name)) && !OTHER.test(field.toLowerCase());
  if (place < 0 && !isNamed) return undefined;
  return ACCEL.test(name) && !GYRO.test(name) ? (place < 2 ? 1 : 2) : 0;
}
