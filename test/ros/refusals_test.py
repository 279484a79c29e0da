#!/usr/bin/python3
"""What must not be run is refused on the console with one line that names the key, and nothing
reports clear."""

import json
import os
import re
import signal
import subprocess
import tempfile
import time
import unittest

import rosnode
import rospkg
import rospy
import rostest

from monitor_recorder import Recorder
from tccm_monitor.msg import MonitorStatus

PACKAGE = rospkg.RosPack().get_path("tccm_monitor")
ARMS = os.path.join(PACKAGE, "simulation", "robot", "dual_arm.urdf")
MESH = os.path.join(PACKAGE, "test", "ros", "mesh_robot.urdf")
DEFAULTS = None  # the launch file's own configuration
LISTENING = 8.0  # seconds


class Case:
    """@param refusals by nodelet, what the one line of its refusal names."""

    def __init__(self, robot, refusals, config=DEFAULTS, standalone=False):
        self.robot = robot
        self.refusals = refusals
        self.config = config
        self.standalone = standalone


CASES = {
    "no_robot": Case("", {"tilt_scan_assembler": "robot_description",
                          "collision_checker": "robot_description"}),
    "bad_cell_size": Case(ARMS, {"tccm_mapper": "cell_size_m: -1"},
                          {"tccm_mapper": {"cell_size_m": -1}}),
    "bad_horizon": Case(ARMS, {"collision_checker": "horizon_s: soon"},
                        {"collision_checker": {"horizon_s": "soon"}}),
    "no_frame": Case(ARMS, {"tilt_scan_assembler": "fixed_frame",
                            "collision_checker": "fixed_frame"},
                     {"tilt_scan_assembler": {"fixed_frame": "/"},
                      "collision_checker": {"fixed_frame": "/"}}),
    "mesh": Case(MESH, {"tilt_scan_assembler": "hand_link", "collision_checker": "hand_link"}),
    "alone": Case(ARMS, {"collision_checker": "horizon_s: soon"},
                  {"collision_checker": {"horizon_s": "soon"}}, standalone=True),
    "wrong_frame": Case(ARMS, {}, {"tilt_scan_assembler": {"fixed_frame": "nowhere"},
                                   "collision_checker": {"fixed_frame": "nowhere"}}),
    "defaults": Case(ARMS, {}),
}


def launch(namespace, case, folder):
    command = ["roslaunch", "tccm_monitor", "monitor.launch", f"robot:={case.robot}",
               f"standalone:={str(case.standalone).lower()}"]
    if case.config is not DEFAULTS:
        path = os.path.join(folder, namespace + ".yaml")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(case.config, file)  # which is YAML too
        command.append(f"config:={path}")
    return subprocess.Popen(command, env=dict(os.environ, ROS_NAMESPACE="/" + namespace),
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def console_of(process):
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=30)
    return re.sub("\x1b\\[[0-9;]*m", "", output).splitlines()


class RefusalsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.recorders = {namespace: Recorder(f"/{namespace}/") for namespace in CASES}
        with tempfile.TemporaryDirectory() as folder:
            running = {namespace: launch(namespace, case, folder)
                       for namespace, case in CASES.items()}
            time.sleep(LISTENING)
            cls.nodes = set(rosnode.get_node_names())
            cls.console = {namespace: console_of(process)
                           for namespace, process in running.items()}

    def said(self, namespace, text):
        return [line for line in self.console[namespace] if text in line]

    def test_each_refusal_is_one_line_naming_the_key(self):
        for namespace, case in CASES.items():
            with self.subTest(namespace=namespace):
                refusals = self.said(namespace, "refuses to start")
                self.assertEqual(len(refusals), len(case.refusals), refusals)
                for nodelet, key in case.refusals.items():
                    said = self.said(namespace, f"/{namespace}/{nodelet} refuses to start")
                    self.assertEqual(len(said), 1, refusals)
                    self.assertIn(key, said[0])
                    self.assertIn("[FATAL]", said[0])

    def test_nothing_ever_reports_clear(self):
        for namespace, recorder in self.recorders.items():
            with self.subTest(namespace=namespace):
                self.assertNotIn(MonitorStatus.OK, {status.level for status in recorder.statuses})
                for flag, values in recorder.flags.items():
                    self.assertNotIn(False, {value for _, value in values}, flag)

    def test_a_checker_that_refuses_says_nothing_at_all(self):
        for namespace, case in CASES.items():
            if "collision_checker" in case.refusals:
                self.assertEqual(self.recorders[namespace].statuses, [], namespace)

    def test_the_manager_and_the_other_nodelets_live_on(self):
        for namespace, case in CASES.items():
            if not case.standalone:
                self.assertIn(f"/{namespace}/tccm_monitor_manager", self.nodes)
        self.assertGreater(len(self.recorders["bad_cell_size"].statuses), 50)

    def test_one_process_for_all_ends(self):
        self.assertNotIn("/alone/tccm_monitor", self.nodes)

    def test_a_frame_that_nobody_publishes_is_a_fault_that_names_it(self):
        last = self.recorders["wrong_frame"].statuses[-1]
        self.assertEqual((last.level, last.reason), (MonitorStatus.FAULT, "NO_TRANSFORM"))
        self.assertIn("fixed_frame 'nowhere'", last.detail)
        said = self.said("wrong_frame", "STOP NO_TRANSFORM")
        self.assertEqual(len(said), 1, said)
        self.assertIn("nowhere", said[0])

    def test_the_defaults_start_and_stop_for_want_of_input(self):
        last = self.recorders["defaults"].statuses[-1]
        self.assertEqual((last.level, last.stop), (MonitorStatus.FAULT, True))


if __name__ == "__main__":
    rospy.init_node("refusals_test")
    rostest.rosrun("tccm_monitor", "refusals", RefusalsTest)
