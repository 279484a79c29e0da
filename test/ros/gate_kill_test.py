#!/usr/bin/python3
"""Whatever dies while an arm moves, the arm stands; and the client has a result where anybody is left
to give it."""

import os
import signal
import time
import unittest

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import Bool

from gated_arm import ELBOW, GatedArm, end_of
from scripted_monitor import ScriptedMonitor
from waiting import process_of, wait_for

SLACK = 0.06  # [s] that a busy machine may add
# How long the arm goes on at its speed. Setpoints lie so far ahead; the guard waits for so long.
GOES_ON = {"stream": 0.04, "forward": 0.06}
SPEED = 0.5  # [rad/s]


class GateKillTest(unittest.TestCase):
    def test_it(self):
        mode, victim = rospy.get_param("~mode"), rospy.get_param("~victim")
        monitor, arm = ScriptedMonitor(), GatedArm("right")
        self.addCleanup(monitor.fall_silent)
        monitor.speak()
        faults = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda message: faults.extend(
            status.message for status in message.status if status.level == 2))
        # Whoever listens besides is no guard.
        rospy.Subscriber("trajectory_gate/moving", Bool, lambda moving: None)

        def sets_off():
            arm.client.send_goal(arm.goal(arm.aside(0.9), 0.9 / SPEED))
            wait_for(lambda: abs(arm.elbow() - arm.start[ELBOW]) > 0.2 or
                     arm.client.get_state() > GoalStatus.ACTIVE)
            return arm.client.get_state() == GoalStatus.ACTIVE
        wait_for(sets_off)
        killed = time.monotonic()
        os.kill(process_of(rospy.resolve_name(victim)), signal.SIGKILL)
        if victim != "trajectory_gate":
            status, _ = end_of(arm.client)
            self.assertEqual(status, GoalStatus.ABORTED)
            text = arm.client.get_result().error_string
            print(f"{1e3 * (time.monotonic() - killed):.0f} ms after the kill: {text}")
            self.assertTrue(any(word in text for word in (
                {"gate_guard": ["gate_guard"]}.get(
                    victim, ["controller listens", "no action server", "s old",
                                "does not reach all arms"]))), text)
        if victim == "simulation":
            wait_for(lambda: any("is not known to stand" in fault for fault in faults))
            return  # and with it the arm
        arm.come_to_rest()
        self.assertTrue(arm.stands(1.0))
        halting = 0.0 if victim == "trajectory_gate" and mode == "stream" else \
            0.625 * arm.stop_duration
        promised = SPEED * (GOES_ON[mode] + halting)
        print(f"{arm.way(killed):.4f} rad of {promised:.4f} and {SPEED * SLACK:.4f}")
        self.assertLess(arm.way(killed), promised + SPEED * SLACK)


if __name__ == "__main__":
    rospy.init_node("gate_kill_test")
    rostest.rosrun("tccm_monitor", "gate_kill", GateKillTest)
