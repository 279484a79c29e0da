#!/usr/bin/python3
"""Where nothing moves the map stays what it is: no cloud is transformed twice, and nobody alters a
message that others hold as well."""

import struct
import unittest

import numpy
import rospy
import rostest

from gated_robot import wait_for
from input_gate import raw_type
from monitor_recorder import SCAN_PERIOD, TILT_PERIOD
from tccm_monitor.msg import CuboidMap

LATER = 4.0 * TILT_PERIOD  # a whole number of scans: the laser looks where it looked before
DOUBT = 0.02  # [m] of heights, besides neighbouring cells: noise and edges of cells
ALIKE = 0.9  # of the cuboids; noise moves edges, and on a busy machine scans may be lost
COMPARED = 10  # maps


def content(message):
    """All that is said of the scene, without what depends on how long the mapper has lived."""
    return [(cuboid.cell, cuboid.top, cuboid.depth, cuboid.points) for cuboid in message.cuboids
            if not cuboid.held]


def share_found(cuboid_map, other):
    """Of a map's cuboids those that meet one of the other in the same or a neighbouring cell."""
    ends = {}
    for cuboid in other.cuboids:
        ends.setdefault(cuboid.cell, []).append((cuboid.top - cuboid.depth, cuboid.top))
    neighbours = [dx + dy * cuboid_map.cells_x for dx in (-1, 0, 1) for dy in (-1, 0, 1)]

    def is_found(cuboid):
        return any(bottom - DOUBT <= cuboid.top and cuboid.top - cuboid.depth <= top + DOUBT
                   for n in neighbours for bottom, top in ends.get(cuboid.cell + n, []))
    return numpy.mean([is_found(cuboid) for cuboid in cuboid_map.cuboids])


class Maps:
    """What one mapper publishes, by stamp; read only where it is asked for."""

    def __init__(self, topic):
        self._raw = {}
        rospy.Subscriber(topic, raw_type(CuboidMap), self._take, queue_size=1000)

    def _take(self, raw):
        _, seconds, nanoseconds = struct.unpack_from("<III", raw._buff)  # of the header
        self._raw[rospy.Time(seconds, nanoseconds)] = raw

    def stamps(self):
        """The newest first."""
        return sorted(self._raw, reverse=True)

    def complete_at(self, stamp):
        """None where there is none, or it does not hold a whole window."""
        if stamp not in self._raw:
            return None
        message = CuboidMap().deserialize(self._raw[stamp]._buff)
        return message if message.complete else None


class StillSceneTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.maps, cls.together, cls.apart = (
            Maps(topic) for topic in ("cuboid_map", "together/cuboid_map", "apart/cuboid_map"))
        found = wait_for(cls.now_and_later)
        cls.now, cls.later = found or (None, None)

    @classmethod
    def now_and_later(cls):
        """Two maps that are LATER apart, but for half a scan; None where there are none."""
        stamps = cls.maps.stamps()
        for later in stamps[:3]:  # the others were tried before
            wanted = later - rospy.Duration(LATER)
            now = min(stamps, key=lambda stamp: abs((stamp - wanted).to_sec()))
            if abs((now - wanted).to_sec()) > 0.5 * SCAN_PERIOD:
                continue
            found = cls.maps.complete_at(now), cls.maps.complete_at(later)
            if all(found):
                return found
        return None

    def pairs(self):
        """Maps of the same scans; on a busy machine one of the mappers may have missed some."""
        pairs = []
        for stamp in self.together.stamps():
            ours, theirs = self.together.complete_at(stamp), self.apart.complete_at(stamp)
            if ours and theirs and ours.window_scans == theirs.window_scans:
                pairs.append((ours, theirs))
            if len(pairs) == COMPARED:
                break
        return pairs

    def test_the_map_is_the_same_later(self):
        self.assertIsNotNone(self.now)
        self.assertGreater(len(self.now.cuboids), 500)
        self.assertGreater(share_found(self.now, self.later), ALIKE)
        self.assertGreater(share_found(self.later, self.now), ALIKE)

    def test_no_more_and_no_less_is_in_it(self):
        self.assertIsNotNone(self.now)
        self.assertAlmostEqual(len(content(self.later)) / len(content(self.now)), 1.0, delta=0.1)
        self.assertAlmostEqual(self.later.window_scans / self.now.window_scans, 1.0, delta=0.1)

    def test_all_mappers_hear_the_same_clouds(self):
        pairs = self.pairs()
        self.assertEqual(len(pairs), COMPARED)
        for ours, theirs in pairs:
            self.assertEqual(content(ours), content(theirs))


if __name__ == "__main__":
    rospy.init_node("still_scene_test")
    rostest.rosrun("tccm_monitor", "still_scene", StillSceneTest)
