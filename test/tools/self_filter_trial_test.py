#!/usr/bin/python3
"""Runs the program `self_filter_trial`. Environment: TCCM_SELF_FILTER_TRIAL the program."""
import json
import os
import subprocess
import tempfile
import unittest

CONFIGS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config")


class SelfFilterTrialTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def call(self, *arguments):
        return subprocess.run([os.environ["TCCM_SELF_FILTER_TRIAL"], *arguments],
                              capture_output=True, text=True, timeout=300)

    def trial(self, *arguments, out="out"):
        """@return exit status and summary."""
        out = os.path.join(self.folder.name, out)
        done = self.call("--out", out, *arguments)
        self.assertEqual(done.stderr, "")
        with open(os.path.join(out, "summary.json")) as f:
            return done.returncode, json.load(f)

    def config(self, text):
        path = os.path.join(self.folder.name, "config.yaml")
        with open(os.path.join(CONFIGS, "simulation.yaml")) as f:
            shipped = f.read()
        with open(path, "w") as f:
            f.write(shipped.replace("tilt_scan_assembler:\n", "tilt_scan_assembler:\n" + text))
        return path

    def test_the_shipped_defaults_keep_all_limits_and_all_figures_are_told(self):
        status, summary = self.trial("--minutes", "0.4")
        self.assertEqual((status, summary["limits_missed"]), (0, []))
        self.assertEqual(summary["own_points_in_map"], 0)
        self.assertEqual(summary["contacts"]["checks_with_body_points"], 0)
        self.assertGreater(summary["points"]["own"]["measured_in_area"], 5000)
        self.assertLess(summary["scene_share_removed"]["all"], 0.02)
        for fates in summary["points"].values():
            fates.pop("kept_out_of_area")
            self.assertEqual(fates.pop("measured_in_area"), sum(fates.values()))

    def test_without_a_configuration_it_runs_with_the_simulated_robot_s(self):
        shipped = os.path.join(CONFIGS, "simulation.yaml")
        self.assertEqual(self.trial("--minutes", "0.1"),
                         self.trial("--minutes", "0.1", "--config", shipped, out="shipped"))

    def test_a_filter_that_is_off_or_too_tight_misses_limits(self):
        for text in ("  self_filter: false\n",
                     "  self_filter_padding_m: 0.01\n  self_filter_range_tolerance_m: 0.0\n"):
            with self.subTest(text):
                status, summary = self.trial("--minutes", "0.3", "--config", self.config(text))
                self.assertEqual(status, 1)
                self.assertIn("own_points", summary["limits_missed"])
                self.assertIn("contacts_with_body", summary["limits_missed"])

    def test_bad_input_is_told_in_one_line(self):
        for arguments in (["--minutes", "0"], ["--noise-m", "-1"], ["--body-error", "bent"],
                          ["--body-error-m", "0.05", "--body-error", "thinner"],
                          ["--config", "/nowhere.yaml"], ["--seed", "x"]):
            with self.subTest(arguments):
                done = self.call("--out", self.folder.name, *arguments)
                self.assertEqual(done.returncode, 2)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertTrue(done.stderr.startswith("self_filter_trial: "))

    def test_help_says_what_the_limits_are(self):
        done = self.call("--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("Limits", done.stdout)


if __name__ == "__main__":
    unittest.main()
