"""What came out of all: a row a recording."""

import csv
import io
import json

from evaluation_report import record

COLUMNS = ("name", "scans", "checks", "stops", "stop_fraction", "slow_fraction", "gravest_reason", "exit_status")
LEVELS = record.LEVELS
BINS = 240


def rank(reason):
    """Of reasons the gravest comes last."""
    known = list(record.WORDS)
    return known.index(reason) if reason in known else -1


def gravest(segments):
    """@return of a stop's segments the one that decides, the first of several alike."""
    return max(segments, key=lambda one: rank(one["reason"]), default=None)


def strip(text):
    """@param text of timeline.csv. @return the worst level of each of some stretches of equal length, as a digit; a space
    where nothing was checked."""
    rows = list(csv.DictReader(io.StringIO(text)))
    times = [float(row["time_s"]) for row in rows]
    if not times or max(times) <= 0.0:
        return ""
    bins = [-1] * BINS
    for time, row in zip(times, rows):
        place = min(BINS - 1, max(0, int(BINS * time / max(times))))
        level = LEVELS.index(row["level"]) if row["level"] in LEVELS else -1
        bins[place] = max(bins[place], level)
    for place in range(1, BINS):  # checks may be rarer than stretches
        bins[place] = bins[place - 1] if bins[place] < 0 else bins[place]
    return "".join(" " if one < 0 else str(one) for one in bins)


def message_of(result):
    """What it said last, where it failed."""
    lines = [line for line in result["error"].splitlines() if line.strip() and ": warning: " not in line]
    return lines[-1] if lines and result["status"] else ""


def row_of(name, result):
    """@param result as job.run() returns it."""
    row = dict.fromkeys(COLUMNS)
    row.update(name=name, exit_status=result["status"], gravest_reason="", gravest_link="", gravest_detail="",
               message=message_of(result), has_report="report.html" in result["files"])
    try:
        summary = json.loads(result["files"].get("summary.json", b"{}"))
    except ValueError:  # it was cut short
        summary = {}
    for key in ("scans", "checks", "stops", "stop_fraction", "slow_fraction"):
        row[key] = summary.get(key)
    worst = gravest(summary.get("stop_segments", []))
    if worst:
        row.update(gravest_reason=worst["reason"], gravest_link=worst["link"], gravest_detail=worst["detail"])
    row["strip"] = strip(result["files"].get("timeline.csv", b"").decode("utf-8", "replace"))
    return row


def text_of(row):
    """In a few words."""
    if row["exit_status"]:
        return f"exit status {row['exit_status']}: {row['message']}"
    if not row["checks"]:
        return f"{row['scans']} scans mapped"
    times = {0: "never stopped", 1: "stopped once"}.get(row["stops"], f"stopped {row['stops']} times")
    share = f", {100.0 * row['stop_fraction']:.1f} % of the checks" if row["stops"] else ""
    return times + share + (f": {row['gravest_reason']}" if row["gravest_reason"] else "")


def as_csv(rows):
    out = io.StringIO()
    writer = csv.DictWriter(out, COLUMNS, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue().encode("utf-8")


def as_json(value):
    return (json.dumps(value, indent=2, ensure_ascii=False) + "\n").encode("utf-8", "replace")


def results_json(rows, interrupted):
    kept = [{key: row[key] for key in row if key != "strip"} for row in rows]
    return as_json({"recordings": kept, "interrupted": interrupted})
