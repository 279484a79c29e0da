"""An arm with a FollowJointTrajectory action, as its clients see it, and what its joints do."""

import threading
import time

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryGoal
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from waiting import PATIENCE, wait_for

ELBOW = 3  # its place among an arm's joints
ELBOW_MIDDLE = -1.3  # [rad]
AT_REST = 1e-6  # [rad]


class ArmClient:
    """@param action its own controller's, or that of a gate before it."""

    def __init__(self, side, action):
        self.joints = rospy.get_param(f"{side}_arm_controller/joints")
        self.stop_duration = rospy.get_param(f"{side}_arm_controller/stop_trajectory_duration")
        self.action = f"{action}/follow_joint_trajectory"
        self.lock = threading.Lock()
        self.samples = []  # (monotonic time, stamp, positions, velocities) of its joints
        rospy.Subscriber("joint_states", JointState, self.take, queue_size=1000, tcp_nodelay=True)
        self.client = self.new_client()
        wait_for(lambda: self.samples)
        self.start = self.positions()

    def new_client(self):
        client = actionlib.SimpleActionClient(self.action, FollowJointTrajectoryAction)
        assert client.wait_for_server(rospy.Duration(PATIENCE))
        return client

    def take(self, message):
        try:
            places = [message.name.index(joint) for joint in self.joints]
        except ValueError:
            return
        with self.lock:
            self.samples.append((time.monotonic(), message.header.stamp.to_sec(),
                                 [message.position[i] for i in places],
                                 [message.velocity[i] for i in places]))

    def log(self, since=0.0, until=float("inf")):
        with self.lock:
            return [sample for sample in self.samples if since <= sample[0] <= until]

    def positions(self):
        return self.log()[-1][2]

    def is_at(self, positions):
        return all(abs(a - b) < 1e-3 for a, b in zip(self.positions(), positions))

    def speed(self):
        return max(abs(v) for v in self.log()[-1][3])

    def elbow(self):
        return self.positions()[ELBOW]

    def way(self, since, until=float("inf")):
        """How far its elbow went in that time [rad]."""
        elbow = [positions[ELBOW] for _, _, positions, _ in self.log(since, until)]
        return max(elbow) - min(elbow)

    def fastest(self, seconds, since, until=float("inf")):
        """The speed of its elbow over the fastest so many seconds: where a busy machine is late, the arm
        catches up at once [rad/s]."""
        speeds, begin = [], 0
        log = [(stamp, positions[ELBOW]) for _, stamp, positions, _ in self.log(since, until)]
        for stamp, elbow in log:
            while stamp - log[begin][0] > seconds:
                speeds.append(abs(elbow - log[begin][1]) / (stamp - log[begin][0]))
                begin += 1
        return max(speeds)

    def aside(self, way):
        """@return where its joints began, the elbow nearer to the middle of its range."""
        towards = way if self.start[ELBOW] < ELBOW_MIDDLE else -way
        return [q + towards * (i == ELBOW) for i, q in enumerate(self.start)]

    def goal(self, positions, seconds, joints=None, smooth=False):
        """From wherever the arm is."""
        velocities = [0.0] * len(positions) if smooth else []
        return FollowJointTrajectoryGoal(trajectory=JointTrajectory(
            joint_names=joints or self.joints, points=[JointTrajectoryPoint(
                positions=positions, velocities=velocities,
                time_from_start=rospy.Duration(seconds))]))

    def wait_until_it_moves(self, speed):
        """Its goal has been sent. @param speed [rad/s], of some joint"""
        def moves():
            state = self.client.get_state()
            if state > GoalStatus.ACTIVE:
                self.client.wait_for_result(rospy.Duration(PATIENCE))
                raise AssertionError(f"its goal ended before it moved, in state {state}: {self.client.get_result()}")
            return self.speed() > speed
        wait_for(moves)

    def come_to_rest(self):
        wait_for(lambda: self.speed() < AT_REST)

    def stands(self, seconds=0.5):
        """Whether it does not move for so long."""
        begin = time.monotonic()
        wait_for(lambda: time.monotonic() > begin + seconds)
        return self.way(begin) < AT_REST


class GatedArm(ArmClient):
    """Behind the TrajectoryGate."""

    def __init__(self, side):
        super().__init__(side, f"{side}_arm")


def end_of(client):
    """@return how its goal ended: status and error code."""
    assert client.wait_for_result(rospy.Duration(PATIENCE))
    return client.get_state(), client.get_result().error_code


def assert_feedback_tells_joints(case, arm):
    feedback = []
    arm.client.send_goal(arm.goal(arm.aside(0.4), 0.8, smooth=True), feedback_cb=feedback.append)
    case.assertEqual(end_of(arm.client)[0], GoalStatus.SUCCEEDED)
    case.assertGreater(len(feedback), 5)
    for message in feedback:
        case.assertEqual(list(message.joint_names), arm.joints)
        for desired, actual, error in zip(message.desired.positions, message.actual.positions,
                                          message.error.positions):
            case.assertAlmostEqual(desired - actual, error, 9)
