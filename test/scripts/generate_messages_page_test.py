"""The page of messages, from made-up definitions."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import load  # noqa: E402

generator = load("generate_messages_page")

PLACE = """# Where a thing is.
#
# It stands there.

uint8 NEAR=0          # nearer
                      # than a metre
float64 distance_m    # from here | there [m]
Thing[] things        # all of them
"""
THING = "# A thing.\nstring name  # its name\n"
ASK = "# Where is it?\nstring name  # of the thing\n---\nPlace place  # where it is\n"


class DefinitionTest(unittest.TestCase):
    def test_a_comment_may_go_on_in_indented_lines(self):
        near, distance, things = generator.Definition("Place", PLACE).entries()
        self.assertEqual((near.name, near.value, near.meaning), ("NEAR", "0", "nearer than a metre"))
        self.assertEqual((distance.type, distance.value), ("float64", None))
        self.assertEqual(things.type, "Thing[]")

    def test_the_first_comment_is_the_description(self):
        self.assertEqual(generator.Definition("Place", PLACE).description,
                         ["Where a thing is.", "It stands there."])

    def refusal(self, text):
        with self.assertRaises(generator.BadComment) as refused:
            generator.Definition("Place", text)
        return str(refused.exception)

    def test_a_field_without_a_comment_is_refused(self):
        self.assertIn("Place: distance_m has no comment", self.refusal("# A.\nfloat64 distance_m\n"))

    def test_a_comment_that_belongs_to_no_field_is_refused(self):
        self.assertIn("line 3", self.refusal("# A.\nbool a  # b\n# Of what follows.\nbool c  # d\n"))

    def test_a_file_without_a_description_is_refused(self):
        self.assertIn("Place", self.refusal("bool a  # b\n"))

    def test_a_line_that_is_no_field_is_refused(self):
        self.assertIn("line 2", self.refusal("# A.\nbool\n"))


class PageTest(unittest.TestCase):
    def page(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for path, text in (("msg/Place.msg", PLACE), ("msg/Thing.msg", THING), ("srv/Ask.srv", ASK)):
                (folder / path).parent.mkdir(exist_ok=True)
                (folder / path).write_text(text, encoding="utf-8")
            return generator.page(folder)

    def test_every_field_and_constant_has_a_row(self):
        for row in ("| `NEAR` | 0 | nearer than a metre |",
                    "| `distance_m` | float64 | from here \\| there [m] |",
                    "| `things` | [Thing](#thing)[] | all of them |",
                    "| `place` | [Place](#place) | where it is |"):
            self.assertIn(f"\n{row}\n", self.page())

    def test_a_service_has_both_halves(self):
        service = self.page().split("### Ask\n")[1]
        self.assertLess(service.index("Request:"), service.index("Response:"))


if __name__ == "__main__":
    unittest.main()
