"""Format, subjects and clang-tidy, in small repositories."""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

check_sources = load("check_sources")

LONG = "Say in so many words what this commit is about that nobody reads to its end"
FAULTY = "int* nothing() { return 0; }\n"  # not nullptr
IDENTITY = {f"GIT_{who}_{what}": "a@b.example" for who in ("AUTHOR", "COMMITTER")
            for what in ("NAME", "EMAIL")}


def installed(tool):
    try:
        return check_sources.clang(tool)
    except check_sources.Skipped:
        return None


class RepositoryTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def git(self, *arguments):
        subprocess.run(["git", "-C", self.folder, *arguments], check=True, capture_output=True,
                       env=dict(os.environ, GIT_CONFIG_GLOBAL="/dev/null", **IDENTITY))

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def commit(self, subject, file="file", text=None):
        if not (self.folder / ".git").exists():
            self.git("init", "-q")
        self.write(file, text or subject)
        self.git("add", ".")
        self.git("commit", "-q", "-m", subject)

    def check(self, *arguments):
        """@return exit status and what was said."""
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            status = check_sources.main(["--repository", str(self.folder), *arguments])
        return int(status), said.getvalue()

    def expect(self, status, text, *arguments):
        done = self.check(*arguments)
        self.assertEqual(done[0], status, done[1])
        self.assertIn(text, done[1])


class SubjectsTest(RepositoryTest):
    def test_a_long_subject_fails_and_is_named(self):
        self.commit("Begin")
        self.expect(0, "passed: 1 commits", "subjects")
        self.commit(LONG)
        self.expect(1, LONG, "subjects")

    def test_without_upstream_the_last_twenty_count(self):
        self.commit(LONG)
        for i in range(20):
            self.commit(f"Change {i}")
        self.expect(0, "passed: 20 commits", "subjects")

    def test_what_upstream_has_is_not_looked_at(self):
        self.commit("Begin")
        self.commit(LONG)
        self.git("update-ref", "refs/remotes/origin/main", "HEAD")
        self.commit("Go on")
        self.expect(0, "passed: 1 commits", "subjects")

    def test_what_is_older_than_the_check_is_not_looked_at(self):
        self.commit(LONG)
        self.commit("Check", "scripts/check_sources")
        self.expect(0, "skipped: no commit", "subjects")
        self.commit("Go on")
        self.expect(0, "passed: 1 commits", "subjects")


class FormatTest(RepositoryTest):
    @unittest.skipUnless(installed("clang-format"), "no clang-format")
    def test_a_file_that_is_not_formatted_fails_and_is_named(self):
        self.commit("Begin", "good.cpp", "int f();\n")
        self.expect(0, "format: passed: 1 files", "format")
        self.commit("Go on", "bad.cpp", "int   f( );\n")
        self.expect(1, "to be formatted: bad.cpp\n", "format")


@unittest.skipUnless(installed("clang-tidy"), "no clang-tidy")
class TidyTest(RepositoryTest):
    def compile(self, *files):
        self.write(".clang-tidy", "Checks: '-*,modernize-use-nullptr'\n")
        self.write("build/compile_commands.json", json.dumps(
            [{"file": str(self.folder / file), "directory": str(self.folder),
              "command": f"c++ -c {self.folder / file}"} for file in files]))

    def test_without_history_it_is_skipped(self):
        self.compile("a.cpp")
        self.commit("Begin", "a.cpp", FAULTY)
        self.expect(0, "skipped: there is no history", "tidy")

    def test_only_what_has_changed_is_looked_at(self):
        self.compile("a.cpp", "b.cpp")
        self.commit("Begin", "a.cpp", FAULTY)
        self.commit("Go on", "b.cpp", "int f();\n")
        self.expect(0, "passed: 1 of 1 changed", "tidy")
        self.write("a.cpp", "\n" + FAULTY)
        self.expect(1, "modernize-use-nullptr", "tidy")

    def test_a_header_is_seen_with_the_source_beside_it(self):
        self.compile("src/a.cpp")
        self.commit("Begin", "src/a.cpp", '#include "a.h"\n')
        self.commit("Go on", "src/a.h", "inline " + FAULTY)
        self.expect(1, "src/a.h:1", "tidy")

    def test_what_is_compiled_as_a_part_of_a_joined_source_is_looked_at_itself(self):
        self.compile("build/test/joined/tests_0.cpp")
        self.commit("Begin", "test/a_test.cpp", "int f();\n")
        self.commit("Go on", "test/a_test.cpp", FAULTY)
        self.write("build/test/joined/tests_0.cpp",
                   f'#line 1 "{self.folder / "test/a_test.cpp"}"\n{FAULTY}')
        self.expect(1, "test/a_test.cpp:1", "tidy")

    def test_what_exceeds_the_limit_is_named(self):
        self.compile("a.cpp", "b.cpp")
        self.commit("Begin", "a.cpp", "int f();\n")
        self.commit("Go on", "a.cpp", "int g();\n")
        self.write("b.cpp", "int h();\n")
        self.expect(0, "passed: 1 of 2 changed sources, and not: a.cpp", "tidy", "--tidy-files", "1")


class OutcomeTest(RepositoryTest):
    def test_outside_of_a_repository_all_is_skipped(self):
        results = self.folder / "results.xml"
        self.assertEqual(self.check("--results", str(results))[0], 0)
        cases = list(ElementTree.parse(results).getroot())
        self.assertEqual([(case.get("name"), [child.tag for child in case]) for case in cases],
                         [(name, ["skipped"]) for name in ("format", "subjects", "tidy")])

    def test_a_failure_is_one_in_the_results(self):
        self.commit(LONG)
        results = self.folder / "results.xml"
        self.assertEqual(self.check("subjects", "--results", str(results))[0], 1)
        self.assertIn(LONG, ElementTree.parse(results).find("testcase/failure").get("message"))


if __name__ == "__main__":
    unittest.main()
