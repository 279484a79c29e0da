"""The tests of a build: what each needs built, and how it is run."""

import dataclasses
import json
import os
import pathlib
import re
import resource
import shlex
import signal
import subprocess
import time

from mutation.entries import Wrong

PREFIX = re.compile(r"^_ctest_[a-z_]+?_(gtest|rostest)_")
ROOT = "monitor"  # the room of tests that lie in no folder
# Whose tests may find what is broken in a room, besides its own (see docs/design.md).
ABOVE = {
    "base": ("config", "robot", "sight", "scan", "map", "check", "gate", ROOT),
    "config": ("check", "gate", ROOT),
    "geometry": ("robot", "sight", "scan", "map", "check", ROOT),
    "robot": ("scan", "check", "gate", ROOT, "simulation"),
    "sight": ("scan", "map", "check", ROOT, "simulation"),
    "scan": (ROOT, "simulation"),
    "map": ("check", ROOT, "simulation"),
    "check": (ROOT, "simulation"),
    "gate": ("simulation",),
    "ros": ("nodelets",),
    "nodelets": (),
}
ROSTEST_TARGETS = ("tccm_monitor_nodelets", "gate_guard", "monitor_node", "simulation_node",
                   "gate_obeys_test", "evaluate", "tccm_monitor_recordings")
MEMORY_MAX = 8 << 30  # [bytes] that one that runs away takes before it fails


@dataclasses.dataclass(frozen=True)
class Outcome:
    """Of one run."""

    passed: bool
    how: str  # in a word
    seconds: float
    output: str


@dataclasses.dataclass(frozen=True)
class Test:
    """Of one file."""

    name: str
    kind: str
    room: str
    command: tuple  # begins with what sets the environment up
    folder: str

    @property
    def targets(self):
        """To be built."""
        return (pathlib.PurePath(self.command[1]).name,) if self.kind == "gtest" else ROSTEST_TARGETS

    @property
    def limit_s(self):
        """That it may take where nothing is known of it."""
        return {"gtest": 300.0, "rostest": 600.0}[self.kind]

    def run(self, timeout_s):
        """Rostests measure in real time: one has failed where it fails twice."""
        outcome = self.run_once(timeout_s)
        return outcome if outcome.passed or self.kind == "gtest" else self.run_once(timeout_s)

    def run_once(self, timeout_s):
        environment = dict(os.environ, GTEST_FAIL_FAST="1", GTEST_BRIEF="1", GTEST_COLOR="no")
        begun = time.monotonic()
        with subprocess.Popen(self.command, cwd=self.folder, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True,
                              preexec_fn=self.limit) as process:
            try:
                output, _ = process.communicate(timeout=timeout_s)
                how = "failed" if process.returncode > 0 else "crashed"
            except subprocess.TimeoutExpired:
                kill(process)
                output, how = process.communicate()[0], "hung"
            except BaseException:
                kill(process)
                raise
        passed = how != "hung" and process.returncode == 0
        return Outcome(passed, "passed" if passed else how, time.monotonic() - begun, output)

    def limit(self):
        """Sanitizers reserve more than there is."""
        if self.kind == "gtest" and "fuzz" not in self.name:
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_MAX, MEMORY_MAX))


def kill(process):
    """With all that it has started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def test_of(entry, rooms):
    """@param rooms that tests lie in. @return a test as ctest tells of it, or nothing where it is of another kind."""
    match, command = PREFIX.match(entry["name"]), entry.get("command", [])
    if not match or "--return-code" not in command:
        return None
    # What catkin hands to its run_tests.py, which would write the results to a file.
    inner = shlex.split(command[command.index("--return-code") + 1])
    command = command[:1] + [word for word in inner if not word.startswith("--gtest_output")]
    name, room = PREFIX.sub("", entry["name"]), PREFIX.sub("", entry["name"]).split("_")[0]
    folder = {one["name"]: one["value"] for one in entry.get("properties", [])}.get("WORKING_DIRECTORY", ".")
    return Test(name, match.group(1), room if room in rooms else ROOT, tuple(command), folder)


class Suite:
    """All tests of a build folder."""

    def __init__(self, build, rooms):
        told = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, capture_output=True, text=True, check=False)
        if told.returncode != 0:
            raise Wrong(f"{build}: ctest fails: {told.stderr.strip()}")
        found = (test_of(entry, rooms) for entry in json.loads(told.stdout)["tests"])
        self.tests = [test for test in found if test]

    def named(self, name):
        """A rostest is run with all its arguments. @raises Wrong"""
        if name.endswith(".test"):
            stem = name[:-len(".test")]
            found = [test for test in self.tests if test.kind == "rostest" and
                     re.fullmatch(rf"(test_ros_)?{re.escape(stem)}(__.*)?\.test", test.name)]
        else:
            found = [test for test in self.tests if test.kind == "gtest" and test.name == name]
        if not found:
            raise Wrong(f"{name}: the build has no such test")
        return found

    def further(self, room, but):
        """The other unit tests of a room, then of those above it."""
        rooms = (room,) + ABOVE.get(room, ())
        return [test for one in rooms for test in self.tests
                if test.kind == "gtest" and test.room == one and test not in but]
