"""Counting of tests as gtest, rostest and pytest report them."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY  # noqa: E402

GTEST = """<testsuites><testsuite name="MapTest">
  <testcase name="Holds" status="run" result="completed" classname="MapTest"/>
  <testcase name="Waits" status="run" result="skipped" classname="MapTest"><skipped/></testcase>
  <testcase name="Sleeps" status="notrun" classname="MapTest"/>
  {more}</testsuite></testsuites>"""
FAILURE = '<testcase name="Breaks" classname="MapTest"><failure message="it broke"/></testcase>'
PASSED = '<testsuite><testcase classname="x" name="y"/></testsuite>'


class SummaryTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, text):
        (pathlib.Path(self.folder.name) / name).write_text(text, encoding="utf-8")

    def summary(self):
        run = subprocess.run([str(REPOSITORY / "scripts" / "test_summary"), self.folder.name],
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stdout.splitlines()

    def test_skipped_tests_are_named_and_do_not_fail(self):
        self.write("gtest-map.xml", GTEST.format(more=""))
        status, lines = self.summary()
        self.assertEqual(status, 0)
        self.assertEqual(lines, ["skipped: gtest-map: MapTest.Waits",
                                 "skipped: gtest-map: MapTest.Sleeps",
                                 "1 passed, 0 failed, 2 skipped"])

    def test_a_failure_fails(self):
        self.write("gtest-map.xml", GTEST.format(more=FAILURE))
        status, lines = self.summary()
        self.assertEqual(status, 1)
        self.assertIn("failed: gtest-map: MapTest.Breaks", lines)
        self.assertEqual(lines[-1], "1 passed, 1 failed, 2 skipped")

    def test_a_test_program_that_ran_is_no_test_itself(self):
        self.write("rostest-run.xml", PASSED)
        self.write("rosunit-run.xml", GTEST.format(more=FAILURE))
        status, lines = self.summary()
        self.assertEqual(status, 1)
        self.assertEqual(lines[-1], "1 passed, 1 failed, 2 skipped")

    def test_a_test_program_that_did_not_run_is_a_failure(self):
        self.write("rostest-run.xml", f"<testsuite>{FAILURE}</testsuite>")
        self.write("gtest-a.xml", PASSED)
        status, lines = self.summary()
        self.assertEqual(status, 1)
        self.assertEqual(lines[-1], "1 passed, 1 failed, 0 skipped")

    def test_a_broken_file_fails(self):
        self.write("gtest-a.xml", PASSED)
        self.write("gtest-b.xml", "<testsuite><testcase")
        status, lines = self.summary()
        self.assertEqual(status, 1)
        self.assertEqual(lines[-1], "1 passed, 1 failed, 0 skipped")

    def test_a_failure_of_no_test_case_fails(self):
        self.write("rosunit-run.xml", '<testsuite failures="1"><testcase name="runs"/></testsuite>')
        status, lines = self.summary()
        self.assertEqual(status, 1)
        self.assertEqual(lines[-1], "1 passed, 1 failed, 0 skipped")

    def test_a_run_without_tests_fails(self):
        self.assertEqual(self.summary(), (1, ["0 passed, 0 failed, 0 skipped"]))


if __name__ == "__main__":
    unittest.main()
