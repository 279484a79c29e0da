"""Which test a name means."""

import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

select_tests = load("select_tests")

ROOMS = ("check", "gate", "map", "ros", "sight", "tools")
TARGETS = ["run_tests_tccm_monitor_" + name for name in (
    "gtest", "gtest_monitor_test", "gtest_check_checker_test", "gtest_gate_gated_motion_test",
    "gtest_map_cuboid_map_test", "gtest_sight_look_map_test", "gtest_ros_conversions_test",
    "pytest_gate_gated_motion_test", "pytest_tools_evaluate_test", "pytest_tools_trials_test",
    "rostest_faults__input_scan.test", "rostest_faults__input_tf.test",
    "rostest_test_ros_start.test", "rostest_test_ros_trials.test")]


class SelectTest(unittest.TestCase):
    def expect(self, expected, *names):
        for name in names:
            with self.subTest(name):
                self.assertEqual(select_tests.select(name, TARGETS, ROOMS),
                                 ([f"run_tests_tccm_monitor_{test}" for test in expected], ""))

    def expect_none(self, name, *parts):
        found, complaint = select_tests.select(name, TARGETS, ROOMS)
        self.assertEqual(found, [])
        self.assertNotIn("\n", complaint)
        for part in parts:
            self.assertIn(part, complaint)

    def test_a_file_may_be_named_in_every_way(self):
        self.expect(["gtest_check_checker_test"], "checker_test", "check_checker_test",
                    "checker_test.cpp", "check/checker_test", "test/check/checker_test.cpp")
        self.expect(["gtest_monitor_test"], "monitor_test", "test/monitor_test.cpp")
        self.expect(["gtest_ros_conversions_test"], "conversions_test")
        self.expect(["pytest_tools_evaluate_test"], "evaluate_test", "evaluate_test.py")
        self.expect(["rostest_test_ros_start.test"], "start", "start.test", "start_test.py")

    def test_a_rostest_is_run_with_all_its_arguments(self):
        self.expect(["rostest_faults__input_scan.test", "rostest_faults__input_tf.test"],
                    "faults", "faults.test", "test/ros/faults.test")

    def test_a_files_own_name_goes_first(self):
        self.expect(["pytest_tools_trials_test"], "trials_test")
        self.expect(["rostest_test_ros_trials.test"], "trials")

    def test_a_name_of_several_is_refused_with_their_paths(self):
        self.expect_none("gated_motion_test", "several",
                         "test/gate/gated_motion_test.cpp, test/gate/gated_motion_test.py")
        self.expect(["pytest_gate_gated_motion_test"], "gated_motion_test.py")

    def test_a_name_of_none_is_refused_with_those_near(self):
        self.expect_none("map_test", "no such", "test/map/cuboid_map_test.cpp",
                         "test/sight/look_map_test.cpp")
        self.expect_none("chekcer_test", "near: test/check/checker_test.cpp")
        self.expect_none("xyzzy", "there is no such test")


if __name__ == "__main__":
    unittest.main()
