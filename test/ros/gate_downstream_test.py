#!/usr/bin/python3
"""Controllers that refuse, do not answer, give up or do nothing, and a speed slider that does not do
as it is told: each goal ends with a result that says so, and the controller is told to halt."""

import struct
import threading
import time
import unittest

import actionlib
import genpy
import rospy
import rostest
from actionlib_msgs.msg import GoalID, GoalStatus
from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryResult
from trajectory_msgs.msg import JointTrajectory

from gated_arm import GatedArm, end_of
from scripted_monitor import ScriptedMonitor
from tccm_monitor.msg import MotionPermission
from waiting import wait_for


class SliderRequest(genpy.Message):
    """As ur_msgs/SetSpeedSliderFraction has it."""
    _type, _md5sum = "ur_msgs/SetSpeedSliderFractionRequest", "172aeb6c49379a44cf68480fa5bfad3c"
    __slots__, _slot_types = ["speed_slider_fraction"], ["float64"]

    def deserialize(self, data):
        self.speed_slider_fraction, = struct.unpack("<d", data)
        return self


class SliderResponse(genpy.Message):
    _type, _md5sum = "ur_msgs/SetSpeedSliderFractionResponse", SliderRequest._md5sum
    __slots__, _slot_types = ["success"], ["bool"]

    def serialize(self, buffer):
        buffer.write(struct.pack("<B", self.success))


class SetSpeedSliderFraction:
    _type, _md5sum = "ur_msgs/SetSpeedSliderFraction", SliderRequest._md5sum
    _request_class, _response_class = SliderRequest, SliderResponse


class Controller:
    """An arm's controller that does with goals what it is told to: `goals` and `cancelled` are what
    it got, `stays` the goals to halt among them, `commands` what came on its topic."""

    def __init__(self, name):
        self.answer = None
        self.forget()
        self.cancelled_ids = []
        self.lock = threading.Lock()
        rospy.Subscriber(f"{name}/follow_joint_trajectory/cancel", GoalID,
                         lambda message: self.cancelled_ids.append(message.id))
        rospy.Subscriber(f"{name}/command", JointTrajectory,
                         lambda message: self.commands.append(message))
        self.server = actionlib.ActionServer(f"{name}/follow_joint_trajectory",
                                             FollowJointTrajectoryAction, self.take, self.cancel,
                                             auto_start=False)
        self.server.start()

    def forget(self):
        self.goals, self.stays, self.cancelled, self.commands = [], [], [], []

    def take(self, handle):
        goal = handle.get_goal()
        is_stay = bool(goal.trajectory.points[-1].velocities)  # those of this test have none
        with self.lock:
            (self.stays if is_stay else self.goals).append(goal)
            self.last_id = handle.get_goal_id().id
        self.answer(handle)

    def cancel(self, handle):
        with self.lock:
            self.cancelled.append(handle.get_goal())
        handle.set_canceled()


def silent(_):
    """Not even that the goal has come is said in time."""
    time.sleep(1.5)


def refuses(handle):
    handle.set_rejected(FollowJointTrajectoryResult(
        error_code=FollowJointTrajectoryResult.INVALID_JOINTS, error_string="no such joints"))


def gives_up(handle):
    handle.set_accepted()
    handle.set_aborted(FollowJointTrajectoryResult(
        error_code=FollowJointTrajectoryResult.GOAL_TOLERANCE_VIOLATED, error_string="too heavy"))


def does_nothing(handle):
    handle.set_accepted()


def is_done_at_once(handle):
    handle.set_accepted()
    handle.set_succeeded()


class GateDownstreamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.monitor = ScriptedMonitor()
        cls.controllers = {side: Controller(f"{side}_arm_controller") for side in ("left", "right")}
        cls.fractions, cls.slider_obeys, cls.slider_hangs = [], True, 0.0
        rospy.Service("set_speed_slider", SetSpeedSliderFraction, cls.slide)
        cls.arms = {side: GatedArm(side) for side in ("left", "right")}
        cls.monitor.speak()

    @classmethod
    def slide(cls, request):
        cls.fractions.append(request.speed_slider_fraction)
        time.sleep(cls.slider_hangs)
        return SliderResponse(success=cls.slider_obeys)

    @classmethod
    def tearDownClass(cls):
        cls.monitor.fall_silent()

    def setUp(self):
        self.set_slider_obeys(True)
        self.permit()

    def permit(self, *permission):
        self.monitor.permit(*permission)
        time.sleep(0.1)

    @classmethod
    def set_slider_obeys(cls, obeys):
        cls.slider_obeys = obeys

    def send(self, side, answer, way=0.05, seconds=5.0):
        arm, controller = self.arms[side], self.controllers[side]

        def arrives():
            controller.answer = answer
            controller.forget()
            arm.client.send_goal(arm.goal(arm.aside(way), seconds))
            wait_for(lambda: controller.goals or arm.client.get_state() > GoalStatus.ACTIVE)
            if controller.goals:
                return True
            result = arm.client.get_result()
            text = result.error_string if result else "lost"
            early = ("nobody", "no action", "no gate_guard", "no perm", "is silent", "lost")
            self.assertTrue(any(reason in text for reason in early), text)
            return False
        wait_for(arrives)
        return arm, controller

    def assert_aborted(self, arm, code, text):
        self.assertEqual(end_of(arm.client), (GoalStatus.ABORTED, code))
        self.assertIn(text, arm.client.get_result().error_string)

    def test_what_a_controller_says_comes_back(self):
        arm, _ = self.send("left", refuses)
        self.assert_aborted(arm, FollowJointTrajectoryResult.INVALID_JOINTS, "no such joints")
        arm, _ = self.send("left", gives_up)
        self.assert_aborted(arm, FollowJointTrajectoryResult.GOAL_TOLERANCE_VIOLATED, "too heavy")

    def test_one_that_has_given_up_is_told_to_halt_all_the_same(self):
        arm, controller = self.send("left", gives_up)
        end_of(arm.client)
        wait_for(lambda: controller.commands and not controller.commands[-1].points)
        wait_for(lambda: controller.stays)
        stay = controller.stays[-1].trajectory
        self.assertEqual(list(stay.joint_names), arm.joints)
        for position, is_at in zip(stay.points[-1].positions, arm.positions()):
            self.assertAlmostEqual(position, is_at, 6)
        self.assertEqual(len(stay.points), 1)
        self.assertEqual(set(stay.points[-1].velocities), {0.0})

    def test_one_that_does_not_answer_is_given_up(self):
        arm, controller = self.send("left", silent)
        sent = time.monotonic()
        self.assert_aborted(arm, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED,
                            "left_arm_controller does not answer for 0.5 s")
        self.assertLess(time.monotonic() - sent, 1.2)
        wait_for(lambda: controller.cancelled, 5.0)

    def test_a_goal_that_its_cancellation_overtakes_is_cancelled_by_its_name(self):
        arm, controller = self.send("left", silent)
        name = controller.last_id
        self.monitor.permit(MotionPermission.STOP, 0.0, ["COLLISION"])
        self.assert_aborted(arm, FollowJointTrajectoryResult.INVALID_GOAL, "COLLISION")
        wait_for(lambda: name in controller.cancelled_ids)
        wait_for(lambda: controller.cancelled, 5.0)

    def test_an_arm_that_does_not_follow_ends_the_goal(self):
        arm, controller = self.send("left", does_nothing, 0.5, 1.0)
        self.assert_aborted(arm, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED,
                            "does not follow: it is off by 0.1")
        wait_for(lambda: controller.cancelled)

    def test_a_stop_cancels_and_does_what_it_takes_to_halt(self):
        for side in ("left", "right"):
            self.permit()
            arm, controller = self.send(side, does_nothing)
            self.monitor.permit(MotionPermission.STOP, 0.0, ["COLLISION"])
            self.assert_aborted(arm, FollowJointTrajectoryResult.INVALID_GOAL, "COLLISION")
            wait_for(lambda: controller.cancelled)
            if side == "left":
                wait_for(lambda: controller.commands and not controller.commands[-1].points)
            else:
                wait_for(lambda: controller.stays)

    def test_the_slider_is_set_before_the_goal_comes_and_follows_the_permission(self):
        self.permit(MotionPermission.SLOW, 0.3)
        self.fractions.clear()
        arm, _ = self.send("right", lambda handle: (
            self.assertTrue(self.fractions), handle.set_accepted()))
        self.assertAlmostEqual(self.fractions[0], 0.3, 6)
        self.monitor.permit(MotionPermission.SLOW, 0.1)
        wait_for(lambda: abs(self.fractions[-1] - 0.1) < 1e-6)
        self.monitor.permit()
        wait_for(lambda: self.fractions[-1] == 1.0)
        arm.client.cancel_goal()
        self.assertEqual(end_of(arm.client)[0], GoalStatus.PREEMPTED)

    def test_the_slider_is_set_anew_for_each_goal(self):
        self.permit(MotionPermission.SLOW, 0.4)
        for _ in range(2):  # somebody else may have moved it since
            self.fractions.clear()
            arm, _ = self.send("right", is_done_at_once)
            self.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
            self.assertEqual([round(fraction, 6) for fraction in self.fractions], [0.4])

    def test_a_slider_that_hangs_on_the_way_ends_the_goal(self):
        arm, controller = self.send("right", does_nothing)
        type(self).slider_hangs = 1.5
        self.addCleanup(time.sleep, 1.5)
        self.addCleanup(setattr, type(self), "slider_hangs", 0.0)
        self.monitor.permit(MotionPermission.SLOW, 0.2)
        self.assert_aborted(arm, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED,
                            "set_speed_slider does not answer for 0.5 s")
        wait_for(lambda: controller.cancelled)

    def test_a_slider_that_refuses_ends_the_goal(self):
        self.set_slider_obeys(True)
        arm, controller = self.send("right", does_nothing)
        self.set_slider_obeys(False)
        self.monitor.permit(MotionPermission.SLOW, 0.2)
        self.assertEqual(end_of(arm.client)[0], GoalStatus.ABORTED)
        self.assertIn("refuses 0.2", arm.client.get_result().error_string)
        wait_for(lambda: controller.cancelled)


if __name__ == "__main__":
    rospy.init_node("gate_downstream_test")
    rostest.rosrun("tccm_monitor", "gate_downstream", GateDownstreamTest)
