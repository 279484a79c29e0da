"""Primitives and cuboids as triangles, and where to look at them from."""

import numpy

MAP_VIEW = (40, 45)  # towards the robot, which stands behind what it looks at
TURNS = 20  # facets around a round primitive


def turned(profile):
    """Vertices and triangles of what a profile of (radius, height) makes around z."""
    angles = numpy.arange(TURNS) * 2.0 * numpy.pi / TURNS
    rings = [numpy.stack([r * numpy.cos(angles), r * numpy.sin(angles),
                          numpy.full(TURNS, z)], axis=1) for r, z in profile]
    triangles = []
    for ring in range(len(profile) - 1):
        for k in range(TURNS):
            a, b = ring * TURNS + k, ring * TURNS + (k + 1) % TURNS
            triangles += [(a, b, b + TURNS), (a, b + TURNS, a + TURNS)]
    return numpy.concatenate(rings), numpy.array(triangles)


def round_profile(radius, half_length):
    quarter = numpy.linspace(0.0, 0.5 * numpy.pi, 5)
    return [(radius * numpy.cos(a), side * (radius * numpy.sin(a) + half_length))
            for side, angles in ((-1, quarter[::-1]), (1, quarter)) for a in angles]


def outward(vertices, triangles):
    """The triangles of a convex solid around its frame's origin, counterclockwise seen from
    outside."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    turned_in = numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), a + b + c) < 0.0
    triangles = triangles.copy()
    triangles[turned_in] = triangles[turned_in][:, ::-1]
    return triangles


CORNERS = numpy.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
FACES = numpy.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
                     (2, 6, 7), (2, 7, 3), (1, 3, 7), (1, 7, 5), (0, 4, 6), (0, 6, 2)])
FACES = outward(CORNERS, FACES)


def mesh(kind, size):
    """Vertices [n, 3] in its own frame, and triangles [m, 3]."""
    if kind == "box":
        return CORNERS * numpy.array(size), FACES
    if kind == "cylinder":
        r, z = size
        vertices, triangles = turned([(0.0, -z), (r, -z), (r, z), (0.0, z)])
    else:
        vertices, triangles = turned(round_profile(size[0], size[1] if kind == "capsule" else 0.0))
    return vertices, outward(vertices, triangles)


def placed(shape):
    """Triangles [n, 3, 3] of a primitive in the fixed frame."""
    vertices, triangles = mesh(shape["kind"], shape["size"])
    turn = numpy.array(shape["rotation"]).reshape(3, 3)
    return (vertices @ turn.T + numpy.array(shape["position"]))[triangles]


def boxes(some, over=0.0):
    """Triangles [n, 3, 3] of upright boxes, each larger by so much on every side."""
    if not len(some):
        return numpy.zeros((0, 3, 3))
    some = numpy.asarray(some, dtype=float)
    middle, half = 0.5 * (some[:, :3] + some[:, 3:]), 0.5 * (some[:, 3:] - some[:, :3]) + over
    corners = middle[:, None, :] + half[:, None, :] * CORNERS
    return corners[:, FACES].reshape(-1, 3, 3)


def direction(azimuth, elevation):
    """From what is looked at to who looks; degrees."""
    a, e = numpy.radians(azimuth), numpy.radians(elevation)
    return numpy.array((numpy.cos(e) * numpy.cos(a), numpy.cos(e) * numpy.sin(a), numpy.sin(e)))


def screen(view):
    """Rows: to the right, up, and towards who looks."""
    right = numpy.cross((0.0, 0.0, 1.0), view)
    right /= numpy.linalg.norm(right)
    return numpy.array((right, numpy.cross(view, right), view))


def covering(point, view, some):
    """How many boxes lie before a point."""
    if not len(some):
        return 0
    with numpy.errstate(divide="ignore", invalid="ignore"):
        to_min, to_max = (some[:, :3] - point) / view, (some[:, 3:] - point) / view
    enters = numpy.nanmax(numpy.minimum(to_min, to_max), axis=1)
    leaves = numpy.nanmin(numpy.maximum(to_min, to_max), axis=1)
    return int(numpy.count_nonzero((leaves > numpy.maximum(enters, 0.0)) & (leaves > 0.015)))


def best_view(points, cuboids, shapes, line=None):
    """(azimuth, elevation) from which most of the points are seen. @param line along which the sensor
    looks: it should not be seen from its end."""
    cuboids = numpy.asarray(cuboids, dtype=float).reshape(-1, 6)
    bodies = [placed(shape).reshape(-1, 3) for shape in shapes]
    limbs = numpy.array([numpy.concatenate((body.min(axis=0), body.max(axis=0))) for body in bodies])
    best = None
    for elevation in (22, 38, 55):
        for azimuth in range(-180, 180, 20):
            view = direction(azimuth, elevation)
            hidden = sum(min(covering(point, view, cuboids), 4) + 0.5 * min(covering(
                point, view, limbs), 4) for point in points) / max(1, len(points))
            cost = hidden + 0.01 * elevation + (abs(line @ view) if line is not None else 0.0)
            if best is None or cost < best[0] - 1e-9:
                best = (cost, azimuth, elevation)
    return best[1:]
