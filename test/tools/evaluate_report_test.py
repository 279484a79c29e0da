#!/usr/bin/python3
"""What `evaluate --report` writes for people, without a browser.

Environment: TCCM_EVALUATE and TCCM_SIMULATE the programs; TCCM_SHARED_DATA a folder of recordings
(optional).
"""
import csv
import html.parser
import json
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

from evaluate_run import CONFIGS, HERE, EvaluateTest
from made_bag import CONFIG, URDF, Stream

DUAL_ARM = os.path.join(HERE, "..", "..", "simulation", "robot", "dual_arm.urdf")
DIFFERS = {"timing.json", "latency.png"}  # computing times
HOSTILE = "<script>alert(1)</script>"
PAGE_MAX = 10_000_000  # bytes


class Page(html.parser.HTMLParser):
    """Elements, what they refer to, and the text of each section."""

    def __init__(self, path):
        super().__init__()
        self.elements, self.sources, self.text, self.silent = [], [], "", 0
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self.silent += tag in ("script", "style")
        self.sources += [value for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag):
        self.silent -= tag in ("script", "style")

    def handle_data(self, data):
        if not self.silent:
            self.text += data + "\n"

    def ids(self, tag):
        return [attributes.get("id") for of_tag, attributes in self.elements if of_tag == tag]


class ReportTest(EvaluateTest):
    def arguments(self, bag, out, urdf, config):
        packages = os.path.join(os.path.dirname(urdf), "packages")
        return ["--bag", str(bag), "--urdf", str(urdf), "--config", str(config), "--out",
                self.path(out), "--report",
                *(["--package-path", packages] if os.path.isdir(packages) else [])]

    def report(self, bag, urdf, config, out="out"):
        done = self.call(*self.arguments(bag, out, urdf, config))
        self.assertEqual(done.returncode, 0, done.stderr)
        return pathlib.Path(self.path(out))

    def simulated(self, *arguments):
        if not os.environ.get("TCCM_SIMULATE"):
            self.skipTest("TCCM_SIMULATE names no simulator")
        bag = self.path("simulated.bag")
        subprocess.run([os.environ["TCCM_SIMULATE"], "--bag", bag, *arguments], check=True,
                       capture_output=True, timeout=300)
        return bag

    def slid(self, urdf=URDF):
        """A hand that slides through what its laser sees."""
        bag = self.path("slides.bag")
        Stream().write(bag)
        return bag, self.text("robot.urdf", urdf), self.text("config.yaml", CONFIG)

    def assertWhole(self, folder):
        """@return the page; each stop has its row, its picture and what helps."""
        page = Page(folder / "report.html")
        scenes = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))
        self.assertLess((folder / "report.html").stat().st_size, PAGE_MAX)
        self.assertEqual(sorted(path.name for path in folder.glob("*.part")), [])
        figures = page.ids("figure")
        for number, stop in enumerate(scenes["stops"], 1):
            self.assertIn(f"stop-{number}", page.ids("h3"))
            self.assertIn(f"stop_{number:02}", figures)
            self.assertTrue((folder / f"stop_{number:02}.png").exists())
            self.assertGreater(len(stop["what_helps"]), 3)
            for text in (stop["reason"], stop["link"], stop["detail"],
                         stop["what_helps"].replace(" (how)", "")):
                self.assertIn(text, page.text)
        for name in ("timeline", "map_from_above", "map_in_3d", "latency"):
            self.assertIn(name, figures)
            self.assertEqual((folder / f"{name}.png").read_bytes()[:4], b"\x89PNG")
        images = [attributes for tag, attributes in page.elements if tag == "img"]
        self.assertTrue(all(image.get("alt") for image in images))
        return page

    def assertOffline(self, page):
        """All that is not in the page lies beside it."""
        for source in page.sources:
            self.assertRegex(source, r"^(data:image/png;base64,|#stop-|[a-z0-9_]+\.png$)")


class MadeReports(ReportTest):
    def test_a_touch_is_told_in_picture_and_text(self):
        folder = self.report(*self.slid())
        page = self.assertWhole(folder)
        self.assertOffline(page)
        scenes = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))
        stop = next(stop for stop in scenes["stops"] if stop["reason"] == "COLLISION")
        scene = next(scene for scene in stop["scenes"] if scene["reason"] == "COLLISION")
        self.assertEqual(scene["concerned"], ["hand"])
        box = scene["flagged"][0]["box"]
        self.assertEqual(scene["flagged"][0]["why"], "touched")
        self.assertTrue(all(box[k] <= scene["point"][k] <= box[k + 3] for k in range(3)))
        self.assertTrue(0.8 - 1e-9 <= box[0] and box[3] <= 0.82 + 1e-9, "the cell that the laser sees")
        self.assertEqual([sensor["saw"] for sensor in scene["sensors"]], [True])
        self.assertEqual(scene["sensors"][0]["position"], [0.5, 0.013, 1.0])
        hand = scene["robot"][0]
        self.assertEqual((hand["link"], hand["kind"], hand["size"]), ("hand", "sphere", [0.06]))

    def test_the_timeline_has_a_row_for_each_check(self):
        folder = self.report(*self.slid())
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        with open(folder / "timeline.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), summary["checks"])
        stops = [row for row in rows if row["level"] in ("STOP", "FAULT")]
        self.assertAlmostEqual(len(stops) / len(rows), summary["stop_fraction"], places=5)
        touching = [row for row in rows if row["reason"] == "COLLISION"]
        self.assertTrue(touching)
        self.assertEqual({row["link"] for row in touching}, {"hand"})
        # Without its padding of 10 mm the hand is at most so far away when it touches.
        self.assertTrue(all(0.0 <= float(row["clearance_m"]) <= 0.0101 for row in touching))
        self.assertEqual(rows[0]["map_age_s"], "", "no scan came yet")
        self.assertTrue(all(0.0 <= float(row["map_age_s"]) <= 0.06 for row in rows[20:]))

    def test_what_names_say_is_no_part_of_the_page(self):
        hostile = HOSTILE.replace("<", "&lt;").replace(">", "&gt;")
        urdf = URDF.replace('"hand"', f'"{hostile}"').replace('"sliding"', f'"{hostile}$x$"')
        folder = self.report(*self.slid(urdf))
        page = self.assertWhole(folder)
        raw = (folder / "report.html").read_text(encoding="utf-8")
        self.assertNotIn(HOSTILE, raw)
        self.assertIn(f"{HOSTILE} touches the map", page.text)
        self.assertEqual(len([tag for tag, _ in page.elements if tag == "script"]), 3)

    def test_without_a_robot_there_is_the_map(self):
        bag, _urdf, config = self.slid()
        done = self.call("--bag", bag, "--config", config, "--out", self.path("out"), "--report")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("There was no robot to check", self.assertWhole(pathlib.Path(self.path("out"))).text)

    def test_pictures_of_an_earlier_run_are_gone(self):
        folder = pathlib.Path(self.path("out"))
        folder.mkdir()
        for name in ("stop_49.png", "mine.png"):
            (folder / name).write_bytes(b"")
        self.report(*self.slid())
        self.assertFalse((folder / "stop_49.png").exists())
        self.assertTrue((folder / "mine.png").exists())

    def test_without_times_all_is_the_same_in_each_run(self):
        bag, urdf, config = self.slid()
        one = self.report(bag, urdf, config)
        arguments = self.arguments(bag, "other", urdf, config)
        pathlib.Path(self.path("other")).mkdir()
        for name in ("timing.json", "latency.png"):
            (pathlib.Path(self.path("other")) / name).write_text("{}", encoding="utf-8")
        done = self.call(*arguments, "--no-times")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("time     ", done.stdout)
        other = pathlib.Path(self.path("other"))
        self.assertEqual({path.name for path in one.iterdir()} - {path.name for path in other.iterdir()}, DIFFERS)
        self.assertNotIn("latency", Page(other / "report.html").ids("figure"))
        self.assertNotIn("How long checks took", Page(other / "report.html").text)
        for path in set(other.iterdir()) - {other / "report.html"}:
            self.assertEqual(path.read_bytes(), (one / path.name).read_bytes(), path.name)

    def test_without_report_nothing_of_it_is_written(self):
        bag, urdf, config = self.slid()
        done = self.call("--bag", bag, "--urdf", urdf, "--config", config, "--out", self.path("out"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(os.listdir(self.path("out"))), ["summary.json", "timing.json"])


class SimulatedReports(ReportTest):
    def test_two_runs_are_the_same_but_for_computing_times(self):
        bag = self.simulated("--obstacle", "box", "--appear-s", "4", "--duration-s", "10")
        config = os.path.join(CONFIGS, "simulation.yaml")
        one, other = (self.report(bag, DUAL_ARM, config, out) for out in ("one", "other"))
        self.assertWhole(one)
        names = sorted(path.name for path in one.iterdir())
        self.assertEqual(names, sorted(path.name for path in other.iterdir()))
        self.assertIn("stop_01.png", names)
        for name in set(names) - DIFFERS:
            self.assertTrue((one / name).read_bytes() == (other / name).read_bytes(), name)

    def test_ctrl_c_leaves_what_was_played(self):
        bag = self.simulated("--obstacle", "box", "--appear-s", "4", "--duration-s", "120")
        config = os.path.join(CONFIGS, "simulation.yaml")
        arguments = self.arguments(bag, "out", DUAL_ARM, config)
        folder = pathlib.Path(self.path("out"))
        with subprocess.Popen([os.environ["TCCM_EVALUATE"], *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, start_new_session=True) as run:
            timeline = folder / "timeline.csv"
            while run.poll() is None and not (timeline.exists() and timeline.stat().st_size > 50000):
                time.sleep(0.005)
            run.send_signal(signal.SIGINT)
            _out, error = run.communicate(timeout=300)
        self.assertEqual(run.returncode, 130, error)
        self.assertIn("evaluate: interrupted", error)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        self.assertIs(summary["interrupted"], True)
        self.assertLess(summary["duration_s"], 119.0)
        self.assertIn("Interrupted", self.assertWhole(folder).text)

    def test_ctrl_c_while_it_is_drawn_leaves_whole_pictures(self):
        bag = self.simulated("--obstacle", "box", "--appear-s", "4", "--duration-s", "10")
        config = os.path.join(CONFIGS, "simulation.yaml")
        arguments = self.arguments(bag, "out", DUAL_ARM, config)
        folder = pathlib.Path(self.path("out"))
        with subprocess.Popen([os.environ["TCCM_EVALUATE"], *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, start_new_session=True) as run:
            for line in run.stdout:
                if line.rstrip().endswith("stop_01.png"):
                    break
            os.killpg(run.pid, signal.SIGINT)
            _out, error = run.communicate(timeout=300)
        self.assertEqual(run.returncode, 130, error)
        self.assertIn("interrupted; the pictures that are done stay", error)
        names = sorted(os.listdir(folder))
        self.assertIn("stop_01.png", names)
        self.assertNotIn("report.html", names)
        self.assertEqual([name for name in names if name.startswith(".")], [])
        for path in folder.glob("*.png"):
            self.assertEqual(path.read_bytes()[-8:-4], b"IEND", path)


class Recordings(ReportTest):
    def test_each_stop_of_the_pr2_at_its_table_is_explained(self):
        data = os.environ.get("TCCM_SHARED_DATA", "")
        if not os.path.isdir(os.path.join(data, "bags", "pr2_at_table")):
            self.skipTest("TCCM_SHARED_DATA names no folder with bags/pr2_at_table")
        for bag, reasons in (("hands_dip_into_table", ["COLLISION", "RELEASING"]),
                             ("both_arms_wave", ["INIT"])):
            with self.subTest(bag):
                folder = self.report(os.path.join(data, "bags/pr2_at_table", bag + ".bag"),
                                     os.path.join(data, "robots/pr2_moveit/pr2.urdf"),
                                     os.path.join(CONFIGS, "pr2.yaml"), bag)
                self.assertOffline(self.assertWhole(folder))
                scenes = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))
                self.assertEqual([stop["reason"] for stop in scenes["stops"]], reasons)
        dips = json.loads((pathlib.Path(self.path("hands_dip_into_table")) / "scenes.json").read_text(
            encoding="utf-8"))["stops"]
        touching = {scene["link"] for scene in dips[0]["scenes"] if scene["reason"] == "COLLISION"}
        self.assertLessEqual({"r_upper_arm_link", "r_elbow_flex_link"}, touching, "of both dips")
        self.assertEqual(dips[1]["scenes"][0]["cause"]["reason"], "COLLISION")


class Words(unittest.TestCase):
    def test_each_reason_of_the_page_of_failures_has_words(self):
        repository = pathlib.Path(HERE).parents[1]
        page = (repository / "docs/failures.md").read_text(encoding="utf-8")
        reasons = set(re.findall(r"^\| `([A-Z_]+)` \| (?:OK|SLOW|STOP|FAULT) ", page, re.MULTILINE))
        words = (repository / "scripts/evaluation_report/record.py").read_text(encoding="utf-8")
        for reason in reasons - {"BAD_QUESTION"}:  # of answers alone
            self.assertIn(f'"{reason}": "', words)


if __name__ == "__main__":
    unittest.main()
