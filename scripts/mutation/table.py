"""What became of each mutation, for people and programs."""

import json

from mutation import trial


def counts_text(results):
    counts = {status: sum(one.status == status for one in results)
              for status in (trial.FOUND, trial.SURVIVED, trial.EQUIVALENT, trial.UNFIT)}
    return ", ".join(f"{count} {status}" for status, count in counts.items() if count or status == trial.FOUND)


def rows_of(results):
    """Those that need a look last, where they are seen."""
    ordered = sorted(results, key=lambda one: (one.is_bad, one.mutation.where))
    return [(one.mutation.room, one.mutation.name, one.text) for one in ordered]


def as_text(results):
    rows = rows_of(results)
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    return "".join(f"{room:{widths[0]}}  {name:{widths[1]}}  {text}\n" for room, name, text in rows)


def as_json(results, interrupted):
    entries = [{"name": one.mutation.name, "room": one.mutation.room, "where": one.mutation.where,
                "file": one.mutation.file, "status": one.status, "found_by": one.by or None, "how": one.how,
                "tests_tried": one.tried, "seconds": round(one.seconds, 1)} for one in results]
    return json.dumps({"interrupted": interrupted, "mutations": entries}, indent=2) + "\n"
