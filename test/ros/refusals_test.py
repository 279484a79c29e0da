#!/usr/bin/python3
"""What must not be run is refused with one line that names the key, and nothing reports clear."""

import time
import unittest

import rosnode
import rospy
import rostest
from rosgraph_msgs.msg import Log

from monitor_recorder import Recorder
from tccm_monitor.msg import MonitorStatus

# Of each namespace: the nodelets that refuse, and what their line names.
REFUSALS = {
    "no_robot": {"tilt_scan_assembler": "robot_description",
                 "collision_checker": "robot_description"},
    "bad_cell_size": {"tccm_mapper": "cell_size_m: -1"},
    "bad_horizon": {"collision_checker": "horizon_s: soon"},
    "no_frame": {"tilt_scan_assembler": "fixed_frame", "collision_checker": "fixed_frame"},
    "mesh": {"tilt_scan_assembler": "hand_link", "collision_checker": "hand_link"},
    "alone": {"collision_checker": "horizon_s: soon"},
}
NAMESPACES = list(REFUSALS) + ["wrong_frame"]
LISTENING = 8.0  # seconds


class RefusalsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lines = []
        # rosout_agg also holds what was said before a subscriber of ours was connected to the node.
        rospy.Subscriber("/rosout_agg", Log, cls.lines.append, queue_size=1000)
        cls.recorders = {namespace: Recorder(f"/{namespace}/") for namespace in NAMESPACES}
        time.sleep(LISTENING)
        cls.nodes = set(rosnode.get_node_names())

    def said(self, text):
        return [line.msg for line in self.lines if text in line.msg]

    def test_each_refusal_is_one_line_naming_the_key(self):
        for namespace, refusals in REFUSALS.items():
            for nodelet, key in refusals.items():
                with self.subTest(namespace=namespace, nodelet=nodelet):
                    said = self.said(f"/{namespace}/{nodelet} refuses to start")
                    self.assertEqual(len(said), 1, said)
                    self.assertIn(key, said[0])
                    self.assertNotIn("\n", said[0])

    def test_nothing_else_is_refused(self):
        refused = self.said("refuses to start")
        self.assertEqual(len(refused), sum(len(nodelets) for nodelets in REFUSALS.values()))

    def test_nothing_ever_reports_clear(self):
        for namespace, recorder in self.recorders.items():
            with self.subTest(namespace=namespace):
                self.assertNotIn(MonitorStatus.OK, {status.level for status in recorder.statuses})
                for flag, values in recorder.flags.items():
                    self.assertNotIn(False, {value for _, value in values}, flag)

    def test_a_checker_that_refuses_says_nothing_at_all(self):
        for namespace, refusals in REFUSALS.items():
            if "collision_checker" in refusals:
                self.assertEqual(self.recorders[namespace].statuses, [], namespace)

    def test_the_manager_and_the_other_nodelets_live_on(self):
        for namespace in NAMESPACES:
            if namespace != "alone":
                self.assertIn(f"/{namespace}/tccm_monitor_manager", self.nodes)
        self.assertGreater(len(self.recorders["bad_cell_size"].statuses), 100)

    def test_one_process_for_all_ends(self):
        self.assertNotIn("/alone/tccm_monitor", self.nodes)

    def test_a_frame_that_nobody_publishes_is_a_fault_that_names_it(self):
        statuses = self.recorders["wrong_frame"].statuses
        self.assertGreater(len(statuses), 100)
        self.assertEqual(statuses[-1].level, MonitorStatus.FAULT)
        self.assertEqual(statuses[-1].reason, "NO_TRANSFORM")
        self.assertIn("fixed_frame 'nowhere'", statuses[-1].detail)
        said = [line for line in self.said("NO_TRANSFORM") if "nowhere" in line]
        self.assertEqual(len(said), 1, said)


if __name__ == "__main__":
    rospy.init_node("refusals_test")
    rostest.rosrun("tccm_monitor", "refusals", RefusalsTest)
