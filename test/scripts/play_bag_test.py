"""Time and transforms as play_bag makes them."""

import pathlib
import sys
import types
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

play_bag = load("play_bag")


def message(seconds):
    stamp = types.SimpleNamespace(to_sec=lambda: seconds)
    return types.SimpleNamespace(header=types.SimpleNamespace(stamp=stamp))


def transforms(*children):
    return types.SimpleNamespace(
        transforms=[types.SimpleNamespace(child_frame_id=child) for child in children])


class StampClockTest(unittest.TestCase):
    def test_it_shows_the_newest_stamp_of_its_topics_and_never_goes_back(self):
        clock = play_bag.StampClock({"/scan", "/joint_states"})
        self.assertIsNone(clock.advance("/tf", None))
        self.assertIsNone(clock.advance("/scan", message(0.0)))
        self.assertEqual(clock.advance("/scan", message(5.0)), 5.0)
        self.assertEqual(clock.advance("/joint_states", message(4.9)), 5.0)
        self.assertEqual(clock.advance("/tf", None), 5.0)
        self.assertEqual(clock.advance("/joint_states", message(5.1)), 5.1)


class PaceTest(unittest.TestCase):
    def test_stamps_are_due_at_the_rate_asked_for(self):
        now = [100.0]
        pace = play_bag.Pace(2.0, lambda: now[0])
        self.assertEqual(pace.wait_for(7.0), 0.0)
        self.assertAlmostEqual(pace.wait_for(8.0), 0.5)
        now[0] = 103.0
        self.assertEqual(pace.wait_for(8.0), 0.0)


class TransformsTest(unittest.TestCase):
    def test_static_transforms_add_up(self):
        static = play_bag.StaticTransforms()
        static.add(transforms("a"))
        both = static.add(transforms("b", "a"))
        self.assertEqual([t.child_frame_id for t in both.transforms], ["a", "b"])

    def test_frames_lose_their_slash(self):
        self.assertEqual(play_bag.child_frames(transforms("/laser", "arm").transforms),
                         {"laser", "arm"})


if __name__ == "__main__":
    unittest.main()
