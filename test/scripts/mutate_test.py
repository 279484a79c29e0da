"""The list of mutations, and what scripts/mutate makes of one in a small repository."""

import contextlib
import io
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY, load  # noqa: E402

mutate = load("mutate")
from mutation import entries, suite, trial, workshop  # noqa: E402

CMAKE = """cmake_minimum_required(VERSION 3.10)
project(small CXX)
enable_testing()
add_library(small SHARED src/check/limit.cpp)
foreach(test limit other)
  add_executable(check_${test}_test test/check/${test}_test.cpp)
  target_link_libraries(check_${test}_test small)
  add_test(NAME _ctest_small_gtest_check_${test}_test
    COMMAND env run_tests.py results.xml --return-code $<TARGET_FILE:check_${test}_test>)
endforeach()
"""
SOURCE = "bool isBeyond(int x) { return x > 3 || x < -3; }\n"
TEST = "bool isBeyond(int x);\nint main() {{ return isBeyond({}) && !isBeyond(3) ? 0 : 1; }}\n"
ABOVE = {"name": "What is above the limit passes", "file": "src/check/limit.cpp", "before": "x > 3", "after": "false",
         "tests": ["check_limit_test"]}
BELOW = dict(ABOVE, name="What is below the limit passes", before="x < -3")
SAME = dict(ABOVE, name="What is just above the limit passes", after="x >= 4")


class RepositoryTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name) / "small"
        self.write("CMakeLists.txt", CMAKE)
        self.write("src/check/limit.cpp", SOURCE)
        self.write("test/check/limit_test.cpp", TEST.format(4))
        self.write("test/check/other_test.cpp", TEST.format(-4))

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def list(self, *mutations):
        self.write("test/mutations/check.yaml", json.dumps(list(mutations), indent=1))  # which is YAML

    def run_on_it(self, *arguments):
        """@return exit status, output and errors."""
        said, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(errors):
            status = mutate.main(["--repository", str(self.folder), *arguments])
        return status, said.getvalue(), errors.getvalue()

    def results(self):
        told = json.loads((self.folder / "build_mutation" / "results.json").read_text(encoding="utf-8"))
        return {one["name"]: (one["status"], one["found_by"]) for one in told["mutations"]}


class ListTest(RepositoryTest):
    def test_every_mutation_of_ours_can_be_applied_and_its_tests_exist(self):
        mutations = entries.read(REPOSITORY)
        self.assertGreater(len(mutations), 150)
        unknown = {mutation.room for mutation in mutations} - set(suite.ABOVE)
        self.assertEqual(unknown, set(), "rooms of which nobody knows what is above them")
        cmake = "".join(path.read_text(encoding="utf-8") for path in (REPOSITORY / "test").rglob("CMakeLists.txt"))
        files = [str(path.relative_to(REPOSITORY / "test"))[:-len("_test.cpp")]
                 for path in (REPOSITORY / "test").rglob("*_test.cpp")]
        names = {file.replace("/", "_") + "_test": file for file in files}
        for test in sorted({test for mutation in mutations for test in mutation.tests}):
            self.assertIn(names.get(test, test), cmake, f"{test} is not built")

    def expect_wrong(self, text, *mutations):
        self.list(*mutations)
        status, _said, errors = self.run_on_it("--list")
        self.assertEqual(status, 2)
        self.assertIn(text, errors)

    def test_a_text_that_is_not_there_once_is_named_with_its_line(self):
        self.expect_wrong("test/mutations/check.yaml:11: What is below the limit passes: before: it stands 0 times in "
                          "src/check/limit.cpp", ABOVE, dict(BELOW, before="x < -4"))
        self.expect_wrong("check.yaml:2: What is above the limit passes: before: it stands 2 times",
                          dict(ABOVE, before="3"))

    def test_each_that_is_wrong_is_named(self):
        self.list(dict(ABOVE, tests=["check_away_test"]), dict(BELOW, file="src/check/away.cpp"))
        _status, _said, errors = self.run_on_it()
        self.assertEqual([line.split(": ", 3)[3] for line in errors.splitlines()],
                         ["tests: there is no check_away_test", "file: there is no src/check/away.cpp"])

    def test_what_changes_nothing_is_wrong(self):
        self.expect_wrong("after: it is what is there before", dict(ABOVE, after="x > 3"))

    def test_keys_are_checked(self):
        self.expect_wrong("check.yaml:2: afetr: is no key", dict(ABOVE, afetr=""))
        self.expect_wrong("tests: has to be a list", dict(ABOVE, tests="check_limit_test"))
        self.expect_wrong("equivalent: has to be a text", dict(ABOVE, equivalent=""))
        self.expect_wrong("after: is missing", {key: value for key, value in ABOVE.items() if key != "after"})
        self.expect_wrong("name: another has it too", ABOVE, dict(BELOW, name=ABOVE["name"]))
        self.expect_wrong("there are no mutations")
        self.write("test/mutations/check.yaml", "check: true\n")
        self.assertIn("has to be a list of mutations", self.run_on_it()[2])
        self.write("test/mutations/check.yaml", "- {name: one, name: other}\n")
        self.assertIn("line 1: name is there twice", self.run_on_it()[2])

    def test_rooms_names_and_parts_of_names_select(self):
        self.list(ABOVE, BELOW)
        for asked, names in (([], [ABOVE, BELOW]), (["check"], [ABOVE, BELOW]), (["BELOW"], [BELOW]),
                             ([BELOW["name"], "above"], [ABOVE, BELOW])):
            status, said, _errors = self.run_on_it("--list", *asked)
            listed = "".join(f"check: {one['name']} (check_limit_test)\n" for one in names)
            self.assertEqual((status, said), (0, listed))
        status, _said, errors = self.run_on_it("gate")
        self.assertEqual((status, errors), (2, "mutate: gate: no mutation has that in its name; rooms are check\n"))


@unittest.skipUnless(shutil.which("cmake") and shutil.which("c++"), "no cmake or compiler")
class MutateTest(RepositoryTest):
    def test_the_test_that_finds_it_is_told_and_all_is_as_it_was(self):
        self.list(ABOVE, BELOW)
        status, said, errors = self.run_on_it()
        self.assertEqual(status, 0, said + errors)
        self.assertEqual(self.results(), {ABOVE["name"]: ("found", "check_limit_test"),
                                          BELOW["name"]: ("found", "check_other_test")})
        self.assertIn(f"check  {ABOVE['name']}  found by check_limit_test, which failed\n", said)
        self.assertIn("found by check_other_test, which failed, and none of those named", said)
        self.assertIn("2 found", said)
        self.assertIn("(2 of 2)", errors)
        self.assertEqual((self.folder / "src/check/limit.cpp").read_text(encoding="utf-8"), SOURCE)
        shop = self.folder / "build_mutation" / "1"
        self.assertEqual((shop / "source/src/check/limit.cpp").read_text(encoding="utf-8"), SOURCE)
        built = subprocess.run(["make", "-C", shop / "build"], capture_output=True, text=True, check=True).stdout
        self.assertNotIn("Building", built, "what was built of whole sources is back")
        self.assertEqual(subprocess.run([shop / "build" / "check_limit_test"], check=False).returncode, 0)

    def test_a_quick_look_runs_those_named_alone(self):
        self.list(BELOW)
        status, said, _errors = self.run_on_it("--quick")
        self.assertEqual((status, self.results()), (1, {BELOW["name"]: ("SURVIVED", None)}), said)
        self.assertIn("SURVIVED: 1 tests pass", said)

    def test_one_that_survives_fails_unless_it_is_said_to_be_equivalent(self):
        self.list(SAME)
        status, said, _errors = self.run_on_it()
        self.assertEqual((status, self.results()), (1, {SAME["name"]: ("SURVIVED", None)}), said)
        self.list(dict(SAME, equivalent="there is no whole number between the two"))
        status, said, _errors = self.run_on_it()
        self.assertEqual((status, self.results()), (0, {SAME["name"]: ("equivalent", None)}), said)
        self.assertIn("equivalent: there is no whole number between the two", said)
        self.list(dict(ABOVE, equivalent="nobody asks for it"))
        self.assertEqual(self.run_on_it()[0], 1, "it is found")

    def test_what_cannot_be_built_is_told_apart(self):
        self.list(dict(ABOVE, after="x >"))
        status, said, _errors = self.run_on_it()
        self.assertEqual((status, self.results()), (1, {ABOVE["name"]: ("unfit", None)}))
        self.assertIn("it cannot be built: ", said)
        self.assertIn("error:", said)

    def test_a_test_that_fails_anyway_is_named(self):
        self.write("test/check/limit_test.cpp", TEST.format(3))
        self.list(ABOVE)
        status, _said, errors = self.run_on_it()
        self.assertEqual(status, 2)
        self.assertIn("mutate: check_limit_test failed where nothing is broken", errors)

    def test_what_changes_in_the_repository_comes_into_the_copy(self):
        self.list(ABOVE)
        self.run_on_it()
        self.write("src/check/limit.cpp", "// Limits.\n" + SOURCE)
        (self.folder / "test/check/other_test.cpp").write_text(TEST.format(-5), encoding="utf-8")
        self.write("test/check/new_test.cpp", "")
        shop = workshop.Workshop(self.folder, self.folder / "build_mutation" / "1", 1)
        shop.source.joinpath("stale").write_text("", encoding="utf-8")
        before = (shop.source / "test/check/limit_test.cpp").stat().st_mtime_ns
        shop.update()
        for name in ("src/check/limit.cpp", "test/check/other_test.cpp", "test/check/new_test.cpp"):
            self.assertEqual((shop.source / name).read_bytes(), (self.folder / name).read_bytes())
        self.assertFalse((shop.source / "stale").exists())
        self.assertEqual((shop.source / "test/check/limit_test.cpp").stat().st_mtime_ns, before)


class SuiteTest(unittest.TestCase):
    def test_programs_and_arguments_are_those_of_ctest(self):
        inner = "/b/core_tests --gtest_output=xml:/b/x.xml --gtest_filter=A.*:A/*"
        entry = {"name": "_ctest_tccm_monitor_gtest_check_limit_test", "properties": [],
                 "command": ["/b/env_cached.sh", "python3", "run_tests.py", "x.xml", "--return-code", inner]}
        test = suite.test_of(entry, {"check"})
        self.assertEqual((test.name, test.room, test.targets), ("check_limit_test", "check", ("core_tests",)))
        self.assertEqual(test.command, ("/b/env_cached.sh", "/b/core_tests", "--gtest_filter=A.*:A/*"))
        other = suite.test_of(dict(entry, name="_ctest_tccm_monitor_gtest_monitor_test"), {"check"})
        self.assertEqual((other.name, other.room), ("monitor_test", "monitor"))
        self.assertIsNone(suite.test_of(dict(entry, name="_ctest_tccm_monitor_pytest_x_test"), {"check"}))
        rostest = suite.test_of(dict(entry, name="_ctest_tccm_monitor_rostest_start.test"), {"check"})
        self.assertEqual(rostest.kind, "rostest")

    def test_one_that_hangs_is_ended_with_all_that_it_started(self):
        with tempfile.TemporaryDirectory() as folder:
            late = pathlib.Path(folder, "late")
            test = suite.Test("a_test", "gtest", "a", ("sh", "-c", f"(sleep 3; touch {late}) & sleep 60"), folder)
            begun = time.monotonic()
            outcome = test.run(0.2)
            self.assertEqual((outcome.passed, outcome.how), (False, "hung"))
            self.assertLess(time.monotonic() - begun, 3.0)
            self.assertFalse(late.exists())

    def test_one_that_crashes_has_not_passed(self):
        test = suite.Test("a_test", "gtest", "a", ("sh", "-c", "kill -SEGV $$"), ".")
        self.assertEqual(test.run(5.0).how, "crashed")

    def test_a_rostest_has_failed_where_it_fails_twice(self):
        with tempfile.TemporaryDirectory() as folder:
            command = ("sh", "-c", "test -e again || { touch again; exit 1; }")
            self.assertTrue(suite.Test("a.test", "rostest", "ros", command, folder).run(5.0).passed)
            pathlib.Path(folder, "again").unlink()
            self.assertFalse(suite.Test("a_test", "gtest", "ros", command, folder).run(5.0).passed)

    def test_patience_follows_what_a_test_takes(self):
        quick = suite.Test("a_test", "gtest", "a", ("true",), ".")
        times = trial.Times()
        self.assertEqual(times.limit(quick), quick.limit_s)
        times.measure(quick)
        self.assertEqual(times.limit(quick), trial.PATIENCE_LEAST_S)


if __name__ == "__main__":
    unittest.main()
