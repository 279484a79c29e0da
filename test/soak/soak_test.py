#!/usr/bin/python3
"""Five minutes of scripts/soak: the real nodelets under random faults. TCCM_SOAK_MINUTES sets another time."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SEED = "1"
# A leak of 1 kB with each scan is more. glibc keeps what a burst left in pieces between what lives on.
GROWN_KB_MAX = 4096


class SoakTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        run = 'set -e; . "$1/scripts/environment"; isolateRos "$2"; shift 2; exec "$@"'
        cls.done = subprocess.run(
            ["bash", "-c", run, "bash", HERE.parent.parent, scratch.name, sys.executable, HERE / "main.py", "--minutes",
             os.environ.get("TCCM_SOAK_MINUTES", "5"), "--seed", SEED, "--out", scratch.name],
            capture_output=True, text=True, check=False)
        print(cls.done.stdout)
        path = pathlib.Path(scratch.name) / "soak.json"
        cls.result = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None

    def setUp(self):
        self.assertIsNotNone(self.result, self.done.stderr[-2000:])

    def found(self, what):
        return [f"{one['why']} ({one['figure']:.3f}), with {one['faults']}" for one in self.result["found"]
                if one["what"] == what]

    def test_nothing_is_permitted_that_must_not_be(self):
        self.assertGreater(self.result["had_to_stop"], 10)
        self.assertEqual(self.found("false clear"), [])

    def test_no_arm_moves_that_has_to_stand(self):
        self.assertEqual(self.found("arm moves"), [])

    def test_no_stop_outlasts_its_fault(self):
        self.assertEqual(self.found("outlasts"), [])

    def test_nothing_crashes_hangs_or_falls_silent(self):
        self.assertEqual(self.result["crashes"], [])
        self.assertEqual(self.found("silent"), [])
        self.assertEqual(self.result["hung_goals"], [])
        self.assertEqual(self.result["would_not_end"], [])
        self.assertGreater(self.result["goals"]["done"], 0)

    def test_no_memory_grows(self):
        self.assertGreater(len(self.result["memory"]), 2)
        self.assertEqual({name: row["grown_kb"] for name, row in self.result["memory"].items()
                          if row["grown_kb"] >= GROWN_KB_MAX}, {})

    def test_each_stop_replays_to_the_same_verdict(self):
        self.assertGreater(self.result["stops"]["replayed"], 0)
        self.assertEqual(self.result["stops"]["another_verdict"], [])


if __name__ == "__main__":
    unittest.main()
