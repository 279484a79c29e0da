#!/usr/bin/python3
"""Recordings in which tf and the URDF put the laser or a link elsewhere, and names of tf with a prefix.

Environment: as evaluate_test.py.
"""
import copy
import math
import os
import random
import unittest

from geometry_msgs.msg import Quaternion

from evaluate_run import CONFIGS, EvaluateTest
from made_bag import CONFIG, LASER, URDF, Stream, transform
from tf2_msgs.msg import TFMessage

MEMBERS = 20
MOUNT = """
  <link name="mount"/><link name="laser"/>
  <joint name="mounted" type="fixed">
    <parent link="base_link"/><child link="mount"/><origin xyz="{} {} {}"/></joint>
  <joint name="screwed" type="fixed"><parent link="mount"/><child link="laser"/></joint>
</robot>
"""


def urdf_with_laser_at(place):
    return URDF.replace("</robot>", MOUNT.format(*place))


class ModelTest(EvaluateTest):
    def setUp(self):
        super().setUp()
        self.runs = 0

    def run_with(self, change=None, config=CONFIG, urdf=urdf_with_laser_at(LASER)):
        """@param change of a message with transforms. @return the summary, and the reasons given."""
        stream = Stream()
        hand = []
        for topic, message, seconds in stream.messages:
            if topic == "/joint_states" and "slide" in message.name:
                hand.append(("/tf", TFMessage([
                    transform(seconds, "base_link", "carriage", (stream.slide(seconds), 0.013, 0.0)),
                    transform(seconds, "carriage", "hand", (0.0, 0.0, 1.0))]), seconds))
        stream.messages = copy.deepcopy(sorted(stream.messages + hand, key=lambda m: m[2]))
        for topic, message, _ in stream.messages:
            if change and topic != "/joint_states":
                change(message)
        self.runs += 1
        out = f"out{self.runs}"
        stream.write(self.path("in.bag"))
        summary = self.evaluate(self.path("in.bag"), out=out, config=self.text("config.yaml", config),
                                urdf=self.text("robot.urdf", urdf))
        return summary, {row["reason"] for row in self.rows("verdicts", out)}

    def assertDisagrees(self, run, link, distance_m):
        summary, reasons = run
        self.assertIn("MODEL_DISAGREES", reasons)
        agreement = summary["agreement"]
        self.assertIn(f"'{link}'", agreement["first_disagreement"])
        worst = max(entry["worst_m"] for entry in agreement["disagree"])
        self.assertAlmostEqual(worst, distance_m, delta=0.002)

    def assertAgrees(self, run):
        summary, reasons = run
        self.assertNotIn("MODEL_DISAGREES", reasons)
        self.assertIn("CLEAR", reasons)
        self.assertEqual(summary["agreement"]["compared"], 2)
        self.assertEqual(summary["agreement"]["not_compared"], [])
        self.assertEqual(summary["agreement"]["disagree"], [])

    def test_a_laser_that_is_mounted_elsewhere_is_a_fault(self):
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            off = rng.choice((-1, 1)) * 10 ** rng.uniform(math.log10(0.035), 1.0)
            axis = rng.randrange(3)
            place = [value + off * (i == axis) for i, value in enumerate(LASER)]
            with self.subTest(seed=seed, off=off):
                self.assertDisagrees(self.run_with(urdf=urdf_with_laser_at(place)), "laser", abs(off))

    def test_a_hand_that_tf_has_elsewhere_is_a_fault(self):
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            off = rng.choice((-1, 1)) * rng.uniform(0.04, 1.0)

            def lie(message):
                for one in getattr(message, "transforms", []):
                    if one.child_frame_id == "hand":
                        one.transform.translation.z += off
            with self.subTest(seed=seed, off=off):
                self.assertDisagrees(self.run_with(lie), "hand", abs(off))

    def test_what_is_rounded_jitters_or_is_calibrated_is_none(self):
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            digits, jitter = rng.choice((2, 3, 6)), rng.uniform(0.0, 0.004)

            def sloppy(message):
                for one in getattr(message, "transforms", []):
                    place = one.transform.translation
                    for axis in "xyz":
                        setattr(place, axis, round(getattr(place, axis), digits))
                    if one.child_frame_id != "/laser":
                        one.header.stamp.nsecs += int(1e9 * jitter * rng.random())
            place = [value + rng.uniform(-0.01, 0.01) for value in LASER]
            with self.subTest(seed=seed):
                self.assertAgrees(self.run_with(sloppy, urdf=urdf_with_laser_at(place)))

    def test_a_trusted_frame_may_be_elsewhere(self):
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            place = [rng.uniform(-1.0, 1.0) for _ in range(3)]
            config = CONFIG + "monitored_robot: {trusted_frames: [mount]}\n"
            with self.subTest(seed=seed):
                self.assertAgrees(self.run_with(config=config, urdf=urdf_with_laser_at(place)))

    def test_what_is_not_compared_is_told(self):
        summary, reasons = self.run_with(urdf=URDF)
        self.assertEqual(summary["agreement"]["not_compared"], ["laser: the URDF does not know it"])
        self.assertNotIn("MODEL_DISAGREES", reasons)

    def test_names_with_a_prefix_change_nothing(self):
        def prefixed(prefix):
            def change(message):
                for one in getattr(message, "transforms", []):
                    one.header.frame_id = prefix + one.header.frame_id.lstrip("/")
                    one.child_frame_id = prefix + one.child_frame_id.lstrip("/")
                if hasattr(message, "ranges"):
                    message.header.frame_id = prefix + message.header.frame_id.lstrip("/")
            return change
        without, reasons = self.run_with()
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            prefix = "/".join("".join(rng.choice("abc_1") for _ in range(rng.randint(1, 8)))
                              for _ in range(rng.randint(1, 3)))
            config = CONFIG.replace("base_link", prefix + "/base_link") + \
                f"monitored_robot: {{tf_prefix: {rng.choice(('', '/')) + prefix}}}\n"
            with self.subTest(prefix=prefix):
                again, with_prefix = self.run_with(prefixed(prefix + "/"), config)
                self.assertAgrees((again, with_prefix))
                self.assertEqual(with_prefix, reasons)
                self.assertEqual(again["stop_fraction"], without["stop_fraction"])
                self.assertEqual(again["agreement"]["compared"], without["agreement"]["compared"])

    def test_a_laser_that_is_turned_is_a_fault(self):
        for seed in range(MEMBERS):
            rng = random.Random(seed)
            angle = rng.choice((-1, 1)) * rng.uniform(0.05, 3.0)

            def turn(message):
                for one in getattr(message, "transforms", []):
                    if one.child_frame_id == "/mount":
                        one.transform.rotation = Quaternion(0.0, math.sin(angle / 2), 0.0,
                                                            math.cos(angle / 2))
            with self.subTest(seed=seed):
                self.assertDisagrees(self.run_with(turn), "laser", 2.0 * math.sin(abs(angle) / 2))


class OnRecordings(EvaluateTest):
    """A Guardian whose base and laser tf has elsewhere than the URDF does; tf is right."""

    def reasons(self, config, out):
        data = os.environ.get("TCCM_SHARED_DATA", "")
        bag = os.path.join(data, "bags", "guardian_tilting_hokuyo", "climbing_palette_facing_door.bag")
        if not os.path.exists(bag):
            self.skipTest("TCCM_SHARED_DATA names no folder of recordings")
        urdf = os.path.join(data, "robots", "guardian_v7_tilt", "guardian_tracks.urdf")
        summary = self.evaluate(bag, out=out, config=self.text("guardian.yaml", config), urdf=urdf)
        return summary["agreement"], {row["reason"] for row in self.rows("verdicts", out)}

    def test_the_shipped_configuration_trusts_tf_and_finds_no_contact(self):
        with open(os.path.join(CONFIGS, "guardian.yaml"), encoding="utf-8") as file:
            shipped = file.read()
        agreement, reasons = self.reasons(shipped, "shipped")
        self.assertEqual(agreement["disagree"], [])
        self.assertFalse({"MODEL_DISAGREES", "COLLISION"} & reasons)
        trusting = "  trusted_frames: [base_link, hokuyo_frontal_laser_link]\n"
        self.assertIn(trusting, shipped)
        agreement, reasons = self.reasons(shipped.replace(trusting, ""), "doubting")
        self.assertIn("MODEL_DISAGREES", reasons)
        self.assertIn("0.111 m off", agreement["first_disagreement"])


if __name__ == "__main__":
    unittest.main()
