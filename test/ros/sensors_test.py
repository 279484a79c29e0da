#!/usr/bin/python3
"""Two sensors, one answer: whatever happens to the second is named, stops the robot where it is
required, and does not where it is not."""

import math
import struct
import time

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from std_srvs.srv import Trigger

from gated_robot import wait_for
from input_faults import FAULTS
from input_gate import Gate, nothing
from monitor_recorder import PUBLISH_PERIOD, SLACK
from named_subtests import NamedSubTests
from tccm_monitor.msg import CuboidMap, MotionPermission

CHOSEN = ("stopped", "late", "all NaN", "of a frame that nobody knows", "stamped in the future",
          "frozen", "no beams")
# Two assemblers and mappers beside the simulation; limits have tests of their own.
BUSY = 0.5


class AsCloud:
    """What a lidar of one line would publish: each point with its time from the stamp."""

    message_type = PointCloud2

    @staticmethod
    def of(scan):
        points = []
        for i, measured in enumerate(scan.ranges):
            range_m = measured if scan.range_min <= measured <= scan.range_max else math.nan
            angle = scan.angle_min + i * scan.angle_increment
            points.append((range_m * math.cos(angle), range_m * math.sin(angle),
                           0.0 * range_m, i * scan.time_increment))
        cloud = PointCloud2(header=scan.header, height=1, width=len(points), point_step=16,
                            row_step=16 * len(points))
        cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1)
                        for i, name in enumerate(("x", "y", "z", "time"))]
        cloud.data = b"".join(struct.pack("<4f", *point) for point in points)
        return cloud


class SensorsTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.required = rospy.get_param("~required")
        cls.permissions, cls.maps, cls.diagnostics = [], {"laser": [], "second": []}, []
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.diagnostics.append, queue_size=100)
        for sensor, maps in cls.maps.items():
            rospy.Subscriber(sensor + "/cuboid_map", CuboidMap, maps.append, queue_size=10)
        cls.laser = Gate("laser_scan", LaserScan, source="raw/scan")
        is_cloud = rospy.get_param("~second") == "cloud"
        cls.second = Gate("second_cloud" if is_cloud else "second_scan", LaserScan,
                          source="raw/scan", converted=AsCloud if is_cloud else None)
        rospy.wait_for_service("reset", 20.0)
        cls.reset = rospy.ServiceProxy("reset", Trigger)

    @classmethod
    def tearDownClass(cls):
        for gate in (cls.laser, cls.second):
            gate.close(nothing)

    def until_it_may_move(self):
        def moves():
            if self.permissions and self.permissions[-1].level == MotionPermission.OK:
                return self.permissions[-1]
            if self.permissions and self.permissions[-1].reasons[:1] == ["AWAITING_RESET"]:
                self.reset()
                time.sleep(0.1)
            return None
        permission = wait_for(moves, 30.0)
        self.assertIsNotNone(permission, self.permissions[-1:] or "no permission came")
        return permission

    def first(self, wanted, begin, patience):
        def found():
            for permission in list(self.permissions):
                if permission.header.stamp.to_sec() >= begin and wanted(permission):
                    return permission
            return None
        return wait_for(found, patience)

    def failed_sensors(self):
        """As the diagnostics name them now."""
        del self.diagnostics[:]

        def newest():
            for array in list(self.diagnostics):
                for status in array.status:
                    values = {value.key: value.value for value in status.values}
                    if "collision_checker" in status.name and "checks" in values:
                        return values
            return None
        return wait_for(newest, 5.0).get("sensor that failed, not required", "")

    def test_both_have_maps_of_their_own_and_one_answer_comes_of_them(self):
        self.until_it_may_move()
        for sensor, maps in self.maps.items():
            self.assertTrue(wait_for(lambda maps=maps: len(maps) > 2, 5.0), sensor)
            self.assertTrue(maps[-1].cuboids, sensor)

    def test_what_happens_to_the_second_is_named(self):
        for name in CHOSEN:
            fault = FAULTS["scan"][name]
            with self.subTest(fault=name):
                self.until_it_may_move()
                begin = self.second.close(fault.change)
                if self.required:
                    self.check_stop(fault, begin)
                else:
                    self.check_goes_on()
                self.second.open()
        self.until_it_may_move()

    def check_stop(self, fault, begin):
        found = self.first(lambda permission: fault.reason in permission.reasons, begin,
                           fault.limit + 3.0)
        self.assertIsNotNone(found)
        self.assertEqual(found.level, MotionPermission.FAULT)
        self.assertFalse(found.permitted)
        self.assertIn("sensor 'second': ", found.detail)
        self.assertLess(found.header.stamp.to_sec() - begin,
                        fault.limit + PUBLISH_PERIOD + SLACK + BUSY)

    def check_goes_on(self):
        named = wait_for(lambda: self.failed_sensors() or None, 6.0)
        self.assertIn("sensor 'second': ", named)
        begin = rospy.get_time()
        rospy.sleep(0.5)
        since = [p for p in self.permissions if p.header.stamp.to_sec() > begin]
        self.assertGreater(len(since), 20)
        self.assertTrue(all(p.permitted for p in since), [p.detail for p in since if not p.permitted][:3])

    def test_what_happens_to_the_first_stops_the_robot(self):
        self.until_it_may_move()
        begin = self.laser.close(nothing)
        found = self.first(lambda permission: "NO_MAP" in permission.reasons, begin, 4.0)
        self.laser.open()
        self.assertIsNotNone(found)
        self.assertIn("sensor 'laser': ", found.detail)
        self.until_it_may_move()


if __name__ == "__main__":
    rospy.init_node("sensors_test")
    rostest.rosrun("tccm_monitor", "sensors", SensorsTest)
