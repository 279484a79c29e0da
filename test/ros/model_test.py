#!/usr/bin/python3
"""Transforms put a hand elsewhere than the URDF and joint states do: a fault that names it, unless its
frame is trusted. Names of frames may have a prefix."""

import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray

from gated_robot import GatedRobot, wait_for
from input_gate import altered
from tccm_monitor.msg import MotionPermission

OFF_M = 0.1
FOUND_IN = 2.0  # seconds: ten comparisons, and what a busy machine adds
WATCHED = 3.0


class ModelTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.prefix = rospy.get_param("~in_front")
        cls.diagnostics = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.diagnostics.append, queue_size=100)
        cls.robot = GatedRobot()
        cls.robot.gates["scan"].close(altered(cls.rename_scan))
        cls.lie_about()
        cls.moved = cls.robot.wait_until_it_may_move()
        cls.trusted_since = cls.lie_about("left_palm_link")
        cls.robot.wait_for_permissions_until(cls.trusted_since + WATCHED)
        cls.lied_since = cls.lie_about("left_palm_link", "right_palm_link")
        cls.found = wait_for(lambda: cls.robot.first_permission(
            lambda permission: "MODEL_DISAGREES" in permission.reasons, cls.lied_since))
        cls.status = wait_for(lambda: cls.robot.status() if cls.robot.status().reason ==
                              "MODEL_DISAGREES" else None)
        cls.lie_about()
        cls.released = cls.robot.wait_until_it_may_move()
        cls.lives = cls.robot.manager_lives()

    @classmethod
    def tearDownClass(cls):
        cls.robot.tear_down()

    @classmethod
    def rename_scan(cls, scan):
        scan.header.frame_id = cls.prefix + scan.header.frame_id

    @classmethod
    def lie_about(cls, *links):
        def alter(message):
            for transform in message.transforms:
                if transform.child_frame_id in links:
                    transform.transform.translation.y += OFF_M
                transform.header.frame_id = cls.prefix + transform.header.frame_id
                transform.child_frame_id = cls.prefix + transform.child_frame_id
        cls.robot.gates["/tf"].close(altered(alter))
        return rospy.get_time()

    def test_the_robot_may_move_where_they_agree(self):
        self.assertIsNotNone(self.moved)

    def test_a_trusted_frame_may_be_elsewhere(self):
        permissions = self.robot.permissions_between(self.trusted_since, self.lied_since)
        reasons = {reason for permission in permissions for reason in permission.reasons}
        self.assertNotIn("MODEL_DISAGREES", reasons)
        self.assertEqual(permissions[-1].level, MotionPermission.OK, permissions[-1])

    def test_another_is_a_fault_that_names_it(self):
        self.assertIsNotNone(self.found)
        self.assertEqual(self.found.level, MotionPermission.FAULT)
        self.assertFalse(self.found.permitted)
        self.assertLess(self.found.header.stamp.to_sec() - self.lied_since, FOUND_IN)
        self.assertEqual(self.status.link, "right_palm_link")
        self.assertIn("tf puts 'right_palm_link' 0.100 m off", self.status.detail)

    def test_it_is_over_once_they_agree_and_a_person_has_reset(self):
        self.assertIsNotNone(self.released)
        self.assertTrue(self.lives)

    def test_the_diagnostics_tell_what_was_compared(self):
        values = {entry.key: entry.value for message in self.diagnostics for status in message.status
                  for entry in status.values}
        self.assertGreater(int(values["links compared with tf"]), 20)
        self.assertNotIn("not compared with tf", values)


if __name__ == "__main__":
    rospy.init_node("model_test")
    rostest.rosrun("tccm_monitor", "model", ModelTest)
