#!/usr/bin/python3
"""The program `evaluate` on recordings of several sensors."""
import copy
import random
import unittest

import yaml

from evaluate_run import EvaluateTest
from made_bag import CONFIG, URDF, Stream

SECOND = "/second_scan"


def config_of(sensors):
    """@param sensors topics by name, and whether each is required."""
    config = yaml.safe_load(CONFIG)
    del config["topics"]
    own = {section: config.pop(section) for section in ("tilt_scan_assembler", "tccm_mapper")}
    for name, (topic, _) in sensors.items():
        config[name] = {"topic": topic, **copy.deepcopy(own)}
    config["collision_checker"]["sensors"] = [
        {"name": name, "required": required} for name, (_, required) in sensors.items()]
    return yaml.safe_dump(config)


def with_second(stream, keep=lambda seconds: True):
    """A second sensor, at the same place, that sees the same."""
    for topic, message, seconds in list(stream.messages):
        if topic == "/tilt_scan" and keep(seconds):
            stream.messages.append((SECOND, message, seconds))
    stream.messages.sort(key=lambda entry: entry[2])
    return stream


class SensorsTest(EvaluateTest):
    def play(self, stream, sensors, out="out", status=0):
        bag = self.path(out + ".bag")
        stream.write(bag)
        config = self.text(out + ".yaml", config_of(sensors)) if sensors else None
        urdf = self.text("robot.urdf", URDF)
        return self.evaluate(bag, out=out, config=config, urdf=urdf, status=status)

    def reasons(self, out):
        """By stamp of the joint states: the last check of each."""
        return {row["stamp"]: row["reason"] for row in self.rows("verdicts", out)}

    def test_two_that_see_the_same_say_what_one_says(self):
        self.play(Stream(2.0), None, "one")
        both = {"laser": ("/tilt_scan", True), "second": (SECOND, True)}
        summary = self.play(with_second(Stream(2.0)), both, "two")
        one, two = self.reasons("one"), self.reasons("two")
        self.assertIn("COLLISION", one.values())
        differing = [stamp for stamp in one if one[stamp] != two[stamp]]
        self.assertEqual(differing, [])
        self.assertEqual(list(summary["sensors"]), ["laser", "second"])
        self.assertEqual(summary["sensors"]["laser"], summary["sensors"]["second"])
        for sensor in both:
            self.assertMapCanBeRecomputed("two", sensor)

    def test_two_runs_are_the_same(self):
        rng = random.Random(1)
        sensors = {"laser": ("/tilt_scan", True), "second": (SECOND, False)}
        kept = [rng.random() < 0.7 for _ in range(1000)]
        for out in ("a", "b"):
            self.play(with_second(Stream(2.0), lambda t: kept[round(100 * t)]), sensors, out)
        for dump in ("points.laser", "points.second", "cuboids.laser", "cuboids.second", "verdicts"):
            self.assertEqual(self.rows(dump, "a"), self.rows(dump, "b"), dump)

    def test_one_that_stops_is_a_fault_only_where_it_is_required(self):
        stops_at = 1.0
        for required in (True, False):
            with self.subTest(required=required):
                out = f"required_{required}"
                sensors = {"laser": ("/tilt_scan", True), "second": (SECOND, required)}
                self.play(with_second(Stream(2.0), lambda t: t < stops_at), sensors, out)
                later = [row["reason"] for row in self.rows("verdicts", out)
                         if row["stamp"] and float(row["stamp"]) > 1000.0 + stops_at + 0.7]
                self.assertEqual("NO_MAP" in later, required)

    def test_slips_in_the_configuration_are_refused_by_name(self):
        bag = self.path("in.bag")
        with_second(Stream(1.0)).write(bag)
        sound = yaml.safe_load(config_of({"laser": ("/tilt_scan", True), "second": (SECOND, True)}))

        def refused(expected, change):
            config = copy.deepcopy(sound)
            change(config)
            done = self.call("--bag", bag, "--out", self.path("out"), "--config",
                             self.text("slip.yaml", yaml.safe_dump(config)))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

        refused("'second' has no section", lambda c: c.pop("second"))
        refused("second/topic", lambda c: c["second"].pop("topic"))
        refused("second/tccm_mapper/cellsize", lambda c: c["second"]["tccm_mapper"].update(cellsize=1))
        refused("second/tilt", lambda c: c["second"].update(tilt={}))
        refused("in its own section", lambda c: c.update(tccm_mapper={}))
        refused("'third' names no nodelet", lambda c: c.update(third={}))
        refused("'/nowhere'", lambda c: c["second"].update(topic="/nowhere"))
        refused("fixed_frame: second/", lambda c: c["second"]["tilt_scan_assembler"].update(fixed_frame="map"))
        refused("named twice", lambda c: c["collision_checker"]["sensors"].append({"name": "laser"}))
        refused("sensors", lambda c: c["collision_checker"].update(sensors=[{"name": "topics"}]))


if __name__ == "__main__":
    unittest.main()
