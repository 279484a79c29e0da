#!/usr/bin/python3
"""What the monitor hears is stopped, delayed, corrupted or falsified: the stop and its reason come
in time, nothing is permitted and nothing clear while it lasts, and the robot moves again only after
a reset."""

import math

import rospy
import rostest

from gated_robot import GatedRobot, wait_for
from input_faults import FAULTS
from monitor_recorder import FLAGS, GAP_MAX, PUBLISH_PERIOD, SLACK, share_in_time
from named_subtests import NamedSubTests
from tccm_monitor.msg import MotionPermission

LASTS = 0.25  # seconds that each fault goes on after it was found
FLAG_DELAY = 0.1  # from a permission to its flags, here
RISE = 0.5  # 1/s, speed_scale_rise_per_s


class Episode:
    """One fault from its beginning until the robot may move again."""

    def __init__(self, robot, name, fault):
        self.name, self.fault, self.robot = name, fault, robot
        self.found = self.reset_meanwhile = self.reset_after = self.held = self.released = None
        self.moved_before = robot.wait_until_it_may_move()
        self.begin = fault.begin(robot)
        self.found = wait_for(lambda: robot.first_permission(
            lambda permission: fault.reason in permission.reasons, self.begin), fault.limit + 3.0)
        if self.found:
            robot.wait_for_permissions_until(self.found.header.stamp.to_sec() + LASTS)
            self.reset_meanwhile = robot.reset()
            self.begin = fault.last_sound(robot, self.found.header.stamp.to_sec(), self.begin)
        self.end = fault.end(robot)
        if self.found:
            self.recover()

    def recover(self):
        robot = self.robot
        wanted = "AWAITING_RESET" if self.fault.holds else "RELEASING"

        def held():
            status = robot.status()
            return status if status.header.stamp.to_sec() > self.end and \
                status.reason == wanted else None

        def reset():
            """A busy machine may cause another fault between the two."""
            self.held = wait_for(held)
            self.reset_after = robot.reset()
            return self.reset_after.success
        wait_for(reset)
        self.released = robot.wait_until_it_may_move()

    def delay(self):
        """From the last sound message to the reason [s]."""
        return self.found.header.stamp.to_sec() - self.begin

    def due(self):
        return self.fault.limit + PUBLISH_PERIOD + SLACK

    def meanwhile(self):
        return self.robot.permissions_between(self.found.header.stamp.to_sec(), self.end)

    def reasons(self):
        """All that were given until nothing but the reset was missing."""
        permissions = self.robot.permissions_between(self.found.header.stamp.to_sec(),
                                                     self.held.header.stamp.to_sec())
        return {reason for permission in permissions for reason in permission.reasons}

    def flags(self, flag):
        return self.robot.recorder.flag_between(
            flag, self.found.header.stamp.to_sec() + FLAG_DELAY, self.end)


class FaultsTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.robot = GatedRobot()
        faults = FAULTS[rospy.get_param("~input")]
        cls.episodes = [Episode(cls.robot, name, fault) for name, fault in faults.items()]
        cls.manager_lives = cls.robot.manager_lives()

    @classmethod
    def tearDownClass(cls):
        cls.robot.tear_down()

    def for_each(self, check, needs="found"):
        """@param needs what an episode has to have come to before that can be checked."""
        for episode in self.episodes:
            with self.subTest(fault=episode.name):
                self.assertIsNotNone(getattr(episode, needs), f"{needs}: it never was")
                check(episode)

    def test_the_robot_may_move_before(self):
        self.for_each(lambda episode: None, needs="moved_before")

    def test_level_and_reason_come_in_time(self):
        def check(episode):
            rospy.loginfo("%s: %s after %.0f ms, at most %.0f ms", episode.name,
                          episode.found.reasons, 1e3 * episode.delay(), 1e3 * episode.due())
            self.assertLess(episode.delay(), episode.due())
            self.assertEqual(episode.found.level, episode.fault.level)
            self.assertEqual(episode.found.reasons[0], episode.fault.reason)
            self.assertNotEqual(episode.found.detail, "")
        self.for_each(check)

    def test_nothing_is_permitted_while_it_lasts(self):
        def check(episode):
            meanwhile = episode.meanwhile()
            self.assertTrue(meanwhile)
            self.assertFalse(any(permission.permitted for permission in meanwhile))
            self.assertEqual({permission.speed_scale for permission in meanwhile}, {0.0})
            self.assertGreaterEqual(min(permission.level for permission in meanwhile),
                                    episode.fault.level)
        self.for_each(check)

    def test_what_is_unknown_is_not_clear(self):
        def check(episode):
            for flag in FLAGS if episode.fault.holds else ("stop",):
                self.assertEqual(set(episode.flags(flag)), {True}, flag)
        self.for_each(check)

    def test_permissions_go_on_at_their_rate(self):
        def check(episode):
            end = episode.released.header.stamp.to_sec()
            permissions = self.robot.permissions_between(episode.begin - 0.1, end)
            stamps = [permission.header.stamp.to_sec() for permission in permissions]
            self.assertGreater(share_in_time(stamps), 0.6)
            gap, at = max((b - a, a - episode.begin) for a, b in zip(stamps, stamps[1:]))
            rospy.loginfo("%s: permissions are at most %.0f ms apart", episode.name, 1e3 * gap)
            self.assertLess(gap, GAP_MAX, f"{at:.3f} s after the fault")
            numbers = [permission.sequence for permission in permissions]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))
        self.for_each(check, needs="released")

    def test_a_reset_is_refused_while_it_lasts(self):
        def check(episode):
            if episode.fault.holds:
                self.assertFalse(episode.reset_meanwhile.success)
                self.assertRegex(episode.reset_meanwhile.message, "^[A-Z_]+ lasts$")
        self.for_each(check, needs="reset_meanwhile")

    def test_what_is_over_holds_until_it_is_reset(self):
        def check(episode):
            self.assertTrue(episode.held.stop)
            self.assertEqual(episode.held.level, MotionPermission.STOP)
            if episode.fault.holds:
                # A busy machine may have caused another one meanwhile.
                self.assertIn(episode.held.latched, {*episode.reasons(), *episode.fault.leaves})
                self.assertIn(episode.held.latched, episode.held.detail)
            else:
                self.assertEqual(episode.held.latched, "")
        self.for_each(check, needs="held")

    def test_the_robot_moves_again_only_after_a_reset(self):
        def check(episode):
            self.assertTrue(episode.reset_after.success, episode.reset_after.message)
            since = self.robot.permissions_between(episode.found.header.stamp.to_sec(), math.inf)
            before, moves = next((before, after) for before, after in zip(since, since[1:])
                                 if after.permitted)
            self.assertGreater(moves.header.stamp, episode.held.header.stamp)
            rose = (moves.header.stamp - before.header.stamp).to_sec()
            self.assertLessEqual(moves.speed_scale, RISE * rose + 1e-3, "it rises slowly")
        self.for_each(check, needs="released")

    def test_the_manager_lives(self):
        self.assertTrue(self.manager_lives)


if __name__ == "__main__":
    rospy.init_node("faults_test")
    rostest.rosrun("tccm_monitor", "faults", FaultsTest)
