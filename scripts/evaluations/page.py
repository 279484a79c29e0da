"""One page for all. It opens without a network, beside the folders that it refers to."""

import html
import pathlib
import urllib.parse

from evaluation_report import record
from evaluation_report.looks import LEVEL_COLORS

from . import baseline, table

HERE = pathlib.Path(__file__).resolve().parent
HEAD = ("recording", "scans", "checks", "stops", "in stop", "slow", "gravest reason", "over time")


def escaped(text):
    return html.escape(str(text), quote=True)


def link(name, file):
    return escaped(f"{urllib.parse.quote(name, safe='', errors='replace')}/{file}")


def bar(share, level):
    if share is None:
        return ""
    return (f'<div class="bar"><div style="width:{100.0 * share:.1f}%;background:{LEVEL_COLORS[level]}"></div></div>'
            f"{100.0 * share:.1f} %")


def picture(strip, name):
    """Levels over time."""
    parts, begin = [], 0
    for end in range(1, len(strip) + 1):
        if end == len(strip) or strip[end] != strip[begin]:
            if strip[begin] != " ":
                color = LEVEL_COLORS[table.LEVELS[int(strip[begin])]]
                parts.append(f'<rect x="{begin}" y="0" width="{end - begin}" height="22" fill="{color}"/>')
            begin = end
    if not parts:
        return ""
    return (f'<svg viewBox="0 0 {table.BINS} 22" width="{table.BINS}" height="22" preserveAspectRatio="none" role="img" '
            f'aria-label="levels of {escaped(name)} over time">{"".join(parts)}</svg>')


def why(row):
    if row["exit_status"]:
        return f"<b>exit status {row['exit_status']}</b><br>{escaped(row['message'])}"
    if not row["gravest_reason"]:
        return ""
    of_link = f" of {escaped(row['gravest_link'])}" if row["gravest_link"] else ""
    return f"<b>{escaped(row['gravest_reason'])}</b>{of_link}<br>{escaped(record.words(row['gravest_reason']))}"


def number(value):
    return "" if value is None else escaped(value)


def table_row(row, changes):
    name, strip = escaped(row["name"]), picture(row["strip"], row["name"])
    if row["has_report"]:
        href = link(row["name"], "report.html")
        name, strip = f'<a href="{href}">{name}</a>', strip and f'<a href="{href}">{strip}</a>'
    cells = [name, number(row["scans"]), number(row["checks"]), number(row["stops"]), bar(row["stop_fraction"], "STOP"),
             bar(row["slow_fraction"], "SLOW"), why(row), strip]
    if changes is not None:
        change = changes[row["name"]]
        text = escaped(baseline.text_of(change))
        cells.append(f"<b>{text}</b>" if change["status"] != baseline.SAME else text)
    failed = ' class="failed"' if row["exit_status"] else ""
    return f"<tr{failed}>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def summary(rows):
    failed = sum(bool(row["exit_status"]) for row in rows)
    stopped = sum(bool(row["stops"]) for row in rows)
    text = f"{len(rows)} recording{'' if len(rows) == 1 else 's'}; in {stopped} of them the robot was stopped"
    return text + (f"; {failed} could not be evaluated to the end." if failed else ".")


def of(rows, changes, interrupted):
    """@param changes as Baseline.changes() has them, or None."""
    by_name = None if changes is None else {change["name"]: change for change in changes}
    head = HEAD + (("since the baseline",) if changes is not None else ())
    gone = [change["name"] for change in changes or [] if change["status"] == baseline.ONLY_BEFORE]
    notes = ["Interrupted: only what was done until then is here."] if interrupted else []
    notes += [f"Only in the baseline: {', '.join(gone)}."] if gone else []
    values = {
        "STYLE": (HERE / "page.css").read_text(encoding="utf-8"),
        "NOTES": "".join(f'<p class="warning">{escaped(note)}</p>' for note in notes),
        "SUMMARY": escaped(summary(rows)),
        "LEGEND": " ".join(f'<span class="level" style="background:{color}"></span> {level}'
                           for level, color in LEVEL_COLORS.items()),
        "HEAD": "".join(f"<th>{cell}</th>" for cell in head),
        "ROWS": "\n".join(table_row(row, by_name) for row in rows)}
    parts = (HERE / "page.html").read_text(encoding="utf-8").split("@@")
    return "".join(values[part] if i % 2 else part for i, part in enumerate(parts)).encode("utf-8", "replace")
