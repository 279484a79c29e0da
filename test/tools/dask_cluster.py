"""A Dask scheduler and workers, as processes of their own, for the tests of what is spread over them."""

import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

PATIENCE_S = 60.0


def wait_until(is_so, what):
    end = time.monotonic() + PATIENCE_S
    while not is_so():
        if time.monotonic() > end:
            raise AssertionError(f"waited in vain until {what}")
        time.sleep(0.02)


def stat(pid):
    """@return state and session; X, a dead one, where it is not there."""
    try:
        words = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    except OSError:
        return "X", 0
    return words[0], int(words[3])


def is_gone(pid):
    """Also where nobody has waited for it yet."""
    return stat(pid)[0] in "ZX"


def has_session(pid):
    """Something runs yet of the session that this process began."""
    every = [stat(path.name) for path in pathlib.Path("/proc").glob("[0-9]*")]
    return any(session == pid and state not in "ZX" for state, session in every)


def pids_in(path):
    """@return those that programs wrote there, a line each."""
    return [int(line) for line in path.read_text(encoding="utf-8").split()] if path.exists() else []


def files_in(folder):
    """@return all that lies in it: the bytes by the path."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@unittest.skipUnless(importlib.util.find_spec("distributed"), "python3-distributed is not installed")
class ClusterTest(unittest.TestCase):
    def start_scheduler(self, folder):
        self.cluster_folder = folder / "cluster"
        self.cluster_folder.mkdir()
        self.scheduler_file = self.cluster_folder / "scheduler.json"
        self.start("scheduler", "--host", "127.0.0.1", "--port", "0")
        wait_until(self.scheduler_file.exists, "the scheduler is there")
        wait_until(lambda: self.scheduler_file.read_text(encoding="utf-8").strip(), "its address is there")
        self.address = json.loads(self.scheduler_file.read_text(encoding="utf-8"))["address"]

    def start_worker(self, name, **environment):
        """It does one thing at a time, and is not begun again where it dies."""
        return self.start("worker", "--nthreads", "1", "--no-nanny", "--local-directory",
                          self.cluster_folder / name, **environment)

    def start(self, what, *arguments, **environment):
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", "--scheduler-file", self.scheduler_file,
                   "--no-dashboard", *arguments]
        with open(self.cluster_folder / f"{what}.log", "ab") as log:
            process = subprocess.Popen(  # pylint: disable=consider-using-with
                [str(word) for word in command], stdout=log, stderr=log, cwd=self.cluster_folder,
                start_new_session=True, env=dict(os.environ, **environment))
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        process.send_signal(signal.SIGKILL)
        process.wait()

    def script(self, path, *lines):
        """@return a program in bash."""
        path.write_text("\n".join(("#!/bin/bash", *lines, "")), encoding="utf-8")
        path.chmod(0o755)
        return str(path)
