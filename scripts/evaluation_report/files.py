"""Files that are there whole or not at all."""

import os
import re

OURS = re.compile(r"(stop_\d\d[a-e]?|timeline|latency|map_from_above|map_in_3d)\.png|report\.html")


class Missing(Exception):
    """What it takes is not there; said in one line."""


def write(path, content):
    """@return the path."""
    part = path.with_name("." + path.name + ".part")
    try:
        part.write_bytes(content)
        os.replace(part, path)
    finally:
        if part.exists():
            part.unlink()
    return path


def forget(folder):
    """What an earlier run drew: a picture that stays behind would be taken for one of this run."""
    for path in sorted(folder.iterdir()):
        if OURS.fullmatch(path.name):
            path.unlink()
