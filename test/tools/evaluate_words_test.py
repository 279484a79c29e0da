#!/usr/bin/python3
"""What `evaluate` says to people: of each stop, and of a recording of which no scan was mapped.

Environment: as evaluate_test.py.
"""
import itertools
import math
import random
import unittest

from evaluate_run import EvaluateTest
from made_bag import CONFIG, URDF, Stream, scan_at

MEMBERS = 20


class Dips(Stream):
    """The hand slides into what the laser sees again and again, for as long as it likes."""

    def __init__(self, rng, dips):
        self.knots, t = [(0.0, 0.4)], 0.8
        for _ in range(dips):
            deep, stays, rests = rng.uniform(0.76, 0.85), rng.uniform(0.05, 0.3), rng.uniform(0.5, 1.0)
            self.knots += [(t, 0.4), (t + 0.6, deep), (t + 0.6 + stays, deep), (t + 1.2 + stays, 0.4)]
            t += 1.2 + stays + rests
        self.knots.append((t, 0.4))
        super().__init__(t)

    def slide(self, t):
        for (t0, x0), (t1, x1) in itertools.pairwise(self.knots):
            if t <= t1:
                return x0 + (x1 - x0) * (t - t0) / (t1 - t0)
        return self.knots[-1][1]


class WordsTest(EvaluateTest):
    def play(self, stream, config=CONFIG, robot=True, **how):
        self.folder.cleanup()
        self.setUp()
        stream.write(self.path("in.bag"))
        urdf = self.text("robot.urdf", URDF) if robot else None
        return self.evaluate(self.path("in.bag"), config=self.text("config.yaml", config), urdf=urdf, **how)

    def lines(self, begin):
        return [line for line in self.done.stdout.splitlines() if line.startswith(begin + " ")]


class StopsTest(WordsTest):
    def runs(self):
        """@return the reasons and links of each stop, as the dump of all checks has them."""
        rows = self.rows("verdicts")
        stops = itertools.groupby(rows, key=lambda row: row["stop"])
        return [list(dict.fromkeys((row["reason"], row["link"]) for row in run))
                for stop, run in stops if stop == "1"]

    def assertStopsAreTold(self, summary):
        runs = self.runs()
        self.assertEqual(summary["stops"], len(runs))
        segments = summary["stop_segments"]
        self.assertEqual([segment["stop"] for segment in segments],
                         sorted(segment["stop"] for segment in segments))
        for number, run in enumerate(runs, 1):
            told = [s["reason"] for s in segments if s["stop"] == number]
            self.assertEqual(list(dict.fromkeys(told)), list(dict.fromkeys(reason for reason, _ in run)))
        lines = self.lines("stop")
        self.assertEqual(len(lines), min(len(runs), 20) + (len(runs) > 20))
        for line, run in zip(lines[:20], runs):
            for reason in {reason for reason, _ in run}:
                self.assertIn(reason, line)
            for link in {link for _, link in run if link}:
                self.assertIn(f"of '{link}'", line)

    def test_stops_of_random_motions_are_counted_and_told(self):
        for seed in range(MEMBERS):
            with self.subTest(seed=seed):
                rng = random.Random(seed)
                dips = rng.randint(1, 4)
                stream = Dips(rng, dips)
                if seed % 2:  # joint states that are silent for a while stop the robot as well
                    silent = rng.uniform(0.5, stream.duration_s - 1.5)
                    stream.messages = [m for m in stream.messages if m[0] != "/joint_states" or
                                       not silent < m[2] < silent + 1.0]
                summary = self.play(stream)
                self.assertStopsAreTold(summary)
                self.assertGreater(summary["stops"], 1)
                self.assertGreater(len(summary["stop_segments"]), summary["stops"])

    def test_a_healthy_robot_whose_stamps_jitter_stops_once_at_the_start(self):
        for seed in range(MEMBERS):
            with self.subTest(seed=seed):
                rng = random.Random(100 + seed)
                stream, deepest = Stream(2.0), rng.uniform(0.5, 0.7)
                for topic, message, t in stream.messages:
                    if topic == "/joint_states":
                        message.header.stamp.nsecs += rng.randint(0, 2_000_000)
                        if "slide" in message.name:
                            message.position = [round(deepest + rng.gauss(0.0, 1e-4), 4)]
                summary = self.play(stream)
                self.assertStopsAreTold(summary)
                self.assertEqual(summary["stops"], 1)
                self.assertEqual({s["reason"] for s in summary["stop_segments"]} - {"INIT", "NO_JOINTS"}, set())

    def test_a_contact_names_the_link_what_it_touches_when_and_for_how_long(self):
        summary = self.play(Dips(random.Random(1), 1))
        line = self.lines("stop")[1]
        segments = [s for s in summary["stop_segments"] if s["stop"] == 2]
        first = segments[0]
        touch = next(s for s in segments if s["reason"] == "COLLISION")
        self.assertEqual(touch["link"], "hand")
        begin = f"stop     at {first['from_s']:.2f} s (stamp {1000 + first['from_s']:.2f}) for "
        self.assertTrue(line.startswith(begin), line)
        self.assertRegex(line, r" for \d+ ms: COLLISION of 'hand': " + touch["detail"])
        self.assertIn("(in turn: COLLISION_AHEAD of 'hand', COLLISION of 'hand')", line)

    def test_of_very_many_stops_the_first_twenty_are_told_and_how_many_more(self):
        summary = self.play(Dips(random.Random(2), 26))
        self.assertStopsAreTold(summary)
        self.assertGreater(summary["stops"], 20)
        self.assertRegex(self.lines("stop")[20], f"^stop +{summary['stops'] - 20} more: ")

    def test_a_stop_outlives_a_time_that_jumps_back(self):
        stream, again = Stream(0.4), Stream()
        stream.messages += [(topic, m, t + 0.4) for topic, m, t in again.messages]
        for topic, message, t in stream.messages[:40]:
            if topic == "/joint_states":
                message.header.stamp.secs += 100
        summary = self.play(stream)
        self.assertStopsAreTold(summary)
        self.assertEqual(summary["time_jumps"], 1)
        self.assertGreater([s["stop"] for s in summary["stop_segments"]].count(1), 1)

    def test_figures_for_people_have_at_most_three_digits_behind_the_point(self):
        self.play(Stream())
        for line in self.done.stdout.splitlines()[:-1]:
            self.assertNotRegex(line, r"\d\.\d{4}", line)


def unknown_frame(stream, rng):
    frame = f"laser_{rng.randint(0, 999)}"
    for topic, message, _ in stream.messages:
        if topic == "/tilt_scan":
            message.header.frame_id = frame
    return "no_transform", f"tf has no frame '{frame}'", "tilt_scan_assembler/fixed_frame"


def malformed(stream, rng):
    wrong = rng.choice((0.5, 2.0, -1.0))
    for topic, message, _ in stream.messages:
        if topic == "/tilt_scan":
            message.angle_max = wrong
    return "malformed", "angle", "driver"


def blind(stream, rng):
    beams = [rng.choice((math.nan, 0.0, 0.01)) for _ in range(2)]
    for topic, message, _ in stream.messages:
        if topic == "/tilt_scan":
            message.ranges = list(beams)
            message.angle_max = 0.1
    return "blind", "hardly anything", "scan_unknown_fraction_max"


def silent_joints(stream, rng):
    joint = rng.choice(("slide", "lift"))
    stream.messages = [m for m in stream.messages if m[0] != "/joint_states" or joint not in m[1].name]
    return "no_joint_states", "joint states", f"'{joint}'"


class NothingMappedTest(WordsTest):
    KINDS = (unknown_frame, malformed, blind, silent_joints)
    FILTERS = CONFIG.replace("self_filter: false", "self_filter: true")

    def test_a_recording_without_a_mapped_scan_exits_with_1_and_says_why_and_what_to_set(self):
        for seed, kind in itertools.product(range(MEMBERS), self.KINDS):
            with self.subTest(seed=seed, kind=kind.__name__):
                rng = random.Random(seed)
                stream = Stream(rng.uniform(0.3, 0.6))
                reason, why, advice = kind(stream, rng)
                summary = self.play(stream, config=self.FILTERS, status=1)
                self.assertEqual(summary["scans"], 0)
                said = self.done.stderr
                self.assertEqual(said.count("\n"), 1, said)
                count = summary["scans_dropped"][reason]
                self.assertEqual(count, max(summary["scans_dropped"].values()))
                begin = f"evaluate: no scan was mapped, {count} of {summary['scans_received']} were dropped: {reason}"
                self.assertTrue(said.startswith(begin), said)
                self.assertIn(why, said)
                self.assertIn(advice, said)

    def test_a_clock_apart_is_told_by_its_amount(self):
        stream = Stream(2.0)
        for topic, message, _ in stream.messages:
            if topic == "/tilt_scan":
                message.header.stamp.secs -= 900
        self.play(stream, robot=False, status=1)
        self.assertIn("15 min", self.done.stderr)

    def test_a_recording_shorter_than_the_wait_for_joint_states_asks_for_them(self):
        stream = Stream(0.3)
        silent_joints(stream, random.Random(0))
        summary = self.play(stream, config=self.FILTERS, status=1)
        self.assertEqual(summary["scans_dropped"], {"no_joint_states": summary["scans_received"]})
        self.assertIn("the recording ended before joint states", self.done.stderr)
        self.assertIn("topics/joint_states", self.done.stderr)

    def test_a_recording_of_which_a_few_scans_are_mapped_is_done(self):
        for seed in range(MEMBERS):
            with self.subTest(seed=seed):
                rng = random.Random(seed)
                stream, bad = Stream(2.0), Stream(2.0)
                rng.choice((malformed, blind))(bad, rng)
                first = rng.randrange(20, 180)
                merged = stream.messages[:first] + bad.messages[first:]
                stream.messages = [m for m in merged if m[0] != "/tilt_scan" or
                                   rng.random() < 0.9]
                summary = self.play(stream, robot=False)
                self.assertGreater(summary["scans"], 0)

    def test_help_names_the_exit_statuses(self):
        self.assertIn("0 done, 1 no scan was mapped, 2 bad input", self.call("--help").stdout)


if __name__ == "__main__":
    unittest.main()
