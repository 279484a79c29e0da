"""What the demo says of a run, from made-up statuses and truth."""

import io
import pathlib
import sys
import tempfile
import types
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

demo_report = load("demo_report")


class Stamp(float):
    def to_sec(self):
        return float(self)


def status(stamp=10.0, stop=True, reason="COLLISION_AHEAD", level=2):
    return types.SimpleNamespace(
        header=types.SimpleNamespace(stamp=Stamp(stamp)), level=level, reason=reason, stop=stop,
        detail="hand touches the map ahead", link="hand", serial=7, cuboids=42,
        scan_to_verdict_s=0.0305)


def hand(stamp, metres):
    return {"event": "hand", "stamp_s": stamp, "hand_obstacle_m": metres}


class TruthTest(unittest.TestCase):
    def setUp(self):
        self.truth = demo_report.Truth()

    def test_what_came_before_the_obstacle_does_not_count(self):
        self.truth.add({"event": "halted", "stamp_s": 1.0})
        self.truth.add({"event": "obstacle_appeared", "stamp_s": 2.0})
        self.truth.add({"event": "halted", "stamp_s": 3.0})
        self.truth.add({"event": "halted", "stamp_s": 4.0})
        self.assertEqual(self.truth.appeared, 2.0)
        self.assertEqual(self.truth.stamps["halted"], 3.0)

    def test_a_distance_lies_between_its_neighbours(self):
        self.truth.add(hand(0.5, None))
        self.truth.add(hand(1.0, 0.2))
        self.truth.add(hand(2.0, 0.1))
        self.assertAlmostEqual(self.truth.distance_at(1.25), 0.175)
        self.assertIsNone(self.truth.distance_at(0.75))
        self.assertIsNone(self.truth.distance_at(2.5))
        self.assertIsNone(self.truth.distance_at(None))


class StoryTest(unittest.TestCase):
    def test_a_stop_before_the_obstacle_is_not_the_demo_s(self):
        story = demo_report.Story(simulated=True)
        self.assertFalse(story.add_status(status(), 0.0))
        story.truth.add({"event": "obstacle_appeared", "stamp_s": 9.0})
        self.assertTrue(story.add_status(status(), 0.0))
        self.assertFalse(story.add_status(status(stamp=11.0), 0.0))
        self.assertEqual(story.stop.header.stamp, 10.0)

    def test_faults_and_releases_are_no_findings(self):
        story = demo_report.Story(simulated=False)
        for reason in ("INIT", "RELEASING", "NO_MAP", "MAP_LATE"):
            self.assertFalse(story.add_status(status(reason=reason), 0.0))

    def test_the_summary_counts_from_the_obstacle_s_appearance(self):
        story = demo_report.Story(simulated=True)
        story.truth.add({"event": "obstacle_appeared", "stamp_s": 9.0})
        story.truth.add(hand(9.0, 0.2))
        story.truth.add({"event": "first_beam", "stamp_s": 9.7})
        story.add_status(status(stamp=9.75), 0.0)
        story.truth.add(hand(10.0, 0.1))
        text = "\n".join(story.summary())
        for expected in ("700 ms", "750 ms (COLLISION_AHEAD", "125 mm", "not known"):
            self.assertIn(expected, text)

    def test_a_beam_at_the_moment_of_the_appearance_came_after_no_time(self):
        story = demo_report.Story(simulated=True)
        story.truth.add({"event": "obstacle_appeared", "stamp_s": 9.0000001})
        story.truth.add({"event": "first_beam", "stamp_s": 9.0})
        story.add_status(status(stamp=9.75), 0.0)
        self.assertRegex("\n".join(story.summary()), r"first beam returned: +0 ms")

    def test_no_stop_is_said(self):
        story = demo_report.Story(simulated=True)
        self.assertEqual(len(story.summary()), 1)
        self.assertIn("no stop", story.summary()[0])

    def test_a_recording_is_over_once_its_time_stands_still(self):
        story = demo_report.Story(simulated=False)
        self.assertFalse(story.over(100.0))
        story.add_status(status(stamp=10.0), 100.0)
        story.add_status(status(stamp=10.1), 101.0)
        story.add_status(status(stamp=10.1), 105.0)
        self.assertFalse(story.over(103.0))
        self.assertTrue(story.over(105.0))

    def test_the_line_names_the_link(self):
        story = demo_report.Story(simulated=False)
        self.assertEqual(story.line(), "waiting for the monitor")
        story.add_status(status(), 0.0)
        for expected in ("STOP", "COLLISION_AHEAD (hand)", "42", "30.5 ms"):
            self.assertIn(expected, story.line())


class RefusalTest(unittest.TestCase):
    def refusal(self, text):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder) / "roslaunch.log"
            log.write_text(text, encoding="utf-8")
            return demo_report.refusal_in(log)

    def test_a_nodelet_that_refuses_to_start_is_found_in_the_log(self):
        line = "/collision_checker refuses to start: link 'hand': hand.stl: no such file"
        self.assertEqual(self.refusal(f"[ INFO] [1.0]: hello\n\x1b[31m[FATAL] [1.5]: {line}\x1b[0m\n"),
                         line[1:])

    def test_a_log_without_one_or_no_log_is_none(self):
        self.assertIsNone(self.refusal("[ INFO] [1.0]: hello\n"))
        self.assertIsNone(demo_report.refusal_in(pathlib.Path("/no/such/log")))


class TerminalTest(unittest.TestCase):
    def test_a_file_gets_a_line_only_when_something_happens(self):
        out = io.StringIO()
        terminal = demo_report.Terminal(out)
        for line, event in (("one", 1), ("two", 1), ("three", 2)):
            terminal.show(line, event)
        self.assertEqual(out.getvalue(), "one\nthree\n")


if __name__ == "__main__":
    unittest.main()
