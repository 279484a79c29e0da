#!/usr/bin/python3
"""The robot is stopped by faults, obstacles or what hides it: each stop is written as a bag, which replays
to the same verdict, and holds what was heard."""

import pathlib
import shutil
import subprocess
import unittest

import rosbag
import roslib.packages
import rospy
import rostest

from gated_robot import GatedRobot, wait_for
from input_faults import FAULTS
from tccm_monitor.msg import CheckerCall, MonitorStatus

KINDS = {"joint_states": ("stopped", "late", "one joint missing", "in degrees"),
         "tf": ("stopped", "late"),
         "scan": ("stopped", "all NaN", "stamped in the future"),
         "nodelets": ("checks too slow", "unknown joint commanded")}
OBSTACLE_STOPS = 3  # at most that are waited for: where a link touches, the robot stays
PATIENCE = 25.0  # seconds
# Whether there is a camera -> prefix of topics, points.
SENSORS = {True: [("laser/", "scan_cloud"), ("camera/", "cloud_scan")], False: [("", "scan_cloud")]}
INPUTS = {"/joint_states", "/tf", "calls", "state", "configuration", "robot_description", "primitives"}


class StopReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(rospy.get_param("~folder"))
        cls.by = rospy.get_param("~by")
        cls.stops = []  # (stamp, status) of those that were seen
        cls.was_permitted = False
        subscriber = rospy.Subscriber("monitor_status", MonitorStatus, cls.take, queue_size=1000)
        if cls.by == "inputs":
            cls.fail_inputs()
        else:
            wait_for(lambda: len(cls.stops) >= OBSTACLE_STOPS, PATIENCE)
        subscriber.unregister()
        wait_for(lambda: len(cls.bags()) >= len(cls.stops), 10.0)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def bags(cls):
        return sorted(cls.folder.glob("*.bag"), key=lambda bag: bag.stat().st_mtime)

    @classmethod
    def take(cls, status):
        if status.stop and cls.was_permitted:
            cls.stops.append(status)
        cls.was_permitted = not status.stop

    @classmethod
    def fail_inputs(cls):
        robot = GatedRobot()
        for topic, names in KINDS.items():
            for name in names:
                fault = FAULTS[topic][name]
                robot.wait_until_it_may_move()
                begin = fault.begin(robot)
                wait_for(lambda: robot.first_permission(
                    lambda permission: fault.reason in permission.reasons, begin), fault.limit + 3.0)
                fault.end(robot)
        robot.wait_until_it_may_move()
        robot.tear_down()

    def test_each_stop_is_written(self):
        bags = self.bags()
        self.assertGreaterEqual(len(bags), len(KINDS) if self.by == "inputs" else 1)
        # A stop that comes while another one is written is not.
        self.assertGreaterEqual(len(bags), len(self.stops) - 2, [str(stop.reason) for stop in self.stops])
        if self.by != "inputs":
            self.assertTrue(any(self.by.upper() in bag.name for bag in bags), bags)

    def test_each_replays_to_the_same_verdict(self):
        program = roslib.packages.find_node("tccm_monitor", "evaluate")[0]
        for bag in self.bags():
            with self.subTest(bag.name):
                done = subprocess.run([program, "--stop", bag], capture_output=True, text=True, check=False)
                rospy.loginfo("%s: %s", bag.name, done.stdout.strip().splitlines()[-1:])
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertIn("\nthe same verdict", done.stdout)

    def test_a_bag_holds_what_was_heard_up_to_the_stop(self):
        for path in self.bags():
            with self.subTest(path.name), rosbag.Bag(str(path)) as bag:
                topics = set(bag.get_type_and_topic_info().topics)
                self.assertLessEqual(INPUTS, topics)
                for prefix, points in SENSORS[rospy.get_param("~camera")]:
                    self.assertLessEqual({prefix + "cuboid_map", prefix + "scan_report", prefix + points}, topics)
                calls = [call for _, call, _ in bag.read_messages("calls")]
                self.assertTrue(calls[-1].stop)
                self.assertIn(calls[-1].call, (CheckerCall.CHECK, CheckerCall.FAIL))
                self.assertFalse([call for call in calls if call.call == CheckerCall.CHECK][-2].stop)
                self.assertLess(path.stat().st_size, 16e6)

    def replay_changed(self, change):
        """@param change (messages, index of the last call): changes the list."""
        path, other = self.bags()[-1], self.folder / "other"
        with rosbag.Bag(str(path)) as bag, rosbag.Bag(str(other), "w") as changed:
            messages = list(bag.read_messages())
            change(messages, max(i for i, (topic, _, _) in enumerate(messages) if topic == "calls"))
            for topic, message, stamp in messages:
                changed.write(topic, message, stamp)
        program = roslib.packages.find_node("tccm_monitor", "evaluate")[0]
        return subprocess.run([program, "--stop", other], capture_output=True, text=True, check=False)

    def test_a_bag_that_says_otherwise_is_told(self):
        def change(messages, last):
            messages[last].message.reason = "KEEP_OUT"
        done = self.replay_changed(change)
        self.assertEqual(done.returncode, 1)
        self.assertIn("NOT the same verdict", done.stdout)

    def test_a_bag_that_was_cut_is_no_stop(self):
        def change(messages, last):
            del messages[last:]
        done = self.replay_changed(change)
        self.assertEqual(done.returncode, 2)
        self.assertIn("does not end with a stop", done.stderr)


if __name__ == "__main__":
    rospy.init_node("stop_replay_test")
    rostest.rosrun("tccm_monitor", "stop_replay", StopReplayTest)
