"""Code, config/default.yaml and README.md name the same parameters with the same defaults."""

import pathlib
import re
import sys
import unittest

import yaml

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY  # noqa: E402

SECTIONS = ("monitored_robot", "tilt_scan_assembler", "tccm_mapper", "collision_checker")


def read_keys():
    source = (REPOSITORY / "src" / "ros" / "settings.cpp").read_text(encoding="utf-8")
    uses = (REPOSITORY / "include/tccm_monitor/robot/link_use.h").read_text(encoding="utf-8")
    return (set(re.findall(r'parameters\.read\("(\w+)"', source)) |
            set(re.findall(r'"(\w+)"[,}]', uses)))


def shipped_defaults():
    return yaml.safe_load((REPOSITORY / "config" / "default.yaml").read_text(encoding="utf-8"))


def documented(section):
    """Default by key, from the README's table of that section."""
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    text = readme.split(f"### {section}\n")[1].split("\n#")[0].split("\n\nShipped")[0]
    return {key: yaml.safe_load(default)
            for key, default in re.findall(r"^\| `(\w+)` \| `(.*?)` \|", text, re.MULTILINE)}


class DocumentedParametersTest(unittest.TestCase):
    def test_the_default_file_names_every_parameter_that_is_read(self):
        defaults = shipped_defaults()
        named = set().union(*(defaults[section] for section in SECTIONS))
        self.assertEqual(named, read_keys())

    def test_the_readme_has_the_default_file_s_values(self):
        for section in SECTIONS:
            with self.subTest(section):
                self.assertEqual(documented(section), shipped_defaults()[section])


if __name__ == "__main__":
    unittest.main()
