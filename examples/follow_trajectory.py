#!/usr/bin/python3
"""A client of an arm's action, to be copied: it reaches there and back until a goal fails; one that is
refused it sends again. The action is the one of the arm's own controller, or the same behind the
TrajectoryGate: the difference is its name. The way is that of a file, or one joint's turn between two
positions; wherever the arm is, it goes to the first of them before.

  rosrun tccm_monitor follow_trajectory.py _action:=right_arm/follow_joint_trajectory _way:=reach.yaml
  rosrun tccm_monitor follow_trajectory.py _action:=arm/follow_joint_trajectory _joint:=joint_1 \
      _from:=0.0 _to:=0.8
"""

import sys

import actionlib
import rospkg
import rospy
import yaml
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryGoal
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

APPROACH_SPEED = 0.3  # [rad/s] of the joints to the way's first point


def goal_of(names, way):
    """From where the arm is. @param way (seconds, positions, velocities) of each point"""
    joints = rospy.wait_for_message("joint_states", JointState)
    here = dict(zip(joints.name, joints.position))
    apart = max(abs(here[name] - position) for name, position in zip(names, way[0][1]))
    approach = max(0.5, 1.5 * apart / APPROACH_SPEED)  # a cubic's top speed is 1.5 times its mean
    return FollowJointTrajectoryGoal(trajectory=JointTrajectory(joint_names=names, points=[
        JointTrajectoryPoint(positions=positions, velocities=velocities,
                             time_from_start=rospy.Duration(approach + seconds))
        for seconds, positions, velocities in way]))


def way_of_file(path):
    """@return joints and (seconds, positions, velocities) of each point."""
    with open(path, encoding="utf-8") as file:
        content = yaml.safe_load(file)
    return content["joint_names"], [(point["time_from_start"], point["positions"], point["velocities"])
                                    for point in content["points"]]


def way_of_joint(name, begin, end):
    """@param begin, end positions [rad]"""
    return [name], [(0.0, [begin], [0.0]), (1.5 * abs(end - begin) / APPROACH_SPEED, [end], [0.0])]


def main():
    rospy.init_node("follow_trajectory")
    if rospy.has_param("~joint"):
        names, there = way_of_joint(rospy.get_param("~joint"), rospy.get_param("~from"),
                                    rospy.get_param("~to"))
    else:
        names, there = way_of_file(rospy.get_param(
            "~way", rospkg.RosPack().get_path("tccm_monitor") + "/examples/reach.yaml"))
    back = [(there[-1][0] - seconds, positions, [-velocity for velocity in velocities])
            for seconds, positions, velocities in reversed(there)]

    client = actionlib.SimpleActionClient(rospy.get_param("~action"), FollowJointTrajectoryAction)
    client.wait_for_server()
    for way in (there, back) * rospy.get_param("~times", 1000):
        while client.send_goal_and_wait(goal_of(names, way)) == GoalStatus.REJECTED:
            rospy.logwarn("Not yet: %s", client.get_result().error_string)
            rospy.sleep(1.0)
        if rospy.is_shutdown():
            return 0
        if client.get_state() != GoalStatus.SUCCEEDED:
            rospy.logerr("The goal is not reached: %s", client.get_result().error_string)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
