#!/usr/bin/python3
"""Runs the program `evaluate` on bags made here and, where they are, on recordings and simulations.

Environment: TCCM_EVALUATE the program; TCCM_SIMULATE the simulator (optional); TCCM_SHARED_DATA a
folder of recordings (optional). Arguments in that order, before those of unittest, do the same.
"""
import glob
import json
import math
import os
import subprocess
import sys
import unittest

from tf2_msgs.msg import TFMessage

from evaluate_run import CONFIGS, HERE, EvaluateTest
from made_bag import CONFIG, LASER, START, URDF, Stream, scan_at, transform


class OnMadeBags(EvaluateTest):
    HALTING = 0.06  # m, from 0.2 m/s

    def bag(self, stream=None, **how):
        (stream or Stream()).write(self.path("in.bag"), **how)
        return self.path("in.bag")

    def robot(self):
        return self.text("robot.urdf", URDF)

    def test_a_single_point_gives_one_cuboid_below_its_height_in_its_cell(self):
        summary = self.evaluate(self.bag())
        cuboids = self.rows("cuboids")
        self.assertEqual(len(cuboids), 1)
        grid, cuboid = summary["map"], {k: float(v) for k, v in cuboids[0].items()}
        for axis, value, origin in zip("xy", (LASER[0] + 0.3, LASER[1]), grid["origin_m"]):
            cell = math.floor((value - origin) / grid["cell_size_m"])
            self.assertAlmostEqual(cuboid[axis], origin + (cell + 0.5) * grid["cell_size_m"], places=6)
        self.assertAlmostEqual(cuboid["top"], LASER[2], places=6)
        self.assertAlmostEqual(cuboid["bottom"], LASER[2] - grid["thickness_m"], places=6)
        self.assertEqual(cuboid["held"], 0)
        self.assertEqual(grid["window_scans"], 5)
        self.assertMapCanBeRecomputed()

    def test_without_a_robot_all_scans_are_mapped_and_nothing_is_checked(self):
        summary = self.evaluate(self.bag())
        self.assertEqual(summary["scans"], 80)
        self.assertEqual(summary["scans_dropped"], {})
        self.assertEqual(summary["points"]["mapped"], 80)
        self.assertEqual(summary["checks"], 0)
        self.assertIsNone(summary["collision_fraction"])
        self.assertIsNone(summary["stop_fraction"])
        self.assertEqual(self.rows("verdicts"), [])

    def test_the_summary_names_its_fields_in_the_promised_order(self):
        summary = self.evaluate(self.bag())
        self.assertNotIn("time_us", summary)
        with open(self.path("out/timing.json")) as f:
            timing = json.load(f)
        for group, fields in (
                (summary, ["scans", "scans_dropped", "points", "map", "checks", "collision_fraction",
                           "occlusion_fraction", "stop_fraction", "sight", "stops", "stop_segments"]),
                (summary["points"], ["measured", "out_of_range", "mixed_pixel", "self", "shadow",
                                     "out_of_area", "mapped"]),
                (summary["map"], ["origin_m", "cell_size_m", "cells", "thickness_m",
                                  "height_quantum_m", "window_scans", "cuboids", "memory_bytes"]),
                (summary["sight"], ["held", "unseen_fraction", "evidence_age_s", "governed_scale",
                                    "slow_by_reason", "stop_by_reason"]),
                (timing["time_us"], ["assemble", "integrate", "collision", "occlusion", "evidence",
                                      "scan_to_verdict"])):
            self.assertEqual([k for k in group if k in fields], fields)

    def test_each_beam_that_is_not_mapped_is_counted_by_its_reason(self):
        stream = Stream()
        beams = (0.3, math.nan, math.inf, -math.inf, 4.0)
        stream.messages = [(topic, scan_at(t, beams) if topic == "/tilt_scan" else m, t)
                           for topic, m, t in stream.messages]
        points = self.evaluate(self.bag(stream))["points"]
        self.assertEqual((points["measured"], points["out_of_range"], points["out_of_area"],
                          points["mapped"]), (400, 240, 80, 80))

    def test_a_hand_that_slides_into_the_obstacle_is_in_collision_while_it_touches(self):
        summary = self.evaluate(self.bag(), urdf=self.robot())
        rows = self.rows("verdicts")
        self.assertEqual(len(rows), summary["checks"])
        self.assertEqual(summary["checks"], 400 + 80)
        # The padded sphere of 60 mm reaches the cell [0.80, 0.82) from 0.74 on.
        for row in rows:
            if row["stamp"] and int(row["scan"]) > 5:
                slide = Stream().slide(float(row["stamp"]) - START)
                if abs(slide - 0.74) > 0.005 and row["reason"] != "COLLISION_AHEAD":
                    self.assertEqual(row["collision"], "1" if slide > 0.74 else "0", row)
                if row["reason"] == "COLLISION_AHEAD":  # what it cannot halt before, whatever horizon_s
                    self.assertGreater(slide, 0.74 - self.HALTING, row)
                    self.assertLess(slide, 0.745, row)
        collisions = [row for row in rows if row["reason"] == "COLLISION"]
        self.assertTrue(collisions)
        self.assertEqual({(row["stop"], row["link"]) for row in collisions}, {("1", "hand")})
        self.assertIn("COLLISION", [stop["reason"] for stop in summary["stop_segments"]])
        self.assertEqual(summary["stop_segments"][0]["reason"], "INIT")
        self.assertEqual(rows[-1]["stop"], "0")
        self.assertMapCanBeRecomputed()

    def test_a_hand_that_slides_into_a_region_to_keep_out_of_is_stopped_and_told_of(self):
        config = CONFIG.replace("check_occlusion: false}", """check_occlusion: false,
                    keep_out: [{name: hatch, center_x_m: 0.7, size_x_m: 0.1, size_y_m: 1.0,
                                size_z_m: 4.0}]}""")
        summary = self.evaluate(self.bag(), config=self.text("region.yaml", config),
                                urdf=self.robot())
        inside = 0
        for row in self.rows("verdicts"):
            if row["stamp"] and int(row["scan"]) > 5:
                slide = Stream().slide(float(row["stamp"]) - START)
                # The padded sphere of 60 mm reaches the region's face at 0.65 from 0.59 on; in the
                # obstacle the collision is named.
                if 0.595 < slide < 0.735 and row["reason"] != "COLLISION_AHEAD":
                    self.assertIn((row["reason"], row["stop"], row["link"]),
                                  (("KEEP_OUT", "1", "hand"), ("MOVING_OUT", "0", "hand")), row)
                    inside += row["reason"] == "KEEP_OUT"
                if slide < 0.59 - self.HALTING:
                    self.assertNotIn(row["reason"], ("KEEP_OUT", "KEEP_OUT_AHEAD"), row)
        self.assertGreater(inside, 10)
        self.assertIn("KEEP_OUT", [stop["reason"] for stop in summary["stop_segments"]])

    def test_what_was_not_seen_of_links_and_their_ways_is_summed_up_and_dumped(self):
        config = CONFIG.replace("horizon_s: 0.0", "horizon_s: 0.5").replace(
            "check_occlusion: false", "check_occlusion: true, occlusion_stops: false")
        summary = self.evaluate(self.bag(), config=self.text("seen.yaml", config), urdf=self.robot())
        self.assertSightAddsUp(summary)
        rows = self.rows("visibility")
        self.assertEqual({row["link"] for row in rows}, {"hand"})
        now = [row for row in rows if row["ahead"] == "0"]
        self.assertEqual(len(now), len(rows) - len(now), "at both poses")
        self.assertLessEqual(len(now), summary["checks"])
        # One beam is all there is: it passes what is beside it, so that most of the way is unseen.
        mean = sum(float(row["way_unseen"]) for row in now) / len(now)
        self.assertGreater(mean, 0.5)
        self.assertAlmostEqual(summary["sight"]["unseen_fraction"]["mean"], mean, places=5)
        above = sum(float(row["way_unseen"]) > 0.2 for row in now) / len(now)
        self.assertAlmostEqual(summary["sight"]["unseen_fraction"]["above_max"], above, places=5)
        self.assertIn("UNSEEN_AHEAD", summary["sight"]["slow_by_reason"])
        self.assertEqual(summary["sight"]["governed_scale"], {"mean": 1.0, "min": 1.0}, "not governed")

    def test_a_governed_speed_is_summed_up(self):
        config = CONFIG.replace("horizon_s: 0.0", "horizon_s: 0.5, appear_distance_m: 0.15")
        summary = self.evaluate(self.bag(), config=self.text("governed.yaml", config), urdf=self.robot())
        governed = summary["sight"]["governed_scale"]
        self.assertLess(governed["min"], governed["mean"])
        self.assertLess(governed["mean"], 1.0)
        self.assertIn("SPEED_GOVERNED", summary["sight"]["slow_by_reason"])

    def test_without_a_robot_no_link_is_seen_and_nothing_is_said_of_it(self):
        sight = self.evaluate(self.bag())["sight"]
        self.assertEqual(self.rows("visibility"), [])
        self.assertEqual(sight["unseen_fraction"], {"mean": None, "above_max": None})
        self.assertEqual(sight["evidence_age_s"], {"mean": None, "max": None})
        self.assertEqual(sight["held"], {"mean": 0.0, "max": 0, "last": 0})
        self.assertEqual((sight["slow_by_reason"], sight["stop_by_reason"]), ({}, {}))

    def test_checks_say_stop_where_joint_states_end_before_the_scans(self):
        stream = Stream()
        stream.messages = [m for m in stream.messages if m[0] != "/joint_states" or m[2] < 0.5]
        self.evaluate(self.bag(stream), urdf=self.robot())
        last = self.rows("verdicts")[-1]
        self.assertEqual((last["stop"], last["reason"]), ("1", "NO_JOINTS"))

    def test_compression_and_the_older_transform_type_change_nothing(self):
        self.evaluate(self.bag(), out="plain", urdf=self.robot())
        for how in ({"compression": "bz2"}, {"compression": "lz4"}, {"tf_type": "tf/tfMessage"}):
            with self.subTest(**how):
                out = "_".join(how.values()).replace("/", "_")
                self.evaluate(self.bag(**how), out=out, urdf=self.robot())
                self.assertSameFiles("plain", out)

    def test_fixed_transforms_that_are_published_again_and_again_serve_as_well(self):
        stream = Stream()
        self.evaluate(self.bag(stream), out="static")
        stream.messages = stream.messages[1:]
        # Dated ahead, as publishers of fixed transforms do.
        extra = [("/tf", TFMessage([transform(k * 0.05 + 0.5, "base_link", "mount", LASER)]), k * 0.05)
                 for k in range(-12, 80)]
        stream.messages = sorted(stream.messages + extra, key=lambda m: m[2])
        self.evaluate(self.bag(stream), out="moving", urdf=self.robot())
        self.assertEqual(self.rows("points", "static"), self.rows("points", "moving"))
        self.assertEqual(self.rows("verdicts", "moving")[-1]["reason"], "CLEAR")

    def test_scans_without_transforms_are_dropped_and_counted(self):
        stream = Stream()
        stream.messages = [m for m in stream.messages if m[0] != "/tf" or not 1.0 < m[2] < 2.0]
        dropped = self.evaluate(self.bag(stream))["scans_dropped"]
        # Those that waited too long, and those that waited until the gap had ended.
        self.assertEqual(set(dropped), {"no_transform", "transform_gap"})
        self.assertEqual(sum(dropped.values()), 19)

    def test_malformed_and_repeated_scans_are_dropped_and_counted(self):
        stream = Stream()
        stream.messages += [("/tilt_scan", scan_at(3.9, ()), 4.0), ("/tilt_scan", scan_at(3.9), 4.0)]
        self.assertEqual(self.evaluate(self.bag(stream))["scans_dropped"],
                         {"malformed": 1, "out_of_order": 1})

    def test_time_that_jumps_back_starts_all_anew_and_is_told(self):
        stream, again = Stream(), Stream()
        stream.messages += [(topic, m, t + 4.0) for topic, m, t in again.messages]
        summary = self.evaluate(self.bag(stream), urdf=self.robot())
        self.assertGreaterEqual(summary["time_jumps"], 1)
        self.assertGreater(summary["scans"], 150)
        self.assertEqual(len({int(p["scan"]) for p in self.rows("points")}), summary["scans"])
        self.assertMapCanBeRecomputed()

    def test_two_runs_give_the_same_files(self):
        bag = self.bag()
        for out in ("one", "other"):
            self.evaluate(bag, out=out, urdf=self.robot())
        self.assertSameFiles("one", "other")


class OnBadInput(EvaluateTest):
    def assertRefuses(self, expected, *arguments):
        done = self.call(*arguments, "--out", self.path("out"))
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(expected, done.stderr)

    def test_help_is_given_without_any_input(self):
        done = self.call("--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("--dump-verdicts", done.stdout)
        self.assertIn("--dump-visibility", done.stdout)

    def test_what_cannot_be_worked_with_is_refused_in_one_line(self):
        bag, config = self.path("in.bag"), self.text("config.yaml", CONFIG)
        Stream(1.0).write(bag)
        self.assertRefuses("[--bag,--clouds,--stop] is required")
        self.assertRefuses("no such bag", "--bag", self.path("none.bag"))
        self.assertRefuses("no readable bag", "--bag", config)
        self.assertRefuses("no messages on scan topic '/scan'; the bag has: /tilt_scan", "--bag", bag)
        self.assertRefuses("cannot read the URDF", "--bag", bag, "--config", config, "--urdf", "none")
        self.assertRefuses("it is no XML", "--bag", bag, "--config", config, "--urdf", config)
        self.assertRefuses("none.yaml", "--bag", bag, "--config", "none.yaml")
        self.assertRefuses("cannot write", "--bag", bag, "--config", config, "--dump-points",
                           self.path("none/points.csv"))

    def test_slips_in_the_configuration_are_refused_by_name(self):
        bag = self.path("in.bag")
        Stream(1.0).write(bag)
        for slip, expected in (("topics: {scan: /tf}", "carries tf2_msgs/TFMessage"),
                               ("tccm_mapper: {cellsize: 1}", "tccm_mapper/cellsize"),
                               ("tccm_maper: {}", "tccm_maper"),
                               ("tccm_mapper: {cell_size_m: -1}", "cell_size_m"),
                               ("topics: {scan: /tilt_scan}\n"
                                "tilt_scan_assembler: {fixed_frame: map}\n"
                                "collision_checker: {fixed_frame: map}", "fixed_frame 'map'")):
            with self.subTest(slip=slip):
                self.assertRefuses(expected, "--bag", bag, "--config", self.text("slip.yaml", slip))

    def test_every_shipped_configuration_is_valid(self):
        # A configuration with a slip is refused before the bag is looked for.
        configs = glob.glob(os.path.join(CONFIGS, "*.yaml"))
        self.assertTrue(configs)
        for config in configs:
            with self.subTest(config=os.path.basename(config)):
                self.assertRefuses("no such bag", "--bag", "none.bag", "--config", config)


class OnRecordings(EvaluateTest):
    RECORDINGS = (
        ("hrl_tabletop.yaml", "hrl_tabletop/tabletop_4_half_sweeps.bag", None, 652),
        ("pr2.yaml", "pr2_at_table/both_arms_wave.bag", "pr2_moveit/pr2.urdf", 652),
        ("pr2.yaml", "pr2_at_table/hands_dip_into_table.bag", "pr2_moveit/pr2.urdf", 652),
        ("guardian.yaml", "guardian_tilting_hokuyo/climbing_palette_facing_door.bag", None, 1514),
        ("guardian.yaml", "guardian_tilting_hokuyo/climbing_palette_facing_door.bag",
         "guardian_v7_tilt/guardian_tracks.urdf", 1514))

    def setUp(self):
        super().setUp()
        self.data = os.environ.get("TCCM_SHARED_DATA", "")
        if not os.path.isdir(os.path.join(self.data, "bags")):
            self.skipTest("TCCM_SHARED_DATA names no folder of recordings")

    def test_recordings_are_mapped_twice_the_same_and_their_maps_can_be_recomputed(self):
        for number, (config, bag, urdf, scans) in enumerate(self.RECORDINGS):
            with self.subTest(bag=bag, urdf=urdf):
                outs = [f"{number}_{run}" for run in ("one", "other")]
                for out in outs:
                    summary = self.evaluate(os.path.join(self.data, "bags", bag), out=out,
                                            config=os.path.join(CONFIGS, config),
                                            urdf=urdf and os.path.join(self.data, "robots", urdf))
                self.assertSameFiles(*outs)
                self.assertMapCanBeRecomputed(outs[0])
                self.assertEqual(summary["scans_received"], scans)
                self.assertGreater(summary["scans"], 0.99 * scans)
                self.assertTrue(summary["map"]["complete"])
                self.assertEqual(summary["points"]["overflowed"], 0)

    def test_hands_that_dip_among_objects_collide_and_waving_arms_do_not(self):
        spells = {}
        for bag in ("both_arms_wave", "hands_dip_into_table"):
            summary = self.evaluate(os.path.join(self.data, "bags/pr2_at_table", bag + ".bag"), out=bag,
                                    config=os.path.join(CONFIGS, "pr2.yaml"),
                                    urdf=os.path.join(self.data, "robots/pr2_moveit/pr2.urdf"))
            self.assertEqual(summary["robot"]["links_monitored"], 30)
            self.assertEqual(summary["robot"]["joints_never_published"], [])
            spells[bag] = [stop for stop in summary["stop_segments"] if stop["reason"] == "COLLISION"]
            if bag == "both_arms_wave":
                self.assertEqual(summary["collision_fraction"], 0.0)
        self.assertEqual(spells["both_arms_wave"], [])
        first, second = spells["hands_dip_into_table"]
        self.assertLess(first["to_s"] + 1.0, second["from_s"])


class OnSimulations(EvaluateTest):
    URDF = os.path.join(HERE, "..", "..", "simulation", "robot", "dual_arm.urdf")

    def setUp(self):
        super().setUp()
        if not os.environ.get("TCCM_SIMULATE"):
            self.skipTest("TCCM_SIMULATE names no simulator")

    def simulated(self, *arguments, config=None):
        """@param config a shipped one; none: defaults.
        @return the summary, the rows of the verdicts and what really happened."""
        bag, truth = self.path("simulated.bag"), self.path("truth.json")
        done = subprocess.run([os.environ["TCCM_SIMULATE"], "--bag", bag, "--truth", truth, *arguments],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        empty = self.text("defaults.yaml", "topics: {scan: /scan}\n")
        config = os.path.join(CONFIGS, config) if config else empty
        summary = self.evaluate(bag, config=config, urdf=self.URDF)
        with open(truth) as f:
            return summary, self.rows("verdicts"), json.load(f)

    def test_an_obstacle_that_appears_stops_the_arm_once_a_beam_has_met_it(self):
        summary, rows, truth = self.simulated("--duration-s", "12", "--obstacle", "pole", "--appear-s", "7")
        self.assertEqual(summary["stop_segments"][0]["reason"], "INIT")
        stop = summary["stop_segments"][1]
        first_beam = truth["first_beam_s"] - START
        self.assertGreater(stop["from_s"], first_beam)
        self.assertLess(stop["from_s"], first_beam + 0.5)
        self.assertIn("COLLISION", stop["reason"])
        self.assertGreater(summary["points"]["self"], 0)
        self.assertMapCanBeRecomputed()

    def test_an_arm_that_works_in_view_is_seen_for_the_most_part(self):
        summary, rows, _ = self.simulated("--duration-s", "12", config="simulation.yaml")
        self.assertSightAddsUp(summary)
        sight = summary["sight"]
        self.assertLess(sight["unseen_fraction"]["mean"], 0.2)
        self.assertLess(sight["unseen_fraction"]["above_max"], 0.3)
        self.assertEqual(set(sight["stop_by_reason"]), {"INIT"})
        links = {row["link"] for row in self.rows("visibility") if row["way_unseen"]}
        self.assertEqual(links, {side + link for side in ("left_", "right_") for link in
                                 ("palm_link", "inner_finger_link", "outer_finger_link")})

    def test_scans_that_stop_coming_end_in_a_stop_that_says_so(self):
        _, rows, _ = self.simulated("--duration-s", "6", "--scans-stop-at", "5")
        self.assertEqual((rows[-1]["stop"], rows[-1]["reason"]), ("1", "NO_MAP"))


if __name__ == "__main__":
    for variable in ("TCCM_EVALUATE", "TCCM_SIMULATE", "TCCM_SHARED_DATA"):
        if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
            os.environ[variable] = sys.argv.pop(1)
    unittest.main()
