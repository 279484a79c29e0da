"""Which recordings are evaluated, each with its robot and configuration."""

import os
import pathlib
import re

import yaml

FOLDER_FILE = "evaluate.yaml"
PATHS = ("bag", "clouds", "urdf", "config", "package_path")
OPTIONS = PATHS + ("cloud_rate", "sensor_pose")  # as evaluate has them
OURS = ("results.csv", "results.json", "index.html", "changes.json")
NAME_MAX = 200


class Wrong(Exception):
    """What is asked for cannot be; said in one line."""


class Loader(yaml.SafeLoader):  # pylint: disable=too-many-ancestors
    """No key twice: the first would silently be none."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _value in node.value]
        for position, key in enumerate(keys):
            if key in keys[:position]:
                line = node.value[position][0].start_mark.line + 1
                raise yaml.MarkedYAMLError(problem=f"line {line}: {key} is there twice")
        return super().construct_mapping(node, deep)


def read_yaml(path, loader=Loader):
    try:
        with open(path, encoding="utf-8") as file:
            return yaml.load(file, loader)
    except (OSError, ValueError) as error:
        raise Wrong(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    except (yaml.YAMLError, TypeError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}: " if mark else ""
        raise Wrong(f"{path}: {where}{getattr(error, 'problem', None) or 'is no YAML'}") from error


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def checked_value(key, value):
    """@return what is wrong with it, or None."""
    if key == "cloud_rate":
        return None if is_number(value) else "has to be a number"
    if key == "sensor_pose":
        fits = isinstance(value, list) and len(value) == 6 and all(is_number(one) for one in value)
        return None if fits else "has to be six numbers"
    return None if isinstance(value, str) and value and "\0" not in value else "has to be a text"


def checked_name(name):
    """@return what is wrong with it as that of a folder, or None."""
    if name.startswith(".") or "/" in name or re.search(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]", name):
        return "has to be good for a folder: no / in it, no . before it"
    if name in OURS:
        return "is that of a file of the results"
    return None if len(name.encode("utf-8")) <= NAME_MAX else "is too long"


def options_of(what, where, base, extra=()):
    """@param extra keys. @return evaluate's options; paths are whole."""
    if not isinstance(what, dict):
        raise Wrong(f"{where}: has to have keys with values")
    for key, value in what.items():
        if key not in OPTIONS + tuple(extra):
            raise Wrong(f"{where}: {key}: is no key; there are {', '.join(tuple(extra) + OPTIONS)}")
        wrong = checked_value(key, value)
        if wrong:
            raise Wrong(f"{where}: {key}: {wrong}")
    return {key: os.path.normpath(base / value) if key in PATHS else value for key, value in what.items()
            if key in OPTIONS}


def entry_of(what, where, base):
    """@return name and options."""
    options = options_of(what, where, base, ("name",))
    if ("bag" in options) == ("clouds" in options):
        raise Wrong(f"{where}: bag: either bag or clouds has to be there")
    name = what.get("name") or pathlib.Path(options.get("bag") or options["clouds"]).stem
    wrong = checked_name(name)
    if wrong:
        raise Wrong(f"{where}: name: {wrong}")
    return name, options


def of_list(path):
    listed, base = read_yaml(path), path.resolve().parent
    if not isinstance(listed, list) or not listed:
        raise Wrong(f"{path}: has to be a list of recordings")
    found = {}
    for number, what in enumerate(listed, 1):
        named = what.get("name") if isinstance(what, dict) else None
        where = f"{path}: entry {number}" + (f" ({named})" if isinstance(named, str) and not checked_name(named) else "")
        name, options = entry_of(what, where, base)
        if name in found:
            raise Wrong(f"{where}: name: another entry has it too: {name}")
        found[name] = options
    return found


def of_folder(folder):
    """Each *.bag below it, and what the nearest evaluate.yaml says of it."""
    base, found, known = folder.resolve(), {}, {}
    for path in sorted(base.rglob("*.bag")):
        if not path.is_file():
            continue
        above = [one for one in path.parents if one == base or base in one.parents]
        nearest = next((one / FOLDER_FILE for one in above if (one / FOLDER_FILE).exists()), None)
        if nearest and nearest not in known:
            known[nearest] = options_of(read_yaml(nearest) or {}, str(nearest), nearest.parent)
            for key in ("bag", "clouds"):
                if key in known[nearest]:
                    raise Wrong(f"{nearest}: {key}: the bags are those that lie there")
        name = os.fsencode(str(path.relative_to(base).with_suffix(""))).decode("utf-8", "replace")
        name = re.sub(r"[/\x00-\x1f\x7f-\x9f]", "_", name).lstrip(".") or "_"
        if checked_name(name) or name in found:
            raise Wrong(f"{path}: its name {checked_name(name) or 'is that of another too, with / as _'}: list it "
                        "in a file, with a name")
        found[name] = dict(known.get(nearest, {}), bag=str(path))
    if not found:
        raise Wrong(f"{folder}: there is no *.bag below it")
    return found


def read(path):
    """@return evaluate's options by the name of each recording, in the names' order. @raises Wrong"""
    found = of_folder(path) if path.is_dir() else of_list(path)
    return dict(sorted(found.items()))


def arguments(options):
    """As evaluate takes them."""
    words = []
    for key, value in sorted(options.items()):
        values = value if isinstance(value, list) else [value]
        words += ["--" + key.replace("_", "-"), *(str(one) for one in values)]
    return words


def inputs(options):
    return [(key, options[key]) for key in PATHS if key in options]
