"""Projects that depend on this one build and run: beside its build, on its install, without ROS."""

import os
import pathlib
import platform
import re
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
BUILD = pathlib.Path(os.environ.get("TCCM_BUILD", REPOSITORY / "build"))
DEVEL = pathlib.Path(os.environ.get("TCCM_DEVEL", BUILD / "devel"))
SAID = ["0.00 s: stop: INIT", "1.36 s: go: CLEAR", "3.00 s: stop: COLLISION ball touches the map"]


def run(*command):
    done = subprocess.run([str(part) for part in command], text=True, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, command))}:\n{done.stdout[-3000:]}")
    return done.stdout


@unittest.skipUnless((BUILD / "CMakeCache.txt").exists(), "needs the build folder in TCCM_BUILD")
class DownstreamTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def build(self, project, prefix):
        out = self.folder / "downstream"
        run("cmake", "-S", HERE / project, "-B", out, f"-DCMAKE_PREFIX_PATH={prefix}")
        run("make", "-C", out)
        return out

    def assert_watches(self, program):
        lines = run(program).splitlines()
        self.assertEqual(len(lines), len(SAID), lines)
        for line, said in zip(lines, SAID):
            self.assertTrue(line.startswith(said), line)

    def assert_package_works(self, prefix):
        programs = self.build("catkin_package", prefix) / "devel/lib/watch_a_ball"
        self.assertEqual(run(programs / "permission_is_a_message"), "stop\n")
        self.assert_watches(programs / "watch_a_ball")

    def test_a_package_beside_this_one(self):
        self.assert_package_works(DEVEL)

    def test_a_package_on_the_installed_one(self):
        # catkin's own scripts go to the configured prefix, whatever --prefix says.
        run("env", f"DESTDIR={self.folder}", "cmake", "--install", BUILD)
        cache = (BUILD / "CMakeCache.txt").read_text()
        prefix = re.search("^CMAKE_INSTALL_PREFIX:PATH=/(.*)$", cache, re.MULTILINE).group(1)
        self.assert_package_works(self.folder / prefix)

    def test_a_project_without_ros_on_the_core_alone(self):
        core, installed = BUILD / "core_alone", self.folder / "install"
        run("cmake", "-S", REPOSITORY, "-B", core, "-DTCCM_MONITOR_ROS=OFF", "-DBUILD_TESTING=OFF",
            "-DCMAKE_BUILD_TYPE=None")  # compiles in half the time
        run("make", "-C", core, f"-j{os.cpu_count()}")
        run("cmake", "--install", core, "--prefix", installed)
        self.assert_watches(self.build("cmake_project", installed) / "watch_a_ball")

    @unittest.skipUnless(platform.machine() == "x86_64", "other processors have other instructions")
    def test_what_is_built_runs_on_a_processor_without_avx(self):
        built = [path for path in (*DEVEL.glob("lib/*.so"), *DEVEL.glob("lib/tccm_monitor/*"))
                 if path.read_bytes()[:4] == b"\x7fELF" and not re.search("_tests?$", path.name)]
        self.assertGreater(len(built), 5)
        for path in built:
            with self.subTest(path=path.name):
                code = run("objdump", "-d", "--no-show-raw-insn", path)
                self.assertTrue("%rsp" in code, "it is disassembled")
                self.assertIsNone(re.search("%[yz]mm", code))

    def test_public_headers_need_nothing_beside_them(self):
        headers = sorted((REPOSITORY / "include/tccm_monitor").glob("*.h"))
        self.assertTrue(0 < len(headers) <= 12, len(headers))
        for header in headers:
            with self.subTest(header=header.name):
                for line in header.read_text().splitlines():
                    if line.startswith('#include "'):
                        self.assertTrue(line.startswith('#include "tccm_monitor/'), line)

    def test_the_page_of_the_library_shows_the_program(self):
        page = (REPOSITORY / "docs/cpp_api.md").read_text()
        self.assertIn((HERE / "watch_a_ball.cpp").read_text(), page)


if __name__ == "__main__":
    unittest.main()
