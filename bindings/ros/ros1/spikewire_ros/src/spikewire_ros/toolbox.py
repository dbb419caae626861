"""The toolbox's node, as its launch files start it: a signal, its spikes on `event`, and both in a bag."""

import time
from dataclasses import replace

import rosbag
import rospy
from spyke_msgs.msg import spyke, spyke_array

from . import codec, schemes
from .encoding import Encoding, Event
from .ros1 import NO_LIMIT, TO_SEND, Node, spyke_of
from .settings import Settings
from .wave import wave

# In the working directory, which roslaunch makes ~/.ros.
BAG = "encoding.bag"


class GenerateSpikes(Node):
    """Plays the toolbox's signal of `T_max` seconds, a sample each `dt`, and ends with it."""

    def __init__(self) -> None:
        super().__init__("spikes_publisher")
        self._dt = rospy.get_param("dt")
        self._signal = list(wave(self._dt, rospy.get_param("T_max")))
        self._low, self._high = min(self._signal), max(self._signal)
        # The toolbox numbers the neurons of its Gaussian fields from 0.
        self._is_toolbox_grf = rospy.get_param("encoding_scheme", "") == schemes.GAUSSIAN_FIELDS
        self._encoding = Encoding(self._complete(self.settings(defaults=True)), self.counters)
        kind = spyke_array if self._encoding.is_array else spyke
        self._event = rospy.Publisher("event", kind, queue_size=NO_LIMIT)

    def _complete(self, settings: Settings) -> Settings:
        """The whole signal tells range and shift; its first second tells a threshold that is to be found."""
        low, high = self._low, self._high
        if self._is_toolbox_grf:
            low, high = schemes.toolbox_range(low, high, settings.options["neurons"])
        names = codec.names(settings.scheme)
        known = {name: value for name, value in (("min", low), ("max", high), ("shift", low)) if name in names}
        calibrate = int(1 / self._dt) if "factor" in settings.options else 0
        return replace(settings, options={**known, **settings.options}, calibrate=calibrate)

    def run(self) -> int:
        rate = rospy.Rate(1.0 / self._dt)
        with rosbag.Bag(BAG, "w") as bag:
            for sample in self._signal:
                if rospy.is_shutdown():
                    break
                self._publish(bag, self._encoding.take(sample, rospy.get_rostime().to_nsec()))
                rate.sleep()
            self._publish(bag, self._encoding.end())
        time.sleep(TO_SEND)
        rospy.loginfo(str(self.counters))
        return 0

    def _publish(self, bag: rosbag.Bag, events: list[Event]) -> None:
        for event in events:
            if self._is_toolbox_grf:
                own = {"scheme": schemes.GAUSSIAN_FIELDS, "min_input": self._low, "max_input": self._high}
                event = replace(event, **own)
            message = spyke_of(event)
            bag.write("event", message)
            self._event.publish(message)
