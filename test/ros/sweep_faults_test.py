#!/usr/bin/python3
"""Scans keep coming, but the sweep does not cover the arm any more: the tilt stands still, nods over a
small part of its range, or the head is turned away. Level and reason come in time, and what was covered
again moves again."""

import rospy
import rostest

import simulated_head
from gated_robot import GatedRobot, wait_for
from monitor_recorder import PUBLISH_PERIOD, SCAN_PERIOD, SLACK, TILT_PERIOD
from named_subtests import NamedSubTests
from simulated_head import SimulatedHead
from tccm_monitor.msg import MotionPermission

LASTS = 1.0  # seconds that each fault goes on after the worst was found
# From the last look to the permission that rests on it.
DELAY = SCAN_PERIOD + PUBLISH_PERIOD + SLACK
SLOW, STOP, FAULT = MotionPermission.SLOW, MotionPermission.STOP, MotionPermission.FAULT


class Stage:
    """@param periods of the tilt from the last sound look to the reason."""

    def __init__(self, level, reason, periods):
        self.level, self.reason = level, reason
        self.due = periods * TILT_PERIOD + DELAY

    def is_told_by(self, permission):
        return permission.level >= self.level and self.reason in permission.reasons


class Fault:
    """@param sound whether positions are of a head that still does what it should."""

    def __init__(self, name, sound, *stages):
        self.name, self.sound, self.stages = name, sound, stages


OLD = (Stage(SLOW, "EVIDENCE_OLD", 1.5), Stage(STOP, "EVIDENCE_OLD", 2.5))
FAULTS = (Fault("frozen", simulated_head.tilts, Stage(FAULT, "SWEEP_INCOMPLETE", 0.75)),
          Fault("narrowed", simulated_head.looks_far_down, *OLD),
          Fault("turned_away", simulated_head.turns, *OLD))


class Episode:
    """One fault from its beginning until the robot may move again."""

    def __init__(self, robot, head, fault):
        self.fault, self.robot = fault, robot
        self.moved_before = robot.wait_until_it_may_move()
        head.wait_until_it_looks_down()
        self.begin = head.set_fault(fault.name)
        self.found = [wait_for(lambda stage=stage: robot.first_permission(
            stage.is_told_by, self.begin), stage.due + 2.0) for stage in fault.stages]
        self.worst = self.found[-1]
        self.last_sound = head.last(fault.sound, self.begin, rospy.get_time())
        if self.worst:
            robot.wait_for_permissions_until(self.worst.header.stamp.to_sec() + LASTS)
        self.maps = robot.heard["cuboid_map"][-1]
        self.meanwhile_reset = robot.reset()
        self.end = head.set_fault("none")
        self.lives = robot.manager_lives()
        self.ended = wait_for(lambda: self.status_without_cause())
        self.reset_after = robot.reset()
        self.released = robot.wait_until_it_may_move()

    def holds(self):
        """Until it is reset."""
        return self.fault.stages[-1].level == FAULT

    def status_without_cause(self):
        status = self.robot.status()
        reason = self.fault.stages[-1].reason
        return status if status.header.stamp.to_sec() > self.end and \
            reason not in status.reasons else None


class SweepFaultsTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.robot, head = GatedRobot(), SimulatedHead()
        # The palm then is below all that counts as looked at by the narrowed tilt, a beam's
        # neighbourhood included, and above the tilt's lowest.
        head.reach_until("right_elbow_joint", -2.35)
        rospy.sleep(2.0 * TILT_PERIOD)
        cls.episodes = [Episode(cls.robot, head, fault) for fault in FAULTS]

    @classmethod
    def tearDownClass(cls):
        cls.robot.tear_down()

    def for_each(self, check):
        for episode in self.episodes:
            with self.subTest(fault=episode.fault.name):
                self.assertIsNotNone(episode.moved_before, "it never may move")
                self.assertNotIn(None, episode.found, "a stage never came")
                check(episode)

    def test_level_and_reason_come_in_time_one_after_the_other(self):
        def check(episode):
            for stage, found in zip(episode.fault.stages, episode.found):
                delay = found.header.stamp.to_sec() - episode.last_sound
                rospy.loginfo("%s: level %d, %s after %.0f ms, at most %.0f ms", episode.fault.name,
                              found.level, found.reasons, 1e3 * delay, 1e3 * stage.due)
                self.assertLess(delay, stage.due)
                self.assertEqual(found.level, stage.level)
                self.assertEqual(found.reasons[0], stage.reason)
                self.assertNotEqual(found.detail, "")
        self.for_each(check)

    def test_nothing_is_permitted_while_it_lasts(self):
        def check(episode):
            meanwhile = self.robot.permissions_between(episode.worst.header.stamp.to_sec(),
                                                       episode.end)
            self.assertGreater(len(meanwhile), 0.5 * LASTS / PUBLISH_PERIOD)
            self.assertFalse(any(permission.permitted for permission in meanwhile))
            self.assertEqual({permission.speed_scale for permission in meanwhile}, {0.0})
        self.for_each(check)

    def test_scans_are_mapped_all_the_while(self):
        def check(episode):
            self.assertGreater(episode.maps, episode.end - 0.2)
        self.for_each(check)

    def test_where_the_evidence_is_old_the_robot_may_only_go_slowly(self):
        def check(episode):
            slow = episode.found[0]
            if slow.level == SLOW:
                self.assertTrue(slow.permitted)
                self.assertLessEqual(slow.speed_scale, 0.3)
        self.for_each(check)

    def test_a_tilt_that_stood_has_to_be_measured_anew_and_be_reset(self):
        def check(episode):
            if not episode.holds():
                return
            self.assertFalse(episode.meanwhile_reset.success)
            self.assertEqual(episode.meanwhile_reset.message, "SWEEP_INCOMPLETE lasts")
            self.assertGreater(episode.ended.header.stamp.to_sec(), episode.end + TILT_PERIOD)
            self.assertEqual(episode.ended.latched, "SWEEP_INCOMPLETE")
            self.assertTrue(episode.ended.stop)
            self.assertTrue(episode.reset_after.success, episode.reset_after.message)
        self.for_each(check)

    def test_evidence_that_is_young_again_lets_the_robot_go_without_a_reset(self):
        def check(episode):
            if episode.holds():
                return
            self.assertEqual(episode.ended.latched, "")
            self.assertEqual(episode.ended.reason, "RELEASING")
        self.for_each(check)

    def test_the_robot_may_move_again(self):
        def check(episode):
            self.assertIsNotNone(episode.released)
            self.assertEqual(episode.released.level, MotionPermission.OK)
        self.for_each(check)

    def test_the_manager_lives(self):
        self.for_each(lambda episode: self.assertTrue(episode.lives))


if __name__ == "__main__":
    rospy.init_node("sweep_faults_test")
    rostest.rosrun("tccm_monitor", "sweep_faults", SweepFaultsTest)
