"""What evaluate wrote, read, and the words for it."""

import csv
import json

from .files import Missing
from .looks import Scene

LEVELS = ("OK", "SLOW", "STOP", "FAULT")
WORDS = {  # of docs/failures.md, for people who do not know the names
    "CLEAR": "nothing speaks against moving",
    "MOVING_OUT": "it moves out of a contact",
    "SPEED_GOVERNED": "what appears ahead would be seen too late at full speed",
    "UNSEEN_AHEAD": "too much of the way ahead was not seen",
    "RELEASING": "all is clear, but not for long enough yet",
    "AWAITING_RESET": "all is clear, but a reset has to lift the stop",
    "INIT": "the map was not whole yet",
    "EVIDENCE_OLD": "the sensor looks no more where the arm is",
    "OCCLUSION_AHEAD": "a link would soon be hidden from the sensor",
    "OCCLUSION": "a link was hidden from the sensor",
    "APPROACHED": "something came near",
    "KEEP_OUT_AHEAD": "a link would soon have entered a region to keep out of",
    "COLLISION_AHEAD": "a link would soon have touched something",
    "KEEP_OUT": "a link was in a region to keep out of",
    "COLLISION": "a link touched something",
    "BAD_TRAJECTORY": "a commanded trajectory was not understood, or not followed",
    "MAP_OVERFLOW": "the map was full",
    "OUTSIDE_AREA": "the robot was outside the map's area",
    "MODEL_DISAGREES": "the robot's model and tf contradict each other",
    "NO_MAP": "no scans came",
    "MAP_LATE": "the scans were too old",
    "SWEEP_INCOMPLETE": "the laser's tilt did not turn as it should",
    "BLIND": "the sensor saw hardly anything",
    "FRAME_CHANGED": "scans of two frames came on one topic",
    "NO_JOINTS": "joint positions were missing",
    "NO_TRANSFORM": "a transform was missing or too old",
    "JOINT_OUT_OF_RANGE": "a joint was said to be where it cannot be",
    "JOINT_CONTRADICTED": "a joint was said to be at two places at one time",
    "FUTURE_STAMP": "a message was stamped in the future",
    "CHECK_LATE": "checks took too long",
    "NO_CLOCK": "time stood still, or went to and fro",
    "INTERNAL": "the check itself failed",
}


def words(reason):
    return WORDS.get(reason, reason)


def duration(seconds):
    if seconds < 1.0:
        return f"{1e3 * seconds:.0f} ms"
    return f"{seconds:.1f} s" if seconds < 90.0 else f"{seconds / 60.0:.1f} min"


class Record:
    """@var rows of the timeline, a check each. @var stops as evaluate numbers them. @var timing None where there are no
    computing times."""

    def __init__(self, scenes, rows, summary, timing):
        self.scenes, self.rows, self.summary, self.timing = scenes, rows, summary, timing
        self.stops = scenes["stops"]
        self.shown = {}

    @property
    def robot(self):
        return self.scenes["robot"] or "the surroundings"

    def drawn_scenes(self):
        """Yields a stop's number, the name of a picture, stop and Scene, as scenes_of() has them."""
        for number, name, stop, scene in self.scenes_of():
            if name not in self.shown:
                self.shown[name] = Scene(scene)
            yield number, name, stop, self.shown[name]

    def scenes_of(self):
        """Yields a stop's number, the name of a picture, stop and what is in it; the one that decides first, the
        others in the order of time, where they are about something."""
        for number, stop in enumerate(self.stops, 1):
            some = [scene for scene in stop["scenes"] if scene.get("cuboids") or "robot" in scene]
            some = some or stop["scenes"][-1:]
            first = next((scene for scene in some if scene["reason"] == stop["reason"]), some[0])
            yield number, f"stop_{number:02}", stop, first
            others = [scene for scene in some if scene is not first and "point" in scene]
            for letter, scene in zip("bcde", others):
                yield number, f"stop_{number:02}{letter}", stop, scene


def json_of(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read(folder):
    """@raises Missing where it has not all of it."""
    try:
        with open(folder / "timeline.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        timing = folder / "timing.json"
        return Record(json_of(folder / "scenes.json"), rows, json_of(folder / "summary.json"),
                      json_of(timing) if timing.exists() else None)
    except (OSError, ValueError) as error:
        raise Missing(f"{folder} has not what `evaluate --report` writes: {error}") from error


def number(text):
    return float(text) if text else None


def segments(rows):
    """Checks in a row with one level and reason: (begin_s, end_s, level, reason, link)."""
    found = []
    for row in rows:
        time = float(row["time_s"])
        if found and time < found[-1][0]:  # time jumped back
            found.append((time, time, row["level"], row["reason"], row["link"]))
            continue
        if found:
            found[-1] = (found[-1][0], time) + found[-1][2:]
        if not found or found[-1][2:4] != (row["level"], row["reason"]):
            found.append((time, time, row["level"], row["reason"], row["link"]))
    return found


def series(rows, column, worst, bins=1500):
    """Times and values; of many checks the worst of a stretch. None where nothing is known."""
    if not rows:
        return [], []
    size = max(1, -(-len(rows) // bins))
    times, values = [], []
    for begin in range(0, len(rows), size):
        some = [number(row[column]) for row in rows[begin:begin + size]]
        some = [value for value in some if value is not None]
        times.append(float(rows[begin]["time_s"]))
        values.append(worst(some) if some else None)
    return times, values


def bounded(found, count=1500):
    """Segments, of too many the longest."""
    if len(found) <= count:
        return found
    least = sorted((end - begin for begin, end, *_ in found), reverse=True)[count - 1]
    return [one for one in found if one[1] - one[0] >= least][:count]
