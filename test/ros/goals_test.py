#!/usr/bin/python3
"""Random goals through the gate: each ends with a result, and nothing is touched that could have been
seen; also when a second robot begins where the first has ended."""

import csv
import json
import os
import subprocess
import tempfile
import unittest

import roslib.packages
import rostest


class GoalsTest(unittest.TestCase):
    def test_some_goals(self):
        with tempfile.TemporaryDirectory() as folder:
            # rosrun passes over a package's folder `build`.
            program = roslib.packages.find_node("tccm_monitor", "trials")[0]
            done = subprocess.run([program, "goals", "--ros", "--goals", "4", "--goals-each", "3",
                                   "--seed", "3", "--no-pictures", "--out", folder],
                                  capture_output=True, text=True, timeout=110)
            self.assertEqual((done.stderr, done.returncode), ("", 0), done.stdout)
            with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
                figures = json.load(file)["figures"]
            with open(os.path.join(folder, "results.csv"), encoding="utf-8") as file:
                goals = list(csv.DictReader(file))
        self.assertGreaterEqual(figures["goals"], 4)  # and those that replaced one
        self.assertEqual(figures["avoidable"], 0)
        self.assertGreaterEqual(len({goal["seed"] for goal in goals}), 2)  # a contact ends one
        for goal in goals:
            self.assertIn(goal["end"],
                          ("SUCCEEDED", "ABORTED", "REJECTED", "PREEMPTED", "RECALLED", "contact"))
            self.assertEqual(bool(goal["reason"]), goal["end"] in ("ABORTED", "REJECTED"), goal)


if __name__ == "__main__":
    rostest.rosrun("tccm_monitor", "goals", GoalsTest)
