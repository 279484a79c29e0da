#!/usr/bin/python3
"""Two sensors, one answer: whatever happens to the second is named, stops the robot where it is
required, and does not where it is not."""

import collections
import math
import struct
import time

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import LaserScan, PointCloud2, PointField
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from gated_robot import wait_for
from input_faults import FAULTS, TRANSFORM_LIMIT, scans, with_fields, with_list
from input_gate import Gate, nothing
from monitor_recorder import PUBLISH_PERIOD, SLACK
from named_subtests import NamedSubTests
from tccm_monitor.msg import CuboidMap, MotionPermission

CHOSEN = ("stopped", "late", "all NaN", "of a frame that nobody knows", "stamped in the future",
          "frozen", "no beams")
NAN = struct.pack("<f", math.nan)
OF_CLOUDS = {
    "all NaN": scans(with_list("data", lambda data: NAN * (len(data) // len(NAN))), "BLIND"),
    "no beams": scans(with_fields(width=0, height=0, row_step=0, data=b"")),
}
# Two assemblers and mappers beside the simulation; limits have tests of their own.
BUSY = 0.5


class Mount:
    """Where the second sensor is, said of a frame of its own: where the simulation has it."""

    FRAME = "second_frame"

    def __init__(self, measured_frame):
        self._measured_frame = measured_frame
        self._stopped = False
        self._publisher = rospy.Publisher("/tf", TFMessage, queue_size=100)
        rospy.Timer(rospy.Duration(0.02), self._tell)

    def _tell(self, _event):
        if self._stopped:
            return
        transform = TransformStamped(child_frame_id=self.FRAME)
        transform.header.frame_id, transform.header.stamp = self._measured_frame, rospy.Time.now()
        transform.transform.rotation.w = 1.0
        self._publisher.publish(TFMessage([transform]))

    def stop(self):
        self._stopped = True
        return rospy.get_time()

    def go_on(self):
        self._stopped = False

    def name(self, message):
        """@return a message that was measured in the frame, as one of its own."""
        if message.header.frame_id == self._measured_frame:
            message.header.frame_id = self.FRAME
        return message


class Laser:
    """The second sensor as the laser once more."""

    source, frame, measured = "raw/scan", "laser_link", LaserScan
    message_type = LaserScan
    faults = FAULTS["scan"]

    def __init__(self):
        self.mount = Mount(self.frame)

    def of(self, message):
        """@return what is published of what was measured."""
        return self.mount.name(message)


class Camera(Laser):
    source, frame, measured = "raw/camera", "camera_depth_optical_frame", PointCloud2
    message_type = PointCloud2
    faults = {**FAULTS["scan"], **OF_CLOUDS}


class Lidar(Laser):
    """What a lidar of one line would publish: each point with its time from the stamp."""

    message_type = PointCloud2

    def of(self, scan):
        scan = self.mount.name(scan)
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
        cls.permissions, cls.diagnostics = [], []
        # A camera's many maps, all kept, would keep Python from everything else.
        cls.maps = {name: collections.deque(maxlen=3) for name in ("laser", "second")}
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.diagnostics.append, queue_size=100)
        for sensor, maps in cls.maps.items():
            rospy.Subscriber(sensor + "/cuboid_map", CuboidMap, maps.append, queue_size=10)
        cls.laser = Gate("laser_scan", LaserScan, source="raw/scan")
        second = rospy.get_param("~second")
        cls.sensor = {"scan": Laser, "cloud": Lidar, "camera": Camera}[second]()
        cls.second = Gate("second_" + second, cls.sensor.measured, source=cls.sensor.source,
                          converted=cls.sensor)
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
            self.assertTrue(wait_for(lambda maps=maps: any(m.cuboids for m in list(maps)), 5.0),
                            sensor)

    def test_what_happens_to_the_second_is_named(self):
        for name in CHOSEN:
            fault = self.sensor.faults[name]
            with self.subTest(fault=name):
                self.until_it_may_move()
                self.check(fault.reason, fault.limit, self.second.close(fault.change))
                self.second.open()
        self.until_it_may_move()

    def test_a_dead_transform_of_the_second_is_named(self):
        self.until_it_may_move()
        self.check("NO_TRANSFORM", TRANSFORM_LIMIT, self.sensor.mount.stop())
        self.sensor.mount.go_on()
        self.until_it_may_move()

    def check(self, reason, limit, begin):
        """@param limit seconds until the reason is to be given. @param begin of the fault."""
        if self.required:
            self.check_stop(reason, limit, begin)
        else:
            self.check_goes_on()

    def check_stop(self, reason, limit, begin):
        found = self.first(lambda permission: reason in permission.reasons, begin, limit + 3.0)
        self.assertIsNotNone(found)
        self.assertEqual(found.level, MotionPermission.FAULT)
        self.assertFalse(found.permitted)
        self.assertIn("sensor 'second': ", found.detail)
        self.assertLess(found.header.stamp.to_sec() - begin,
                        limit + PUBLISH_PERIOD + SLACK + BUSY)

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
