#!/usr/bin/python3
"""A depth camera's clouds go through the real nodelets: a box on a table is in the map, and nothing
else. Clouds with a wrong layout are counted, and scan_report says what is wrong."""

import math
import threading
import unittest

import numpy
import rospy
import rostest
import tf2_ros
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import PointCloud2, PointField

from tccm_monitor.msg import CuboidMap, ScanReport
from waiting import wait_for

WIDTH, HEIGHT, FOCAL = 160, 120, 140.0
EYE = numpy.array([0.2, 0.0, 1.4])  # of the camera in base_link [m]
DOWN = math.radians(40.0)
TABLE = 0.5  # height [m]
BOX = (numpy.array([0.9, -0.1, TABLE]), numpy.array([1.1, 0.1, 0.7]))
CELL = 0.02
RATE = 15.0

# The columns are the camera's axes in base_link: x to the right, y down, z ahead.
AXES = numpy.array([[0.0, -math.sin(DOWN), math.cos(DOWN)],
                    [-1.0, 0.0, 0.0],
                    [0.0, -math.cos(DOWN), -math.sin(DOWN)]])


def directions():
    """@return one a pixel, in the camera's frame."""
    v, u = numpy.mgrid[0:HEIGHT, 0:WIDTH]
    return numpy.stack([(u - WIDTH / 2.0) / FOCAL, (v - HEIGHT / 2.0) / FOCAL,
                        numpy.ones(u.shape)], axis=-1).reshape(-1, 3)


def scene():
    """@return the camera's points on table and box; NaN where there is neither."""
    rays = directions() @ AXES.T
    with numpy.errstate(divide="ignore", invalid="ignore"):
        depth = (TABLE - EYE[2]) / rays[:, 2]
        depth[depth < 0.0] = numpy.inf
        enter, leave = ((corner - EYE) / rays for corner in BOX)
        first = numpy.minimum(enter, leave).max(axis=1)
        last = numpy.maximum(enter, leave).min(axis=1)
    hit = (first <= last) & (first > 0.0)
    depth[hit] = numpy.minimum(depth[hit], first[hit])
    depth[depth > 3.0] = numpy.nan
    return (directions() * depth[:, None]).astype(numpy.float32)


def cloud(points):
    """As depth_image_proc lays it out."""
    message = PointCloud2(width=WIDTH, height=HEIGHT, point_step=16, row_step=16 * WIDTH)
    message.header.frame_id = "camera_optical"
    message.fields = [PointField(name=name, offset=4 * i, datatype=PointField.FLOAT32, count=1)
                      for i, name in enumerate("xyz")]
    padded = numpy.zeros((len(points), 4), dtype=numpy.float32)
    padded[:, :3] = points
    message.data = padded.tobytes()
    return message


class CloudTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.maps, cls.reports, cls.windowless, cls.diagnostics = [], [], [], []
        rospy.Subscriber("/camera/cuboid_map", CuboidMap, cls.maps.append, queue_size=100)
        rospy.Subscriber("/camera/scan_report", ScanReport, cls.reports.append, queue_size=1000)
        rospy.Subscriber("/windowless/cuboid_map", CuboidMap, cls.windowless.append)
        rospy.Subscriber("/diagnostics", DiagnosticArray,
                         lambda array: cls.diagnostics.extend(array.status), queue_size=100)
        cls.tell_where_the_camera_is()
        cls.publisher = rospy.Publisher("/points", PointCloud2, queue_size=10)
        cls.healthy = cloud(scene())
        cls.next, cls.ended = cls.healthy, False
        cls.thread = threading.Thread(target=cls.publish)
        cls.thread.start()

    @classmethod
    def tearDownClass(cls):
        cls.ended = True
        cls.thread.join()

    @classmethod
    def tell_where_the_camera_is(cls):
        transform = TransformStamped()
        transform.header.frame_id, transform.child_frame_id = "base_link", "camera_optical"
        transform.transform.translation.x, transform.transform.translation.z = EYE[0], EYE[2]
        rotation = transform.transform.rotation
        w = 0.5 * math.sqrt(1.0 + numpy.trace(AXES))
        rotation.w = w
        rotation.x = (AXES[2, 1] - AXES[1, 2]) / (4.0 * w)
        rotation.y = (AXES[0, 2] - AXES[2, 0]) / (4.0 * w)
        rotation.z = (AXES[1, 0] - AXES[0, 1]) / (4.0 * w)
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        cls.broadcaster.sendTransform(transform)

    @classmethod
    def publish(cls):
        while not cls.ended:
            message = cls.next
            message.header.stamp = rospy.Time.now()
            cls.publisher.publish(message)
            rospy.sleep(1.0 / RATE)

    def test_a_box_on_a_table_is_in_the_map_and_nothing_else(self):
        found = wait_for(lambda: next((m for m in list(self.maps) if m.complete), None))
        tops = {}
        for cuboid in found.cuboids:
            x, y = self.middle(found, cuboid)
            on_box = all(BOX[0][k] - CELL <= (x, y)[k] <= BOX[1][k] + CELL for k in range(2))
            self.assertGreater(cuboid.top - cuboid.depth, TABLE - 0.05)
            self.assertLess(cuboid.top, (BOX[1][2] if on_box else TABLE) + 0.03)
            tops[on_box] = max(tops.get(on_box, 0.0), cuboid.top)
        self.assertAlmostEqual(tops[True], BOX[1][2], delta=0.01)
        self.assertAlmostEqual(tops[False], TABLE, delta=0.01)
        covered = {cuboid.cell for cuboid in found.cuboids if cuboid.top > BOX[1][2] - 0.03}
        self.assertGreater(len(covered), 60)  # of the 100 cells on top of it

    @staticmethod
    def middle(message, cuboid):
        ix, iy = cuboid.cell % message.cells_x, cuboid.cell // message.cells_x
        return (message.origin_x + (ix + 0.5) * message.cell_size,
                message.origin_y + (iy + 0.5) * message.cell_size)

    def test_what_is_left_is_published_while_somebody_listens(self):
        heard = []
        subscriber = rospy.Subscriber("/camera/filtered_cloud", PointCloud2, heard.append)
        message = wait_for(lambda: next(iter(list(heard)), None))
        subscriber.unregister()
        self.assertEqual(message.header.frame_id, "base_link")
        self.assertEqual([field.name for field in message.fields], ["x", "y", "z"])
        self.assertEqual(len(message.data), 12 * message.width * message.height)
        points = numpy.frombuffer(message.data, dtype=numpy.float32).reshape(-1, 3)
        self.assertGreater(len(points), 0.8 * numpy.isfinite(scene()[:, 0]).sum())
        on_table = numpy.abs(points[:, 2] - TABLE) < 0.01
        on_box = numpy.all([(points[:, k] > BOX[0][k] - 0.01) & (points[:, k] < BOX[1][k] + 0.01)
                            for k in range(3)], axis=0)
        self.assertTrue(numpy.all(on_table | on_box))
        self.assertGreater(on_box.sum(), 100)

    def test_wrong_layouts_are_counted_and_reported(self):
        def renamed(message):
            message.fields[1].name = "intensity"

        def of_integers(message):
            message.fields[2].datatype = PointField.INT32

        def too_short(message):
            message.data = message.data[:-8]

        def timed(message):
            message.fields.append(PointField(name="t", offset=12, datatype=PointField.FLOAT32,
                                             count=1))

        for make, said in ((renamed, "no field 'y'"), (of_integers, "'z' (int32)"),
                           (too_short, "bytes"), (timed, "'t' (float32)")):
            with self.subTest(said):
                wrong = cloud(scene())
                make(wrong)
                type(self).next = wrong
                report = wait_for(lambda: next((r for r in list(self.reports)
                                                if said in r.detail), None))
                type(self).next = self.healthy
                self.assertEqual(report.outcome, ScanReport.DROPPED)
                self.assertEqual(report.dropped, "malformed")
        wait_for(lambda: any("clouds dropped: malformed" == value.key
                             for status in list(self.diagnostics) for value in status.values))

    def test_a_mapper_without_a_window_says_what_to_set(self):
        wait_for(lambda: any("window_s" in status.message for status in list(self.diagnostics)))
        self.assertEqual(self.windowless, [])


if __name__ == "__main__":
    rospy.init_node("cloud_test")
    rostest.rosrun("tccm_monitor", "cloud", CloudTest)
