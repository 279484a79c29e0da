#!/usr/bin/python3
"""Goals of stock action clients go through the gate as an arm's own controller would take them, and only
where the monitor says that they are free."""

import subprocess
import tempfile
import time

import roslib.packages
import rospy
import rostest
import yaml
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryGoal, FollowJointTrajectoryResult
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from gate_case import REACHED, GateCase
from gated_arm import AT_REST, ELBOW, assert_feedback_tells_joints, end_of
from tccm_monitor.msg import MotionPermission
from tccm_monitor.srv import CheckTrajectoryResponse
from waiting import wait_for

REFUSED = (GoalStatus.REJECTED, FollowJointTrajectoryResult.INVALID_GOAL)


class GoalsTest(GateCase):
    def test_nothing_moves_before_any_permission_is_heard(self):
        status, text = self.before_any_permission
        self.assertEqual((status, text), (GoalStatus.REJECTED, "no permission was ever heard"))

    def test_a_goal_is_checked_announced_and_reached_whatever_the_order_of_its_names(self):
        arm, there = self.right, self.right.aside(0.4)
        asked, begun = len(self.monitor.questions), time.monotonic()
        here = arm.positions()
        arm.client.send_goal(arm.goal(there[::-1], 0.8, arm.joints[::-1], smooth=True))
        self.assertEqual(end_of(arm.client), REACHED)
        arm.come_to_rest()
        self.assert_at(arm, there, 1e-6)
        self.assertGreater(time.monotonic() - begun, 0.75)
        self.assertEqual(len(self.monitor.questions), asked + 1)
        question = self.monitor.questions[-1]
        self.assertEqual(list(question.joint_names), arm.joints)
        self.assertEqual(question.points[0].time_from_start.to_sec(), 0.0)
        for asked_at, is_at, wanted in zip(question.points[0].positions, here, there):
            self.assertAlmostEqual(asked_at, is_at, 6)
        for asked_at, wanted in zip(question.points[-1].positions, there):
            self.assertAlmostEqual(asked_at, wanted, 9)
        announced = [message for at, message in self.trajectories if at > begun]
        self.assertTrue(announced[0].points)
        wait_for(lambda: not self.last_trajectory().points)
        self.assertEqual(list(self.last_trajectory().joint_names), arm.joints)

    def test_a_goal_of_many_points_is_done_as_it_is_and_in_its_time(self):
        arm = self.right
        names, towards = arm.joints, 1.0 if arm.aside(0.1)[ELBOW] > arm.start[ELBOW] else -1.0
        goal = FollowJointTrajectoryGoal(trajectory=JointTrajectory(joint_names=names))
        for i in range(1, 11):
            u = i / 10.0
            way = 0.6 * (3 * u**2 - 2 * u**3) * towards
            velocity = 0.6 * (6 * u - 6 * u**2) / 2.0 * towards
            goal.trajectory.points.append(JointTrajectoryPoint(
                positions=[q + way * (j == ELBOW) for j, q in enumerate(arm.positions())],
                velocities=[velocity * (j == ELBOW) for j in range(len(names))],
                time_from_start=rospy.Duration(2.0 * u)))
        begun = time.monotonic()
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client), REACHED)
        self.assertLess(time.monotonic() - begun, 3.2)
        arm.come_to_rest()
        self.assert_at(arm, arm.aside(0.6), 1e-6)
        self.assertLess(arm.fastest(0.5, begun), 0.45 * 1.1)

    def test_a_goal_is_reported_before_it_is_asked_about_until_it_has_ended(self):
        arm = self.right
        for cancels, way in ((False, 0.3), (True, 0.9)):
            before = {goal for _, goal, _, _ in self.monitor.goals}
            asked = len(self.monitor.questions)
            arm.client.send_goal(arm.goal(arm.aside(way), 0.6, smooth=True))
            if cancels:
                arm.wait_until_it_moves(0.05)
                arm.client.cancel_goal()
            end_of(arm.client)

            def reports():
                return [report for report in self.monitor.goals if report[1] not in before]
            wait_for(lambda: len(reports()) == 2)
            begin, end = reports()
            self.assertEqual((begin[0], begin[2:]), (rospy.get_name(), (True, asked)))
            self.assertTrue(begin[1].startswith(rospy.get_name() + "-"))
            self.assertEqual(end, (begin[0], begin[1], False, asked + 1))
            arm.come_to_rest()

    def test_feedback_tells_where_the_joints_are(self):
        assert_feedback_tells_joints(self, self.right)

    def test_the_example_client_reaches_there_and_back_and_waits_where_it_is_refused(self):
        arm, begun = self.right, time.monotonic()
        still = [0.0] * len(arm.joints)
        way = {"joint_names": arm.joints, "points": [
            {"time_from_start": 0.0, "positions": arm.start, "velocities": still},
            {"time_from_start": 0.6, "positions": arm.aside(0.3), "velocities": still}]}
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            yaml.safe_dump(way, file)
            file.flush()
            self.monitor.result = CheckTrajectoryResponse.UNKNOWN
            asked = len(self.monitor.questions)
            with subprocess.Popen([
                    roslib.packages.find_node("tccm_monitor", "follow_trajectory.py")[0],
                    f"_action:={arm.action}", f"_way:={file.name}", "_times:=1"]) as client:
                wait_for(lambda: len(self.monitor.questions) > asked)
                self.monitor.result = CheckTrajectoryResponse.FREE
                self.assertEqual(client.wait(timeout=20.0), 0)
        self.assertAlmostEqual(arm.way(begun), 0.3, delta=1e-3)
        self.assert_at(arm, arm.start)

    def test_both_arms_move_at_once(self):
        for arm in (self.left, self.right):
            arm.client.send_goal(arm.goal(arm.aside(0.4), 1.0, smooth=True))
        for arm in (self.left, self.right):
            arm.wait_until_it_moves(0.1)
        self.assertGreater(self.left.speed(), 0.1)
        for arm in (self.left, self.right):
            self.assertEqual(end_of(arm.client), REACHED)
            arm.come_to_rest()
            self.assert_at(arm, arm.aside(0.4), 1e-6)

    def test_where_parts_are_allowed_the_other_joints_stay(self):
        arm = self.left
        arm.client.send_goal(arm.goal([arm.aside(0.3)[ELBOW]], 0.6, [arm.joints[ELBOW]], True))
        self.assertEqual(end_of(arm.client), REACHED)
        arm.come_to_rest()
        self.assert_at(arm, arm.aside(0.3), 1e-6)

    def test_a_goal_that_is_not_free_is_refused_with_reason_link_and_time(self):
        arm = self.right
        begun = time.monotonic()
        self.monitor.reason = "COLLISION"
        for self.monitor.result in (CheckTrajectoryResponse.COLLISION,
                                    CheckTrajectoryResponse.OCCLUDED,
                                    CheckTrajectoryResponse.UNKNOWN,
                                    CheckTrajectoryResponse.FAULT):
            arm.client.send_goal(arm.goal(arm.aside(0.4), 0.8))
            self.assertEqual(end_of(arm.client), REFUSED)
            for word in ("COLLISION", "as the test says", "left_hand_link", "1.25 s"):
                self.assertIn(word, arm.client.get_result().error_string)
        self.assertLess(arm.way(begun), AT_REST)

    def test_a_goal_is_refused_while_nothing_is_permitted(self):
        self.monitor.permit(MotionPermission.STOP, 0.0, ["COLLISION_AHEAD"])
        time.sleep(0.1)
        self.right.client.send_goal(self.right.goal(self.right.aside(0.4), 0.8))
        self.assertEqual(end_of(self.right.client), REFUSED)
        self.assertIn("COLLISION_AHEAD", self.right.client.get_result().error_string)

    def test_what_is_no_goal_leaves_the_one_before_it_under_way(self):
        arm = self.right
        self.set_off(arm)
        stale = arm.goal(arm.start, 1.0)
        stale.trajectory.header.stamp = rospy.Time.now() - rospy.Duration(10.0)
        endless = arm.goal([float("nan")] * len(arm.joints), 1.0)
        other = arm.goal(arm.start, 1.0, self.left.joints)
        part = arm.goal([arm.start[ELBOW]], 1.0, [arm.joints[ELBOW]])
        second = arm.new_client()
        for goal, code in ((stale, FollowJointTrajectoryResult.INVALID_GOAL),
                           (endless, FollowJointTrajectoryResult.INVALID_GOAL),
                           (other, FollowJointTrajectoryResult.INVALID_JOINTS),
                           (part, FollowJointTrajectoryResult.INVALID_JOINTS)):
            second.send_goal(goal)
            self.assertEqual(end_of(second), (GoalStatus.REJECTED, code))
            self.assertTrue(second.get_result().error_string)
        self.assertEqual(end_of(arm.client), REACHED)
        self.assert_at(arm, arm.aside(0.9))

    def test_a_goal_with_a_stamp_waits_for_it(self):
        arm = self.right
        goal = arm.goal(arm.aside(0.2), 0.4, smooth=True)
        start = rospy.Time.now() + rospy.Duration(0.7)
        goal.trajectory.header.stamp = start
        begun = time.monotonic()
        arm.client.send_goal(goal)
        self.assertEqual(end_of(arm.client), REACHED)
        moving = [stamp for _, stamp, _, v in arm.log(begun) if abs(v[ELBOW]) > 1e-9]
        self.assertGreater(min(moving), start.to_sec())

    def test_a_cancelled_goal_is_preempted_and_the_arm_stands(self):
        speed = self.set_off(self.right)
        cancelled = time.monotonic()
        self.right.client.cancel_goal()
        self.assertEqual(end_of(self.right.client)[0], GoalStatus.PREEMPTED)
        self.assert_stood(self.right, speed, cancelled, 0.0)

    def test_a_goal_may_be_cancelled_while_it_is_checked(self):
        self.monitor.answer_after = 0.5
        begun = time.monotonic()
        self.right.client.send_goal(self.right.goal(self.right.aside(0.4), 0.8))
        time.sleep(0.2)
        self.right.client.cancel_goal()
        self.assertIn(end_of(self.right.client)[0], (GoalStatus.PREEMPTED, GoalStatus.RECALLED))
        self.assertTrue(self.right.stands(0.6))
        self.assertLess(self.right.way(begun), AT_REST)

    def test_a_second_goal_takes_the_place_of_the_first_once_the_arm_stands(self):
        arm, second = self.right, self.right.new_client()
        self.set_off(arm)
        second.send_goal(arm.goal(arm.start, 1.0, smooth=True))
        self.assertEqual(end_of(arm.client)[0], GoalStatus.PREEMPTED)
        self.assertEqual(end_of(second), REACHED)
        arm.come_to_rest()
        self.assert_at(arm, arm.start, 1e-6)

    def test_a_checker_that_does_not_answer_is_no_permission(self):
        self.monitor.answer_after = 1.1
        self.right.client.send_goal(self.right.goal(self.right.aside(0.4), 0.8))
        self.assertEqual(end_of(self.right.client), REFUSED)
        self.assertIn("check_trajectory has not answered",
                      self.right.client.get_result().error_string)
        time.sleep(0.6)  # until it has


if __name__ == "__main__":
    rospy.init_node("gate_goals_test")
    rostest.rosrun("tccm_monitor", "gate_goals", GoalsTest)
