#!/usr/bin/python3
"""An arm is never faster than permitted, and slows down as fast as the margins assume."""

import time

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus

from gate_case import REACHED, SLACK, GateCase
from gated_arm import ELBOW, end_of
from scripted_monitor import PERMISSION_PERIOD
from tccm_monitor.msg import MotionPermission
from waiting import wait_for

OVER = 0.2  # [s] that speeds are measured over


class SpeedsTest(GateCase):
    def run_at(self, arm, scale, seconds):
        """@return from when to when it goes at that scale at most: it has had the time to slow
        down."""
        level = MotionPermission.SLOW if scale < 1.0 else MotionPermission.OK
        begin = self.monitor.permit(level, scale) + arm.stop_duration + 0.1
        end = begin + seconds
        wait_for(lambda: time.monotonic() > end)
        return begin, end

    def test_SLOW_is_never_faster_than_permitted_and_takes_longer(self):
        arm, begun = self.right, time.monotonic()
        speed = self.set_off(arm, 1.0, 2.5)
        for scale in (0.5, 0.1, 0.3, 0.05):
            begin, end = self.run_at(arm, scale, 0.4)
            fastest = arm.fastest(OVER, begin, end)
            print(f"{self.mode}: {fastest / speed:.3f} of the speed at a scale of {scale}")
            self.assertLess(fastest, 1.01 * scale * speed)
            self.assertGreater(fastest, 0.4 * scale * speed)
        self.monitor.permit()
        self.assertEqual(end_of(arm.client), REACHED)
        self.assertGreater(time.monotonic() - begun, 3.5)
        arm.come_to_rest()
        self.assert_at(arm, arm.aside(1.0))

    def test_it_slows_down_as_fast_as_the_margins_assume(self):
        arm = self.right
        speed = self.set_off(arm, 1.0, 2.5)
        told = self.monitor.permit(MotionPermission.SLOW, 0.1)
        wait_for(lambda: time.monotonic() > told + 1.0)
        end = told + PERMISSION_PERIOD + SLACK + 0.04
        slow = next(at for at, _, _, v in arm.log(told) if abs(v[ELBOW]) < 0.11 * speed)
        print(f"{self.mode}: slow {1e3 * (slow - told):.0f} ms after it was told")
        self.assertLess(slow, end + arm.stop_duration)

    def test_what_is_announced_says_where_the_arm_is(self):
        arm = self.right
        self.set_off(arm, 1.0, 2.5)
        for scale in (1.0, 0.4):
            self.run_at(arm, scale, 0.3)
            _, stamp, positions, _ = arm.log()[-1]
            announced = self.last_trajectory()
            a, b = announced.points[0], announced.points[-1]
            speed = (b.positions[ELBOW] - a.positions[ELBOW]) / b.time_from_start.to_sec()
            since = stamp - announced.header.stamp.to_sec()
            where = a.positions[ELBOW] + since * speed
            self.assertLess(abs(where - positions[ELBOW]), abs(speed) * (0.05 / scale + 0.05))

    def test_a_goal_that_is_begun_slowly_is_slow_from_its_begin(self):
        arm, begun = self.right, time.monotonic()
        self.monitor.permit(MotionPermission.SLOW, 0.2)
        time.sleep(0.1)
        arm.client.send_goal(arm.goal(arm.aside(0.2), 0.5))
        self.assertEqual(end_of(arm.client), REACHED)
        self.assertLess(arm.fastest(OVER, begun), 1.02 * 0.2 * 0.4)

    def test_a_scale_that_changes_all_the_time(self):
        arm, begun = self.right, time.monotonic()
        arm.client.send_goal(arm.goal(arm.aside(1.0), 2.0, smooth=True))
        scale, step = 1.0, -0.07
        while arm.client.get_state() <= GoalStatus.ACTIVE:
            scale += step
            if not 0.3 < scale < 1.0:
                step = -step
            self.monitor.permit(MotionPermission.SLOW, max(0.3, min(1.0, scale)))
            time.sleep(PERMISSION_PERIOD)
            self.assertLess(time.monotonic() - begun, 15.0)
        self.assertEqual(end_of(arm.client), REACHED)
        arm.come_to_rest()
        self.assert_at(arm, arm.aside(1.0))
        self.assertLess(arm.fastest(OVER, begun), 1.5 * 1.0 / 2.0 * 1.05)


if __name__ == "__main__":
    rospy.init_node("gate_speeds_test")
    rostest.rosrun("tccm_monitor", "gate_speeds", SpeedsTest)
