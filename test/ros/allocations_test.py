#!/usr/bin/python3
"""Nothing of this package allocates on the way from a scan to the permission once it has started:
counted in the nodelets' process, by the way to each allocation."""

import collections
import os
import re
import signal
import subprocess
import time
import unittest

import rospkg
import rospy
import rostest

from monitor_recorder import Recorder, wait_for_nodelets
from tccm_monitor.msg import MonitorStatus
from waiting import process_of, wait_for

SECONDS = 5.0
TRIES = 4
OURS = "libtccm_monitor_"
# What may: messages on their way in and out are roscpp's, transforms are kept by tf2, what tells people
# more than the permission does is published beside the way, and a pool grows when more are under way
# at once than ever before.
APART = re.compile("|".join((
    "MessagePool<.*::grow", "makeMap",
    "ros::serialization", "serializeMessage", "::deserialize",
    "ros::Publisher::publish", "ros::Publication", "ros::MessageEvent", "libtf2",
    "diagnostic_updater", "publishMarkers", "publishPictures", "statusOf", "ros::console")))


def names_of(places):
    """@return by place, its library and function."""
    offsets = collections.defaultdict(list)
    for place in places:
        library, _, offset = place.rpartition("+")
        offsets[library].append(offset)
    names = {}
    for library, of_library in offsets.items():
        told = subprocess.run(["addr2line", "-fC", "-e", library, *of_library], check=False,
                              capture_output=True, text=True).stdout.splitlines()
        for offset, name in zip(of_library, told[::2] or ["?"] * len(of_library)):
            names[f"{library}+{offset}"] = f"{os.path.basename(library)}: {name}"
    return names


class AllocationsTest(unittest.TestCase):
    def test_nothing_is_allocated_on_the_way_from_a_scan_to_the_permission(self):
        recorder = Recorder()
        wait_for_nodelets()
        report = os.path.join(rospkg.get_ros_home(), "allocations.txt")
        for _ in range(TRIES):
            wait_for(lambda: recorder.statuses and self.is_ok(recorder.statuses[-1]), 60.0)
            time.sleep(15.0)  # a tilt's period and more, until all memory has been used once
            first = len(recorder.statuses)
            process = process_of("/watched_manager")
            os.kill(process, signal.SIGUSR1)
            time.sleep(SECONDS)
            os.kill(process, signal.SIGUSR2)
            wait_for(lambda: os.path.exists(report) and self.lines(report))
            ways, found = self.found_in(report)
            os.remove(report)
            was_ok = all(self.is_ok(status) for status in recorder.statuses[first:])
            # Where the machine was busy a fault has a text, and pools grow, once.
            if was_ok and not found:
                break
        else:
            self.fail(found or "it was not OK for long enough")
        self.assertGreater(ways, 5, "it counts")

    def found_in(self, report):
        """@return how many ways there are through this package, and those that are not allowed."""
        ways = [line.split("\t") for line in self.lines(report)]
        ways = [way for way in ways if any(OURS in place for place in way)]
        names = names_of({place for way in ways for place in way[1:]})
        found = [[way[0], *(names[place] for place in way[1:])] for way in ways]
        return len(ways), "\n".join("\n  ".join(way) for way in found if self.is_ours(way[1:]))

    @staticmethod
    def is_ok(status):
        return status.level == MonitorStatus.OK

    @staticmethod
    def lines(path):
        with open(path, encoding="utf-8") as file:
            return file.read().splitlines()

    @staticmethod
    def is_ours(frames):
        """Some function of ours is on the way, and none of what may."""
        ours = [i for i, frame in enumerate(frames) if OURS in frame]
        if not ours or any(APART.search(frame) for frame in frames[:ours[-1] + 1]):
            return False
        # ros::Publisher::publish(), inlined, makes a string of the message's checksum.
        innermost, caller = frames[ours[0]], frames[ours[0] + 1]
        return not ("basic_string" in innermost and re.search(r"publish|::report\(", caller))


if __name__ == "__main__":
    rospy.init_node("allocations_test")
    rostest.rosrun("tccm_monitor", "allocations", AllocationsTest)
