#!/usr/bin/python3
"""The program `evaluate` on clouds of cameras and lidars: from bags, and from folders of PCD files."""
import math
import os
import random
import struct
import unittest

import genpy
import yaml
from sensor_msgs.msg import PointCloud2, PointField

from evaluate_run import EvaluateTest
from made_bag import CONFIG, START, URDF, Stream

WIDTH, HEIGHT = 64, 48
NAN = float("nan")
# A camera's axes, x right, y down, z ahead, in a frame with x ahead and z up.
LOOKS_AHEAD = ["0", "0", "1.0", str(-math.pi / 2), "0", str(-math.pi / 2)]

CAMERA = """
collision_checker: {sensors: [{name: camera}]}
camera:
  topic: /camera/points
  cloud_assembler: {range_max_m: 4.0}
  tccm_mapper: {area_origin_y_m: -2.0, area_size_x_m: 4.0, area_size_y_m: 4.0, height_min_m: 0.1,
                window_s: 0.3, look_pass_gap_s: 0.001, window_returns_max: 3000000}
"""


def wall(distance, rng, sigma=0.005):
    """What a camera sees of a wall across its view; here and there nothing."""
    points = []
    for row in range(HEIGHT):
        for column in range(WIDTH):
            if rng.random() < 0.05:
                points.append((NAN, NAN, NAN))
                continue
            z = distance + rng.gauss(0.0, sigma)
            points.append(((column - WIDTH / 2) / WIDTH * z, (row - HEIGHT / 2) / WIDTH * z, z))
    return points


def pcd_of(points, width=WIDTH, height=HEIGHT, viewpoint="0 0 0 1 0 0 0", binary=False):
    header = f"""# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS x y z
SIZE 4 4 4
TYPE F F F
COUNT 1 1 1
WIDTH {width}
HEIGHT {height}
VIEWPOINT {viewpoint}
POINTS {width * height}
DATA {"binary" if binary else "ascii"}
"""
    if binary:
        return header.encode() + b"".join(struct.pack("<3f", *p) for p in points)
    return (header + "".join("%.9g %.9g %.9g\n" % p for p in points)).encode()


def message_of(points, stamp, frame="laser"):
    """In a frame with x ahead and z up."""
    message = PointCloud2(height=HEIGHT, width=WIDTH, point_step=12, row_step=12 * WIDTH)
    message.header.stamp = genpy.Time.from_sec(stamp)
    message.header.frame_id = frame
    message.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate("xyz")]
    message.data = b"".join(struct.pack("<3f", z, -x, -y) for x, y, z in points)
    return message


class PcdFolders(EvaluateTest):
    def folder_of(self, clouds, **how):
        folder = self.path("clouds")
        os.makedirs(folder)
        for i, points in enumerate(clouds):
            with open(os.path.join(folder, f"frame{i:03}.pcd"), "wb") as f:
                f.write(pcd_of(points, **how))
        return folder

    def play(self, folder, *arguments, out="out", config=CAMERA, status=0):
        return self.evaluate(None, out=out, config=self.text("camera.yaml", config), status=status,
                             recording=["--clouds", folder, *arguments])

    def test_a_wall_is_where_it_was_seen_and_the_map_can_be_recomputed(self):
        rng = random.Random(1)
        for binary in (False, True):
            with self.subTest(binary=binary):
                self.setUp()
                folder = self.folder_of([wall(2.0, rng) for _ in range(12)], binary=binary)
                for out in ("one", "other"):
                    summary = self.play(folder, "--sensor-pose", *LOOKS_AHEAD, out=out)
                self.assertEqual(summary["scans"], 12)
                self.assertTrue(summary["sensors"]["camera"]["map"]["complete"])
                self.assertSameFiles("one", "other", "camera")
                self.assertMapCanBeRecomputed("one", "camera")
                cuboids = self.rows("cuboids.camera", "one")
                self.assertGreater(len(cuboids), 50)
                for cuboid in cuboids:
                    self.assertAlmostEqual(float(cuboid["x"]), 2.0, delta=0.05)
                    self.assertLess(abs(float(cuboid["y"])), 1.1)

    def test_the_viewpoint_counts_where_no_pose_is_given(self):
        folder = self.folder_of([wall(2.0, random.Random(2))] * 3,
                                viewpoint="0.5 0 1 0.5 -0.5 0.5 -0.5")
        self.play(folder)
        for cuboid in self.rows("cuboids.camera"):
            self.assertAlmostEqual(float(cuboid["x"]), 2.5, delta=0.05)
        self.assertGreater(len(self.rows("cuboids.camera")), 50)

    def test_clouds_beside_the_area_are_told_of(self):
        folder = self.folder_of([wall(2.0, random.Random(3))] * 3)
        self.play(folder, "--sensor-pose", "100", *LOOKS_AHEAD[1:])
        self.assertIn("warning  no point of camera lies in the map's area", self.done.stdout)

    def test_what_is_no_folder_of_clouds_is_refused_in_one_line(self):
        config = self.text("camera.yaml", CAMERA)
        empty = self.path("empty")
        os.makedirs(empty)
        good = pcd_of(wall(2.0, random.Random(4)))
        bad = {"cut": good[:len(good) // 2], "words": b"hello", "nothing": b"",
               "no_place": pcd_of(wall(2.0, random.Random(4)), viewpoint="nan 0 0 1 0 0 0"),
               "too_many": good.replace(b"POINTS 3072", b"POINTS 3071"),
               "slip": good.replace(b"VERSION", b"VERS2ON"),
               "endless": good.replace(b"WIDTH 64", b"WIDTH 99999999999999999999")}
        cases = [(empty, "has no PCD file"), (self.path("nowhere"), "no such folder")]
        for name, content in bad.items():
            os.makedirs(self.path(name))
            with open(os.path.join(self.path(name), "a.pcd"), "wb") as f:
                f.write(content)
            cases.append((self.path(name), "a.pcd"))
        for folder, expected in cases:
            with self.subTest(folder=folder):
                done = self.call("--clouds", folder, "--out", self.path("out"), "--config", config)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn(expected, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_arguments_that_do_not_go_together_are_refused(self):
        folder = self.folder_of([wall(2.0, random.Random(5))])
        camera, laser = self.text("camera.yaml", CAMERA), self.text("laser.yaml", CONFIG)
        urdf = self.text("robot.urdf", URDF)
        for arguments, expected in (
                (["--clouds", folder, "--config", laser], "one sensor"),
                (["--clouds", folder, "--config", camera, "--urdf", urdf], "--urdf"),
                (["--config", camera], "required"),
                (["--clouds", folder, "--bag", "x.bag", "--config", camera], "required"),
                (["--clouds", folder, "--config", camera, "--sensor-pose", "1", "2"], "sensor-pose")):
            with self.subTest(arguments=arguments[2:]):
                done = self.call("--out", self.path("out"), *arguments)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn(expected, done.stderr)


class Bags(EvaluateTest):
    """A laser over the robot and a camera that stands where the laser does."""

    def config_of(self, required=True, **camera):
        config = yaml.safe_load(CONFIG)
        del config["topics"]
        config["laser"] = {"topic": "/tilt_scan"}
        for section in ("tilt_scan_assembler", "tccm_mapper"):
            config["laser"][section] = config.pop(section)
        config["camera"] = {
            "topic": "/camera/points",
            "cloud_assembler": {"fixed_frame": config["laser"]["tilt_scan_assembler"]["fixed_frame"]},
            "tccm_mapper": {**config["laser"]["tccm_mapper"], "window_s": 0.3, "look_pass_gap_s": 0.001}}
        config["camera"]["tccm_mapper"].pop("window_scans", None)
        config["camera"].update(camera)
        config["collision_checker"]["sensors"] = [
            {"name": "laser"}, {"name": "camera", "required": required}]
        return yaml.safe_dump(config)

    def bag_with(self, clouds, seconds=2.0):
        """@param clouds what comes at a time, by index; none: nothing."""
        stream = Stream(seconds)
        for i in range(int(seconds * 10)):
            message = clouds(i, START + i / 10.0)
            if message:
                stream.messages.append(("/camera/points", message, i / 10.0))
        stream.messages.sort(key=lambda entry: entry[2])
        bag = self.path("in.bag")
        stream.write(bag)
        return bag

    def play(self, bag, out="out", status=0, **config):
        return self.evaluate(bag, out=out, status=status, urdf=self.text("robot.urdf", URDF),
                             config=self.text("config.yaml", self.config_of(**config)))

    def test_laser_and_camera_are_mapped_and_recomputed_by_name(self):
        rng = random.Random(6)
        bag = self.bag_with(lambda i, stamp: message_of(wall(0.8, rng), stamp))
        for out in ("one", "other"):
            summary = self.play(bag, out=out)
        self.assertEqual(list(summary["sensors"]), ["laser", "camera"])
        for sensor in ("laser", "camera"):
            self.assertGreater(summary["sensors"][sensor]["scans"], 15)
            self.assertSameFiles("one", "other", sensor)
            self.assertMapCanBeRecomputed("one", sensor)

    def test_clouds_that_cannot_be_read_are_told_by_field(self):
        def broken(_, stamp):
            message = message_of(wall(0.8, random.Random(7)), stamp)
            message.fields[2].name = "depth"
            return message

        bag = self.bag_with(broken)
        summary = self.play(bag)
        dropped = summary["sensors"]["camera"]["scans_dropped"]
        self.assertEqual(dropped, {"malformed": 20})
        reasons = {row["reason"] for row in self.rows("verdicts")}
        self.assertIn("NO_MAP", reasons)

    def test_a_config_with_a_slip_is_refused(self):
        bag = self.bag_with(lambda i, stamp: message_of(wall(0.8, random.Random(8)), stamp))
        both = yaml.safe_load(self.config_of())
        both["camera"]["tilt_scan_assembler"] = {}
        unnamed = {"cloud_assembler": {"range_max_m": 2.0}}
        no_window = yaml.safe_load(self.config_of())
        del no_window["camera"]["tccm_mapper"]["window_s"]
        wrong_type = yaml.safe_load(self.config_of())
        wrong_type["camera"]["topic"] = "/tilt_scan"
        for config, expected in ((both, "camera: it has tilt_scan_assembler and cloud_assembler"),
                                 (unnamed, "cloud_assembler: it is no sensor's"),
                                 (no_window, "camera/tccm_mapper/window_s"),
                                 (wrong_type, "carries sensor_msgs/LaserScan, not sensor_msgs/PointCloud2")):
            with self.subTest(expected=expected):
                done = self.call("--bag", bag, "--out", self.path("out"), "--config",
                                 self.text("slip.yaml", yaml.safe_dump(config)))
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn(expected, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


class OnRealClouds(EvaluateTest):
    FOLDERS = {"kinect_tabletop": 4, "kinect_office": 2, "pr2_stereo": 1}

    def setUp(self):
        super().setUp()
        self.data = os.path.join(os.environ.get("TCCM_SHARED_DATA", ""), "clouds")
        if not os.path.isdir(self.data):
            self.skipTest("TCCM_SHARED_DATA names no folder of clouds")

    def test_real_clouds_are_mapped_twice_the_same_and_their_maps_can_be_recomputed(self):
        config = self.text("camera.yaml", CAMERA)
        for folder, files in self.FOLDERS.items():
            with self.subTest(folder=folder):
                for run in ("_one", "_other"):
                    summary = self.evaluate(
                        None, out=folder + run, config=config,
                        recording=["--clouds", os.path.join(self.data, folder), "--sensor-pose",
                                   *LOOKS_AHEAD])
                self.assertEqual(summary["scans"], files)
                self.assertGreater(summary["points"]["mapped"], 10000)
                self.assertSameFiles(folder + "_one", folder + "_other", "camera")
                self.assertMapCanBeRecomputed(folder + "_one", "camera")


if __name__ == "__main__":
    unittest.main()
