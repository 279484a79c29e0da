#!/usr/bin/python3
"""What must not be run is refused on the console with one line that names the key, and nothing
reports clear. What may be run starts, and reads its robot once."""

import glob
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
import threading
import time

import rosnode
import rospkg
import rospy
import rostest

from gated_robot import wait_for
from monitor_recorder import Recorder
from named_subtests import NamedSubTests
from tccm_monitor.msg import MonitorStatus

PACKAGE = rospkg.RosPack().get_path("tccm_monitor")
ARMS = os.path.join(PACKAGE, "simulation", "robot", "dual_arm.urdf")
MISSING_MESH = os.path.join(PACKAGE, "test", "ros", "mesh_robot.urdf")
DEFAULTS = None  # the launch file's own configuration
PATIENCE = 90.0  # seconds until all have started or refused to, on a machine that may be busy
LISTENING = 3.0  # seconds from then on
STATUSES = 50  # of a checker that runs, at least


# Of mesh_robot.urdf, to be replaced by one that is there.
MESH_URI = "package://somewhere/hand.stl"
BOTH = ("tilt_scan_assembler", "collision_checker")


class Case:
    """@param robot a URDF file, or a function that writes one into a folder.
    @param refusals by nodelet, the texts that the one line of its refusal has."""

    def __init__(self, robot, refusals, config=DEFAULTS, standalone=False):
        self.robot = robot
        self.refusals = refusals
        self.config = config
        self.standalone = standalone


def stl_box(x, y, z):
    """A box between the origin and (x, y, z), as a binary STL."""
    corner = [(x * (i & 1), y * (i >> 1 & 1), z * (i >> 2 & 1)) for i in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    triangles = [(f[0], f[k], f[k + 1]) for f in faces for k in (1, 2)]
    stl = bytes(80) + struct.pack("<I", len(triangles))
    for triangle in triangles:
        stl += struct.pack("<12f", 0, 0, 0, *(value for i in triangle for value in corner[i]))
        stl += bytes(2)
    return stl


def robot_with_mesh(folder, name, content):
    """@return the path of a URDF whose hand is that mesh."""
    mesh, urdf = os.path.join(folder, name), os.path.join(folder, name + ".urdf")
    with open(mesh, "wb") as file:
        file.write(content)
    with open(MISSING_MESH, encoding="utf-8") as file:
        text = file.read()
    with open(urdf, "w", encoding="utf-8") as file:
        file.write(text.replace(MESH_URI, "file://" + mesh))
    return urdf


# What is wrong with what names the sensors is said once.
FIRST = ("collision_checker",)
KEY_TWICE = """collision_checker:
  horizon_s: 0.4  # and again below
  stop_time_s: 0.3
  horizon_s: 0.5
"""
NO_NUMBER = "collision_checker:\n  horizon_s: .nan\n"

CASES = {
    "no_robot": Case("", {nodelet: ["robot_description"] for nodelet in BOTH}),
    "bad_cell_size": Case(ARMS, {"tccm_mapper": ["line 1", "cell_size_m: -1"]},
                          {"tccm_mapper": {"cell_size_m": -1}}),
    "bad_horizon": Case(ARMS, {"collision_checker": ["line 1", "horizon_s: soon"]},
                        {"collision_checker": {"horizon_s": "soon"}}),
    "no_frame": Case(ARMS, {nodelet: ["fixed_frame"] for nodelet in FIRST},
                     {"tilt_scan_assembler": {"fixed_frame": "/"},
                      "collision_checker": {"fixed_frame": "/"}}),
    "key_twice": Case(ARMS, {nodelet: ["line 4", "horizon_s", "line 2"] for nodelet in FIRST},
                      KEY_TWICE),
    "no_number": Case(ARMS, {nodelet: ["line 2", "horizon_s", ".nan"] for nodelet in FIRST},
                      NO_NUMBER),
    "lost_region": Case(ARMS, {"collision_checker": ["keep_out[0]/frame: 'nowhere'", "'base_link'"]},
                        {"collision_checker": {"keep_out": [
                            {"name": "wall", "frame": "nowhere", "size_x_m": 0.1, "size_y_m": 1.0,
                             "size_z_m": 2.0}]}}),
    "leftover": Case(ARMS, {}),
    "missing_mesh": Case(MISSING_MESH, {nodelet: ["hand_link", MESH_URI] for nodelet in BOTH}),
    "broken_mesh": Case(lambda folder: robot_with_mesh(folder, "broken.stl", b"solid but nothing"),
                        {nodelet: ["hand_link", "broken.stl"] for nodelet in BOTH}),
    "mesh": Case(lambda folder: robot_with_mesh(folder, "hand.stl", stl_box(0.1, 0.04, 0.02)), {}),
    "alone": Case(ARMS, {"collision_checker": ["line 1", "horizon_s: soon"]},
                  {"collision_checker": {"horizon_s": "soon"}}, standalone=True),
    "wrong_frame": Case(ARMS, {}, {"tilt_scan_assembler": {"fixed_frame": "nowhere"},
                                   "collision_checker": {"fixed_frame": "nowhere"}}),
    "defaults": Case(ARMS, {}),
}


class Launched:
    """One case in a namespace of its own, and what it says on its console."""

    def __init__(self, namespace, case, folder):
        self._case = case
        robot = case.robot(folder) if callable(case.robot) else case.robot
        command = ["roslaunch", "tccm_monitor", "monitor.launch", f"robot:={robot}",
                   f"standalone:={str(case.standalone).lower()}"]
        if case.config is not DEFAULTS:
            path = os.path.join(folder, namespace + ".yaml")
            with open(path, "w", encoding="utf-8") as file:
                if isinstance(case.config, str):
                    file.write(case.config)
                else:
                    json.dump(case.config, file)  # which is YAML too
            command.append(f"config:={path}")
        # A folder of its own for the fits that are kept.
        environment = dict(os.environ, ROS_NAMESPACE="/" + namespace, ROS_HOME=folder)
        self._process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE,
                                         stderr=subprocess.STDOUT, text=True)
        self.console = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self._process.stdout:
            self.console.append(re.sub("\x1b\\[[0-9;]*m", "", line.rstrip("\n")))

    def said(self, text):
        return [line for line in self.console if text in line]

    def has_refused(self):
        return len(self.said("refuses to start")) >= len(self._case.refusals)

    def end(self):
        self._process.send_signal(signal.SIGINT)
        self._process.wait(timeout=30)
        self._reader.join()


class RefusalsTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.recorders = {namespace: Recorder(f"/{namespace}/") for namespace in CASES}
        folder = tempfile.mkdtemp()
        # As an earlier launch may have left it there.
        rospy.set_param("/leftover/collision_checker", {"horizon_s": "soon"})
        rospy.set_param("/leftover/monitored_robot", {"monitored_links": ["nowhere"]})
        cls.launched = {namespace: Launched(namespace, case, folder)
                        for namespace, case in CASES.items()}
        try:
            wait_for(cls.all_came_up, PATIENCE)
            time.sleep(LISTENING)
            cls.nodes = set(rosnode.get_node_names())
        finally:
            for launched in cls.launched.values():
                launched.end()
        cls.fits = glob.glob(os.path.join(folder, "tccm_monitor", "fits", "*"))
        shutil.rmtree(folder, ignore_errors=True)

    @classmethod
    def all_came_up(cls):
        """Whether nothing that is asked for below is still to come."""
        time.sleep(0.2)  # the master has enough to do
        nodes = rosnode.get_node_names()
        return all(cls.came_up(namespace, case, nodes) for namespace, case in CASES.items())

    @classmethod
    def came_up(cls, namespace, case, nodes):
        if not cls.launched[namespace].has_refused():
            return False
        if case.standalone:
            return f"/{namespace}/tccm_monitor" not in nodes
        if f"/{namespace}/tccm_monitor_manager" not in nodes:
            return False
        return "collision_checker" in case.refusals or \
            len(cls.recorders[namespace].statuses) > STATUSES

    def said(self, namespace, text):
        return self.launched[namespace].said(text)

    def test_each_refusal_is_one_line_naming_the_key(self):
        for namespace, case in CASES.items():
            with self.subTest(namespace=namespace):
                refusals = self.said(namespace, "refuses to start")
                self.assertEqual(len(refusals), len(case.refusals), refusals)
                for nodelet, texts in case.refusals.items():
                    said = self.said(namespace, f"/{namespace}/{nodelet} refuses to start")
                    self.assertEqual(len(said), 1, refusals)
                    for text in texts:
                        self.assertIn(text, said[0])
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
        self.assertGreater(len(self.recorders["bad_cell_size"].statuses), STATUSES)

    def test_one_process_for_all_ends(self):
        self.assertNotIn("/alone/tccm_monitor", self.nodes)

    def test_a_frame_that_nobody_publishes_is_a_fault_that_names_it(self):
        last = self.recorders["wrong_frame"].statuses[-1]
        self.assertEqual((last.level, last.reason), (MonitorStatus.FAULT, "NO_TRANSFORM"))
        self.assertIn("fixed_frame 'nowhere'", last.detail)
        said = self.said("wrong_frame", "FAULT NO_TRANSFORM")
        self.assertEqual(len(said), 1, said)
        self.assertIn("nowhere", said[0])

    def test_the_defaults_start_and_stop_for_want_of_input(self):
        last = self.recorders["defaults"].statuses[-1]
        self.assertEqual((last.level, last.stop), (MonitorStatus.FAULT, True))

    def test_what_differs_from_the_defaults_is_said(self):
        said = self.launched["wrong_frame"].console
        self.assertIn("  fixed_frame: nowhere  # base_link", said)
        self.assertEqual(len(self.said("defaults", "collision_checker: all as by default")), 1)

    def test_what_an_earlier_launch_left_does_not_count(self):
        self.assertEqual(self.said("leftover", "[FATAL]"), [])
        self.assertGreater(len(self.recorders["leftover"].statuses), STATUSES)

    def test_a_robot_with_a_mesh_starts_and_keeps_the_fit(self):
        last = self.recorders["mesh"].statuses[-1]
        self.assertEqual((last.level, last.stop), (MonitorStatus.FAULT, True))
        self.assertEqual(self.said("mesh", "[FATAL]") + self.said("mesh", "[ERROR]"), [])
        self.assertGreater(len(self.fits), 0)

    def test_the_nodelets_of_one_process_read_the_robot_once(self):
        self.assertEqual(len(self.said("mesh", "Reading 1 meshes")), 1)
        said = self.said("defaults", "have no collision element")
        self.assertEqual(len(said), 1, said)
        self.assertIn("laser_tilt_link", said[0])


if __name__ == "__main__":
    rospy.init_node("refusals_test")
    rostest.rosrun("tccm_monitor", "refusals", RefusalsTest)
