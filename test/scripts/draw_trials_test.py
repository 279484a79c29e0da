"""The pictures of trials."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

draw_trials = load("draw_trials")

HOVER = """kind,seed,gap_m,outcome,left_m,held_max
hover,1,0.07,stopped,0.03,100
hover,2,0.09,touched,0.0,120
ghost,1,,gone,,50
"""
VISIBILITY = """link,counted,true_visible,visible,difference
palm,1,0.5,0.45,-0.05
elbow,1,1.0,1.0,0.0
elbow,0,1.0,0.0,-1.0
"""
OCCLUSION = """hidden,occluded,found_s
0.5,0.6,0.2
0.3,0.1,
,,
"""
SPEEDS = """tilt_deg,constant_mps,governed_mps,phase_0_mps,phase_1_mps
15.0,0.09,0.12,0.1,0.14
20.0,0.10,0.13,0.11,0.15
"""
HANDS = {"hands": [{"from": "side", "hand_mps": 0.5, "tilt_period_s": 1.575, "trials": 4,
                    "seen_before_contact": 3, "stopped_before_contact": 1,
                    "touched_in_motion": 2}]}


class PictureTest(unittest.TestCase):
    def pictures(self, experiment, rows, settings=None, speeds=SPEEDS, figures=None):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            results = {"experiment": experiment, "settings": settings or {},
                       "figures": figures or {}}
            (folder / "results.json").write_text(json.dumps(results), encoding="utf-8")
            (folder / "results.csv").write_text(rows, encoding="utf-8")
            if speeds is not None:
                (folder / "speeds.csv").write_text(speeds, encoding="utf-8")
            return [(path.name, path.stat().st_size) for path in draw_trials.draw(folder)]

    def test_every_experiment_has_its_picture(self):
        for experiment, rows, settings in (("hover", HOVER, {"hold_s": 10.0}),
                                           ("visibility", VISIBILITY, None),
                                           ("governed", "seed\n", {"distance_m": 0.15})):
            with self.subTest(experiment):
                (name, size), = self.pictures(experiment, rows, settings)
                self.assertEqual(name, experiment + ".png")
                self.assertGreater(size, 10000)

    def test_hands_have_theirs(self):
        (name, size), = self.pictures("hands", "seed\n1\n", figures=HANDS)
        self.assertEqual(name, "hands.png")
        self.assertGreater(size, 10000)
        self.assertEqual(self.pictures("hands", "seed\n", figures={"hands": []}), [])

    def test_false_stops_and_occluders_have_theirs(self):
        cells = [{"noise_m": 0.01, "motions": 10, "motions_with_false_stop": 1}]
        (name, size), = self.pictures("false-stops", "seed\n1\n", figures={"by_noise": cells})
        self.assertEqual(name, "false-stops.png")
        self.assertGreater(size, 5000)
        (name, size), = self.pictures("occlusion", OCCLUSION)
        self.assertEqual(name, "occlusion.png")
        self.assertGreater(size, 10000)
        self.assertEqual(self.pictures("occlusion", OCCLUSION.splitlines()[0]), [])

    def test_where_nothing_was_tried_nothing_is_drawn(self):
        for experiment, rows in (("hover", HOVER), ("visibility", VISIBILITY)):
            self.assertEqual(self.pictures(experiment, rows.splitlines()[0]), [])
        for speeds in (SPEEDS.splitlines()[0], None):
            self.assertEqual(self.pictures("governed", "seed\n", speeds=speeds), [])


if __name__ == "__main__":
    unittest.main()
