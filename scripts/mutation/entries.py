"""The list: what is broken, where, and which tests should find it."""

import dataclasses
import pathlib
import re

from evaluations.entries import Loader, Wrong, read_yaml

FOLDER = pathlib.PurePath("test", "mutations")
NEEDED, OPTIONAL = ("name", "file", "before", "after", "tests"), ("equivalent",)
NAME_MAX = 100
LINE = "line"


@dataclasses.dataclass(frozen=True)
class Mutation:
    """One rule broken."""

    name: str  # the rule as it is then, in a sentence
    room: str  # the file of the list, without suffix
    where: str  # in the list, FILE:LINE
    file: str  # from the repository on
    before: str
    after: str
    tests: tuple
    equivalent: str = ""  # why no test can find it

    @property
    def title(self):
        return f"{self.room}: {self.name}"


class WithLines(Loader):  # pylint: disable=too-many-ancestors
    """Each mapping knows its line."""

    def construct_mapping(self, node, deep=False):
        return dict(super().construct_mapping(node, deep), **{LINE: node.start_mark.line + 1})


def read_list(path):
    listed = read_yaml(path, WithLines)
    if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
        raise Wrong(f"{path}: has to be a list of mutations, each with keys")
    return listed


def defect_of_keys(what):
    """@return what is wrong with an entry's keys, or nothing."""
    for key in what:
        if key not in NEEDED + OPTIONAL + (LINE,):
            return f"{key}: is no key; there are {', '.join(NEEDED + OPTIONAL)}"
    for key in NEEDED:
        if key not in what:
            return f"{key}: is missing"
    for key in NEEDED[:-1] + OPTIONAL:
        # What comes after may be nothing at all.
        if not isinstance(what.get(key, ""), str) or (key in what and not what[key] and key != "after"):
            return f"{key}: has to be a text"
    tests = what["tests"]
    if not isinstance(tests, list) or not tests or not all(isinstance(test, str) for test in tests):
        return "tests: has to be a list of tests"
    if len(what["name"]) > NAME_MAX or "\n" in what["name"]:
        return f"name: has to be one line of at most {NAME_MAX} characters"
    return None


def known_tests(repository):
    """@return unit tests as make calls them, and rostests by their file."""
    folder = repository / "test"
    names = {str(path.relative_to(folder).with_suffix("")).replace("/", "_") for path in folder.rglob("*_test.cpp")}
    return names | {path.name for path in folder.rglob("*.test")}


def defect_of(mutation, repository, tests):
    """@return why it cannot be applied as the sources are, or nothing."""
    path = repository / mutation.file
    if ".." in pathlib.PurePath(mutation.file).parts or not path.is_file():
        return f"file: there is no {mutation.file}"
    count = path.read_text(encoding="utf-8").count(mutation.before)
    if count != 1:
        return f"before: it stands {count} times in {mutation.file}, and has to once"
    if mutation.before == mutation.after:
        return "after: it is what is there before"
    unknown = [test for test in mutation.tests if test not in tests]
    return f"tests: there is no {unknown[0]}" if unknown else None


def of_file(path, repository):
    """@return mutations, and what is wrong with others, a line each."""
    mutations, defects = [], []
    tests = known_tests(repository)
    for what in read_list(path):
        where = f"{path.relative_to(repository)}:{what[LINE]}"
        defect = defect_of_keys(what)
        if not defect:
            fields = {key: what[key] for key in NEEDED + OPTIONAL if key in what}
            mutation = Mutation(**dict(fields, tests=tuple(what["tests"]), room=path.stem, where=where))
            defect = defect_of(mutation, repository, tests)
            where += f": {mutation.name}"
        if defect:
            defects.append(f"{where}: {defect}")
        else:
            mutations.append(mutation)
    return mutations, defects


def read(repository):
    """@return all mutations, room by room. @raises Wrong with a line for each defect."""
    mutations, defects = [], []
    files = sorted((repository / FOLDER).glob("*.yaml"))
    for path in files:
        found, wrong = of_file(path, repository)
        mutations += found
        defects += wrong
    names = [mutation.name for mutation in mutations]
    defects += [f"{mutation.where}: name: another has it too: {mutation.name}"
                for place, mutation in enumerate(mutations) if mutation.name in names[:place]]
    if defects:
        raise Wrong("\n".join(defects))
    if not mutations:
        raise Wrong(f"{repository / FOLDER}: there are no mutations")
    return mutations


def select(mutations, asked):
    """@param asked rooms, names or parts of names; none: all. @raises Wrong"""
    if not asked:
        return mutations
    chosen = set()
    for word in asked:
        found = {one for one in mutations if word in (one.room, one.name)}
        found = found or {one for one in mutations if re.search(re.escape(word), one.name, re.IGNORECASE)}
        if not found:
            rooms = ", ".join(sorted({one.room for one in mutations}))
            raise Wrong(f"{word}: no mutation has that in its name; rooms are {rooms}")
        chosen |= found
    return [one for one in mutations if one in chosen]
