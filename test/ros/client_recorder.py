"""What the tests of the example clients share: they write down what a client publishes and what the
arms do, and when on the wall clock."""

import threading
import time

import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from waiting import PATIENCE, wait_for

PERMISSION_PERIOD = 0.02
# What the way through sockets, schedulers and this program may add on a machine that is busy.
SLACK = 0.04
ARM_JOINTS = ("left_shoulder_pitch_joint", "left_elbow_joint")
AT_REST = 1e-6  # [rad]


def goal_to(positions, seconds):
    """From wherever the arm is, straight."""
    return JointTrajectory(joint_names=ARM_JOINTS, points=[
        JointTrajectoryPoint(positions=positions, time_from_start=rospy.Duration(seconds))])


class ClientRecorder:
    """Lists of (monotonic time, message), in the order they came."""

    def __init__(self):
        self.states, self.commands, self.trajectories, self.joints = [], [], [], []
        for topic, kind, log in (("client_state", String, self.states),
                                 ("command", JointTrajectory, self.commands),
                                 ("trajectory", JointTrajectory, self.trajectories),
                                 ("joint_states", JointState, self.joints)):
            rospy.Subscriber(topic, kind, self._take, callback_args=log, queue_size=1000,
                             tcp_nodelay=True)
        self.goals = rospy.Publisher("goal", JointTrajectory, queue_size=1, tcp_nodelay=True)

    @staticmethod
    def _take(message, log):
        log.append((time.monotonic(), message))

    def wait_until_connected(self):
        wait_for(lambda: self.states and self.joints and self.goals.get_num_connections())

    @property
    def state(self):
        return self.states[-1][1].data

    def positions(self, joints=ARM_JOINTS):
        """The newest, with the stamp."""
        message = self.joints[-1][1]
        return (message.header.stamp.to_sec(),
                [message.position[message.name.index(joint)] for joint in joints])

    def send(self, goal):
        """@return the state that the client takes up then, other than CHECKING."""
        before = len(self.states)
        self.goals.publish(goal)
        return wait_for(lambda: next((message.data for _, message in self.states[before:]
                                      if message.data != "CHECKING"), None))

    def wait_for_state(self, start, patience=PATIENCE):
        """@return when it came."""
        wait_for(lambda: self.state.startswith(start), patience)
        return self.states[-1][0]

    def last_setpoint(self):
        """When the last command came that moves the arm."""
        return max((at for at, message in list(self.commands) if message.points), default=0.0)

    def first_hold(self, since):
        """When the first empty command came; None where there is none."""
        return next((at for at, message in list(self.commands)
                     if at >= since and not message.points), None)

    def moving(self, since, until=float("inf")):
        """How far any joint but the laser's went in that time [rad]."""
        rows = [[q for name, q in zip(message.name, message.position) if "laser" not in name]
                for at, message in list(self.joints) if since <= at <= until]
        return max(max(column) - min(column) for column in zip(*rows))


class Rate:
    """Calls a function at a steady pace, in a thread of its own, until it is stopped."""

    def __init__(self, period, function):
        self.period, self.function = period, function
        self.stopped = threading.Event()
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        due = time.monotonic()
        while not self.stopped.wait(max(0.0, due - time.monotonic())):
            self.function()
            due += self.period

    def stop(self):
        self.stopped.set()
        self.thread.join()
