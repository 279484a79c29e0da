#!/usr/bin/python3
"""The commands of docs/tutorial.md, as they stand there, from the robot on: with a robot made here in
place of the one that is fetched, without rviz, and programs by their path, as rosrun passes over a
folder `build`."""

import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
import yaml
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from tccm_monitor.msg import MonitorStatus
from waiting import wait_for

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "tutorial.md"
# Of each joint: origin xyz and roll, and limits, so that it reaches as the arm of the tutorial does.
JOINTS = (((0.0, 0.0, 0.333), 0.0, (-2.9, 2.9)), ((0.0, 0.0, 0.0), -1.5708, (-1.8, 1.8)),
          ((0.0, -0.316, 0.0), 1.5708, (-2.9, 2.9)), ((0.0825, 0.0, 0.0), 1.5708, (-3.1, -0.1)),
          ((-0.0825, 0.384, 0.0), -1.5708, (-2.9, 2.9)), ((0.0, 0.0, 0.0), 1.5708, (0.0, 3.7)),
          ((0.088, 0.0, 0.0), 1.5708, (-2.9, 2.9)))


def arm():
    """@return its URDF."""
    parts = ['<link name="panda_link0"><collision><origin xyz="0 0 0.07"/><geometry>'
             '<cylinder radius="0.08" length="0.14"/></geometry></collision></link>']
    for number, (xyz, roll, (lower, upper)) in enumerate(JOINTS, 1):
        place = " ".join(str(value) for value in xyz)
        parts.append(
            f'<joint name="panda_joint{number}" type="revolute"><axis xyz="0 0 1"/>'
            f'<origin xyz="{place}" rpy="{roll} 0 0"/><parent link="panda_link{number - 1}"/>'
            f'<child link="panda_link{number}"/>'
            f'<limit lower="{lower}" upper="{upper}" effort="10" velocity="2.2"/></joint>'
            f'<link name="panda_link{number}"><collision><geometry><sphere radius="0.07"/></geometry>'
            '</collision></link>')
    return '<robot name="arm">' + "".join(parts) + "</robot>"


def by_path(command):
    """@return it with the program's path in place of rosrun."""
    words = command.split(" ")
    if words[0] != "rosrun":
        return command
    path = subprocess.run(["catkin_find", "--first-only", "--libexec", *words[1:3]], check=True,
                          capture_output=True, text=True).stdout.strip()
    return " ".join([path] + words[3:])


def commands():
    """@return those of the page, in their order."""
    return [by_path(line[4:]) for line in PAGE.read_text(encoding="utf-8").splitlines()
            if line.startswith("    ") and line[4] != " "]


class TutorialTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "arm.urdf").write_text(arm(), encoding="utf-8")
        self.level, self.turn, self.speed = None, None, 0.0
        self.moved, self.stopped_by = False, set()
        rospy.Subscriber("monitor_status", MonitorStatus, self.hear)
        rospy.Subscriber("joint_states", JointState, self.hear_joints)
        self.said = []
        rospy.Subscriber("/rosout", Log, lambda line: self.said.append(line.msg), queue_size=1000)
        self.reset = rospy.ServiceProxy("reset", Trigger)

    def hear(self, status):
        self.level = status.level
        if status.stopped_by and self.moved:
            self.stopped_by.add(status.stopped_by)

    def hear_joints(self, joints):
        self.turn = joints.position[joints.name.index("panda_joint1")]
        self.speed = abs(joints.velocity[joints.name.index("panda_joint1")])

    def start(self, command):
        process = subprocess.Popen(["bash", "-c", "exec " + command], cwd=self.folder)

        def end():
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.addCleanup(end)
        return process

    def run_to_end(self, command):
        run = subprocess.run(["bash", "-c", command], cwd=self.folder, timeout=120, check=False, text=True,
                             capture_output=True)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def test_its_commands_lead_to_an_arm_that_stops(self):
        every = commands()
        self.assertLessEqual(len(every), 10)
        build, source, master, fetch, robot, setup, monitor, client, box, no_boxes = every
        for command, word in ((build, "scripts/build --install"), (source, "setup.bash"), (master, "roscore"),
                              (fetch, "-O arm.urdf")):
            self.assertIn(word, command)

        simulation = self.start(robot)
        wait_for(lambda: self.turn is not None)
        self.assertIn("nothing wrong", self.run_to_end(setup))
        self.assert_patient()
        self.start(monitor.replace("rviz:=true", "rviz:=false"))
        wait_for(lambda: self.level == MonitorStatus.OK, 30.0)
        moving = self.start(client)
        wait_for(lambda: self.turn < -0.05)
        self.moved = True
        self.run_to_end(box)
        self.assertEqual(moving.wait(30), 1, "the goal has failed")
        wait_for(lambda: self.speed == 0.0)
        self.assertGreater(self.turn, -0.9, "the box is there")
        self.assertTrue(self.stopped_by, "a stop was told")
        self.assert_stops_are_logged()

        self.assert_refused(client)
        self.run_to_end(no_boxes)
        wait_for(lambda: self.level == MonitorStatus.OK)
        stood = self.turn
        self.start(client)
        wait_for(lambda: abs(self.turn - stood) > 0.05)

        simulation.send_signal(signal.SIGINT)
        simulation.wait(30)
        wait_for(lambda: self.level == MonitorStatus.FAULT)
        self.start(robot)
        wait_for(lambda: self.reset().success, 60.0)
        wait_for(lambda: self.level == MonitorStatus.OK)

    def assert_patient(self):
        """The gate's limits are those of the checker."""
        config = yaml.safe_load((self.folder / "arm.yaml").read_text(encoding="utf-8"))
        self.assertEqual(config["trajectory_gate"]["joints_age_max_s"],
                         config["collision_checker"]["joint_timeout_s"])

    def assert_stops_are_logged(self):
        wait_for(lambda: any(line.startswith(tuple(f"STOP {reason}: " for reason in self.stopped_by))
                             for line in self.said))

    def assert_refused(self, client):
        """The box is there still, and seen."""
        again = self.start(client)
        wait_for(lambda: any("not free" in line for line in self.said), 30.0)
        self.assertGreater(self.turn, -0.9)
        again.kill()
        again.wait()


if __name__ == "__main__":
    rospy.init_node("tutorial_test")
    rostest.rosrun("tccm_monitor", "tutorial", TutorialTest, sys.argv)
