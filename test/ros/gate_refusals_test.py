#!/usr/bin/python3
"""A TrajectoryGate whose configuration contradicts the arms' controllers, or itself, refuses to start,
and says in one line what is to be changed."""

import subprocess
import unittest

import rospy
import rostest

SOUND = {"name": "right_arm", "downstream": "right_arm_controller", "stop_duration_s": 0.3}
SLIDER = {"name": "right_arm", "downstream": "bare_controller", "mode": "forward",
          "joints": ["right_elbow_joint"], "slider": "speed"}


class GateRefusalsTest(unittest.TestCase):
    def assert_refused(self, controllers, *words, name="trajectory_gate"):
        """@param words of the line that says why."""
        rospy.set_param(f"{name}/controllers", controllers)
        gate = subprocess.run(["rosrun", "nodelet", "nodelet", "standalone",
                               "tccm_monitor/TrajectoryGate", f"__name:={name}"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=20.0, check=False)
        self.assertNotEqual(gate.returncode, 0)
        told = [line for line in gate.stdout.splitlines() if "refuses to start" in line]
        self.assertEqual(len(told), 1, gate.stdout)
        for word in words:
            self.assertIn(word, told[0])

    def test_a_stop_duration_that_is_not_the_controllers(self):
        for wrong in (0.0, 0.5):
            self.assert_refused([{**SOUND, "stop_duration_s": wrong}], "right_arm",
                                f"stop_duration_s is {wrong:g}",
                                "stop_trajectory_duration of right_arm_controller is 0.3")

    def test_joints_that_are_not_the_controllers(self):
        self.assert_refused([{**SOUND, "joints": ["right_elbow_joint"]}], "joints are others than")

    def test_a_controller_without_joints(self):
        self.assert_refused([{"name": "arm", "downstream": "bare_controller"}],
                            "bare_controller/joints")

    def test_a_slider_with_a_controller_that_takes_time_to_halt(self):
        self.assert_refused([{**SLIDER, "stop_duration_s": 0.3}], "stop_duration_s has to be 0")

    def test_a_slider_without_forwarding(self):
        self.assert_refused([{**SLIDER, "mode": "stream"}], "slider is for the mode 'forward'")

    def test_words_that_are_none_of_those_allowed(self):
        for key in ("mode", "hold", "slider_type"):
            self.assert_refused([{**SOUND, key: "fast"}], f"{key} is 'fast', it may be one of")

    def test_the_same_controller_twice_and_none_at_all(self):
        self.assert_refused([SOUND, {**SOUND, "name": "other_arm"}], "is there twice")
        self.assert_refused([{**SOUND, "downstream": "right_arm"}], "another namespace")
        self.assert_refused([], "there is none")

    def test_another_name_than_the_one_that_the_checker_reads(self):
        self.assert_refused([SOUND], "it has to be named /trajectory_gate", name="my_gate")


if __name__ == "__main__":
    rospy.init_node("gate_refusals_test")
    rostest.rosrun("tccm_monitor", "gate_refusals", GateRefusalsTest)
