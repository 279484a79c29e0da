#!/usr/bin/python3
"""Many recordings at once, by `evaluate_all`: on this computer, and on a Dask scheduler whose workers die.

Environment: TCCM_EVALUATE and TCCM_SIMULATE the programs; TCCM_SHARED_DATA a folder of recordings (optional).
"""

import csv
import html
import html.parser
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse

import yaml

from dask_cluster import ClusterTest, files_in, has_session, is_gone, pids_in, wait_until
from evaluate_run import CONFIGS
from made_bag import CONFIG, URDF, Stream

sys.dont_write_bytecode = True
REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "scripts"))
from evaluations import baseline  # noqa: E402
from spreading import engine  # noqa: E402

SCRIPT = REPOSITORY / "scripts" / "evaluate_all"
DUAL_ARM = REPOSITORY / "simulation/robot/dual_arm.urdf"
HOSTILE = "<img src=x onerror='alert(1)'> & \"more\" %41 #1"
REPORT = {"console.txt", "report.html", "scenes.json", "summary.json", "timeline.csv", "timeline.png",
          "map_from_above.png", "map_in_3d.png"}


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.elements = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def links(self):
        return [attributes["href"] for tag, attributes in self.elements if tag == "a"]


class EvaluateAllTest(ClusterTest):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        for name, content in (("robot.urdf", URDF), ("config.yaml", CONFIG)):
            (self.folder / name).write_text(content, encoding="utf-8")

    def command(self, recordings, out, *arguments):
        return [sys.executable, str(SCRIPT), str(recordings), "--out", str(self.folder / out), *arguments]

    def call(self, recordings, *arguments, out="out", status=0, **environment):
        """@return the folder that it filled."""
        done = subprocess.run(self.command(recordings, out, *arguments), capture_output=True, text=True, timeout=600,
                              check=False, env=dict(os.environ, **environment), cwd=self.folder)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        self.output, self.error = done.stdout, done.stderr
        return self.folder / out

    def slides(self, name, duration_s=4.0):
        """A bag of a hand that slides through what its laser sees."""
        Stream(duration_s).write(self.folder / name)
        return {"bag": name, "urdf": "robot.urdf", "config": "config.yaml"}

    def listed(self, *entries):
        path = self.folder / "list.yaml"
        path.write_text(yaml.safe_dump(list(entries)), encoding="utf-8")
        return path

    def rows(self, out):
        with open(out / "results.csv", encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    def assert_opens_offline(self, out):
        """All that it refers to lies beside it."""
        page = Page(out / "index.html")
        self.assertEqual([tag for tag, _ in page.elements if tag in ("script", "img", "link", "iframe")], [])
        for link in page.links():
            self.assertTrue((out / urllib.parse.unquote(link)).is_file(), link)
        return page


class OnThisComputer(EvaluateAllTest):
    def test_all_are_in_one_table_and_a_damaged_one_is_a_row(self):
        simulated = self.folder / "simulated.bag"
        subprocess.run([os.environ["TCCM_SIMULATE"], "--bag", simulated, "--obstacle", "box", "--appear-s", "4",
                        "--duration-s", "8"], check=True, capture_output=True, timeout=300)
        slides = dict(self.slides("slides.bag"), name=HOSTILE)
        whole = (self.folder / "slides.bag").read_bytes()
        (self.folder / "cut.bag").write_bytes(whole[:len(whole) // 2])
        recordings = self.listed(slides, {"bag": "simulated.bag", "urdf": str(DUAL_ARM),
                                          "config": os.path.join(CONFIGS, "simulation.yaml")},
                                 {"bag": "cut.bag"}, {"bag": "nowhere.bag"})
        for name in ("summary.json", "report.html", "stop_49.png", "mine.txt"):
            (self.folder / "out" / "cut").mkdir(parents=True, exist_ok=True)
            (self.folder / "out" / "cut" / name).write_text("{}", encoding="utf-8")
        out = self.call(recordings, "--jobs", "2", status=1)
        self.assertEqual(sorted(os.listdir(out / "cut")), ["console.txt", "mine.txt"], "of an earlier run all is gone")
        rows = self.rows(out)
        self.assertEqual([row["name"] for row in rows], [HOSTILE, "cut", "nowhere", "simulated"])
        self.assertEqual([row["exit_status"] for row in rows], ["0", "2", "2", "0"])
        self.assertEqual(rows[0]["gravest_reason"], "COLLISION")
        for row in (rows[0], rows[3]):
            summary = json.loads((out / row["name"] / "summary.json").read_text(encoding="utf-8"))
            for key in ("scans", "checks", "stops"):
                self.assertEqual(int(row[key]), summary[key])
            self.assertEqual(float(row["stop_fraction"]), summary["stop_fraction"])
            files = {path.name for path in (out / row["name"]).iterdir()}
            self.assertEqual({name for name in files if not re.fullmatch(r"stop_\d\d[a-e]?\.png", name)}, REPORT)
            self.assertNotIn("computer", (out / row["name"] / "report.html").read_text(encoding="utf-8").split(
                "<script")[0], "computing times are of one computer")
        results = json.loads((out / "results.json").read_text(encoding="utf-8"))["recordings"]
        self.assertIn("bag", results[1]["message"])
        self.assertIn("cannot be read where it was to be used", results[2]["message"])
        page = self.assert_opens_offline(out)
        self.assertEqual(sorted(urllib.parse.unquote(link) for link in set(page.links())),
                         sorted(f"{name}/report.html" for name in (HOSTILE, "simulated")))
        raw = (out / "index.html").read_text(encoding="utf-8")
        self.assertNotIn("<img", raw)
        self.assertIn(HOSTILE, html.unescape(raw))
        self.assertEqual(self.error.count("done "), 4)

    def test_a_folder_stands_for_its_bags_with_the_nearest_file_above_each(self):
        for folder in ("all/arm/deep", "all/alone"):
            (self.folder / folder).mkdir(parents=True)
        self.slides("all/arm/deep/slides.bag", 1.0)
        shutil.copy(self.folder / "all/arm/deep/slides.bag", self.folder / "all/alone/slides.bag")
        (self.folder / "all/arm/evaluate.yaml").write_text("{urdf: ../../robot.urdf, config: ../../config.yaml}\n",
                                                           encoding="utf-8")
        (self.folder / "all/evaluate.yaml").write_text("config: ../config.yaml\n", encoding="utf-8")
        rows = self.rows(self.call(self.folder / "all"))
        self.assertEqual([row["name"] for row in rows], ["alone_slides", "arm_deep_slides"])
        self.assertEqual([int(row["checks"]) > 0 for row in rows], [False, True])

    def test_a_wrong_list_is_told_in_one_line(self):
        path, before = self.folder / "list.yaml", sorted(os.listdir(self.folder)) + ["list.yaml"]
        for text, *words in (
                ("[{bag: a.bag, urdff: r.urdf}]", "entry 1", "urdff"),
                ("[{bag: a.bag}, {name: b, urdf: r.urdf}]", "entry 2 (b)", "bag"),
                ("[{bag: a.bag, clouds: folder}]", "entry 1", "bag"), ("[{bag: 5}]", "entry 1", "bag"),
                ("[{bag: a.bag}, {bag: b/a.bag}]", "entry 2", "name"), ("[{bag: a.bag, name: a/b}]", "entry 1", "name"),
                ("[{bag: a.bag, name: ..}]", "entry 1", "name"), ("[{bag: a.bag, name: index.html}]", "entry 1", "name"),
                ('[{bag: a.bag, name: "a\\nb"}]', "entry 1", "name"), ("[{bag: a.bag, name: 7}]", "entry 1", "name"),
                ("[{clouds: a, sensor_pose: [1, 2]}]", "entry 1", "sensor_pose"),
                ("[{clouds: a, cloud_rate: fast}]", "entry 1", "cloud_rate"), ("[a.bag]", "entry 1"),
                ("{bag: a.bag}", "list"), ("[]", "list"), ("", "list"), ("[{bag: a.bag", "line 1"),
                ("- bag: a.bag\n  urdf: a\n  urdf: b\n", "line 3", "urdf"), ("[{[a]: b}]", "list.yaml"),
                ("a: &a [*a]", "list.yaml"), ("\x00", "list.yaml")):
            with self.subTest(text):
                path.write_text(text, encoding="utf-8")
                self.call(path, status=2)
                self.assertEqual(len(self.error.splitlines()), 1, self.error)
                for word in ("evaluate_all: ", "list.yaml", *words):
                    self.assertIn(word, self.error)
        for recordings, *arguments in (("none.yaml",), (self.folder,), ("list.yaml", "--jobs", "0"),
                                       ("list.yaml", "--baseline", "nowhere")):
            with self.subTest(arguments):
                path.write_text("[{bag: a.bag}]", encoding="utf-8")
                self.call(recordings, *arguments, status=2)
                self.assertEqual(len(self.error.splitlines()), 1, self.error)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(before), "nothing is written")

    def test_a_verdict_that_changed_since_the_baseline_is_told(self):
        recordings = self.listed(dict(self.slides("slides.bag"), name="one"), dict(self.slides("slides.bag"), name="two"))
        before = self.call(recordings, out="before")
        self.call(recordings, "--baseline", str(before), out="same")
        self.assertEqual({change["status"] for change in self.changes("same")}, {"same"})
        config = CONFIG.replace("collision_padding_m: 0.01", "collision_padding_m: 0.05")
        (self.folder / "config.yaml").write_text(config, encoding="utf-8")
        recordings = self.listed(dict(self.slides("slides.bag"), name="one"), dict(self.slides("slides.bag"), name="new"))
        out = self.call(recordings, "--baseline", str(before), out="after", status=1)
        new, one, two = self.changes("after")
        self.assertEqual([(change["name"], change["status"]) for change in (new, one, two)],
                         [("new", "only now"), ("one", "changed"), ("two", "only before")])
        moved = next(stop for stop in one["stops"] if stop["what"] == "moved")
        self.assertEqual((moved["now"]["reason"], moved["now"]["link"]), ("COLLISION", "hand"))
        self.assertLess(moved["begin_s"], -0.1, "it is touched earlier")
        self.assertGreater(one["checks"]["differ"], 0)
        self.assertIn("one: changed: ", self.output)
        page = html.unescape((out / "index.html").read_text(encoding="utf-8"))
        self.assertIn("since the baseline", page)
        self.assertIn("Only in the baseline: two.", page)

    def changes(self, out):
        return json.loads((self.folder / out / "changes.json").read_text(encoding="utf-8"))["recordings"]

    def test_ctrl_c_leaves_what_was_done_and_nothing_that_runs(self):
        pids = self.folder / "pids"
        evaluate = self.script(self.folder / "evaluate", f'case "$*" in *blocks*) echo $$ >>{pids}; sleep 600 & '
                               f'echo $! >>{pids}; wait;; esac', f'exec {os.environ["TCCM_EVALUATE"]} "$@"')
        recordings = self.listed(self.slides("done.bag", 1.0), dict(self.slides("blocks.bag", 1.0)))
        for arguments in ([], ["--scheduler"]):
            with self.subTest(arguments):
                pids.unlink(missing_ok=True)
                if arguments:
                    self.start_scheduler(self.folder)
                    for name in ("one", "other"):
                        self.start_worker(name, TCCM_EVALUATE=evaluate)
                    arguments = ["--scheduler", self.address]
                out = self.folder / f"out_{len(arguments)}"
                with subprocess.Popen(self.command(recordings, out.name, "--jobs", "2", *arguments),
                                      stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                                      env=dict(os.environ, TCCM_EVALUATE=evaluate)) as run:
                    for line in run.stderr:
                        if line.startswith("done "):
                            break
                    wait_until(lambda: len(pids_in(pids)) == 2, "the other runs")
                    begin = time.monotonic()
                    os.killpg(run.pid, signal.SIGINT)
                    _output, error = run.communicate(timeout=60)
                self.assertLess(time.monotonic() - begin, engine.END_S - 5, "it waits for no worker that is gone")
                self.assertEqual(run.returncode, 130, error)
                self.assertIn("evaluate_all: interrupted", error)
                self.assertNotIn("Traceback", error)
                self.assertEqual([row["name"] for row in self.rows(out)], ["done"])
                self.assertIn("Interrupted", (out / "index.html").read_text(encoding="utf-8"))
                self.assertFalse((out / "blocks").exists())
                wait_until(lambda: all(is_gone(pid) for pid in pids_in(pids)), "what it started is gone")
                wait_until(lambda: not has_session(run.pid), "nothing of it is left")


class Baselines(unittest.TestCase):
    """Without programs: what counts as a change."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.stops = [dict(stop=1, from_s=1.0, to_s=2.0, reason="INIT", link="", detail=""),
                      dict(stop=1, from_s=2.0, to_s=3.0, reason="COLLISION", link="hand", detail=""),
                      dict(stop=2, from_s=5.0, to_s=6.0, reason="NO_MAP", link="", detail="")]
        self.checks = ["1.0,STOP,INIT,", "2.0,STOP,COLLISION,hand"]
        self.lay("before", self.stops, self.checks)

    def lay(self, out, stops, checks):
        folder = self.folder / out / "run"
        folder.mkdir(parents=True, exist_ok=True)
        (folder.parent / "results.json").write_text('{"recordings": [{"name": "run", "exit_status": 0}]}', encoding="utf-8")
        (folder / "summary.json").write_text(json.dumps({"stop_segments": stops}), encoding="utf-8")
        (folder / "timeline.csv").write_text("\n".join(["stamp,level,reason,link", *checks, ""]), encoding="utf-8")

    def change(self, stops=None, checks=None, status=0):
        """@return status, and what is told of stops."""
        self.lay("now", self.stops if stops is None else stops, self.checks if checks is None else checks)
        earlier = baseline.Baseline(self.folder / "before", self.folder / "now")
        change, = earlier.changes(self.folder / "now", [{"name": "run", "exit_status": status}])
        self.text = baseline.text_of(change)
        return change["status"], [stop["what"] for stop in change["stops"]]

    def test_the_same_is_no_change(self):
        self.assertEqual(self.change(), ("same", []))

    def test_a_check_or_an_exit_status_alone_is_a_change(self):
        for checks in (["1.0,STOP,INIT,", "2.0,STOP,COLLISION,arm"], ["1.0,SLOW,INIT,", "2.0,STOP,COLLISION,hand"],
                       self.checks[:1], self.checks + ["3.0,OK,CLEAR,"]):
            self.assertEqual(self.change(checks=checks), ("changed", []), checks)
            self.assertIn("1 of", self.text)
        self.assertEqual(self.change(status=1), ("changed", []))
        self.assertIn("exit status 1, was 0", self.text)

    def test_stops_that_overlap_most_belong_together(self):
        def with_stops(*changes):
            return [dict(stop, **change) for stop, change in zip(self.stops, changes) if change is not None]
        self.assertEqual(self.change(self.stops[:2]), ("changed", ["gone"]))
        self.assertEqual(self.change(self.stops[2:]), ("changed", ["gone"]))
        early = dict(self.stops[2], stop=3, from_s=0.0, to_s=0.5)
        self.assertEqual(self.change([early] + self.stops), ("changed", ["come"]))
        self.assertEqual(self.change(with_stops({}, {"link": "arm"}, {})), ("changed", ["other link"]))
        self.assertIn("was COLLISION of hand", self.text)
        self.assertEqual(self.change(with_stops({}, {}, {"to_s": 6.5, "reason": "INIT"})),
                         ("changed", ["moved and other reason"]))
        self.assertIn("ends +0.500 s", self.text)
        self.assertEqual(self.change(with_stops({}, {}, {"from_s": 2.9, "to_s": 6.0})), ("changed", ["moved"]))
        self.assertIn("begins -2.100 s", self.text)


class OnACluster(EvaluateAllTest):
    def test_without_a_scheduler_or_dask_there_is_one_line(self):
        recordings = self.listed(self.slides("slides.bag", 1.0))
        for address in ("tcp://127.0.0.1:1", "nonsense", "http://127.0.0.1:1"):
            with self.subTest(address):
                self.call(recordings, "--scheduler", address, status=2)
                self.assertEqual(len(self.error.splitlines()), 1, self.error)
                self.assertIn(f"no Dask scheduler answers at {address}", self.error)
        (self.folder / "distributed.py").write_text("raise ImportError('none')", encoding="utf-8")
        self.call(recordings, status=2, PYTHONPATH=f"{self.folder}:{os.environ.get('PYTHONPATH', '')}")
        self.assertEqual(self.error, "evaluate_all: needs the Debian package python3-distributed (none)\n")

    def test_a_worker_that_dies_changes_nothing(self):
        recordings = self.listed(*(dict(self.slides(f"{name}.bag", 1.0 + k), name=name)
                                   for k, name in enumerate(("one", "two", "three"))), {"bag": "nowhere.bag"})
        here = self.call(recordings, "--jobs", "1", out="here", status=1)
        self.start_scheduler(self.folder)
        pids = self.folder / "pids"
        blocks = self.script(self.folder / "blocks", f"echo $$ >>{pids}", f"sleep 600 & echo $! >>{pids}", "wait")
        dying = self.start_worker("dying", TCCM_EVALUATE=blocks)
        with subprocess.Popen(self.command(recordings, "there", "--scheduler", self.address), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as run:
            wait_until(lambda: len(pids_in(pids)) == 2, "it runs")
            self.start_worker("other")
            dying.send_signal(signal.SIGKILL)
            wait_until(lambda: all(is_gone(pid) for pid in pids_in(pids)), "what the worker started is gone with it")
            _output, error = run.communicate(timeout=300)
        self.assertEqual(run.returncode, 1, error)
        self.assertIn("the worker that had it is gone", error)
        self.assertEqual(files_in(here), files_in(self.folder / "there"))
        self.assertGreater(len(files_in(here)), 3 * len(REPORT))

    def test_a_worker_without_the_program_or_a_recording_fails_that_recording(self):
        recordings = self.listed(self.slides("slides.bag", 1.0))
        self.start_scheduler(self.folder)
        self.start_worker("bare", TCCM_EVALUATE="", CMAKE_PREFIX_PATH="")
        out = self.call(recordings, "--scheduler", self.address, status=1)
        self.assertEqual([row["exit_status"] for row in self.rows(out)], ["2"])
        self.assertIn("the program evaluate is not there", self.error)


class Recordings(EvaluateAllTest):
    """Others' recordings. Those of arm motions alone have no scans: they are rows that say so."""

    def test_all_of_others_recordings_are_the_same_on_a_cluster_of_which_a_worker_is_killed(self):
        data = pathlib.Path(os.environ.get("TCCM_SHARED_DATA") or "none").resolve()
        if not (data / "bags").is_dir():
            self.skipTest("TCCM_SHARED_DATA names no folder with bags")
        recordings = self.listed(*self.entries(data))
        here = self.call(recordings, out="here", status=1)
        self.start_scheduler(self.folder)
        workers = [self.start_worker(name) for name in ("one", "other")]
        with subprocess.Popen(self.command(recordings, "there", "--scheduler", self.address), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as run:
            for line in run.stderr:
                if line.startswith("done ") and "scans mapped" in line:
                    break
            wait_until(lambda: self.children(workers[0]), "it works on the next")
            workers[0].send_signal(signal.SIGKILL)
            _output, error = run.communicate(timeout=600)
        self.assertEqual(run.returncode, 1, error)
        self.assertIn("the worker that had it is gone", error)
        self.assertEqual(files_in(here), files_in(self.folder / "there"))
        rows = {row["name"]: row for row in self.rows(here)}
        self.assertEqual(len(rows), len(list(data.glob("bags/*/*.bag"))))
        self.assertEqual(rows["pr2_at_table_hands_dip_into_table"]["gravest_reason"], "COLLISION")
        self.assertEqual({name for name, row in rows.items() if row["exit_status"] != "0"},
                         {name for name in rows if name.startswith("pr2_arm_motion_")})

    @staticmethod
    def children(process):
        tasks = pathlib.Path(f"/proc/{process.pid}/task").glob("*/children")
        return [pid for task in tasks for pid in task.read_text(encoding="utf-8").split()]

    @staticmethod
    def entries(data):
        robots = {"pr2_at_table": ("pr2_moveit/pr2.urdf", "pr2.yaml"), "pr2_arm_motion": ("pr2_moveit/pr2.urdf", "pr2.yaml"),
                  "guardian_tilting_hokuyo": ("guardian_v7_tilt/guardian_tracks.urdf", "guardian.yaml"),
                  "hrl_tabletop": (None, "hrl_tabletop.yaml")}
        for bag in sorted(data.glob("bags/*/*.bag")):
            robot, config = robots[bag.parent.name]
            entry = {"name": f"{bag.parent.name}_{bag.stem}", "bag": str(bag),
                     "config": os.path.abspath(os.path.join(CONFIGS, config))}
            if robot:
                urdf = data / "robots" / robot
                entry.update(urdf=str(urdf), package_path=str(urdf.parent / "packages"))
            yield entry


if __name__ == "__main__":
    unittest.main()
