#!/usr/bin/python3
"""With `occlusion_stops: false` a hidden hand slows the robot down and does not stop it, and the
flag says so all the same."""

import unittest

import rospy
import rostest

from monitor_recorder import SLACK, START, Recorder, Recording, wait_for_nodelets
from tccm_monitor.msg import MonitorStatus, MotionPermission

SETTLED = START + 2.6
PATIENCE = 0.3  # from the first beam on, until a good part of the hand is hidden
SLOW_SCALE = 0.3  # the default


class OcclusionSlowsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        recording = Recording("occlusion")
        cls.truth = recording.truth
        cls.recorder, cls.permissions = Recorder(), []
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=1000)
        wait_for_nodelets()
        recording.play().wait()
        cls.hidden = cls.longest_run()
        stamps = [status.header.stamp.to_sec() for status in cls.hidden]
        cls.rise, cls.fall = (stamps[0], stamps[-1]) if stamps else (None, None)

    @classmethod
    def longest_run(cls):
        """The most statuses in a row that say hidden: at its edges it may come and go. Their stamps
        do not tell them from their neighbours, as several checks may be made at one instant."""
        runs = [[]]
        for status in cls.recorder.between(SETTLED, START + 1e6):
            if status.occlusion:
                runs[-1].append(status)
            elif runs[-1]:
                runs.append([])
        return max(runs, key=len)

    def test_it_is_found_in_time(self):
        self.assertIsNotNone(self.rise, self.recorder.changes())
        self.assertGreater(self.rise, self.truth["first_beam_s"])
        self.assertLess(self.rise, self.truth["first_beam_s"] + PATIENCE)

    def test_the_robot_is_slowed_down_and_told_why(self):
        self.assertGreater(len(self.hidden), 3)
        for status in self.hidden:
            self.assertEqual((status.level, status.stop), (MonitorStatus.SLOW, False))
            self.assertIn(status.reason, ("OCCLUSION", "OCCLUSION_AHEAD", "MOVING_OUT"))
            self.assertGreater(status.speed_scale, 0.0)
            self.assertLessEqual(status.speed_scale, SLOW_SCALE)

    def test_the_flag_says_so_all_the_same(self):
        begin, end = self.rise + SLACK, self.fall - SLACK
        self.assertEqual(set(self.recorder.flag_between("occlusion", begin, end)), {True})
        self.assertEqual(set(self.recorder.flag_between("stop", begin, end)), {False})

    def test_the_permission_is_a_slow_one(self):
        given = [permission for permission in self.permissions
                 if self.rise < permission.header.stamp.to_sec() < self.fall - SLACK]
        self.assertEqual({(permission.level, permission.permitted) for permission in given},
                         {(MotionPermission.SLOW, True)})

    def test_nothing_ever_stops_it(self):
        after = self.recorder.between(SETTLED, START + 1e6)
        # Where the recording is over, the clock stands still.
        self.assertFalse(any(status.stop and status.reason != "NO_CLOCK" for status in after),
                         self.recorder.changes())

    def test_the_speed_scale_falls_at_once_and_rises_slowly(self):
        statuses = self.recorder.between(SETTLED, START + 1e6)
        for before, after in zip(statuses, statuses[1:]):
            seconds = (after.header.stamp - before.header.stamp).to_sec()
            self.assertLess(after.speed_scale - before.speed_scale, 0.5 * seconds + 1e-6)


if __name__ == "__main__":
    rospy.init_node("occlusion_slows_test")
    rostest.rosrun("tccm_monitor", "occlusion_slows", OcclusionSlowsTest)
