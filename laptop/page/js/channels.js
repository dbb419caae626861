// The axes of a flight's gyroscope and accelerometer, as the library finds them by their names.

const topicOf = (topics, name) => topics.find((topic) => topic.name === name) ?? topics[0];

/** The inertial fields of this topic, to be drawn beside each other. */
export const siblings = (topics, name) => topicOf(topics, name).axes;

/** Banks have parameters for turn rates (0), for sideways forces (1), and for the force along the thrust (2); for no other channel. */
export function groupOf({ opened, topic }, field) {
  const { fields, groups } = topicOf(opened.topics, topic);
  return groups[fields.indexOf(field)] ?? undefined;
}
