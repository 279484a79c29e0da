"""What an earlier run said otherwise."""

import csv
import json

from . import table
from .entries import Wrong

SAME, CHANGED, ONLY_BEFORE, ONLY_NOW = "same", "changed", "only before", "only now"


def stops_of(summary):
    """Each stop as a whole: from when to when, and the segment that decides."""
    by_number = {}
    for segment in summary.get("stop_segments", []):
        by_number.setdefault(segment["stop"], []).append(segment)
    return [{"number": number, "from_s": some[0]["from_s"], "to_s": some[-1]["to_s"],
             "reason": table.gravest(some)["reason"], "link": table.gravest(some)["link"]}
            for number, some in sorted(by_number.items())]


def overlap(one, other):
    return min(one["to_s"], other["to_s"]) - max(one["from_s"], other["from_s"])


def pairs(before, now):
    """Stops that overlap most belong together. Yields (before, now), None where there is none."""
    left_before, left_now, found = list(before), list(now), []
    every = [(overlap(one, other), one, other) for one in before for other in now]
    for shared, one, other in sorted(every, key=lambda three: -three[0]):
        if shared >= 0.0 and one in left_before and other in left_now:
            found.append((one, other))
            left_before.remove(one)
            left_now.remove(other)
    found += [(one, None) for one in left_before] + [(None, other) for other in left_now]
    return sorted(found, key=lambda two: min(one["from_s"] for one in two if one))


def change_of(before, now):
    """@return what is told of a stop, or None where it is the same."""
    if now is None:
        return {"what": "gone", "before": before}
    if before is None:
        return {"what": "come", "now": now}
    begin, end = (round(now[key] - before[key], 6) for key in ("from_s", "to_s"))
    other = [key for key in ("reason", "link") if now[key] != before[key]]
    if not (begin or end or other):
        return None
    return {"what": " and ".join((["moved"] if begin or end else []) + [f"other {key}" for key in other]),
            "before": before, "now": now, "begin_s": begin, "end_s": end}


def rows_of(path):
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return [(row["stamp"], row["level"], row["reason"], row["link"]) for row in csv.DictReader(file)]


def summary_of(folder):
    try:
        return json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


class Baseline:
    """@var statuses exit statuses by name."""

    def __init__(self, folder, out):
        self.folder = folder
        if folder.resolve() == out.resolve():
            raise Wrong(f"--baseline: {folder} is where the results go")
        try:
            results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
            self.statuses = {row["name"]: row["exit_status"] for row in results["recordings"]}
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise Wrong(f"--baseline: {folder} has no results.json of evaluate_all") from error

    def compared(self, name, out, status):
        """Of a recording that is on both sides."""
        before, now = self.folder / name, out / name
        stops = [change_of(*two) for two in pairs(stops_of(summary_of(before)), stops_of(summary_of(now)))]
        stops = [one for one in stops if one]
        rows_before, rows_now = (rows_of(folder / "timeline.csv") for folder in (before, now))
        differ = sum(one != other for one, other in zip(rows_before, rows_now))
        differ += abs(len(rows_before) - len(rows_now))
        changed = bool(stops or differ or self.statuses[name] != status)
        return {"name": name, "status": CHANGED if changed else SAME, "stops": stops,
                "exit_status": [self.statuses[name], status],
                "checks": {"before": len(rows_before), "now": len(rows_now), "differ": differ}}

    def changes(self, out, rows):
        """A dictionary for each recording of either side, in the names' order."""
        now = {row["name"]: row["exit_status"] for row in rows}
        found = []
        for name in sorted(set(now) | set(self.statuses)):
            if name in now and name in self.statuses:
                found.append(self.compared(name, out, now[name]))
            else:
                found.append({"name": name, "status": ONLY_NOW if name in now else ONLY_BEFORE})
        return found


def stop_text(change):
    """Of one stop, in a line."""
    one = change.get("now") or change["before"]
    of_link = f" of {one['link']}" if one["link"] else ""
    text = f"stop at {one['from_s']:.2f} s, {one['reason']}{of_link}: {change['what']}"
    parts = [f"{word} {change[key]:+.3f} s" for key, word in (("begin_s", "begins"), ("end_s", "ends"))
             if change.get(key)]
    if "other" in change["what"]:
        was = change["before"]
        parts.append(f"was {was['reason']}" + (f" of {was['link']}" if was["link"] else ""))
    return text + (f" ({', '.join(parts)})" if parts else "")


def text_of(change):
    """Of a recording, in a line."""
    if "checks" not in change:
        return change["status"]
    if change["status"] == SAME:
        return SAME
    parts = [stop_text(one) for one in change["stops"]]
    was, status = change["exit_status"]
    if was != status:
        parts.insert(0, f"exit status {status}, was {was}")
    if change["checks"]["differ"]:
        parts.append(f"{change['checks']['differ']} of {change['checks']['now']} checks say otherwise")
    return "changed: " + "; ".join(parts)
