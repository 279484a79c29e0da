#!/usr/bin/python3
"""The program `setup` on recordings of the simulated robot, sound ones and such with a fault.

Environment: TCCM_SETUP, TCCM_SIMULATE, TCCM_EVALUATE: the programs. TCCM_SHARED_DATA: folder of others'
recordings; what needs it is skipped without.
"""

import itertools
import json
import os
import pathlib
import subprocess
import tempfile
import unittest
import unittest.mock

import numpy
import rosbag
import rospy
import yaml

import standing_robot

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
URDF = REPOSITORY / "simulation" / "robot" / "dual_arm.urdf"
SHARED = pathlib.Path(os.environ.get("TCCM_SHARED_DATA") or "none")


ARM = """<robot name="arm"><link name="plate"><collision><origin xyz="0 0 0.1"/><geometry>
<cylinder radius="0.1" length="0.2"/></geometry></collision></link>""" + "".join(f"""
<link name="link_{i}"><collision><origin xyz="0 0 0.1"/><geometry><box size="0.06 0.06 0.2"/></geometry>
</collision></link><joint name="joint_{i}" type="revolute"><axis xyz="0 {i % 2} {1 - i % 2}"/>
<parent link="{f'link_{i - 1}' if i else 'plate'}"/><child link="link_{i}"/><origin xyz="0 0 0.2"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>""" for i in range(5)) + "</robot>"


class SetupTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.sound = cls.record("sound.bag", "--sensors", "laser")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def record(cls, name, *arguments, seconds=9):
        bag = cls.folder / name
        subprocess.run([os.environ["TCCM_SIMULATE"], "--bag", bag, "--duration-s", str(seconds), "--speed", "0.1",
                        "--seed", "3", *arguments], check=True, capture_output=True, timeout=300)
        return bag

    def changed(self, name, change):
        """@param change (topic, message): gives the messages to put in place of one."""
        bag = self.folder / name
        with rosbag.Bag(str(self.sound)) as source, rosbag.Bag(str(bag), "w") as target:
            for topic, message, stamp in source.read_messages():
                for other_topic, other in change(topic, message):
                    target.write(other_topic, other, stamp)
        return bag

    def set_up(self, bag, *arguments, status=0, urdf=URDF, out="robot.yaml"):
        """@return the lines that say what is wrong."""
        command = [os.environ["TCCM_SETUP"], "--out", self.folder / out, *arguments]
        command += ["--bag", bag] if bag else []
        command += ["--urdf", urdf] if urdf else []
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False,
                              env={**os.environ, "ROS_MASTER_URI": "http://localhost:1"})
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        self.error, self.output = done.stderr, done.stdout
        return [line[len("wrong: "):] for line in done.stdout.splitlines()
                if line.startswith("wrong: ")]

    def config(self, out="robot.yaml"):
        return yaml.safe_load((self.folder / out).read_text())

    def evaluate(self, bag, out="robot.yaml", urdf=URDF, packages=None):
        folder = self.folder / "evaluated"
        command = [os.environ["TCCM_EVALUATE"], "--bag", bag, "--config", self.folder / out, "--out", folder]
        command += ["--urdf", urdf] if urdf else []
        command += ["--package-path", packages] if packages else []
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((folder / "summary.json").read_text())

    def test_a_sound_robot_gets_a_config_with_which_it_may_move(self):
        self.assertEqual(self.set_up(self.sound), [])
        config = self.config()
        self.assertEqual(config["topics"]["scan"], "/scan")
        self.assertEqual(config["collision_checker"]["fixed_frame"], "base_link")
        mapper = config["tccm_mapper"]
        self.assertTrue(0.01 < mapper["height_min_m"] <= 0.1, "the floor lies at 0")
        self.assertLess(mapper["area_origin_x_m"], -0.5)
        self.assertGreater(mapper["area_origin_x_m"] + mapper["area_size_x_m"], 0.8)
        self.assertIn("right_palm_link", config["collision_checker"]["evidence_links"])
        self.assert_remarks()
        comments = [line for line in (self.folder / "robot.yaml").read_text().splitlines() if "#" in line]
        self.assertTrue(any("floor" in line for line in comments))
        summary = self.evaluate(self.sound)
        self.assertGreater(summary["scans"], 300)
        self.assertLess(summary["stop_fraction"], 0.5)
        self.assertEqual(set(summary["sight"]["stop_by_reason"]), {"INIT"})

    def assert_remarks(self, out="robot.yaml"):
        """Each value says where it comes from."""
        for line in (self.folder / out).read_text().splitlines():
            if line and not line.startswith("#") and not line.endswith(":"):
                self.assertIn("  # ", line)

    def moved(self, link, offset):
        """@return the robot with a link's shape elsewhere, by so much [m] along its y axis."""
        text = URDF.read_text()
        begin = text.index(f'<link name="{link}">')
        end = text.index("</link>", begin)
        part = text[begin:end].replace('<collision><origin xyz="0 0 ', f'<collision><origin xyz="0 {offset} ')
        self.assertNotEqual(part, text[begin:end])
        urdf = self.folder / "moved.urdf"
        urdf.write_text(text[:begin] + part + text[end:])
        return urdf

    def test_a_model_that_is_off_is_told_with_a_picture(self):
        self.assertNotIn("self_filter_exceptions", (self.set_up(self.sound), self.config())[1]["tilt_scan_assembler"])
        self.assertIn("% on the robot", (self.folder / "robot.yaml").read_text())
        off = self.set_up(self.sound, urdf=self.moved("right_elbow_link", -0.04), status=1)
        self.assertIn("the model is off by up to ", off[0])
        self.assertIn("right_elbow_link (", off[0])
        self.assertGreater((self.folder / "robot.model.png").stat().st_size, 20000)

    def test_padding_grows_a_little_where_the_robot_lies_outside_of_its_model(self):
        self.assertEqual(self.set_up(self.sound, urdf=self.moved("right_elbow_link", 0.03)), [])
        exceptions = self.config()["tilt_scan_assembler"]["self_filter_exceptions"]
        self.assertIn("right_elbow_link", [entry["links"][0] for entry in exceptions])
        self.assertTrue(all(0.03 <= entry["padding_m"] <= 0.035 for entry in exceptions))

    def test_patience_shortens_no_limit(self):
        def late(topic, message):
            if topic == "/joint_states":
                message.header.stamp -= rospy.Duration(0, 350000000)
            return [(topic, message)]
        self.set_up(self.sound, "--patient")
        checker = self.config()["collision_checker"]
        self.assertEqual((checker["joint_timeout_s"], checker["scan_timeout_periods"]), (0.3, 10))
        self.assertEqual((checker["publish_rate_hz"], checker["check_time_max_periods"]), (10, 2))
        self.set_up(self.changed("late.bag", late), "--patient", status=1)  # tf has the tilt elsewhere
        self.assertGreater(self.config()["collision_checker"]["joint_timeout_s"], 0.4)

    def test_two_runs_write_the_same(self):
        for out in ("one.yaml", "two.yaml"):
            self.set_up(self.sound, out=out)
        self.assertEqual((self.folder / "one.yaml").read_bytes(), (self.folder / "two.yaml").read_bytes())

    def test_each_of_several_sensors_gets_a_section(self):
        bag = self.record("both.bag", "--sensors", "laser", "--sensors", "camera", seconds=6)
        self.assertEqual(self.set_up(bag), [])
        config = self.config()
        self.assertEqual(config["collision_checker"]["sensors"], [{"name": "camera"}, {"name": "scan"}])
        self.assertEqual(config["camera"]["topic"], "/camera/depth/color/points")
        self.assertIn("cloud_assembler", config["camera"])
        self.assertIn("tilt_scan_assembler", config["scan"])
        self.assertGreater(self.evaluate(bag)["scans"], 200)

    def test_a_check_writes_nothing(self):
        self.assertEqual(self.set_up(self.sound, "--check", out="none.yaml"), [])
        self.assertFalse((self.folder / "none.yaml").exists())

    def test_of_too_short_a_recording_it_does_not_say_that_nothing_is_wrong(self):
        lines = self.set_up(self.record("short.bag", seconds=2), "--check", status=1)
        self.assertIn("listen for longer", lines[0])

    def assert_found(self, bag, *words, **how):
        lines = self.set_up(bag, "--check", status=1, **how)
        self.assertEqual(len(lines), 1, lines)
        for word in words:
            self.assertIn(word, lines[0])

    def test_positions_in_degrees_are_named(self):
        def degrees(topic, message):
            if topic == "/joint_states":
                message.position = [57.3 * position + 90.0 for position in message.position]
            return [(topic, message)]
        self.assert_found(self.changed("degrees.bag", degrees), "JOINT_OUT_OF_RANGE", "degrees?")

    def test_a_joint_that_nobody_publishes_is_named(self):
        def without(topic, message):
            if topic == "/joint_states":
                kept = [i for i, name in enumerate(message.name) if name != "right_elbow_joint"]
                for field in ("name", "position", "velocity"):
                    values = getattr(message, field)
                    setattr(message, field, [values[i] for i in kept] if values else [])
            return [(topic, message)]
        self.assert_found(self.changed("missing.bag", without), "right_elbow_joint", "fixed_joints")

    def test_a_second_publisher_of_zeros_is_named(self):
        def twice(topic, message):
            if topic != "/joint_states":
                return [(topic, message)]
            zeros = type(message)(header=message.header, name=list(message.name),
                                  position=[0.0] * len(message.name))
            return [(topic, zeros), (topic, message)]
        self.assert_found(self.changed("twice.bag", twice), "JOINT_CONTRADICTED", "one node")

    def test_an_encoders_ticks_are_named_once(self):
        def ticks(topic, message):
            if topic == "/joint_states" and 4.0 < (message.header.stamp.to_sec() - 1000.0) % 8.0 < 4.2:
                message.velocity = [1e5] * len(message.name)
            return [(topic, message)]
        self.assert_found(self.changed("ticks.bag", ticks), "JOINT_OUT_OF_RANGE", "ticks?")

    @staticmethod
    def still(topic, message):
        if topic == "/tf":
            for transform in message.transforms:
                if "tilt" in transform.child_frame_id:
                    transform.transform.rotation.x = transform.transform.rotation.y = 0.0
                    transform.transform.rotation.z, transform.transform.rotation.w = 0.0, 1.0
        return [(topic, message)]

    def test_a_laser_that_does_not_tilt_is_named(self):
        self.assert_found(self.changed("still.bag", self.still), "tilts")

    def test_two_lasers_on_one_topic_are_named(self):
        frames = itertools.cycle(("laser_link", "other_laser"))

        def two(topic, message):
            if topic == "/scan":
                message.header.frame_id = next(frames)
            return self.still(topic, message)
        self.assert_found(self.changed("two.bag", two), "/scan", "'laser_link'", "'other_laser'")

    def test_scans_of_another_frame_are_named(self):
        def other(topic, message):
            if topic == "/scan":
                message.header.frame_id = "nowhere"
            return [(topic, message)]
        self.assert_found(self.changed("frame.bag", other), "tilts")

    def test_a_robot_and_a_config_alone_are_checked(self):
        surplus = self.folder / "surplus.urdf"
        sound = URDF.read_text()
        place = sound.index("</geometry>", sound.index("<collision>"))
        surplus.write_text(sound[:place] + "</geometry><geometry><sphere radius='1'/>" + sound[place:])
        self.assert_found(None, "more than one <geometry>", urdf=surplus)
        twice = self.folder / "twice.yaml"
        twice.write_text("tccm_mapper:\n  cell_size_m: 0.02\n  cell_size_m: 0.01\n")
        lines = self.set_up(None, "--check", "--config", twice, status=1)
        self.assertIn("line 3", lines[0])

    def test_bad_input_is_one_line(self):
        for bag, urdf in ((self.folder / "none.bag", URDF), (None, None)):
            self.set_up(bag, status=2, urdf=urdf)
            self.assertEqual(len(self.error.splitlines()), 1, self.error)

    def assert_reaches_ok(self, urdf, floor_m=0.0, packages=None):
        bag = self.folder / "standing.bag"
        standing_robot.write(bag, urdf.read_text(), floor_m)
        more = ["--package-path", packages] if packages else []
        self.assertEqual(self.set_up(bag, *more, urdf=urdf), [])
        self.assert_remarks()
        self.assertLess(abs(self.config()["camera"]["tccm_mapper"]["height_min_m"] - floor_m - 0.03), 0.02)
        summary = self.evaluate(bag, urdf=urdf, packages=packages)
        self.assertEqual(set(summary["sight"]["stop_by_reason"]), {"INIT"})
        self.assertLess(summary["stop_fraction"], 0.2)

    def test_an_arm_before_a_camera_reaches_its_first_ok(self):
        urdf = self.folder / "arm.urdf"
        urdf.write_text(ARM)
        self.assert_reaches_ok(urdf)

    def test_a_camera_that_looks_away_is_told(self):
        urdf, bag = self.folder / "arm.urdf", self.folder / "aside.bag"
        urdf.write_text(ARM)
        with unittest.mock.patch.object(standing_robot, "TARGET", numpy.array([4.0, 0.0, 0.0])):
            standing_robot.write(bag, ARM)
        lines = self.set_up(bag, urdf=urdf, status=1)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn("/camera/depth/points: nothing that it saw lies in the area", lines[0])
        self.assertFalse(self.config()["collision_checker"]["check_occlusion"])
        self.assertIn("note: no sensor sees [", self.output)

    def test_robots_of_others_before_a_camera_reach_their_first_ok(self):
        robots = SHARED / "robots"
        if not robots.is_dir():
            self.skipTest("TCCM_SHARED_DATA names no folder with robots")
        for urdf, floor_m in (("nextage/NextageOpen", -0.97), ("ur5/ur5_robot", 0.0),
                              ("baxter/baxter", -0.92), ("panda_moveit/panda", 0.0),
                              ("panda_primitives/panda_collision", 0.0)):
            with self.subTest(urdf):
                path = robots / f"{urdf}.urdf"
                packages = path.parent / "packages"
                self.assert_reaches_ok(path, floor_m, packages if packages.is_dir() else None)

    def test_recordings_of_others_get_a_config_that_maps_and_checks(self):
        if not SHARED.is_dir():
            self.skipTest("TCCM_SHARED_DATA names no folder of recordings")
        robots = SHARED / "robots"
        for bag, robot in (("pr2_at_table/both_arms_wave", robots / "pr2_moveit" / "pr2.urdf"),
                           ("hrl_tabletop/tabletop_4_half_sweeps", None)):
            with self.subTest(bag):
                path = SHARED / "bags" / f"{bag}.bag"
                packages = robot.parent / "packages" if robot else None
                more = ["--package-path", packages] if packages else []
                self.assertEqual(self.set_up(path, *more, urdf=robot), [])
                summary = self.evaluate(path, urdf=robot, packages=packages)
                self.assertEqual(summary["scans"], 652)
                self.assertGreater(summary["checks"] if robot else 1, 0)

    def test_what_is_wrong_with_others_cases_is_named_in_one_line(self):
        cases = SHARED / "cases"
        if not cases.is_dir():
            self.skipTest("TCCM_SHARED_DATA names no folder with cases")
        for folder, bag, robot, word in (
                ("mesh-in-mm", "control_rad.bag", "mm.urdf", "millimetres"),
                ("units", "units/deg.bag", "arm.urdf", "degrees"),
                ("scan-angles-contradict", "scan-angles-contradict/contra_rad.bag", "arm.urdf", "angle_max"),
                ("two-lasers-one-topic", "two-lasers-one-topic/two_rad.bag", "arm.urdf", "base_laser"),
                ("latch-lost-by-time-step", "latch-lost-by-time-step/latch_step.bag", "arm.urdf",
                 "jumped back"),
                ("urdf-surplus-geometry", None, "two_geometries.urdf", "<geometry>")):
            with self.subTest(folder):
                config = next((cases / folder).glob("cfg*.yaml"), None)
                more = ["--config", config] if config else []
                packages = cases / folder / "packages"
                more += ["--package-path", packages] if packages.is_dir() else []
                lines = self.set_up(cases / bag if bag else None, "--check", *more, status=1,
                                    urdf=cases / folder / robot)
                self.assertEqual(len(lines), 1, lines)
                self.assertIn(word, lines[0])
        units = cases / "units"
        self.assertEqual(self.set_up(cases / "control_rad.bag", "--check", "--config", units / "cfg.yaml",
                                     urdf=units / "arm.urdf"), [])


if __name__ == "__main__":
    unittest.main()
