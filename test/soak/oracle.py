"""Says when motion must not be permitted, and when it should be again, from what was done to the monitor and from the
simulated world: nothing of the monitor's own judges it. All times are those of the monitor's clock [s], but where it is
said."""

import dataclasses
import math
import typing

CHECK_S = 0.02  # from one permission to the next
SEEN_S = 2.4  # what has stood for so long was seen: a tilt period, and what a check and its message take
NEAR_M = 0.012  # well within the padding of 0.03, and noise
MOVES_RPS = 0.01  # a joint that is faster moves
HALT_S = 0.3  # stop_trajectory_duration of the arm's controller
GOES_IN_M = 0.003  # that the hand may come nearer while it moves out, by noise and as it turns
GATE_S = 0.1  # silence, the gate's cycle and the way to the controller; a machine that is busy


@dataclasses.dataclass
class Span:
    """A time in which nothing may be permitted. @var why for people."""
    begin: float
    end: float
    why: str


@dataclasses.dataclass
class Found:
    """What contradicts the oracle. @var what "false clear", "arm moves", "outlasts" or "silent"."""
    what: str
    why: str
    at: float
    figure: float = 0.0

    def __str__(self):
        return f"{self.what}: {self.why} (at {self.at:.3f} s, {self.figure:.3f})"


@dataclasses.dataclass
class Permission:
    stamp: float
    permitted: bool
    valid_until: float
    received: float  # by the machine's clock
    reasons: typing.Sequence[str] = ()


def fault_span(begin, end, limit, why):
    """@param begin when the last sound message went through. @param limit [s], or None where nothing has to stop.
    @return the time in which nothing may be permitted, or None."""
    if limit is None or begin + limit + CHECK_S >= end:
        return None
    return Span(begin + limit + CHECK_S, end, why)


def near_spans(truths, since):
    """@param truths (stamp, distance of the hand to what was put there, or None). @param since when it was put there.
    @return the times in which it had stood for long enough to be seen, with the hand near."""
    spans = []
    for stamp, distance in truths:
        if distance is None or distance > NEAR_M or stamp < since + SEEN_S:
            continue
        if spans and stamp - spans[-1].end < 0.05:
            spans[-1].end = stamp
        else:
            spans.append(Span(stamp, stamp, f"the hand is {1e3 * distance:.0f} mm from what is there"))
    return [span for span in spans if span.end - span.begin > CHECK_S]


def moving_out(permissions, halt=HALT_S + GATE_S):
    """@return the times in which the arm may move out of what it touches, and no other way."""
    spans = []
    for one in permissions:
        if not one.permitted or "MOVING_OUT" not in one.reasons:
            continue
        if spans and one.stamp <= spans[-1].end:
            spans[-1].end = one.valid_until + halt
        else:
            spans.append(Span(one.stamp, one.valid_until + halt, "the hand moves out, and comes nearer"))
    return spans


def without(spans, others):
    """@return what is left of spans."""
    left = list(spans)
    for other in others:
        cut = []
        for span in left:
            for begin, end in ((span.begin, min(span.end, other.begin)), (max(span.begin, other.end), span.end)):
                if begin < end:
                    cut.append(dataclasses.replace(span, begin=begin, end=end))
        left = cut
    return left


def ways_in(truths, outs):
    """The hand comes nearer to what is there when it might only move out of it. @param outs as of moving_out()."""
    found = []
    for out in outs:
        there = [(stamp, distance) for stamp, distance in truths
                 if out.begin <= stamp <= out.end and distance is not None]
        nearest = min(there, key=lambda one: one[1], default=None)
        if nearest and nearest[1] < min(NEAR_M, there[0][1] - GOES_IN_M):
            found.append(Found("false clear", out.why, nearest[0], there[0][1] - nearest[1]))
    return found


def false_clears(permissions, spans):
    """Permissions that were given when none might be: one for each span, the first."""
    found = []
    for span in spans:
        wrong = [one for one in permissions if one.permitted and span.begin <= one.stamp < span.end]
        if wrong:
            why = f"{span.why}: {' '.join(wrong[0].reasons) or 'permitted'}"
            found.append(Found("false clear", why, wrong[0].stamp, wrong[-1].stamp - wrong[0].stamp))
    return found


def too_long_valid(permissions, validity):
    """Permissions that hold for longer than they may. @param validity [s]"""
    wrong = [one for one in permissions if one.permitted and one.valid_until - one.stamp > validity + 1e-6]
    return [Found("false clear", "a permission is valid for too long", one.stamp, one.valid_until - one.stamp)
            for one in wrong[:1]]


def moves(samples, spans, halt=HALT_S + GATE_S):
    """The arm moves when it should stand. @param samples (stamp, speed of the fastest joint [rad/s])."""
    found = []
    for span in spans:
        wrong = [(stamp, speed) for stamp, speed in samples
                 if span.begin + halt <= stamp <= span.end and speed > MOVES_RPS]
        if wrong:
            found.append(Found("arm moves", span.why, wrong[0][0], max(speed for _, speed in wrong)))
    return found


def contacts(truths, samples, since, outs):
    """The hand goes on into what has stood for long enough to be seen. @param truths as near_spans(). @param samples as
    moves(). @param outs when it might move out, as of moving_out()."""
    speeds = dict((round(stamp, 3), speed) for stamp, speed in samples)
    for stamp, distance in truths:
        if distance is not None and distance <= 0.0 and stamp > since + SEEN_S and \
                not any(out.begin <= stamp <= out.end for out in outs):
            speed = speeds.get(round(stamp, 3), 0.0)
            if speed > MOVES_RPS:
                return [Found("false clear", "the hand moves in contact with what has stood there", stamp, speed)]
    return []


def stopped_after(permissions, begin):
    """@return from the last sound message to when nothing is permitted any more: by a permission that does not, or since
    the last one has expired; None where that is never."""
    valid_until = begin
    for one in permissions:
        if one.stamp < begin:
            valid_until = max(valid_until, one.valid_until if one.permitted else begin)
        elif not one.permitted:
            return min(one.stamp, valid_until) - begin
        elif one.stamp > valid_until:
            return valid_until - begin
        else:
            valid_until = max(valid_until, one.valid_until)
    return None


def permitted_again(permissions, after):
    """@param after by the machine's clock. @return when a permission was received again, or None."""
    return next((one.received for one in permissions if one.received > after and one.permitted), None)


def longest_silence(permissions, begin, end):
    """Between two permissions. All by the machine's clock. @return (when it began, how long)"""
    times = [begin] + [one.received for one in permissions if begin < one.received < end] + [end]
    gaps = [(later - earlier, earlier) for earlier, later in zip(times, times[1:])]
    length, at = max(gaps)
    return at, length


def percentile(values, share):
    """@return NaN of nothing."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan
