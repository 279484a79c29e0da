"""What the tests of the gate with a scripted monitor have in common."""

import time
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryResult
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from gated_arm import ELBOW, GatedArm, end_of
from scripted_monitor import PERMISSION_PERIOD, ScriptedMonitor
from tccm_monitor.srv import CheckTrajectoryResponse
from waiting import wait_for

# What the way through sockets, schedulers and this program may add on a machine that is busy.
SLACK = 0.06
REACHED = (GoalStatus.SUCCEEDED, FollowJointTrajectoryResult.SUCCESSFUL)
CLOSE = 0.02  # [rad], the goals' tolerance of arm_controllers.yaml


class GateCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.mode = rospy.get_param("~mode")
        cls.monitor = ScriptedMonitor()
        cls.left, cls.right = GatedArm("left"), GatedArm("right")
        cls.trajectories, cls.events = [], []
        rospy.Subscriber("trajectory", JointTrajectory,
                         lambda message: cls.trajectories.append((time.monotonic(), message)),
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("trajectory_execution_event", String,
                         lambda message: cls.events.append(message.data), queue_size=10)
        wait_for(cls.monitor.publisher.get_num_connections)
        cls.before_any_permission = wait_for(cls.refusal_of_a_known_arm)
        cls.monitor.speak()

    @classmethod
    def tearDownClass(cls):
        cls.monitor.fall_silent()

    @classmethod
    def refusal_of_a_known_arm(cls):
        """A goal is refused for another reason than that something is not there yet."""
        cls.left.client.send_goal(cls.left.goal(cls.left.aside(0.3), 1.0))
        status, _ = end_of(cls.left.client)
        text = cls.left.client.get_result().error_string
        is_early = any(early in text for early in ("nobody publishes", "no action server", "listen"))
        return None if is_early else (status, text)

    def setUp(self):
        self.monitor.permit()
        self.monitor.result, self.monitor.reason = CheckTrajectoryResponse.FREE, ""
        self.monitor.answer_after = 0.0
        if self.monitor.is_silent():
            self.monitor.speak()
        wait_for(self.both_are_back)

    def both_are_back(self):
        """The arms are where they began."""
        away = [arm for arm in (self.left, self.right) if not arm.is_at(arm.start)]
        for arm in away:
            arm.client.send_goal(arm.goal(arm.start, 0.5, smooth=True))
        for arm in away:
            arm.client.wait_for_result()
            arm.come_to_rest()
        return not away

    def tearDown(self):
        for arm in (self.left, self.right):
            if arm.client.get_state() not in (GoalStatus.PENDING, GoalStatus.ACTIVE):
                continue
            arm.client.cancel_goal()  # alone: to cancel all could meet the next test's goal
            arm.client.wait_for_result()

    def set_off(self, arm, way=0.9, seconds=1.8, client=None):
        """Straight; @return its speed once it is under way at full speed."""
        client = client or arm.client
        client.send_goal(arm.goal(arm.aside(way), seconds))
        wait_for(lambda: abs(arm.elbow() - arm.start[ELBOW]) > 0.2)
        return way / seconds

    def assert_at(self, arm, positions, delta=CLOSE):
        for is_at, wanted in zip(arm.positions(), positions):
            self.assertAlmostEqual(is_at, wanted, delta=delta)

    def assert_stood(self, arm, speed, since, delay=PERMISSION_PERIOD):
        """It stands, and went no further since then than the margins reckon with."""
        arm.come_to_rest()
        self.assertTrue(arm.stands())
        promised = speed * (delay + 0.625 * arm.stop_duration)
        print(f"{self.id()}: {arm.way(since):.4f} rad of {promised:.4f} and {speed * SLACK:.4f}")
        self.assertLess(arm.way(since), promised + speed * SLACK)

    def last_trajectory(self):
        return self.trajectories[-1][1]
