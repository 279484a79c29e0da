"""What the Python client does, apart from its node: it does as the C++ one."""

import math
import pathlib
import random
import sys
import unittest

import rospy
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from tccm_monitor.msg import MotionPermission

sys.dont_write_bytecode = True
REPOSITORY = pathlib.Path(__file__).resolve().parents[2]

sys.path.insert(0, str(REPOSITORY / "examples"))
from guarded_motion import (CHECKING, HELD, IDLE, MOVING, REFUSED, BadGoal, GoalPath,  # noqa: E402
                            GuardedMotion, Instant, PermissionGate)

CYCLE, PERIOD, VALIDITY = 0.005, 0.02, 0.05
HERE = {"a": 0.0, "b": 1.0, "other": 9.0}
FIELDS = {"level": MotionPermission.OK, "permitted": True, "speed_scale": 1.0}


def at(elapsed):
    return Instant(1000.0 + elapsed, 5.0 + elapsed)


def permission(sequence, elapsed, **fields):
    message = MotionPermission(sequence=sequence, **{**FIELDS, **fields})
    message.header.stamp = rospy.Time.from_sec(1000.0 + elapsed)
    message.valid_until = message.header.stamp + rospy.Duration.from_sec(VALIDITY)
    return message


def point(seconds, positions, velocities=()):
    return JointTrajectoryPoint(positions=positions, velocities=velocities,
                                time_from_start=rospy.Duration.from_sec(seconds))


def path(*points, here=None):
    trajectory = JointTrajectory(joint_names=["a", "b"], points=points)
    return GoalPath(trajectory, here or HERE, 0.01)


class PermissionGateTest(unittest.TestCase):
    def setUp(self):
        self.gate = PermissionGate()

    def permits(self, elapsed):
        return not self.gate.objection(at(elapsed))

    def test_nothing_is_permitted_before_a_permission_is_heard(self):
        self.assertFalse(self.permits(0.0))
        self.gate.hear(permission(1, 0.0), at(0.0))
        self.assertTrue(self.permits(0.0))

    def test_only_a_permission_of_OK_or_SLOW_with_a_share_of_the_speed_permits(self):
        for level in range(5):
            for permitted in (False, True):
                for scale in (-1.0, 0.0, 0.5, 1.0, 1.1, math.nan, math.inf):
                    gate = PermissionGate()
                    gate.hear(permission(1, 0.0, level=level, permitted=permitted,
                                         speed_scale=scale), at(0.0))
                    expected = permitted and level <= 1 and scale in (0.5, 1.0)
                    self.assertEqual(not gate.objection(at(0.0)), expected)

    def test_the_objection_names_the_gravest_reason(self):
        self.gate.hear(permission(1, 0.0, permitted=False, reasons=["COLLISION", "OCCLUSION"],
                                  detail="hand touches the map"), at(0.0))
        self.assertEqual(self.gate.objection(at(0.0)),
                         "not permitted: COLLISION, hand touches the map")

    def test_a_permission_expires_on_either_clock(self):
        self.gate.hear(permission(1, 0.0), at(0.0))
        for stamp, steady, permits in ((0.049, 0.0, True), (0.051, 0.0, False),
                                       (0.0, 0.049, True), (0.0, 0.051, False)):
            now = Instant(at(stamp).stamp, at(steady).steady)
            self.assertEqual(not self.gate.objection(now), permits)

    def test_the_same_stamp_again_is_no_news(self):
        for i in range(1, 6):
            now = Instant(at(0.0).stamp, at(0.02 * i).steady)
            self.gate.hear(permission(i, 0.0), now)
            self.assertEqual(not self.gate.objection(now), i <= 3)

    def test_the_sequence_has_to_rise_and_may_wrap_around(self):
        for i, (sequence, permits) in enumerate((
                (2**32 - 2, True), (2**32 - 1, True), (3, True), (3, False), (4, True), (2, False),
                (3, True), (2, False))):
            self.gate.hear(permission(sequence, 0.02 * i), at(0.02 * i))
            self.assertEqual(self.permits(0.02 * i), permits, i)

    def test_stamps_do_not_go_back_nor_come_from_the_future(self):
        self.gate.hear(permission(1, 0.03), at(0.0))
        self.assertTrue(self.permits(0.0))
        self.gate.hear(permission(2, 0.02), at(0.01))
        self.assertFalse(self.permits(0.01))
        self.gate.hear(permission(3, 0.08), at(0.02))
        self.assertFalse(self.permits(0.02))


class GoalPathTest(unittest.TestCase):
    def test_it_goes_straight_from_where_the_joints_are_and_rests_at_its_end(self):
        way = path(point(2.0, [1.0, 1.0]), point(4.0, [1.0, 3.0]))
        self.assertEqual(way.at(1.0), ([0.5, 1.0], [0.5, 0.0]))
        self.assertEqual(way.at(3.0), ([1.0, 2.0], [0.0, 1.0]))
        self.assertEqual(way.at(9.0), ([1.0, 3.0], [0.0, 0.0]))

    def test_it_is_the_cubic_that_its_points_lie_on(self):
        def cubic(t):
            return 0.1 * t**3 - 0.3 * t**2, 0.3 * t**2 - 0.6 * t
        way = path(*(point(t, [cubic(t)[0], 1.0], [cubic(t)[1], 0.0]) for t in (1.5, 3.0)))
        for i in range(30):
            positions, velocities = way.at(0.1 * i)
            self.assertAlmostEqual(positions[0], cubic(0.1 * i)[0])
            self.assertAlmostEqual(velocities[0], cubic(0.1 * i)[1])

    def test_what_is_left_is_the_same_way_at_its_scale(self):
        values = random.Random(1)
        for cubic in (False, True):
            way = path(*(point(i, [values.uniform(-1, 1), values.uniform(-1, 1)],
                               [values.uniform(-1, 1), values.uniform(-1, 1)] if cubic else [])
                         for i in range(1, 5)))
            for begin in (0.0, 0.7, 2.0, 3.9):
                rest = way.rest(begin, 0.25)
                again = path(*rest.points, here=dict(zip("ab", rest.points[0].positions)))
                for i in range(40):
                    seconds = begin + (4.0 - begin) * i / 40.0
                    positions, velocities = way.at(seconds)
                    slow_positions, slow_velocities = again.at(4.0 * (seconds - begin))
                    self.assertAlmostEqual(slow_positions[0], positions[0], 6)
                    self.assertAlmostEqual(slow_velocities[1], 0.25 * velocities[1], 6)

    def test_what_cannot_be_followed_is_refused(self):
        good = [1.0, 1.0]
        for points in ((), (point(1.0, [1.0]),), (point(1.0, good, [1.0]),),
                       (point(1.0, [1.0, math.nan]),), (point(1.0, good, [0.0, math.inf]),),
                       (point(-1.0, good),), (point(1.0, good), point(1.0, good)),
                       (point(0.0, [0.02, 1.0]), point(1.0, good))):
            with self.assertRaises(BadGoal):
                path(*points)
        with self.assertRaises(BadGoal):
            path(point(1.0, good), here={"a": 0.0})
        with self.assertRaises(BadGoal):
            path(point(1.0, good), here={"a": 0.0, "b": math.nan})


class GuardedMotionTest(unittest.TestCase):
    def setUp(self):
        self.motion = GuardedMotion()
        self.elapsed, self.sequence = 0.0, 0
        self.commands, self.trajectories = [], []

    def take(self, output):
        if output.command:
            self.commands.append(output.command)
        if output.trajectory:
            self.trajectories.append(output.trajectory)

    def permit(self, scale=1.0):
        self.sequence += 1
        level = MotionPermission.OK if scale else MotionPermission.STOP
        self.take(self.motion.hear(permission(self.sequence, self.elapsed, speed_scale=scale,
                                              level=level, permitted=scale > 0.0),
                                   at(self.elapsed)))

    def start(self):
        """From 0 to 10 rad at 1 rad/s."""
        self.motion.begin_check()
        self.take(self.motion.start(path(point(10.0, [10.0, 1.0])), at(self.elapsed)))

    def set_off(self):
        self.permit()
        self.start()
        self.assertEqual(self.motion.state, MOVING)

    def run_for(self, seconds, scale=1.0):
        """@param scale of the permissions meanwhile; None: silence."""
        for cycle in range(round(seconds / CYCLE)):
            self.elapsed += CYCLE
            if cycle % 4 == 3 and scale is not None:
                self.permit(scale)
            self.take(self.motion.step(at(self.elapsed)))

    def setpoint(self):
        return self.commands[-1].points[0].positions[0]

    def assert_cancelled(self):
        self.assertEqual(self.motion.state, HELD)
        self.assertEqual((self.commands[-1].points, self.trajectories[-1].points), ([], []))

    def test_a_goal_without_permission_is_refused_and_publishes_nothing(self):
        self.start()
        self.assertEqual(self.motion.state_text, "REFUSED: no permission was ever heard")
        self.run_for(1.0)
        self.assertEqual((self.commands, self.trajectories), ([], []))

    def test_it_sets_off_gently_and_reaches_the_goal(self):
        self.set_off()
        self.run_for(0.25)
        self.assertAlmostEqual(self.setpoint(), 0.125 + 0.04, 5)
        self.run_for(1.0)
        self.assertAlmostEqual(self.setpoint(), 1.125 + 0.04, 5)
        self.run_for(10.0)
        self.assertEqual(self.motion.state_text, "IDLE: the goal is reached")
        self.assertEqual(self.setpoint(), 10.0)
        self.assertEqual(self.trajectories[-1].points, [])

    def test_SLOW_halves_the_speed_and_is_announced(self):
        self.set_off()
        self.run_for(1.0)
        self.run_for(0.5, 0.5)
        before = self.setpoint()
        self.run_for(2.0, 0.5)
        self.assertAlmostEqual(self.setpoint() - before, 1.0, 5)
        rest = self.trajectories[-1].points
        self.assertAlmostEqual((rest[-1].positions[0] - rest[0].positions[0]) /
                               rest[-1].time_from_start.to_sec(), 0.5, 6)

    def test_a_speed_of_next_to_nothing_is_no_error(self):
        self.set_off()
        self.run_for(1.0)
        self.run_for(1.0, 1e-12)
        self.assertEqual(self.motion.state, MOVING)

    def test_STOP_holds_when_it_is_heard(self):
        self.set_off()
        self.run_for(1.0)
        self.permit(0.0)
        self.assert_cancelled()

    def test_silence_holds_within_three_periods(self):
        self.set_off()
        self.run_for(1.0)
        self.permit()
        self.run_for(VALIDITY - CYCLE, None)
        self.assertEqual(self.motion.state, MOVING)
        self.run_for(2.0 * CYCLE, None)
        self.assert_cancelled()

    def test_once_held_nothing_resumes_it_but_a_new_goal(self):
        self.set_off()
        self.run_for(1.0)
        self.permit(0.0)
        published = len(self.commands), len(self.trajectories)
        for scale in (1.0, 0.5, 0.0, None, 1.0):
            self.run_for(1.0, scale)
        self.assertEqual(self.motion.state, HELD)
        self.assertEqual((len(self.commands), len(self.trajectories)), published)
        self.set_off()
        self.run_for(0.5)
        self.assertGreater(self.setpoint(), 0.3)

    def test_time_that_jumps_back_or_stands_still_holds(self):
        self.set_off()
        self.run_for(1.0)
        self.take(self.motion.step(Instant(at(0.99).stamp, at(1.0).steady)))
        self.assert_cancelled()
        self.set_off()
        self.take(self.motion.step(Instant(at(1.0).stamp, at(1.0 + VALIDITY + CYCLE).steady)))
        self.assert_cancelled()

    def test_a_late_cycle_does_not_catch_up(self):
        self.set_off()
        self.run_for(1.0)
        before = self.setpoint()
        self.elapsed += 1.0
        self.permit()
        self.take(self.motion.step(at(self.elapsed)))
        self.assertAlmostEqual(self.setpoint() - before, 0.05, 6)

    def test_wrong_parameters_are_refused(self):
        for lookahead, scale_change in ((0.0, 4.0), (0.04, math.nan)):
            with self.assertRaises(ValueError):
                GuardedMotion(lookahead, scale_change)

    def test_the_operator_cancels_what_moves_or_is_about_to(self):
        self.take(self.motion.cancel())
        self.assertEqual((self.motion.state, self.commands), (IDLE, []))
        self.motion.begin_check()
        self.assertEqual(self.motion.state, CHECKING)
        self.take(self.motion.cancel())
        self.assertEqual((self.motion.state, self.commands), (REFUSED, []))
        self.set_off()
        self.take(self.motion.cancel())
        self.assert_cancelled()


if __name__ == "__main__":
    unittest.main()
