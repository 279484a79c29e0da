#!/usr/bin/python3
"""Ever new names of frames, joints, links, objects, reasons and topics come from outside: the
nodelets' memory stays bounded, and they say what they passed over."""

import argparse
import pathlib
import random
import re
import time
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Transform, TransformStamped
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Bool
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from gated_robot import pid_of_manager, wait_for
from tccm_monitor.msg import (AttachedObject, AttachedObjects, CuboidMap, MotionPermission,
                              Primitive, ScanReport)
from tccm_monitor.srv import AddExemption, AttachObject, CheckState, ReportGoal

GROWTH_MAX_KB = 20_000
BURST = 50  # names in one message
RATE = 100.0  # messages a second


def resident_kb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1])


class StrangeNamesTest(unittest.TestCase):
    seconds, seed = 8.0, 1

    @classmethod
    def setUpClass(cls):
        cls.random = random.Random(cls.seed)
        cls.names = 0
        cls.diagnostics, cls.permissions = [], []
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.take_diagnostics, queue_size=10)
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=10)
        cls.publishers = {topic: rospy.Publisher(topic, message_type, queue_size=10)
                          for topic, message_type in (
                              ("/tf", TFMessage), ("/tf_static", TFMessage),
                              ("joint_states", JointState), ("scan", LaserScan),
                              ("scan_report", ScanReport), ("trajectory", JointTrajectory),
                              ("attached_objects", AttachedObjects), ("cuboid_map", CuboidMap))}
        cls.services = [rospy.ServiceProxy("add_exemption", AddExemption),
                        rospy.ServiceProxy("report_goal", ReportGoal),
                        rospy.ServiceProxy("attach_object", AttachObject),
                        rospy.ServiceProxy("check_state", CheckState)]
        cls.services[0].wait_for_service(20.0)
        wait_for(lambda: cls.permissions)
        cls.pid = pid_of_manager()
        cls.run_for(1.0)  # what is allocated at first
        cls.before_kb, begin = resident_kb(cls.pid), time.monotonic()
        cls.run_for(cls.seconds)
        cls.after_kb, cls.took = resident_kb(cls.pid), time.monotonic() - begin
        cls.pid_after = pid_of_manager()

    @classmethod
    def take_diagnostics(cls, message):
        cls.diagnostics = (cls.diagnostics + [f"{value.key}: {value.value}"
                                              for status in message.status
                                              for value in status.values])[-2000:]

    @classmethod
    def name(cls):
        cls.names += 1
        return f"name_{cls.names}_{cls.random.randrange(1 << 40)}"

    @classmethod
    def run_for(cls, seconds):
        rate, end, rounds = rospy.Rate(RATE), time.monotonic() + seconds, 0
        while time.monotonic() < end:
            cls.publish(rospy.Time.now())
            if rounds % 10 == 0:
                cls.call()
            if rounds % 50 == 0:
                rospy.Publisher(cls.name(), Bool, queue_size=1).unregister()
            rounds += 1
            rate.sleep()

    @classmethod
    def publish(cls, now):
        transforms = []
        for _ in range(BURST):
            transform = TransformStamped(child_frame_id=cls.name(), transform=Transform())
            transform.header.frame_id = cls.random.choice((cls.name(), "torso_link"))
            transform.header.stamp = now
            transform.transform.rotation.w = 1.0
            transforms.append(transform)
        cls.publishers[cls.random.choice(("/tf", "/tf_static"))].publish(transforms)
        joints = JointState(name=[cls.name() for _ in range(BURST)], position=[0.0] * BURST)
        joints.header.stamp = now
        cls.publishers["joint_states"].publish(joints)
        scan = LaserScan(angle_min=-1.0, angle_max=1.0, angle_increment=0.02, range_max=10.0,
                         ranges=[1.0] * 101)
        scan.header.stamp, scan.header.frame_id = now, cls.name()
        cls.publishers["scan"].publish(scan)
        report = ScanReport(outcome=ScanReport.DROPPED, dropped=cls.name())
        report.header.stamp = now
        cls.publishers["scan_report"].publish(report)
        cls.publishers["trajectory"].publish(
            JointTrajectory(joint_names=[cls.name()],
                            points=[JointTrajectoryPoint(positions=[0.0])]))
        sphere = Primitive(shape="sphere", radius=0.01)
        sphere.pose.orientation.w = 1.0
        held = AttachedObjects(objects=[AttachedObject(name=cls.name(), link="torso_link",
                                                       primitive=sphere)])
        held.header.stamp, held.header.frame_id = now, cls.name()
        cls.publishers["attached_objects"].publish(held)
        bad_map = CuboidMap()
        bad_map.header.stamp, bad_map.header.frame_id = now, cls.name()
        cls.publishers["cuboid_map"].publish(bad_map)

    @classmethod
    def call(cls):
        sphere = Primitive(shape="sphere", radius=0.01)
        sphere.pose.orientation.w = 1.0
        for service, arguments in zip(cls.services, (
                (cls.name(), "right_palm_link", sphere, rospy.Duration(1.0), cls.name(), True),
                (cls.name(), cls.name(), True),
                (cls.name(), "right_palm_link", sphere),
                (JointState(name=[cls.name()], position=[0.0]),))):
            try:
                service(*arguments)
            except rospy.ServiceException:
                pass

    def test_memory_is_bounded(self):
        print(f"{self.names} names in {self.took:.0f} s: {self.before_kb} -> {self.after_kb} kB")
        self.assertGreater(self.names, 500 * self.seconds)
        self.assertLess(self.after_kb - self.before_kb, GROWTH_MAX_KB)

    def test_the_nodelets_live_and_say_what_they_passed_over(self):
        self.assertEqual(self.pid_after, self.pid)
        told = wait_for(lambda: [line for line in self.diagnostics
                                 if "more than 2000 frame names" in line])
        self.assertTrue(told)

    def test_permissions_go_on(self):
        begin = self.permissions[-1].header.stamp
        wait_for(lambda: self.permissions[-1].header.stamp > begin + rospy.Duration(0.5))


if __name__ == "__main__":
    rospy.init_node("strange_names_test")
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=StrangeNamesTest.seconds)
    parser.add_argument("--seed", type=int, default=StrangeNamesTest.seed)
    settings, _ = parser.parse_known_args(rospy.myargv()[1:])
    StrangeNamesTest.seconds, StrangeNamesTest.seed = settings.seconds, settings.seed
    rostest.rosrun("tccm_monitor", "strange_names", StrangeNamesTest)
