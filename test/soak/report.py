"""What came of a soak: a line for each episode, and a table."""

import collections
import math
import sys
import time

import oracle
import system

MEMORY_KB = 1024  # that a process may grow by after its first minute
LATENCY_TIMES = 1.2  # how much longer the last part's may be than the first's
PART_S = 600.0
STOPS_BYTES_MAX = system.STOPS_MEMORY_MB * 1e6


class Tally:
    """What was found, by kind of fault. @var last the number of the last episode."""

    def __init__(self, last=0):
        self.kinds = collections.defaultdict(lambda: {"count": 0, "had_to_stop": 0, "stopped_s": [], "released_s": []})
        self.found, self.crashes, self.stubborn = [], [], []
        self.replayed = (0, [])
        self.last, self.episodes, self.faults, self.spans = last, 0, 0, 0

    def add(self, fault, stopped_s, released_s):
        """@param stopped_s, released_s None where it was not, or is not known."""
        row = self.kinds[fault.name]
        row["count"] += 1
        self.faults += 1
        if stopped_s is not None:
            row["stopped_s"].append(round(stopped_s, 3))
        if released_s is not None:
            row["released_s"].append(round(released_s, 3))

    def episode(self, names, found, spans):
        self.episodes += 1
        self.last += 1
        self.spans += len(spans)
        for name in {span.why for span in spans} & set(names):
            self.kinds[name]["had_to_stop"] += 1
        self.found += [{"episode": self.last, "faults": names, "what": one.what, "why": one.why,
                        "at_s": one.at, "figure": one.figure} for one in found]

    def ended(self, name, status):
        """One that was asked to. @param status None where it had to be killed."""
        if status is None:
            self.stubborn.append(name)
        elif status != 0:
            self.crash(name, status, ["asked to end"])

    def crash(self, name, status, names):
        self.crashes.append({"episode": self.last + 1, "program": name, "status": status, "faults": names})


def show(soak, begun, found):
    """One line an episode, and one for each thing found."""
    tally = soak.tally
    seconds = time.monotonic() - soak.begun
    parts = []
    for fault, _, _ in begun:
        row = tally.kinds[fault.name]
        stopped = f"stopped after {row['stopped_s'][-1]:.3f} s" if row["stopped_s"] else "no stop"
        parts.append(f"{fault.name} ({fault.length:.2f} s, {stopped})")
    released = next((tally.kinds[fault.name]["released_s"][-1] for fault, _, _ in begun
                     if tally.kinds[fault.name]["released_s"]), math.nan)
    print(f"{int(seconds // 60):3d}:{seconds % 60:04.1f}  {tally.last:4d}  {' + '.join(parts)}; "
          f"released after {released:.2f} s", flush=True)
    for one in found:
        print(f"            {one}", file=sys.stderr, flush=True)


def latencies(soak):
    """@return the 99th percentile of the first and of the last part, and how long a part was [s]"""
    rows = soak.robot.latencies.take()
    if not rows:
        return None
    begin, end = rows[0][0], rows[-1][0]
    part_s = min(PART_S, 0.5 * (end - begin))
    first = [value for at, value in rows if at < begin + part_s]
    last = [value for at, value in rows if at > end - part_s]
    return {"part_s": part_s, "first_p99_s": oracle.percentile(first, 0.99), "last_p99_s": oracle.percentile(last, 0.99),
            "scans": len(rows)}


def result(soak):
    tally = soak.tally
    memory = {program.name: {"first_kb": program.grown_most.first_kb, "grown_kb": program.grown_most.grown_kb,
                             "lived_s": round(program.lived_s, 1)}
              for program in soak.system.programs.values() if program.lived_s > 0.0}
    latency = latencies(soak)
    hung = [{"begun_s": at - soak.begun} for at in soak.client.hung]
    # Over short parts the 99th percentile is a matter of chance.
    is_steady = not latency or latency["part_s"] < PART_S or \
        latency["last_p99_s"] <= LATENCY_TIMES * latency["first_p99_s"]
    stops, others = tally.replayed
    holds = not (tally.found or tally.crashes or hung or tally.stubborn or others) and is_steady and \
        soak.robot.stops_bytes <= STOPS_BYTES_MAX and all(
        row["grown_kb"] < MEMORY_KB for row in memory.values())
    return {"seed": soak.options.seed, "minutes": (time.monotonic() - soak.begun) / 60.0, "holds": holds,
            "episodes": tally.episodes, "faults": tally.faults, "had_to_stop": tally.spans, "found": tally.found,
            "crashes": tally.crashes, "hung_goals": hung, "would_not_end": tally.stubborn,
            "goals": {"done": soak.client.done, "failed": soak.client.failed}, "resets": soak.robot.resets,
            "maps_cleared": soak.robot.cleared,
            "latency": latency, "memory": memory,
            "stops": {"replayed": stops, "another_verdict": others, "memory_bytes_max": soak.robot.stops_bytes},
            "kinds": {name: row for name, row in sorted(tally.kinds.items())}}


def print_table(all_):
    width = max([len(name) for name in all_["kinds"]] + [4])
    print(f"\n{'kind':{width}s}  times  had to stop  stopped within  released within")
    for name, row in all_["kinds"].items():
        stopped = f"{max(row['stopped_s']):10.3f} s" if row["stopped_s"] else f"{'-':>12s}"
        released = f"{max(row['released_s']):10.2f} s" if row["released_s"] else f"{'-':>12s}"
        print(f"{name:{width}s}  {row['count']:5d}  {row['had_to_stop']:11d}  {stopped:>14s}  {released:>15s}")
    print(f"\nseed {all_['seed']}, {all_['minutes']:.1f} min: {all_['faults']} faults in {all_['episodes']} episodes, "
          f"{all_['had_to_stop']} had to stop the robot; goals: {all_['goals']['done']} done, "
          f"{all_['goals']['failed']} not; {all_['resets']} resets, {all_['maps_cleared']} maps cleared")
    for name, row in all_["memory"].items():
        print(f"memory   {name:18s} {row['first_kb']:7d} kB after its first minute, grew by {row['grown_kb']:5d} kB; lived "
              f"for {row['lived_s']:.0f} s")
    if all_["latency"]:
        row = all_["latency"]
        print(f"latency  p99 from ready to permission: first {row['part_s']:.0f} s {1e3 * row['first_p99_s']:.2f} ms, "
              f"last {1e3 * row['last_p99_s']:.2f} ms, {row['scans']} scans")
    print(f"stops    {all_['stops']['replayed']} kept and replayed, of "
          f"{len(all_['stops']['another_verdict'])} another verdict came; at most "
          f"{1e-6 * all_['stops']['memory_bytes_max']:.1f} MB were kept for the next")
    counts = collections.Counter(one["what"] for one in all_["found"])
    told = [f"{count} x {what}" for what, count in counts.items()]
    told += [f"{row['program']} ended with {row['status']}" for row in all_["crashes"]]
    told += [f"{len(all_['hung_goals'])} goals hung"] if all_["hung_goals"] else []
    told += [f"{name} replays to another verdict" for name in all_["stops"]["another_verdict"]]
    told += [f"{name} would not end" for name in all_["would_not_end"]]
    print("found    " + ("; ".join(told) if told else "nothing"))
    for one in all_["found"]:
        print(f"         episode {one['episode']}: {one['what']}: {one['why']} ({one['figure']:.3f}), with "
              f"{' and '.join(one['faults'])}")
    print("holds" if all_["holds"] else "DOES NOT HOLD")
