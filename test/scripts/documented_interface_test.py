"""Every topic, service, message field, parameter, program and reason is defined in one page of docs/.

A name is defined where a row of a table begins with it in backticks. The head of the table's first
column says what kind of name it is: topic, service, field, constant, parameter, program or reason.
A field or constant stands below the heading of its message.
"""

import pathlib
import re
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from program import REPOSITORY, load  # noqa: E402

generate_messages_page = load("generate_messages_page")

README_BYTES = 8192
# The pages in which names of each kind may be defined.
PAGES = {"topic": ("interfaces.md",), "service": ("interfaces.md",),
         "field": ("messages.md",), "constant": ("messages.md",),
         "parameter": ("parameters.md",), "program": ("offline.md",), "reason": ("failures.md",)}
# Of tables whose rows begin with backticks and define none of these.
OTHER_HEADS = ("option", "action", "key of a region", "key of a controller")

PUBLISHED = re.compile(r'(?:\badvertise(?:Counting)?|\bsubscribe|\bhear|SubscribeOptions::create|'
                       r'Publisher|Subscriber)'
                       r'(?:<[^<>()]*>)?\(\s*(?:\w+(?:\(\))?,\s*)?"([^"/][^"]*)"')
SERVED = re.compile(r'(?:\badvertiseService(?:<[^<>()]*>)?\(|\bserve\(\s*\w+(?:\(\))?,)'
                    r'\s*"([^"/][^"]*)"')
ENTRY = re.compile(r"^\s*[\w/]+(?:\[\d*\])?\s+(\w+)\s*(=?)", re.MULTILINE)
LINK = re.compile(r"\]\(([^()\s]+)\)")


def read(path):
    return path.read_text(encoding="utf-8")


def sources(*patterns):
    """@return the text of all files that match."""
    return "\n".join(read(path) for pattern in patterns for path in sorted(REPOSITORY.glob(pattern)))


def topics():
    return set(PUBLISHED.findall(sources("src/nodelets/*.[ch]*", "src/ros/*.[ch]*", "simulation/*.cpp",
                                         "examples/*.py")))


def services():
    return set(SERVED.findall(sources("src/nodelets/*.[ch]*", "src/ros/*.[ch]*")))


def entries(constant):
    """Message.field, or Message.CONSTANT."""
    found = set()
    for path in [*REPOSITORY.glob("msg/*.msg"), *REPOSITORY.glob("srv/*.srv")]:
        text = re.sub("#.*", "", read(path))
        found |= {f"{path.stem}.{name}" for name, equals in ENTRY.findall(text)
                  if bool(equals) == constant}
    return found


def programs():
    text = sources(*(f"{room}/CMakeLists.txt"
                     for room in ("src", "tools", "simulation", "experiments", "examples")),
                   "cmake/*.cmake")
    scripts = " ".join(re.findall(r"catkin_install_python\(PROGRAMS([^)]*?)DESTINATION", text))
    return (set(re.findall(r"add_executable\((\w+)", text)) |
            {pathlib.PurePath(script).name for script in scripts.split()})


def reasons():
    return set(re.findall(r'"([A-Z_]+)"', sources("src/check/verdict.cpp"))) - {"UNKNOWN"}


def pages():
    return sorted((REPOSITORY / "docs").glob("*.md"))


def definitions(page):
    """Yields the kind and the name for each row that begins with a name; kind as the table says."""
    heading, kind, above = "", None, ""
    for line in read(page).splitlines():
        if line.startswith("#"):
            heading = line.lstrip("#").strip()
        elif line.startswith("|") and not above.startswith("|"):
            kind = line.split("|")[1].strip()
        elif row := re.match(r"\|\s*`([^`]+)`", line):
            yield kind, f"{heading}.{row[1]}" if kind in ("field", "constant") else row[1]
        above = line


def defined(kind):
    """@return by name, the pages in which names of that kind are defined."""
    found = {}
    for page in pages():
        for its_kind, name in definitions(page):
            if its_kind == kind:
                found.setdefault(name, set()).add(page.name)
    return found


def anchors(page):
    """As GitHub makes them of headings."""
    found = {}
    text = re.sub(r"^```.*?^```", "", read(page), flags=re.MULTILINE | re.DOTALL)
    for heading in re.findall(r"^#+ +(.*?) *$", text, re.MULTILINE):
        shown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        anchor = re.sub(r"[^\w\- ]", "", shown).replace(" ", "-")
        found[anchor] = found.get(anchor, -1) + 1
    return {anchor if i == 0 else f"{anchor}-{i}"
            for anchor, last in found.items() for i in range(last + 1)}


def defect_of(link, page):
    """@return what is wrong with a relative link; empty where it leads somewhere."""
    file, _, anchor = link.partition("#")
    target = (page.parent / file).resolve() if file else page
    if not target.exists():
        return "there is no such file"
    if anchor and anchor not in anchors(target):
        return "there is no such heading"
    return ""


def defects_of(kind, names):
    """@return a line for each name that is not defined once, or is defined and does not exist."""
    where = defined(kind)
    for name in sorted(names | set(where)):
        found = sorted(where.get(name, ()))
        if name not in names:
            yield f"{kind} '{name}' in {', '.join(found)}: no source has it"
        elif len(found) != 1 or found[0] not in PAGES[kind]:
            yield (f"{kind} '{name}' is defined in {', '.join(found) or 'no page'}, "
                   f"not in one of {', '.join(PAGES[kind])} alone")


class DefinitionTest(unittest.TestCase):
    maxDiff = None

    def expect_defined_once(self, kind, names):
        self.assertTrue(names, f"no {kind} was found in the sources")
        self.assertEqual(list(defects_of(kind, names)), [])

    def test_every_topic_is_defined_in_one_page(self):
        self.expect_defined_once("topic", topics())

    def test_every_service_is_defined_in_one_page(self):
        self.expect_defined_once("service", services())

    def test_every_message_field_is_defined_in_one_page(self):
        self.expect_defined_once("field", entries(constant=False))
        self.expect_defined_once("constant", entries(constant=True))

    def test_every_parameter_is_defined_in_one_page(self):
        page = REPOSITORY / "docs" / "parameters.md"
        if not page.exists():
            self.skipTest("docs/parameters.md is not there yet")
        rows = set(re.findall(r"^\| `(\w+)`", read(page), re.MULTILINE))
        self.expect_defined_once("parameter", rows)

    def test_every_program_is_defined_in_one_page(self):
        self.expect_defined_once("program", programs())

    def test_every_reason_is_defined_in_one_page(self):
        self.expect_defined_once("reason", reasons())

    def test_every_table_of_names_says_what_they_are(self):
        self.assertEqual([(page.name, kind, name) for page in pages()
                          for kind, name in definitions(page)
                          if kind not in (*PAGES, *OTHER_HEADS)], [])


class PagesTest(unittest.TestCase):
    maxDiff = None

    def test_the_page_of_messages_is_what_their_comments_make_of_it(self):
        self.assertEqual(generate_messages_page.main(["--check"]), 0)

    def test_the_readme_is_short(self):
        self.assertLessEqual(len((REPOSITORY / "README.md").read_bytes()), README_BYTES)

    def test_the_readme_leads_to_every_page(self):
        links = {link.partition("#")[0] for link in LINK.findall(read(REPOSITORY / "README.md"))}
        self.assertEqual([page.name for page in pages() if f"docs/{page.name}" not in links], [])

    def test_no_link_is_broken(self):
        broken = []
        for page in [REPOSITORY / "README.md", REPOSITORY / "CONTRIBUTING.md", *pages()]:
            for link in LINK.findall(read(page)):
                defect = "" if re.match(r"[a-z]+:", link) else defect_of(link, page)
                if defect:
                    broken.append(f"{page.name}: {link}: {defect}")
        self.assertEqual(broken, [])


if __name__ == "__main__":
    unittest.main()
