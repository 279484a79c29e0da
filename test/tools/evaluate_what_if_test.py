#!/usr/bin/python3
"""`evaluate --compare` and `--sweep`: what other configurations would have made of a recording.

Environment: TCCM_EVALUATE, TCCM_SIMULATE: the programs.
"""

import filecmp
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
URDF = REPOSITORY / "simulation" / "robot" / "dual_arm.urdf"
SIMULATION = REPOSITORY / "config" / "simulation.yaml"


class WhatIfTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.bag = cls.folder / "reach.bag"
        subprocess.run([os.environ["TCCM_SIMULATE"], "--bag", cls.bag, "--duration-s", "9", "--obstacle", "box",
                        "--appear-s", "4", "--stop-at", "5.6", "--seed", "2"],
                       check=True, capture_output=True, timeout=300)
        for padding in (0.03, 0.05):
            config = yaml.safe_load(SIMULATION.read_text())
            config["collision_checker"]["collision_padding_m"] = padding
            (cls.folder / f"{padding}.yaml").write_text(yaml.safe_dump(config))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def evaluate(self, out, *arguments, status=0):
        done = subprocess.run([os.environ["TCCM_EVALUATE"], "--bag", self.bag, "--urdf", URDF, "--out",
                               self.folder / out, *arguments], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def stops(self, config):
        """As evaluate finds them with that configuration alone."""
        self.evaluate("alone", "--config", config)
        segments = json.loads((self.folder / "alone" / "summary.json").read_text())["stop_segments"]
        numbers = sorted({segment["stop"] for segment in segments})
        return [(min(s["from_s"] for s in segments if s["stop"] == n), max(s["to_s"] for s in segments if s["stop"] == n))
                for n in numbers]

    def test_a_comparison_has_the_stops_of_both_and_what_differs(self):
        configs = [self.folder / "0.03.yaml", self.folder / "0.05.yaml"]
        done = self.evaluate("compared", "--compare", *configs)
        results = json.loads((self.folder / "compared" / "comparison.json").read_text())
        for run, config in zip(results["runs"], configs):
            self.assertEqual([(stop["from_s"], stop["to_s"]) for stop in run["stops"]], self.stops(config))
        changes = results["changes"]
        for side, run in zip(("before", "after"), results["runs"]):  # each stop is in one line
            self.assertEqual([change[side] for change in changes if change[side]], run["stops"])
        moved = [change for change in changes if change["change"] == "moved"]
        self.assertTrue(moved, done.stdout)
        self.assertLess(moved[0]["after"]["from_s"], moved[0]["before"]["from_s"], "more padding stops it earlier")
        self.assertRegex(done.stdout, r"moved    at .* s earlier")
        self.assertGreater((self.folder / "compared" / "comparison.png").stat().st_size, 10000)

    def test_a_configuration_compared_with_itself_changes_nothing(self):
        done = self.evaluate("same", "--compare", SIMULATION, SIMULATION)
        self.assertIn("0 moved, 0 for another reason, 0 gone, 0 come", done.stdout)

    def test_a_sweep_has_a_row_a_value_and_the_same_bytes_twice(self):
        sweep = ("--config", SIMULATION, "--sweep", "collision_padding_m=0.02:0.14:0.06")
        done = self.evaluate("one", *sweep)
        self.evaluate("two", *sweep)
        results = json.loads((self.folder / "one" / "sweep.json").read_text())
        self.assertEqual([run["name"] for run in results["runs"]], ["0.02", "0.08", "0.14"])
        shares = [run["stop_fraction"] for run in results["runs"]]
        self.assertEqual(shares, sorted(shares), "more padding never stops it for a shorter time here")
        self.assertLess(shares[0], shares[2])
        self.assertEqual(len(done.stdout.splitlines()), 6)
        self.assertTrue(filecmp.cmp(self.folder / "one" / "sweep.json", self.folder / "two" / "sweep.json", False))
        self.assertGreater((self.folder / "one" / "sweep.png").stat().st_size, 20000)

    def test_what_is_wrong_is_told_in_a_line(self):
        for sweep, told in (("no_such_key=0:1:1", "there is no parameter no_such_key"),
                            ("collision_padding_m=0:1", "is not key=from:to:step"),
                            ("collision_padding_m=0:1:0", "is not key=from:to:step"),
                            ("collision_padding_m=0:1:1e-6", "at most 1000"),
                            ("collision_padding_m=0:2:2", "collision_padding_m: 2"),
                            ("marker_rate_hz=1:2:1", "may be any of")):
            with self.subTest(sweep):
                done = self.evaluate("bad", "--config", SIMULATION, "--sweep", sweep, status=2)
                self.assertIn(told, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_what_saw_nothing_is_not_the_same(self):
        """No stop is found with it, which does not mean that there would be none."""
        other = self.folder / "other.yaml"
        config = yaml.safe_load(SIMULATION.read_text())
        config["tilt_scan_assembler"]["transform_gap_max_s"] = 0.001
        other.write_text(yaml.safe_dump(config))
        done = self.evaluate("nothing", "--compare", SIMULATION, other, status=2)
        self.assertIn("transform_gap", done.stderr)


if __name__ == "__main__":
    unittest.main()
