#!/usr/bin/python3
"""From a planner that drives an arm to one whose arm obeys the monitor it takes three changed lines: the
very same goal goes on through a stop before, and is held at it after."""

import difflib
import os
import time
import unittest

import actionlib
import rospkg
import rospy
import rostest
import yaml
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal,
                              FollowJointTrajectoryResult)
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from tccm_monitor.msg import MotionPermission
from tccm_monitor.srv import SetKeepOut
from waiting import wait_for

FILES = ("controllers.yaml", "monitor.yaml")
PATIENCE = 40.0  # [s] on a machine that is busy
APPROACH_SPEED = 0.5  # [rad/s] of the joints to the first point of the reach
UNDER_WAY = 1.5  # [s] from there on, after which the hand is fast
REACHED = 0.02  # [rad], the goals' tolerance of arm_controllers.yaml
AT_REST = 1e-6  # [rad]
FRONT = 0.60  # [m] of a region in the hand's way, which goes from x = 0.24 to 0.70 m


class Planner:
    """Has controllers do what it has planned, as MoveIt's moveit_simple_controller_manager does: of
    each controller in its list it knows the name, the joints and the action NAME/action_ns."""

    def __init__(self):
        controller, = rospy.get_param("move_group/controller_list")
        assert controller["type"] == "FollowJointTrajectory"
        self.joints = controller["joints"]
        self.action = f"{controller['name']}/{controller['action_ns']}"
        self.client = actionlib.SimpleActionClient(self.action, FollowJointTrajectoryAction)
        assert self.client.wait_for_server(rospy.Duration(PATIENCE)), self.action

    def execute(self, points):
        self.client.send_goal(FollowJointTrajectoryGoal(
            trajectory=JointTrajectory(joint_names=self.joints, points=points)))

    def is_done(self):
        return self.client.get_state() > GoalStatus.ACTIVE


class ThreeLinesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.obeys = rospy.get_param("~obeys")
        cls.permissions, cls.states = [], []
        rospy.Subscriber("motion_permission", MotionPermission, cls.permissions.append,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("joint_states", JointState, cls.states.append, queue_size=1000,
                         tcp_nodelay=True)
        with open(os.path.join(rospkg.RosPack().get_path("tccm_monitor"), "examples", "reach.yaml"),
                  encoding="utf-8") as file:
            cls.way = yaml.safe_load(file)["points"]
        cls.end = cls.way[-1]["positions"]
        cls.planner = Planner()
        wait_for(lambda: cls.states)
        rospy.wait_for_service("set_keep_out", PATIENCE)
        wait_for(cls.set_off, PATIENCE)
        cls.set_at = rospy.get_time()
        cls.answer = rospy.ServiceProxy("set_keep_out", SetKeepOut)(
            "window", "", Pose(Point(FRONT + 0.2, -0.25, 0.95), Quaternion(0, 0, 0, 1)),
            Vector3(0.4, 0.6, 0.6), False)
        assert cls.planner.client.wait_for_result(rospy.Duration(PATIENCE))
        cls.status = cls.planner.client.get_state()
        cls.result = cls.planner.client.get_result()

    @classmethod
    def positions(cls, state=None):
        state = state or cls.states[-1]
        places = dict(zip(state.name, state.position))
        return [places[joint] for joint in cls.planner.joints]

    @classmethod
    def distance_to(cls, there):
        return max(abs(q - p) for q, p in zip(cls.positions(), there))

    @classmethod
    def set_off(cls):
        """The arm does the goal and the hand is fast. On a machine that is busy, the monitor may hold
        it before: then it is sent again."""
        wait_for(cls.is_permitted, PATIENCE)
        approach = 0.5 + cls.distance_to(cls.way[0]["positions"]) / APPROACH_SPEED
        cls.planner.execute([JointTrajectoryPoint(
            positions=point["positions"], velocities=point["velocities"],
            time_from_start=rospy.Duration(approach + point["time_from_start"]))
            for point in cls.way])
        fast = cls.way[3]["positions"]
        assert cls.way[3]["time_from_start"] == UNDER_WAY
        wait_for(lambda: cls.planner.is_done() or cls.distance_to(fast) < 0.05, PATIENCE)
        return not cls.planner.is_done()

    @classmethod
    def is_permitted(cls):
        if cls.permissions and cls.permissions[-1].permitted:
            return True
        time.sleep(0.2)
        try:
            rospy.ServiceProxy("reset", Trigger)()
        except rospy.ServiceException:
            pass
        return False

    def heard(self):
        return [permission for permission in list(self.permissions)
                if permission.header.stamp.to_sec() >= self.set_at]

    def test_no_more_than_three_lines_are_changed(self):
        changed = 0
        for name in FILES:
            texts = []
            for folder in ("drives", "obeys"):
                with open(os.path.join(rospy.get_param("~files"), folder, name),
                          encoding="utf-8") as file:
                    texts.append(file.readlines())
            matcher = difflib.SequenceMatcher(None, *texts, autojunk=False)
            for operation, i1, i2, j1, j2 in matcher.get_opcodes():
                if operation != "equal":
                    changed += max(i2 - i1, j2 - j1)
        self.assertLessEqual(changed, 3)
        self.assertGreater(changed, 0)

    def test_the_monitor_stops_the_motion(self):
        self.assertTrue(self.answer.success, self.answer.message)
        stops = [permission for permission in self.heard()
                 if permission.level >= MotionPermission.STOP]
        self.assertTrue(stops)
        self.assertIn("KEEP_OUT_AHEAD", stops[0].reasons)

    def test_the_goal_is_held_at_the_stop_if_and_only_if_the_lines_are_changed(self):
        if not self.obeys:
            self.assertEqual(self.planner.action, "right_arm_controller/follow_joint_trajectory")
            self.assertEqual(self.status, GoalStatus.SUCCEEDED)
            self.assertLess(self.distance_to(self.end), REACHED)
            return
        self.assertEqual((self.status, self.result.error_code),
                         (GoalStatus.ABORTED, FollowJointTrajectoryResult.INVALID_GOAL))
        self.assertIn("KEEP_OUT_AHEAD", self.result.error_string)
        self.assertIn("'window'", self.result.error_string)
        self.assertGreater(self.distance_to(self.end), 0.1)

    def test_then_the_arm_stands_and_was_only_in_the_region_where_it_was_driven(self):
        wait_for(lambda: self.stands_for(0.5))  # the controller takes a while to halt
        reasons = {reason for permission in self.heard() for reason in permission.reasons}
        self.assertEqual("KEEP_OUT" in reasons, not self.obeys, reasons)

    def stands_for(self, seconds):
        here, end = self.positions(), rospy.get_time() + seconds
        wait_for(lambda: self.states[-1].header.stamp.to_sec() > end)
        return self.distance_to(here) < AT_REST


if __name__ == "__main__":
    rospy.init_node("gate_three_lines_test")
    rostest.rosrun("tccm_monitor", "gate_three_lines", ThreeLinesTest)
