"""What stands in config/default.yaml and docs/parameters.md is what the tables in the code say."""

import os
import pathlib
import subprocess
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("TCCM_PRINT_PARAMETERS")


@unittest.skipUnless(PROGRAM, "needs the program in TCCM_PRINT_PARAMETERS")
class PrintParametersTest(unittest.TestCase):
    def assert_prints(self, path, *arguments):
        done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, (REPOSITORY / path).read_text(),
                         "run scripts/generate_parameters")

    def test_the_default_file(self):
        self.assert_prints("config/default.yaml")

    def test_the_page_of_parameters(self):
        self.assert_prints("docs/parameters.md", "--page")
        done = subprocess.run([PROGRAM, "--page"], capture_output=True, text=True, check=True)
        self.assertIn("| `cell_size_m` | `0.02` | m | 0.001 to 1 |  | edge of a cell |\n", done.stdout)
        self.assertIn("| `check_occlusion` | `true` |  |  | yes | ", done.stdout)


if __name__ == "__main__":
    unittest.main()
