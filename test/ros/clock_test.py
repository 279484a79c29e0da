#!/usr/bin/python3
"""Simulated time stands still: a fault. It jumps back: all begins anew, but what awaits a reset."""

import subprocess
import time
import unittest

import rospy
import rostest
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool, Trigger

from gated_robot import wait_for
from monitor_recorder import (FLAGS, GAP_MAX, PUBLISH_PERIOD, START, Recorder, Recording,
                              share_in_time, wait_for_nodelets, wait_until)
from tccm_monitor.msg import MonitorStatus, MotionPermission

PLAYED = 4.0  # seconds of the recording
PAUSED = START + 1.5
WINDOW = 0.4
STALL_LIMIT = 0.5  # seconds of the wall clock
SLACK = 0.1  # both ends are measured here


class ClockTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorder = Recorder()
        cls.permissions, cls.moved = [], [(0.0, 0.0)]
        rospy.Subscriber("motion_permission", MotionPermission, cls.take_permission,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("/clock", Clock, cls.take_clock, queue_size=1000, tcp_nodelay=True)
        cls.reset = rospy.ServiceProxy("reset", Trigger)
        wait_for_nodelets()
        player = cls.play()
        cls.ok_before = wait_for(cls.is_ok)
        wait_until(PAUSED)
        cls.stand_still()
        cls.move_on()
        player.wait()
        cls.stalled_at_the_end = wait_for(cls.stands_still)
        cls.anew = len(cls.recorder.statuses)
        player = cls.play()
        cls.held_at_last = wait_for(lambda: cls.recorder.statuses[-1].reason == "AWAITING_RESET")
        cls.reset_at_last = cls.reset()
        cls.ok_at_last = wait_for(cls.is_ok)
        player.terminate()
        player.wait()

    @classmethod
    def play(cls):
        return subprocess.Popen(
            ["rosbag", "play", "--quiet", "--clock", "--hz=200", "--delay=1.0",
             f"--duration={PLAYED}", Recording("free_motion").bag, "__name:=player"],
            stdin=subprocess.DEVNULL)

    @classmethod
    def stand_still(cls):
        pause = rospy.ServiceProxy("/player/pause_playback", SetBool)
        pause.wait_for_service(10.0)
        pause(True)
        cls.still = wait_for(cls.stands_still)
        cls.still_since = cls.moved[-1][0]
        begin = time.monotonic()
        wait_for(lambda: cls.permissions[-1][0] > begin + 0.3)
        cls.reset_meanwhile = cls.reset()
        pause(False)
        cls.still_until = time.monotonic()

    @classmethod
    def move_on(cls):
        cls.held = wait_for(lambda: cls.recorder.statuses[-1]
                            if cls.recorder.statuses[-1].reason == "AWAITING_RESET" else None)
        cls.reset_after = cls.reset()
        cls.ok_after = wait_for(cls.is_ok)

    @classmethod
    def take_permission(cls, permission):
        cls.permissions.append((time.monotonic(), permission))

    @classmethod
    def take_clock(cls, clock):
        if clock.clock.to_sec() != cls.moved[-1][1]:
            cls.moved.append((time.monotonic(), clock.clock.to_sec()))

    @classmethod
    def is_ok(cls):
        return bool(cls.permissions) and cls.permissions[-1][1].level == MotionPermission.OK

    @classmethod
    def stands_still(cls):
        """The permission that says so, and when it came."""
        if cls.permissions and "NO_CLOCK" in cls.permissions[-1][1].reasons:
            return cls.permissions[-1]
        return None

    def test_time_that_stands_still_is_a_fault_in_time(self):
        self.assertTrue(self.ok_before)
        self.assertIsNotNone(self.still)
        arrival, permission = self.still
        self.assertLess(arrival - self.still_since, STALL_LIMIT + PUBLISH_PERIOD + SLACK)
        self.assertEqual(permission.level, MotionPermission.FAULT)
        self.assertEqual(permission.reasons[0], "NO_CLOCK")

    def test_nothing_is_permitted_while_it_stands_still(self):
        meanwhile = [permission for arrival, permission in self.permissions
                     if self.still[0] <= arrival < self.still_until]
        self.assertGreater(len(meanwhile), 8)
        self.assertFalse(any(permission.permitted for permission in meanwhile))
        self.assertEqual({permission.speed_scale for permission in meanwhile}, {0.0})

    def test_it_holds_until_it_is_reset(self):
        self.assertFalse(self.reset_meanwhile.success)
        self.assertEqual(self.reset_meanwhile.message, "NO_CLOCK lasts")
        self.assertEqual(self.held.latched, "NO_CLOCK")
        self.assertTrue(self.reset_after.success)
        self.assertTrue(self.ok_after)

    def test_the_end_of_a_recording_is_a_fault_too(self):
        self.assertIsNotNone(self.stalled_at_the_end)

    def test_a_jump_back_begins_anew_as_INIT_and_lifts_no_latch(self):
        after = self.recorder.statuses[self.anew:]
        self.assertTrue(self.held_at_last)
        jump = next(i for i, status in enumerate(after)
                    if status.header.stamp.to_sec() < START + 1.0)
        waits = next(i for i, status in enumerate(after)
                     if i > jump and status.reason == "AWAITING_RESET")
        moves = next(i for i, status in enumerate(after) if i > waits and not status.stop)
        begun = after[jump:waits]
        self.assertEqual({(status.level, status.reason) for status in begun},
                         {(MonitorStatus.STOP, "INIT")})
        self.assertFalse(any(status.known for status in begun))
        self.assertEqual({status.speed_scale for status in begun}, {0.0})
        self.assertGreater(after[moves].header.stamp.to_sec(), START + WINDOW)
        self.assertEqual({status.latched for status in after[jump:moves - 1]}, {"NO_CLOCK"})
        self.assertTrue(self.reset_at_last.success, self.reset_at_last.message)
        self.assertTrue(self.ok_at_last)

    def test_no_flag_says_clear_before_the_new_window_is_full(self):
        for flag in FLAGS:
            values = self.recorder.flags[flag]
            jump = next(i for i in range(1, len(values)) if values[i][0] < values[i - 1][0] - 1.0)
            self.assertNotIn(False, [value for stamp, value in values[jump:]
                                     if stamp < START + WINDOW], flag)

    def test_permissions_go_on_at_their_rate(self):
        arrivals = [arrival for arrival, _ in self.permissions]
        self.assertLess(max(b - a for a, b in zip(arrivals, arrivals[1:])), GAP_MAX)
        self.assertGreater(share_in_time(arrivals), 0.6)
        numbers = [permission.sequence for _, permission in self.permissions]
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))


if __name__ == "__main__":
    rospy.init_node("clock_test")
    rostest.rosrun("tccm_monitor", "clock", ClockTest)
