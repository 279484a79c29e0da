"""What scripts/fuzz says of its targets. Nothing is installed or built: cmake and make are functions
that do nothing, and the targets are scripts."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY  # noqa: E402

FUZZ = REPOSITORY / "test" / "fuzz"
PACKAGES = REPOSITORY / "scripts" / "packages.txt"
STATISTICS = "echo 'stat::number_of_executed_units: 1234' >&2"


class FuzzTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "test" / "fuzz").mkdir(parents=True)

    def target(self, name, *lines):
        """One whose corpus folders come last, the one for new inputs first."""
        path = self.folder / "test" / "fuzz" / f"{name}_fuzz"
        path.write_text("\n".join(("#!/usr/bin/env bash", f'echo "$@" >{self.folder}/arguments',
                                   *lines)) + "\n", encoding="utf-8")
        path.chmod(0o755)

    def fuzz(self, *words):
        environment = {**os.environ, "TCCM_MONITOR_BUILD_FUZZ": str(self.folder),
                       "TCCM_MONITOR_OPT_ROS": str(self.folder / "none")}
        (self.folder / "os-release").write_text("ID=debian", encoding="utf-8")
        environment["TCCM_MONITOR_OS_RELEASE"] = str(self.folder / "os-release")
        for name, body in {"cmake": "true", "make": "true", "apt-get": "false",
                           "dpkg-query": f"sed 's/^/installed /' {PACKAGES}"}.items():
            environment[f"BASH_FUNC_{name}%%"] = f"() {{ {body}; }}"
        run = subprocess.run([str(REPOSITORY / "scripts" / "fuzz"), *words], env=environment,
                             capture_output=True, text=True, check=False, timeout=60)
        return run.returncode, run.stdout, run.stderr

    def test_every_target_is_listed_and_built_and_every_corpus_is_replayed(self):
        status, listed, _ = self.fuzz("--list")
        self.assertEqual(status, 0)
        names = listed.split()
        self.assertGreaterEqual(len(names), 12)
        built = (FUZZ / "CMakeLists.txt").read_text(encoding="utf-8").replace(")", " ").split()
        for name in names:
            self.assertIn(name, built)
        replayed = "".join(path.read_text(encoding="utf-8") for path in FUZZ.glob("*_test.cpp"))
        for corpus in (FUZZ / "corpus").iterdir():
            self.assertIn(corpus.name, names)
            self.assertIn(f'replay("{corpus.name}"', replayed)

    def test_a_target_that_finds_nothing_is_told_in_one_line(self):
        self.target("mesh", 'touch "${@: -2:1}/new"', STATISTICS)
        status, out, err = self.fuzz("--minutes", "0.5", "mesh")
        self.assertEqual(status, 0, err)
        self.assertIn("mesh: 1234 executions, 1 new inputs, nothing found\n", out)
        arguments = (self.folder / "arguments").read_text(encoding="utf-8")
        self.assertIn("-max_total_time=30 ", arguments)
        self.assertTrue(arguments.strip().endswith(f"{FUZZ}/corpus/mesh"), arguments)

    def test_a_dictionary_is_handed_over_where_there_is_one(self):
        self.target("config", STATISTICS)
        self.assertEqual(self.fuzz("config")[0], 0)
        arguments = (self.folder / "arguments").read_text(encoding="utf-8")
        self.assertIn(f"-dict={FUZZ}/config.dict", arguments)

    def test_a_finding_is_told_with_its_file_and_the_promise_and_fails(self):
        self.target("scans", "echo 'broken promise: the map is not the union' >&2",
                    "for word; do case $word in -artifact_prefix=*) "
                    'touch "${word#*=}crash-1" ;; esac; done', STATISTICS, "exit 77")
        self.target("maps", STATISTICS)
        status, out, _ = self.fuzz("scans", "maps")
        self.assertEqual(status, 1)
        self.assertIn(f"scans: 1234 executions, 0 new inputs, FOUND {self.folder}/findings/scans/"
                      "crash-1: broken promise: the map is not the union\n", out)
        self.assertIn("maps: 1234 executions, 0 new inputs, nothing found\n", out)

    def test_a_target_that_cannot_be_run_fails(self):
        self.target("maps", "exit 1")
        status, out, _ = self.fuzz("maps")
        self.assertEqual(status, 1)
        self.assertIn("maps: it could not be run to its end", out)

    def test_wrong_words_are_refused(self):
        for words in (("nothing",), ("--minutes",), ("--minutes", "0"), ("--minutes", "ten"),
                      ("--minutes", "-1"), ("--fast",)):
            status, out, err = self.fuzz(*words)
            self.assertEqual(status, 2, words)
            self.assertEqual(out, "")
            self.assertTrue(err)
        self.assertIn("maps", self.fuzz("nothing")[2])

    def test_help_names_what_there_is(self):
        status, out, _ = self.fuzz("--help")
        self.assertEqual(status, 0)
        for word in ("--minutes", "--list", "build_fuzz/", "test/fuzz/corpus"):
            self.assertIn(word, out)


if __name__ == "__main__":
    unittest.main()
