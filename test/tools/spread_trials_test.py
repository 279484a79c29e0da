#!/usr/bin/python3
"""The program `trials` with its cases on a Dask cluster, or in parts. Environment: TCCM_TRIALS the program."""

import os
import pathlib
import signal
import subprocess
import tempfile
import unittest

from dask_cluster import ClusterTest, files_in, is_gone, pids_in, wait_until

EXPERIMENTS = (
    ("stopping", "--trials", "5"), ("hands", "--trials", "1", "--hand-speeds", "0.5,1.6", "--speeds", "0.25"),
    ("hover", "--trials", "3", "--ghosts", "1"), ("occlusion", "--trials", "5"), ("visibility", "--poses", "3"),
    ("governed", "--minutes", "0.3", "--tilt-step-deg", "30"),
    ("false-stops", "--motions", "2", "--noises-m", "0.01,0.03", "--duration-s", "5", "--speeds", "0.1"),
    ("dynamic", "--trials", "3", "--settle-s", "3", "--judge-s", "1"), ("small-objects", "--step-m", "0.3", "--phases", "1"))


class SpreadTrialsTest(ClusterTest):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def call(self, *arguments, out="out"):
        """Pictures are left out: they take longer than these few trials."""
        return subprocess.run([os.environ["TCCM_TRIALS"], *arguments, "--no-pictures", "--out", self.folder / out],
                              capture_output=True, text=True, timeout=600, check=False)

    def results(self, out):
        """All but how long it took."""
        return {name: content for name, content in files_in(self.folder / out).items() if name != "timing.json"}

    def assert_same(self, arguments, *how):
        """@return what was printed where the cases were spread."""
        name = f"{arguments[0]}_{len(how)}"
        here = self.call(*arguments, "--seed", "3", out=name + "_here")
        there = self.call(*arguments, "--seed=3", "--jobs", "2", *how, out=name + "_there")
        self.assertIn(here.returncode, (0, 1), here.stderr)
        self.assertEqual(there.returncode, here.returncode, there.stderr)
        self.assertEqual(self.results(name + "_here"), self.results(name + "_there"))
        lines = [line for line in here.stdout.splitlines() if not line.startswith(("took ", "processing "))]
        self.assertEqual([line for line in there.stdout.splitlines() if not line.startswith("processing ")], lines)
        return there

    def test_every_experiment_finds_the_same_on_a_cluster(self):
        self.start_scheduler(self.folder)
        for name in ("one", "other"):
            self.start_worker(name)
        for arguments in EXPERIMENTS:
            with self.subTest(arguments[0]):
                self.assert_same(arguments, "--scheduler", self.address)

    def test_a_worker_that_dies_changes_nothing(self):
        here = self.call("occlusion", "--trials", "6", out="here")
        self.start_scheduler(self.folder)
        pids = self.folder / "pids"
        dying = self.start_worker("dying", TCCM_TRIALS=self.script(self.folder / "blocks", f"echo $$ >>{pids}",
                                                                   "exec sleep 600"))
        with subprocess.Popen([os.environ["TCCM_TRIALS"], "occlusion", "--trials", "6", "--no-pictures", "--out",
                               self.folder / "there", "--scheduler", self.address], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as run:
            wait_until(lambda: pids_in(pids), "a part runs")
            self.start_worker("other")
            dying.send_signal(signal.SIGKILL)
            wait_until(lambda: is_gone(pids_in(pids)[0]), "what the worker started is gone with it")
            _output, error = run.communicate(timeout=300)
        self.assertEqual(run.returncode, here.returncode, error)
        self.assertIn("the worker that had it is gone", error)
        self.assertEqual(self.results("here"), self.results("there"))

    def test_what_cannot_be_spread_is_refused_in_one_line(self):
        self.start_scheduler(self.folder)
        self.start_worker("one")
        for arguments in (("updates",), ("stopping", "--ros"), ("stopping", "--speeds", "0")):
            with self.subTest(arguments):
                done = self.call(*arguments, "--scheduler", self.address)
                self.assertEqual(done.returncode, 2, done.stderr)
                lines = [line for line in done.stderr.splitlines()
                         if not line.startswith("running ") and "has no worker yet" not in line]
                self.assertEqual(len(lines), 1, lines)
                self.assertTrue(lines[0].startswith("trials: "), lines)

    def test_parts_are_joined_by_the_same_run_alone(self):
        for number in range(2):
            self.assertEqual(self.call("occlusion", "--trials", "3", "--part", f"{number}/2", out="parts").returncode, 0)
        parts = self.folder / "parts"
        self.assertEqual(sorted(files_in(parts)), ["part_0", "part_1"])
        self.assertEqual(self.call("occlusion", "--trials", "3", "--join", parts).returncode, 0)
        for arguments in (("--trials", "4"), ("--trials", "3", "--seed", "2")):
            self.assert_refused("occlusion", *arguments, "--join", parts)
        self.assert_refused("visibility", "--poses", "3", "--join", parts)
        for damage in (lambda bytes_: bytes_[:-1], lambda bytes_: bytes_ + b"x", lambda bytes_: b"\xff" * 60):
            whole = (parts / "part_1").read_bytes()
            (parts / "part_1").write_bytes(damage(whole))
            self.assert_refused("occlusion", "--trials", "3", "--join", parts)
            (parts / "part_1").write_bytes(whole)
        whole = (parts / "part_1").read_bytes()
        (parts / "part_1").write_bytes(bytes([whole[0] ^ 1]) + whole[1:])
        self.assert_refused("occlusion", "--trials", "3", "--join", parts, says="another build")
        (parts / "part_1").unlink()
        self.assert_refused("occlusion", "--trials", "3", "--join", parts)
        for part in ("2/2", "x", "0/0", "0/2x", "-1/2"):
            self.assert_refused("occlusion", "--trials", "3", "--part", part)

    def assert_refused(self, *arguments, says="trials: "):
        done = self.call(*arguments, out="none")
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), (arguments, done.stderr))
        self.assertIn(says, done.stderr)
        self.assertFalse((self.folder / "none" / "results.csv").exists(), arguments)


if __name__ == "__main__":
    unittest.main()
