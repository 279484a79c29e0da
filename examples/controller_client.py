#!/usr/bin/python3
"""An arm's controller client that obeys tccm_monitor's permission, to be copied from.

  goal               in: trajectory_msgs/JointTrajectory; without points: cancels
  motion_permission  in: tccm_monitor/MotionPermission
  joint_states       in: sensor_msgs/JointState
  check_trajectory   asked before a goal is begun; only FREE will do
  trajectory         out: what is being done, for the monitor; without points: nothing any more
  command            out: setpoints for the arm's controller; without points: stop and hold
  client_state       out: std_msgs/String, IDLE, CHECKING, MOVING, HELD or REFUSED and why; latched

Once held, it waits for a new goal. All names can be remapped. Private parameters:
  _rate_hz             of the setpoints, 100 to 1000 (200)
  _lookahead_s         setpoints are to be reached so much later (0.04)
  _scale_change_per_s  how fast the scale of the speed may change (4)
  _start_tolerance     between the joints and a goal's point at time 0, rad or m (0.01)
"""

import argparse
import pathlib
import sys
import threading
import time

import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from tccm_monitor.msg import MotionPermission
from tccm_monitor.srv import CheckTrajectory, CheckTrajectoryResponse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from guarded_motion import (HELD, REFUSED, BadGoal, GoalPath, GuardedMotion,  # noqa: E402
                            Instant, Output, require_in_range)

BAD_USE = 2


def instant():
    return Instant(rospy.get_time(), time.monotonic())


class ControllerClient:
    def __init__(self):
        self.tolerance = rospy.get_param("~start_tolerance", 0.01)
        require_in_range("start_tolerance", self.tolerance, 0.0, 1.0)
        self.motion = GuardedMotion(rospy.get_param("~lookahead_s", 0.04),
                                    rospy.get_param("~scale_change_per_s", 4.0))
        self.lock = threading.RLock()
        self.positions = {}
        self.goals = 0  # goals and cancellations so far
        self.told = None
        self.command = rospy.Publisher("command", JointTrajectory, queue_size=10, tcp_nodelay=True)
        self.trajectory = rospy.Publisher("trajectory", JointTrajectory, queue_size=10,
                                          tcp_nodelay=True)
        self.state = rospy.Publisher("client_state", String, queue_size=10, latch=True)
        self.check_trajectory = rospy.ServiceProxy("check_trajectory", CheckTrajectory)
        self.publish(Output())
        rospy.on_shutdown(self.cancel)
        rospy.Subscriber("motion_permission", MotionPermission, self.hear, queue_size=10,
                         tcp_nodelay=True)
        rospy.Subscriber("joint_states", JointState, self.hear_joints, queue_size=10)
        rospy.Subscriber("goal", JointTrajectory, self.hear_goal, queue_size=10)

    def run(self, rate):
        """Cycles of the monotonic clock: it goes on where simulated time stands still."""
        due = time.monotonic()
        while not rospy.is_shutdown():
            with self.lock:
                self.publish(self.motion.step(instant()))
            due = max(due + 1.0 / rate, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))

    def publish(self, output):
        if output.command:
            self.command.publish(output.command)
        if output.trajectory:
            self.trajectory.publish(output.trajectory)
        if self.motion.state_text != self.told:
            self.told = self.motion.state_text
            self.state.publish(self.told)
            log = rospy.logwarn if self.motion.state in (HELD, REFUSED) else rospy.loginfo
            log("%s", self.told)

    def hear(self, permission):
        with self.lock:
            self.publish(self.motion.hear(permission, instant()))

    def hear_joints(self, message):
        with self.lock:
            self.positions.update(zip(message.name, message.position))

    def cancel(self):
        with self.lock:
            self.goals += 1
            self.publish(self.motion.cancel())

    def hear_goal(self, goal):
        if not goal.points:
            self.cancel()
            return
        path, number = self.accept(goal)
        if not path:
            return
        complaint = self.check(path)
        with self.lock:
            if number != self.goals:
                return  # it was cancelled meanwhile
            if not path.starts_at(self.positions, self.tolerance):
                complaint = "the joints moved meanwhile"
            if complaint:
                self.motion.refuse(complaint)
            self.publish(Output() if complaint else self.motion.start(path, instant()))

    def accept(self, goal):
        """@return the goal's path, None where it cannot be followed, and its number."""
        path = None
        with self.lock:
            if self.motion.busy:
                rospy.logwarn("A goal came while another is not done; it is ignored.")
                return None, 0
            self.goals += 1
            self.motion.begin_check()
            self.publish(Output())
            try:
                path = GoalPath(goal, self.positions, self.tolerance)
            except BadGoal as error:
                self.motion.refuse(str(error))
                self.publish(Output())
            return path, self.goals

    def check(self, path):
        """@return why the arm may not go there; empty where it may."""
        try:
            answer = self.check_trajectory(path.rest())
        except rospy.ServiceException:
            return "check_trajectory does not answer"
        free = answer.result == CheckTrajectoryResponse.FREE
        return "" if free else f"not free: {answer.reason}, {answer.detail}"


def main():
    parser = argparse.ArgumentParser(prog="controller_client.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args(rospy.myargv(sys.argv)[1:])
    rospy.init_node("controller_client")
    try:
        rate = rospy.get_param("~rate_hz", 200.0)
        require_in_range("rate_hz", rate, 100.0, 1000.0)
        client = ControllerClient()
    except ValueError as error:
        rospy.logfatal("controller_client.py: %s", error)
        return BAD_USE
    client.run(rate)
    return 0


if __name__ == "__main__":
    sys.exit(main())
