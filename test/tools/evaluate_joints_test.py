#!/usr/bin/python3
"""Joint states that lie, replayed: recordings of others, where they are, and bags made here.

Environment: as evaluate_test.py.
"""
import os
import sys
import unittest

from sensor_msgs.msg import JointState

from evaluate_run import CONFIGS, HERE, EvaluateTest
from made_bag import CONFIG, URDF, Stream


class OnCases(EvaluateTest):
    """Small recordings with one fault each that were believed."""

    def setUp(self):
        super().setUp()
        self.cases = os.path.join(os.environ.get("TCCM_SHARED_DATA", ""), "cases")
        if not os.path.isdir(self.cases):
            self.skipTest("TCCM_SHARED_DATA names no folder with cases")

    def reasons(self, bag, urdf, config, out="out", status=0):
        """@param status 1 where no scan can be mapped, since the robot cannot be placed."""
        self.evaluate(os.path.join(self.cases, bag), out=out, config=config, urdf=urdf,
                      status=status)
        return [(float(row["stamp"] or 0.0), row["reason"]) for row in self.rows("verdicts", out)]

    def case(self, folder, bag, urdf, out="out", status=0):
        return self.reasons(bag, os.path.join(self.cases, folder, urdf),
                            os.path.join(self.cases, folder, "cfg.yaml"), out, status)

    def test_two_joint_publishers_contradict_each_other(self):
        dual_arm = os.path.join(HERE, "..", "..", "simulation", "robot", "dual_arm.urdf")
        reasons = self.reasons("two-joint-publishers/zerofirst_box.bag", dual_arm,
                               os.path.join(CONFIGS, "simulation.yaml"), status=1)
        after = [reason for stamp, reason in reasons if stamp > 1000.1]
        self.assertEqual(set(after), {"JOINT_CONTRADICTED"})

    def test_the_way_ahead_goes_on_beyond_a_limit_that_does_not_hold(self):
        wrong = self.case("limit-beyond", "limit-beyond/limit.bag", "r157.urdf", "wrong")
        right = self.case("limit-beyond", "limit-beyond/limit.bag", "r31.urdf", "right")
        first = [min(stamp for stamp, reason in run if reason == "COLLISION_AHEAD")
                 for run in (wrong, right)]
        self.assertLess(first[0] - first[1], 0.02)
        after = {reason for stamp, reason in wrong if stamp >= first[0]}
        self.assertEqual(after, {"COLLISION_AHEAD", "JOINT_OUT_OF_RANGE"}, "in the end it is far beyond")

    def test_positions_in_degrees_are_a_fault(self):
        reasons = self.case("units", "units/deg.bag", "arm.urdf", status=1)
        self.assertEqual({reason for _, reason in reasons}, {"JOINT_OUT_OF_RANGE"})
        control = self.case("units", "control_rad.bag", "arm.urdf", "control")
        self.assertEqual(control[-1][1], "COLLISION")

    def test_a_velocity_in_ticks_is_a_fault(self):
        reasons = self.case("ticks", "ticks/roll_100000.bag", "roll.urdf")
        self.assertIn("JOINT_OUT_OF_RANGE", {reason for _, reason in reasons})


class OnMadeBags(EvaluateTest):
    def reasons(self, change):
        """@param change of each joint state: what comes in its place."""
        stream = Stream()
        messages = []
        for topic, message, seconds in stream.messages:
            states = change(message) if topic == "/joint_states" else [message]
            messages += [(topic, state, seconds) for state in states]
        stream.messages = messages
        stream.write(self.path("in.bag"))
        self.evaluate(self.path("in.bag"), urdf=self.text("robot.urdf", URDF),
                      config=self.text("config.yaml", CONFIG))
        return {row["reason"] for row in self.rows("verdicts")}

    def test_a_relay_of_the_same_states_changes_nothing(self):
        once = self.reasons(lambda state: [state])
        self.folder.cleanup()
        self.setUp()
        self.assertEqual(self.reasons(lambda state: [state, state]), once)
        self.assertNotIn("JOINT_CONTRADICTED", once)

    def test_a_second_publisher_of_zeros_is_a_fault(self):
        def with_zeros(state):
            zeros = JointState(header=state.header, name=state.name, position=[0.0] * len(state.name))
            return [state, zeros]
        self.assertIn("JOINT_CONTRADICTED", self.reasons(with_zeros))


if __name__ == "__main__":
    unittest.main()
