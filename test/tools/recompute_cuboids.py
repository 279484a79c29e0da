#!/usr/bin/python3
"""Recomputes the map of evaluate's dumps by uniting part maps, and compares.

A point at height z covers (z - thickness, z] of the cell that floor((x - origin) / cell_size) names,
nothing below the least height of the area, and at least the first quantum above it; the map after the last scan is the union over the last window_scans scans.

usage: recompute_cuboids.py summary.json points.csv cuboids.csv [sensor]
"""
import csv
import json
import math
import sys
from collections import defaultdict


def union(points_path, grid):
    """{cell: [[bottom, top], ...]} in height quanta, of the last scans of the window."""
    with open(points_path) as f:
        points = [(int(p["scan"]), float(p["x"]), float(p["y"]), float(p["z"])) for p in csv.DictReader(f)]
    quantum, size = grid["height_quantum_m"], grid["cell_size_m"]
    thickness = round(grid["thickness_m"] / quantum)
    lowest = math.ceil(grid["height_limits_m"][0] / quantum - 1e-6)
    columns = defaultdict(list)
    # The last scan is the last that was mapped, also where it brought no point.
    first = grid["last_scan"] - grid["window_scans"] + 1
    for scan, x, y, z in points:
        if scan >= first:
            cell = tuple(math.floor((p - origin) / size) for p, origin in zip((x, y), grid["origin_m"]))
            columns[cell].append(round(z / quantum))
    result = {}
    for cell, tops in columns.items():
        runs = []
        for height in sorted(tops):
            bottom, top = max(height - thickness, lowest), max(height, lowest + 1)
            if runs and bottom <= runs[-1][1]:
                runs[-1][1] = top
            else:
                runs.append([bottom, top])
        result[cell] = runs
    return result


def dumped(cuboids_path, grid):
    columns = defaultdict(list)
    with open(cuboids_path) as f:
        for c in csv.DictReader(f):
            if c["held"] == "0":
                cell = tuple(math.floor((float(c[k]) - origin) / grid["cell_size_m"])
                             for k, origin in zip("xy", grid["origin_m"]))
                columns[cell].append([round(float(c[k]) / grid["height_quantum_m"]) for k in ("bottom", "top")])
    return {cell: sorted(runs) for cell, runs in columns.items()}


def main(summary_path, points_path, cuboids_path, sensor=None):
    with open(summary_path) as f:
        summary = json.load(f)
    grid = (summary["sensors"][sensor] if sensor else summary)["map"]
    expected, got = union(points_path, grid), dumped(cuboids_path, grid)
    wrong = sorted(c for c in expected.keys() | got.keys() if expected.get(c) != got.get(c))
    for cell in wrong[:10]:
        print(f"cell {cell}: united {expected.get(cell)}, dumped {got.get(cell)}")
    print(f"{sum(map(len, expected.values()))} cuboids united, {sum(map(len, got.values()))} dumped, "
          f"{len(wrong)} cells differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
