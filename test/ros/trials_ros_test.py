#!/usr/bin/python3
"""An arm that obeys the nodelets stops before what appears; a second trial begins once what held from
the first is let go."""

import csv
import json
import os
import subprocess
import tempfile
import unittest

import roslib.packages
import rostest


class TrialsTest(unittest.TestCase):
    def test_one_trial_after_the_other(self):
        with tempfile.TemporaryDirectory() as folder:
            # rosrun passes over a package's folder `build`.
            program = roslib.packages.find_node("tccm_monitor", "trials")[0]
            done = subprocess.run([program, "stopping", "--ros", "--trials", "2", "--speeds",
                                   "0.1,0.25", "--no-pictures", "--out", folder],
                                  capture_output=True, text=True, timeout=100)
            self.assertEqual(done.stderr, "")
            with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
                results = json.load(file)
            with open(os.path.join(folder, "results.csv"), encoding="utf-8") as file:
                slow, fast = csv.DictReader(file)
        self.assertTrue(results["settings"]["through_nodelets"])
        self.assertEqual(slow["outcome"], "stopped")
        self.assertEqual(slow["reason"], "COLLISION_AHEAD")
        self.assertGreater(float(slow["left_m"]), 0.02)
        # What the laser sees in time depends on when the arm sets off.
        self.assertIn(fast["outcome"], ("stopped", "touched"))
        self.assertEqual(fast["avoidable_from_support"], "0")


if __name__ == "__main__":
    rostest.rosrun("tccm_monitor", "trials", TrialsTest)
