"""Where scripts/install_dependencies takes packages from. Nothing is installed: apt-get and rosdep
are functions that say what they were called with."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY  # noqa: E402

PACKAGES = REPOSITORY / "scripts" / "packages.txt"
UBUNTU, DEBIAN, MINT = "ID=ubuntu", "ID=debian", 'ID=linuxmint\nID_LIKE="ubuntu debian"'
SET_UP = "export ROS_DISTRO=noetic ROS_VERSION=1"
RUN = f"rosdep install --from-paths {REPOSITORY} --ignore-src -y --rosdistro noetic"


def function(name, body):
    """What bash takes for a function of that name, ahead of all programs."""
    return {f"BASH_FUNC_{name}%%": f"() {{ {body}; }}"}


class InstallTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def ros(self, distro, *parts):
        for part in parts:
            (self.folder / "ros" / distro / part).mkdir(parents=True)
        (self.folder / "ros" / distro / "setup.bash").write_text(SET_UP, encoding="utf-8")

    def run_on(self, system, *, installed=True):
        (self.folder / "os-release").write_text(system, encoding="utf-8")
        listed = f"sed 's/^/installed /' {PACKAGES}" if installed else "true"
        environment = {key: value for key, value in os.environ.items()
                       if key not in ("ROS_DISTRO", "ROS_VERSION")}
        environment.update(TCCM_MONITOR_OS_RELEASE=str(self.folder / "os-release"),
                           TCCM_MONITOR_OPT_ROS=str(self.folder / "ros"),
                           **function("rosdep", 'echo "rosdep $*"'),
                           **function("apt-get", "echo apt-get"), **function("env", "echo apt-get"),
                           **function("sudo", "echo apt-get"), **function("dpkg-query", listed))
        run = subprocess.run([str(REPOSITORY / "scripts" / "install_dependencies")], env=environment,
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stdout.splitlines(), run.stderr.splitlines()

    def expect_refused(self, outcome):
        status, out, error = outcome
        self.assertEqual((status, out, len(error)), (1, [], 1), error)
        self.assertTrue(error[0].endswith(f"run: {RUN}"), error)

    def test_debian_takes_its_own_packages(self):
        self.assertEqual(self.run_on(DEBIAN), (0, ["dependencies: all installed"], []))

    def test_its_last_line_says_that_it_is_done(self):
        status, out, error = self.run_on(DEBIAN, installed=False)
        self.assertEqual((status, out[-1], error), (0, "dependencies: all installed", []))

    def test_ubuntu_without_ros_is_told_what_to_run(self):
        self.expect_refused(self.run_on(UBUNTU))
        self.expect_refused(self.run_on(MINT))

    def test_a_ros_below_opt_takes_what_rosdep_finds(self):
        self.ros("noetic", "share/catkin")
        for system in (UBUNTU, DEBIAN):
            self.assertEqual(self.run_on(system), (0, [RUN], []))

    def test_a_ros_2_below_opt_is_none(self):
        self.ros("humble", "share/ament_index")
        self.assertEqual(self.run_on(DEBIAN)[0], 0)
        self.expect_refused(self.run_on(UBUNTU))


if __name__ == "__main__":
    unittest.main()
