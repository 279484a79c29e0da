#!/usr/bin/python3
"""One message that is lost or worth nothing is dropped and counted, and the robot moves on; so it
does where several publishers send parts of the joint states."""

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray

from bad_maps import BAD_MAPS, bad_map
from gated_robot import GatedRobot, wait_for
from input_faults import (BAD_JOINTS, BAD_SCANS, BAD_TRANSFORMS, NAN, parts_of,
                          with_list)
from input_gate import dated, nothing
from named_subtests import NamedSubTests
from tccm_monitor.msg import CuboidMap, MotionPermission, ScanReport

WATCHED = 0.3  # seconds after each
TRIES = 3  # a busy machine may stop the robot for its own reasons
BLIND = with_list("ranges", lambda ranges: [NAN] * len(ranges))
# (topic, what becomes of one message, why a scan is dropped)
SINGLE = {
    **{"joint state: " + name: ("joint_states", change, "") for name, change in BAD_JOINTS.items()},
    "joint state: lost": ("joint_states", nothing, ""),
    "joint state: stamped in the future": ("joint_states", dated(1.0), ""),
    **{"scan: " + name: ("scan", change, "malformed") for name, change in BAD_SCANS.items()},
    "scan: lost": ("scan", nothing, ""),
    "scan: blind": ("scan", BLIND, "blind"),
    "scan: stamped in the future": ("scan", dated(1.0), "future_stamp"),
    "scan: without transforms": ("scan", dated(-3600.0), "no_transform"),
    "transforms: lost": ("/tf", nothing, ""),
    "transforms: out of order": ("/tf", dated(-0.805), ""),
    **{"transforms: " + name: ("/tf", change, "") for name, change in BAD_TRANSFORMS.items()},
}


class Watch:
    """What was said while something was done to the input."""

    def __init__(self, robot, act):
        for _ in range(TRIES):
            self.moved_before = robot.wait_until_it_may_move()
            reports = len(robot.reports)
            self.begin = rospy.get_time()
            act()
            self.end = rospy.get_time() + WATCHED
            robot.wait_for_permissions_until(self.end)
            self.permissions = robot.permissions_between(self.begin, self.end)
            self.dropped = [report.dropped for report in robot.reports[reports:]
                            if report.outcome == ScanReport.DROPPED]
            if {permission.level for permission in self.permissions} == {MotionPermission.OK}:
                return


class HarmlessTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.robot = GatedRobot()
        cls.diagnostics = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.diagnostics.append, queue_size=100)
        cls.watches = {name: Watch(cls.robot, lambda: cls.alter_one(topic, change))
                       for name, (topic, change, _) in SINGLE.items()}
        cls.parts = Watch(cls.robot, lambda: cls.robot.gates["joint_states"].close(parts_of))
        cls.robot.gates["joint_states"].open()
        cls.maps = rospy.Publisher("cuboid_map", CuboidMap, queue_size=10)
        wait_for(lambda: cls.maps.get_num_connections() > 1)  # the checker, and this program
        cls.map_watches = {name: Watch(cls.robot, lambda: cls.forge(alter))
                           for name, alter in BAD_MAPS.items()}

    @classmethod
    def tearDownClass(cls):
        cls.robot.tear_down()

    @classmethod
    def alter_one(cls, topic, change):
        gate = cls.robot.gates[topic]
        gate.close(change, messages=1)
        wait_for(gate.is_open)

    @classmethod
    def forge(cls, alter):
        cls.maps.publish(bad_map(alter))

    def count(self, key):
        """The newest count of that key among all diagnostics; None where there is none."""
        counts = [int(value.value) for message in self.diagnostics for status in message.status
                  for value in status.values if value.key == key]
        return counts[-1] if counts else None

    def wait_for_count(self, key, least):
        wait_for(lambda: (self.count(key) or 0) >= least, patience=3.0)
        self.assertGreaterEqual(self.count(key) or 0, least, key)

    def test_the_robot_moves_on(self):
        for name, watch in {**self.watches, "parts": self.parts, **self.map_watches}.items():
            with self.subTest(name):
                self.assertIsNotNone(watch.moved_before)
                self.assertGreater(len(watch.permissions), 10)
                self.assertEqual({(permission.level, tuple(permission.reasons))
                                  for permission in watch.permissions},
                                 {(MotionPermission.OK, ())})

    def test_a_scan_that_is_dropped_is_reported_with_its_reason(self):
        for name, watch in self.watches.items():
            with self.subTest(name):
                self.assertEqual(watch.dropped, [SINGLE[name][2]] if SINGLE[name][2] else [])

    def test_what_is_dropped_is_counted(self):
        reasons = [reason for _, _, reason in SINGLE.values() if reason]
        for reason in set(reasons):
            self.wait_for_count("scans dropped: " + reason, reasons.count(reason))
        self.wait_for_count("joint states dropped: stamped in the future", 1)
        self.wait_for_count("cuboid_maps dropped", len(BAD_MAPS))

    def test_the_manager_lives(self):
        self.assertTrue(self.robot.manager_lives())


if __name__ == "__main__":
    rospy.init_node("harmless_test")
    rostest.rosrun("tccm_monitor", "harmless", HarmlessTest)
