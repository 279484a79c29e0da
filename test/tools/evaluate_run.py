"""What the tests of the program `evaluate` share: they run it, and hold what it wrote against itself."""
import csv
import filecmp
import json
import os
import subprocess
import tempfile
import unittest

from made_bag import CONFIG

HERE = os.path.dirname(os.path.abspath(__file__))
CONFIGS = os.path.join(HERE, "..", "..", "config")


class EvaluateTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def text(self, name, content):
        with open(self.path(name), "w") as f:
            f.write(content)
        return self.path(name)

    def call(self, *arguments):
        return subprocess.run([os.environ["TCCM_EVALUATE"], *arguments], capture_output=True,
                              text=True, timeout=300)

    def evaluate(self, bag, out="out", config=None, urdf=None, status=0, recording=None):
        """What it printed is kept in `done`. @param status that it has to end with. @param recording
        arguments in place of the bag.
        @return the summary; dumps lie beside it."""
        out = self.path(out)
        os.makedirs(out)
        arguments = ["--out", out, "--config", config or self.text("config.yaml", CONFIG)]
        arguments += recording or ["--bag", bag]
        arguments += ["--urdf", urdf] if urdf else []
        packages = os.path.join(os.path.dirname(urdf or ""), "packages")
        arguments += ["--package-path", packages] if os.path.isdir(packages) else []
        for dump in ("points", "cuboids", "verdicts", "visibility"):
            arguments += [f"--dump-{dump}", os.path.join(out, dump + ".csv")]
        done = self.call(*arguments)
        self.done = done
        self.assertEqual(done.returncode, status, done.stderr)
        if status == 0:
            for line in done.stderr.splitlines():  # what of a robot is taken otherwise than it stands
                self.assertTrue(line.startswith("evaluate: warning: link '"), line)
        with open(os.path.join(out, "summary.json")) as f:
            summary = json.load(f)
        self.assertAddsUp(summary)
        return summary

    def rows(self, dump, out="out"):
        with open(self.path(os.path.join(out, dump + ".csv"))) as f:
            return list(csv.DictReader(f))

    def assertAddsUp(self, summary):
        self.assertEqual(summary["scans"] + sum(summary["scans_dropped"].values()),
                         summary["scans_received"])
        points = dict(summary["points"])
        self.assertEqual(points.pop("measured"), sum(points.values()))
        for level in ("slow", "stop"):
            shares = summary["sight"][level + "_by_reason"].values()
            self.assertAlmostEqual(sum(shares), summary[level + "_fraction"] or 0.0, places=5)

    def assertSightAddsUp(self, summary, out="out"):
        """The dumps say the same as the section "sight"."""
        sight, rows = summary["sight"], self.rows("visibility", out)
        self.assertEqual(sight["held"]["last"], sum(c["held"] == "1" for c in self.rows("cuboids", out)))
        verdicts = self.rows("verdicts", out)
        for reason in {row["reason"] for row in verdicts}:
            stops = sum(row["stop"] == "1" and row["reason"] == reason for row in verdicts)
            self.assertAlmostEqual(sight["stop_by_reason"].get(reason, 0.0), stops / len(verdicts), places=5)
        oldest = {}
        for row in rows:
            if row["visible"]:
                shares = [float(row[share]) for share in ("visible", "occluded", "unseen")]
                self.assertAlmostEqual(sum(shares), 1.0, places=5)
            if row["ahead"] == "1":
                self.assertEqual((row["way_unseen"], row["evidence_age_s"], row["next_look_s"]), ("", "", ""))
            elif row["evidence_age_s"]:
                # Several checks may have one stamp, and are alike then but for their scan.
                check = row["stamp"], row["scan"]
                oldest[check] = max(oldest.get(check, 0.0), float(row["evidence_age_s"]))
        self.assertAlmostEqual(sight["evidence_age_s"]["max"], max(oldest.values()), places=5)

    def assertSameFiles(self, one, other, sensor=None):
        """@param sensor where several have names."""
        of_sensor = "." + sensor if sensor else ""
        summaries = []
        for out in (one, other):
            with open(self.path(os.path.join(out, "summary.json"))) as f:
                summaries.append(json.load(f))
        self.assertEqual(json.dumps(summaries[0]), json.dumps(summaries[1]))
        for dump in (f"points{of_sensor}.csv", f"cuboids{of_sensor}.csv", "verdicts.csv",
                     "visibility.csv"):
            a, b = self.path(os.path.join(one, dump)), self.path(os.path.join(other, dump))
            self.assertTrue(filecmp.cmp(a, b, shallow=False), dump)

    def assertMapCanBeRecomputed(self, out="out", sensor=None):
        """@param sensor where several have names."""
        out = self.path(out)
        dot_sensor = "." + sensor if sensor else ""
        files = ("summary.json", f"points{dot_sensor}.csv", f"cuboids{dot_sensor}.csv")
        done = subprocess.run(["/usr/bin/python3", os.path.join(HERE, "recompute_cuboids.py"),
                               *[os.path.join(out, f) for f in files], *([sensor] if sensor else [])],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
