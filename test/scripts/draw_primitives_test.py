"""The picture of primitives over meshes."""

import pathlib
import sys
import tempfile
import unittest

import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

draw_primitives = load("draw_primitives")

POSE = [[1, 0, 0, 1.0], [0, 1, 0, 2.0], [0, 0, 1, 3.0]]
PRIMITIVES = [{"shape": "box", "size": [0.2, 0.4, 0.6], "pose": POSE},
              {"shape": "cylinder", "radius": 0.1, "length": 0.6, "pose": POSE},
              {"shape": "capsule", "radius": 0.1, "length": 0.6, "pose": POSE},
              {"shape": "sphere", "radius": 0.3, "pose": POSE}]
# Half of the upright box around each.
EXTENTS = ([0.1, 0.2, 0.3], [0.1, 0.1, 0.3], [0.1, 0.1, 0.4], [0.3, 0.3, 0.3])


class SurfaceTest(unittest.TestCase):
    def test_every_primitive_is_drawn_at_its_place_in_its_size(self):
        for primitive, extents in zip(PRIMITIVES, EXTENTS):
            with self.subTest(primitive["shape"]):
                points = draw_primitives.surface(primitive).reshape(-1, 3)
                numpy.testing.assert_allclose(points.max(0), numpy.add([1, 2, 3], extents))
                numpy.testing.assert_allclose(points.min(0), numpy.subtract([1, 2, 3], extents))


class PictureTest(unittest.TestCase):
    def test_a_picture_is_drawn_with_and_without_meshes(self):
        mesh = {"vertices": [[1, 2, 3], [1.1, 2, 3], [1, 2.1, 3]], "triangles": [[0, 1, 2]]}
        with tempfile.TemporaryDirectory() as folder:
            for meshes in ([], [mesh]):
                path = pathlib.Path(folder) / f"{len(meshes)}.png"
                draw_primitives.draw({"robot": "r", "meshes": meshes, "primitives": PRIMITIVES}, path)
                self.assertGreater(path.stat().st_size, 10000)


if __name__ == "__main__":
    unittest.main()
