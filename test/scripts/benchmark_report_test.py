import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/benchmark_report"

COMPARISON = {"what": "a laser, 20 mm, window 40, 145 returns a scan", "unit": "flat counters",
              "rows": [{"name": "this package", "p50_us": 6.0, "p99_us": 9.0},
                       {"name": "flat counters", "p50_us": 3.0, "p99_us": 4.0},
                       {"name": "OctoMap", "p50_us": 300.0, "p99_us": 900.0}]}
OWN = {"benchmarks": [{"name": "checkWay/free", "p50_us": 350.0, "p99_us": 400.0},
                      {"name": "without percentiles"}]}


class BenchmarkReportTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def report(self, **files):
        paths = []
        for name, content in files.items():
            paths.append(self.folder / f"{name}.json")
            paths[-1].write_text(json.dumps(content), encoding="utf-8")
        return subprocess.run([sys.executable, SCRIPT, "--output", self.folder / "out", *paths],
                              capture_output=True, text=True, check=False)

    def test_what_is_compared_is_told_as_multiples_of_its_unit(self):
        done = self.report(peers=[COMPARISON], own=OWN)
        self.assertEqual(done.returncode, 0, done.stderr)
        for line in (COMPARISON["what"], "2.0 x  this package",
                     "1.0 x  flat counters", "100.0 x  OctoMap"):
            self.assertIn(line, done.stdout)
        self.assertRegex(done.stdout, r"checkWay/free +350\.0 +400\.0")
        self.assertTrue((self.folder / "out/compared.png").stat().st_size > 1000)
        results = json.loads((self.folder / "out/results.json").read_text(encoding="utf-8"))
        self.assertEqual(results["compared"], [COMPARISON])
        self.assertEqual([row["benchmark"] for row in results["own"]], ["checkWay/free"])

    def test_of_the_packages_own_alone_there_is_no_picture(self):
        done = self.report(own=OWN)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse((self.folder / "out/compared.png").exists())

    def test_nothing_measured_is_a_failure(self):
        done = self.report(peers=[])
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing was measured", done.stderr)


if __name__ == "__main__":
    unittest.main()
