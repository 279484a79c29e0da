#!/usr/bin/python3
"""Runs the program `trials`. Environment: TCCM_TRIALS the program."""
import csv
import json
import os
import subprocess
import tempfile
import unittest


class TrialsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def call(self, *arguments):
        return subprocess.run([os.environ["TCCM_TRIALS"], *arguments], capture_output=True,
                              text=True, timeout=300)

    def results(self, *arguments, out="out"):
        """@return exit status, results.json and the rows of results.csv."""
        out = os.path.join(self.folder.name, out)
        done = self.call(*arguments, "--no-pictures", "--out", out)
        self.assertEqual(done.stderr, "")
        with open(os.path.join(out, "results.json")) as f:
            results = json.load(f)
        with open(os.path.join(out, "results.csv")) as f:
            return done.returncode, results, list(csv.DictReader(f))

    def test_arms_stop_before_what_appears_and_what_could_not_be_avoided_is_told(self):
        status, results, rows = self.results("stopping", "--trials", "6")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        self.assertEqual([row["speed_mps"] for row in rows], 2 * ["0.100", "0.250", "0.400"])
        self.assertEqual([row["obstacle"] for row in rows], 3 * ["pole"] + 3 * ["arm"])
        for row in rows:
            self.assertIn(row["outcome"], ("stopped", "touched"))
            self.assertEqual(row["outcome"] == "touched", row["contact_s"] != "")
            self.assertEqual(row["outcome"] == "touched", row["cause"] != "")
        figures = results["figures"]
        self.assertEqual(figures["all"]["trials"], 6)
        self.assertEqual(figures["by_speed"]["100 mm/s"]["stopped"], 2)
        self.assertEqual(sum(sum(row["by_phase"]) for row in figures["contacts"]),
                         figures["all"]["touched"])
        with open(os.path.join(self.folder.name, "out", "timing.json")) as f:
            self.assertGreater(json.load(f)["processing_us"]["p99"], 0.0)

    def test_a_governed_arm_touches_nothing_that_appears(self):
        status, results, rows = self.results("stopping", "--trials", "3", "--appear-distance-m",
                                             "0.15", "--gap-min-m", "0.15", "--gap-max-m", "0.151")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        self.assertEqual([row["outcome"] for row in rows], 3 * ["stopped"])

    def test_hands_that_reach_for_the_arm_are_told_by_side_speed_and_period(self):
        status, results, rows = self.results("hands", "--trials", "1", "--hand-speeds", "0.5,1.6",
                                             "--tilt-periods", "1.575", "--speeds", "0.25")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        cells = results["figures"]["hands"]
        self.assertEqual([(cell["from"], cell["hand_mps"]) for cell in cells],
                         [("side", 0.5), ("side", 1.6), ("behind", 0.5), ("behind", 1.6)])
        for cell, row in zip(cells, rows):
            self.assertEqual(cell["touched"], int(row["outcome"] == "touched"))
            self.assertEqual(cell["touched_in_motion"], int(float(row["contact_speed_mps"]) > 0.005))

    def test_hovering_hands_stop_before_what_they_hide(self):
        status, results, rows = self.results("hover", "--trials", "6", "--ghosts", "1", "--seed",
                                             "2")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        self.assertEqual(results["figures"]["hover"]["stopped"], 6)
        self.assertEqual(results["figures"]["ghosts"]["left_after_two_tilts"], 0)
        self.assertEqual([row["kind"] for row in rows], 6 * ["hover"] + ["ghost"])
        for row in rows[:6]:
            self.assertGreater(float(row["left_m"]), 0.0)

    def test_without_holding_what_is_hidden_contacts_miss_a_limit(self):
        status, results, rows = self.results("hover", "--trials", "8", "--ghosts", "0",
                                             "--hold-s", "0")
        self.assertEqual((status, results["limits_missed"]), (1, ["contacts"]))
        touched = [row for row in rows if row["outcome"] == "touched"]
        self.assertEqual(len(touched), results["figures"]["hover"]["touched"])

    def test_the_same_seed_gives_the_same_rows_whatever_the_number_of_threads(self):
        arguments = ("stopping", "--trials", "4")
        once = self.results(*arguments, "--seed", "3")
        self.assertEqual(once, self.results(*arguments, "--seed", "3", "--jobs", "2", out="again"))
        self.assertNotEqual(once[2], self.results(*arguments, "--seed", "4", out="other")[2])

    def test_visibility_is_compared_link_by_link(self):
        for robot in ("in_pose", "away"):
            with self.subTest(robot):
                _, results, rows = self.results("visibility", "--poses", "4", "--robot", robot,
                                                "--agree-min", "0", out=robot)
                self.assertEqual(len(rows), 4 * 6)
                counted = [row for row in rows if row["counted"] == "1"]
                self.assertEqual(len(counted), results["figures"]["all"]["cases"])
                for row in rows:
                    self.assertAlmostEqual(float(row["visible"]) - float(row["true_visible"]),
                                           float(row["difference"]), places=3)

    def test_a_governed_speed_is_judged_and_tabulated(self):
        _, results, rows = self.results("governed", "--minutes", "0.3", "--tilt-step-deg", "30")
        self.assertEqual(len(rows), 1)
        self.assertEqual(int(rows[0]["cases"]), results["figures"]["motions"]["cases"])
        self.assertEqual([round(place["tilt_deg"], 6) for place in results["figures"]["places"]],
                         [30.0, 60.0])
        _, free, _ = self.results("governed", "--minutes", "0.3", "--tilt-step-deg", "60", "--free",
                                  out="free")
        self.assertGreater(free["figures"]["motions"]["violations"], 0)

    def test_arms_that_move_clear_of_everything_are_counted_by_noise(self):
        _, results, rows = self.results("false-stops", "--motions", "2", "--noises-m", "0.01,0.03",
                                        "--duration-s", "5", "--speeds", "0.1", "--scenes", "table")
        self.assertEqual(len(rows), 4)
        cells = results["figures"]["by_noise"]
        self.assertEqual([cell["noise_m"] for cell in cells], [0.01, 0.03])
        self.assertEqual(cells[0]["false_stops"],
                         sum(int(row["false_stops"]) for row in rows[:2]))

    def test_what_occluders_hide_is_found(self):
        status, results, rows = self.results("occlusion", "--trials", "6", "--seed", "3")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        hidden = [row for row in rows if row["hidden"]]
        self.assertEqual(len(hidden), results["figures"]["hiding"])
        self.assertEqual(sum(row["found_s"] != "" for row in hidden), results["figures"]["found"])

    def test_a_small_object_is_found_from_every_place(self):
        status, results, rows = self.results("small-objects", "--step-m", "0.3", "--phases", "1")
        self.assertEqual((status, results["limits_missed"]), (0, []))
        self.assertEqual(len(rows), results["figures"]["places"])
        self.assertGreater(len(rows), 3)
        self.assertLess(max(float(row["found_s"]) for row in rows), 1.61)

    def test_the_map_is_timed_and_weighed(self):
        _, results, rows = self.results("updates", "--windows", "5,10", "--steps", "200",
                                        "--additions", "3")
        self.assertEqual([row["scene"] for row in rows], ["table", "shelf"])
        with open(os.path.join(self.folder.name, "out", "timing.json")) as f:
            updates = json.load(f)["updates"]
        self.assertEqual([update["part_maps"] for update in updates], [5, 10])
        for update in updates:
            self.assertGreater(update["addition_us"], update["replacement_us"])

    def test_pictures_are_drawn(self):
        out = os.path.join(self.folder.name, "out")
        self.call("visibility", "--poses", "4", "--out", out)
        self.assertGreater(os.path.getsize(os.path.join(out, "visibility.png")), 10000)

    def test_bad_input_is_told_in_one_line(self):
        for arguments in ([], ["dance"], ["hover", "--trials", "-1"], ["hover", "--speed", "0"],
                          ["hover", "--gap-min-m", "0.2"], ["hover", "--jobs", "0"],
                          ["hover", "--config", "/nowhere.yaml"], ["hover", "--seed", "x"]):
            with self.subTest(arguments):
                done = self.call(*arguments, "--out", self.folder.name)
                self.assertEqual(done.returncode, 2)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertTrue(done.stderr.startswith("trials: "))

    def test_without_a_master_trials_through_the_nodelets_are_refused_in_one_line(self):
        done = subprocess.run([os.environ["TCCM_TRIALS"], "stopping", "--ros", "--out",
                               self.folder.name], capture_output=True, text=True, timeout=60,
                              env=dict(os.environ, ROS_MASTER_URI="http://localhost:1"))
        self.assertEqual(done.returncode, 2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("roslaunch tccm_monitor trials.launch", done.stderr)

    def test_a_speed_that_the_nodelets_would_not_govern_is_refused(self):
        done = self.call("stopping", "--ros", "--appear-distance-m", "0.15", "--out",
                         self.folder.name)
        self.assertEqual(done.returncode, 2)
        self.assertIn("appear_distance_m", done.stderr)

    def test_help_says_what_the_experiments_and_their_limits_are(self):
        done = self.call("--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("hover", done.stdout)
        done = self.call("hover", "--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("Limits", done.stdout)


if __name__ == "__main__":
    unittest.main()
