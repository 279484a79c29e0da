#!/usr/bin/python3
"""An example client moves the arm as long as a scripted monitor permits it, and only then."""

import threading
import time
import unittest

import rospy
import rostest
from trajectory_msgs.msg import JointTrajectory

from client_recorder import (AT_REST, PERMISSION_PERIOD, SLACK, ClientRecorder, Rate,
                             goal_to)
from tccm_monitor.msg import MotionPermission
from tccm_monitor.srv import CheckTrajectory, CheckTrajectoryResponse
from waiting import wait_for

VALIDITY = 2.5 * PERMISSION_PERIOD
# Where silence is not what is tested: a busy machine may be late.
PATIENT_VALIDITY = 0.4
THERE, BACK = (-0.5, -1.3), (0.15, -0.4)
SECONDS = 8.0  # from one to the other
BRAKING = 0.3  # [s] at most, of the simulated arm
WATCHED = 0.5  # [s] after which nothing has happened that must not happen


class ScriptedMonitor:
    """Publishes permissions and answers questions as told."""

    def __init__(self):
        self.lock = threading.Lock()
        self.result = CheckTrajectoryResponse.FREE
        self.questions = []
        self.sent = []  # when
        self.sequence = 0
        self.permit()
        self.publisher = rospy.Publisher("motion_permission", MotionPermission, queue_size=1,
                                         tcp_nodelay=True)
        self.service = rospy.Service("check_trajectory", CheckTrajectory, self.answer)
        self.rate = None

    def permit(self, level=MotionPermission.OK, scale=1.0, reasons=(), age=0.0,
               validity=PATIENT_VALIDITY, rising=True):
        """@param age of the stamps [s]."""
        with self.lock:
            self.script = (level, scale, reasons, age, validity, rising)

    def speak(self):
        self.rate = Rate(PERMISSION_PERIOD, self.publish)

    def fall_silent(self):
        self.rate.stop()

    def publish(self):
        with self.lock:
            level, scale, reasons, age, validity, rising = self.script
        self.sequence += rising
        message = MotionPermission(sequence=self.sequence, level=level, speed_scale=scale,
                                   permitted=level <= MotionPermission.SLOW, reasons=reasons)
        message.header.stamp = rospy.Time.now() - rospy.Duration(age)
        message.valid_until = message.header.stamp + rospy.Duration(validity)
        self.sent.append(time.monotonic())
        self.publisher.publish(message)

    def answer(self, question):
        self.questions.append(question.trajectory)
        reason = "COLLISION" if self.result else ""
        return CheckTrajectoryResponse(result=self.result, reason=reason)


class ClientTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorder = ClientRecorder()
        cls.monitor = ScriptedMonitor()
        cls.recorder.wait_until_connected()
        wait_for(cls.monitor.publisher.get_num_connections)
        cls.before_any_permission = wait_for(cls.refusal_of_a_known_arm)
        cls.commands_before = len(cls.recorder.commands)
        cls.monitor.speak()

    @classmethod
    def refusal_of_a_known_arm(cls):
        """A goal is refused for another reason than that the client has heard no joints yet."""
        state = cls.recorder.send(goal_to(THERE, SECONDS))
        return None if "nobody publishes" in state else state

    def setUp(self):
        self.monitor.permit()
        self.monitor.result = CheckTrajectoryResponse.FREE

    def tearDown(self):
        self.recorder.goals.publish(JointTrajectory())
        wait_for(lambda: self.recorder.state.split(":")[0] in ("IDLE", "HELD", "REFUSED"))
        time.sleep(BRAKING)
        if self.monitor.rate.stopped.is_set():
            self.monitor.speak()

    def set_off(self, validity=PATIENT_VALIDITY):
        """The arm is on its way to the goal that is further away, at full speed."""
        self.monitor.permit(validity=validity)
        _, here = self.recorder.positions()
        away = max((THERE, BACK), key=lambda goal: abs(goal[0] - here[0]))
        seconds = SECONDS * abs(away[0] - here[0]) / abs(THERE[0] - BACK[0])
        wait_for(lambda: self.recorder.send(goal_to(away, seconds)) == "MOVING")
        start = time.monotonic()
        wait_for(lambda: time.monotonic() > start + 0.6)
        return away

    def speed(self, seconds=0.8):
        """Mean speed of the first joint, by the stamps [rad/s]."""
        before, (from_position, _) = self.recorder.positions()
        wait_for(lambda: self.recorder.positions()[0] > before + seconds)
        after, (to_position, _) = self.recorder.positions()
        return abs(to_position - from_position) / (after - before)

    def assert_held(self, since, reason, limit=SLACK):
        """One empty command and one empty trajectory, in time; then the arm stands still and
        nothing is published any more."""
        self.recorder.wait_for_state("HELD")
        self.assertIn(reason, self.recorder.state)
        held = wait_for(lambda: self.recorder.first_hold(since))
        self.assertLess(held - since, limit)
        wait_for(lambda: time.monotonic() > held + BRAKING + WATCHED)
        for log in (self.recorder.commands, self.recorder.trajectories):
            after = [message for at, message in log if at >= held - SLACK]
            self.assertEqual(len([message for message in after if not message.points]), 1)
            self.assertFalse(after[-1].points)
        self.assertLess(self.recorder.last_setpoint(), held)
        self.assertLess(self.recorder.moving(held + BRAKING), AT_REST)

    def test_nothing_moves_before_any_permission_is_heard(self):
        self.assertEqual(self.before_any_permission,
                         "REFUSED: no permission was ever heard")
        self.assertEqual(self.commands_before, 0)

    def test_a_permitted_goal_is_checked_announced_and_reached(self):
        asked, announced = len(self.monitor.questions), len(self.recorder.trajectories)
        _, here = self.recorder.positions()
        goal = [q + 0.1 for q in here]
        self.assertEqual(self.recorder.send(goal_to(goal, 1.0)), "MOVING")
        self.recorder.wait_for_state("IDLE: the goal is reached")
        self.assertEqual(len(self.monitor.questions), asked + 1)
        question = self.monitor.questions[-1]
        self.assertEqual(question.points[0].time_from_start.to_sec(), 0.0)
        for position, value in zip(question.points[0].positions, here):
            self.assertAlmostEqual(position, value, 6)
        self.assertEqual(list(question.points[-1].positions), goal)
        first = self.recorder.trajectories[announced][1]
        self.assertEqual(first.points, question.points)
        self.assertGreater(first.header.stamp.to_sec(), 0.0)
        wait_for(lambda: not self.recorder.trajectories[-1][1].points)
        wait_for(lambda: max(abs(a - b) for a, b in
                             zip(self.recorder.positions()[1], goal)) < 1e-6)

    def test_a_goal_that_is_not_free_is_never_begun(self):
        for self.monitor.result in (CheckTrajectoryResponse.COLLISION,
                                    CheckTrajectoryResponse.UNKNOWN,
                                    CheckTrajectoryResponse.FAULT):
            commands = len(self.recorder.commands)
            state = self.recorder.send(goal_to(THERE, SECONDS))
            self.assertTrue(state.startswith("REFUSED: not free: COLLISION"), state)
            time.sleep(0.1)
            self.assertEqual(len(self.recorder.commands), commands)

    def test_setpoints_come_100_times_a_second_and_more(self):
        self.set_off()
        before = len(self.recorder.commands)
        time.sleep(1.0)
        setpoints = self.recorder.commands[before:]
        self.assertGreater(len(setpoints), 100)
        for _, message in setpoints:
            self.assertEqual(len(message.points), 1)
            self.assertGreater(message.points[0].time_from_start.to_sec(), 0.0)

    def test_SLOW_halves_the_speed_and_the_commanded_trajectory_says_so(self):
        self.set_off()
        full = self.speed()
        self.assertGreater(full, 0.05)
        self.monitor.permit(MotionPermission.SLOW, 0.5)
        time.sleep(0.3)
        self.assertAlmostEqual(self.speed() / full, 0.5, delta=0.03)
        _, trajectory = self.recorder.trajectories[-1]
        way = abs(trajectory.points[-1].positions[0] - trajectory.points[0].positions[0])
        announced = way / trajectory.points[-1].time_from_start.to_sec()
        self.assertAlmostEqual(announced / full, 0.5, delta=0.03)
        self.monitor.permit()
        time.sleep(0.5)
        self.assertAlmostEqual(self.speed() / full, 1.0, delta=0.05)

    def test_the_announced_trajectory_says_where_the_arm_is(self):
        self.set_off()
        for scale in (1.0, 0.4):
            self.monitor.permit(MotionPermission.SLOW, scale)
            time.sleep(0.5)
            self.speed(0.3)
            stamp, (position, _) = self.recorder.positions()
            _, trajectory = self.recorder.trajectories[-1]
            a, b = trajectory.points[0], trajectory.points[-1]
            u = (stamp - trajectory.header.stamp.to_sec()) / b.time_from_start.to_sec()
            announced = a.positions[0] + u * (b.positions[0] - a.positions[0])
            seconds_off = abs(announced - position) / abs(
                (b.positions[0] - a.positions[0]) / b.time_from_start.to_sec())
            self.assertLess(seconds_off, 0.05 / scale + 0.02)

    def test_STOP_holds_at_once(self):
        for level in (MotionPermission.STOP, MotionPermission.FAULT):
            self.set_off()
            self.monitor.permit(level, 0.0, ["COLLISION_AHEAD"])
            self.assert_held(time.monotonic(), "not permitted: COLLISION_AHEAD",
                             PERMISSION_PERIOD + SLACK)

    def test_silence_holds_within_three_periods(self):
        self.set_off(VALIDITY)
        self.monitor.fall_silent()
        self.assert_held(self.monitor.sent[-1], "permission",
                         3.0 * PERMISSION_PERIOD + SLACK)

    def test_expired_stamps_hold(self):
        self.set_off()
        self.monitor.permit(age=2.0 * PATIENT_VALIDITY)
        self.assert_held(time.monotonic(), "permission", PERMISSION_PERIOD + SLACK)

    def test_stamps_from_the_future_hold(self):
        self.set_off()
        self.monitor.permit(age=-1.0)
        self.assert_held(time.monotonic(), "future", PERMISSION_PERIOD + SLACK)

    def test_a_sequence_that_stands_still_holds(self):
        self.set_off()
        self.monitor.permit(rising=False)
        self.assert_held(time.monotonic(), "sequence", PERMISSION_PERIOD + SLACK)

    def test_a_permission_that_comes_back_resumes_nothing_and_a_new_goal_moves(self):
        self.set_off()
        self.monitor.permit(MotionPermission.STOP, 0.0)
        self.assert_held(time.monotonic(), "not permitted", PERMISSION_PERIOD + SLACK)
        held = self.recorder.commands[-1][0]
        self.monitor.permit()
        wait_for(lambda: time.monotonic() > held + 2.0)
        self.assertTrue(self.recorder.state.startswith("HELD"), self.recorder.state)
        self.assertEqual(self.recorder.commands[-1][0], held)
        self.assertLess(self.recorder.moving(held + BRAKING), AT_REST)
        self.set_off()
        self.assertGreater(self.speed(0.2), 0.05)

    def test_an_empty_goal_cancels(self):
        self.set_off()
        asked = time.monotonic()  # the arm may hold before publish() returns
        self.recorder.goals.publish(JointTrajectory())
        self.assert_held(asked, "cancelled")

    def test_a_goal_while_another_is_under_way_is_ignored(self):
        goal = self.set_off()
        asked = len(self.monitor.questions)
        self.recorder.goals.publish(goal_to((0.0, 0.0), 1.0))
        time.sleep(0.3)
        self.assertEqual(len(self.monitor.questions), asked)
        self.assertEqual(self.recorder.state, "MOVING")
        self.assertEqual(tuple(self.recorder.trajectories[-1][1].points[-1].positions), goal)


if __name__ == "__main__":
    rospy.init_node("client_test")
    rostest.rosrun("tccm_monitor", "client", ClientTest)
