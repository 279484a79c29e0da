#!/usr/bin/python3
"""Every tunable parameter can be changed through dynamic_reconfigure, within its limits."""

import pathlib
import re
import unittest

import rospy
import rostest
from dynamic_reconfigure.client import Client

NAME = "collision_checker"
PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/parameters.md"
SWITCHED_OFF = "check_occlusion"  # refused while the checker runs


class TuningTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.heard = []
        cls.client = Client(NAME, timeout=30.0, config_callback=cls.heard.append)
        cls.described = {p["name"]: p for p in cls.client.get_parameter_descriptions()}
        cls.defaults = cls.client.get_configuration(timeout=10.0)

    def tearDown(self):
        self.client.update_configuration({name: self.defaults[name] for name in self.described})

    def other_value(self, name):
        value, parameter = self.defaults[name], self.described[name]
        if parameter["type"] == "bool":
            return not value
        bound = parameter["max"] if value < parameter["max"] else parameter["min"]
        return type(value)(value + 0.5 * (min(bound, value + 2.0) - value))

    def test_what_the_page_calls_tunable_is_offered(self):
        rows = re.findall(r"^\| `(\w+)` \|(?:[^|]*\|){3} yes \|", PAGE.read_text(), re.MULTILINE)
        self.assertEqual(sorted(self.described), sorted(rows))

    def test_each_is_taken_shown_and_kept_alone(self):
        for name in self.described:
            if name == SWITCHED_OFF:
                continue
            with self.subTest(name=name):
                value = self.other_value(name)
                self.assertNotEqual(value, self.defaults[name])
                answer = self.client.update_configuration({name: value})
                expected = dict(self.defaults, **{name: value})
                for other in self.described:
                    self.assertEqual(answer[other], expected[other], other)
                self.assertEqual(rospy.get_param(f"{NAME}/{name}"), value)
                self.tearDown()

    def test_others_hear_of_a_change(self):
        self.client.update_configuration({"release_checks": 7})
        for _ in range(200):
            if any(config.get("release_checks") == 7 for config in self.heard):
                return
            rospy.sleep(0.02)
        self.fail("no update was published")

    def test_beyond_its_range_a_value_ends_at_the_limit(self):
        answer = self.client.update_configuration({"primitive_scale": 100.0})
        self.assertEqual(answer["primitive_scale"], self.described["primitive_scale"]["max"])

    def test_what_is_no_finite_number_changes_nothing_at_all(self):
        numbers = [name for name, parameter in self.described.items()
                   if parameter["type"] == "double"]
        self.assertIn("check_time_max_periods", numbers)
        for name in numbers:
            for value in (float("nan"), float("inf"), float("-inf")):
                with self.subTest(name=name, value=value):
                    answer = self.client.update_configuration({"release_checks": 9, name: value})
                    for other in self.described:
                        self.assertEqual(answer[other], self.defaults[other], other)

    def test_what_is_not_safe_changes_nothing_at_all(self):
        for unsafe in ({"collision_padding_m": 0.0}, {"stop_time_s": 0.0}, {SWITCHED_OFF: False}):
            with self.subTest(unsafe=unsafe):
                answer = self.client.update_configuration({"release_checks": 9, **unsafe})
                for name in self.described:
                    self.assertEqual(answer[name], self.defaults[name], name)


if __name__ == "__main__":
    rospy.init_node("tuning_test")
    rostest.rosrun("tccm_monitor", "tuning", TuningTest)
