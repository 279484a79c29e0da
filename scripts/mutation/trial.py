"""One mutation after another: is it found?"""

import dataclasses
import threading
import time

from mutation.entries import Wrong

FOUND, SURVIVED, EQUIVALENT, UNFIT = "found", "SURVIVED", "equivalent", "unfit"
PATIENCE, PATIENCE_LEAST_S = 10.0, 20.0  # of what a test takes otherwise; beyond that it hangs


@dataclasses.dataclass
class Result:
    """Of one mutation."""

    mutation: object
    status: str
    by: str = ""  # the test that found it
    how: str = ""
    seconds: float = 0.0
    tried: int = 0  # tests

    @property
    def text(self):
        if self.status == FOUND:
            return f"found by {self.by}, which {self.how}"
        return f"{self.status}: {self.how}" if self.how else self.status

    @property
    def is_bad(self):
        """Not as the list says it is."""
        return self.status in (SURVIVED, UNFIT) or (self.status == FOUND and bool(self.mutation.equivalent))


class Times:
    """What tests take where nothing is broken; each is run once for it."""

    def __init__(self):
        self.seconds, self.lock = {}, threading.Lock()

    def measure(self, test):
        """@pre nothing is broken. @raises Wrong where it fails all the same."""
        with self.lock:
            if test.name in self.seconds:
                return
            outcome = test.run(test.limit_s)
            if not outcome.passed:
                last = (outcome.output.strip().splitlines() or [""])[-1]
                raise Wrong(f"{test.name} {outcome.how} where nothing is broken: {last}")
            self.seconds[test.name] = outcome.seconds

    def limit(self, test):
        known = self.seconds.get(test.name)
        return test.limit_s if known is None else max(PATIENCE_LEAST_S, PATIENCE * known)


class Trial:
    """In one workshop."""

    def __init__(self, workshop, suite, times, is_quick):
        self.workshop, self.suite, self.times, self.is_quick = workshop, suite, times, is_quick

    def tests_of(self, mutation):
        named = [test for name in mutation.tests for test in self.suite.named(name)]
        return named, [] if self.is_quick else self.suite.further(mutation.room, named)

    def targets_of(self, mutation):
        named, further = self.tests_of(mutation)
        return {target for test in named + further for target in test.targets}

    def judge(self, mutation):
        """@return its result. @raises Wrong where a test fails without it."""
        begun = time.monotonic()
        named, further = self.tests_of(mutation)
        for test in named:
            self.times.measure(test)
        with self.workshop.broken_by(mutation):
            result = self.look_for(mutation, named, further)
        found_by = [test for test in further if test.name == result.by]
        if found_by:
            self.times.measure(found_by[0])
            result.how += ", and none of those named"
        result.seconds = time.monotonic() - begun
        return result

    def look_for(self, mutation, named, further):
        tried = 0
        for tests in (named, further):
            if not tests:
                continue
            if not self.workshop.make({target for test in tests for target in test.targets}):
                return Result(mutation, UNFIT, how=f"it cannot be built: {self.workshop.complaint()}")
            for test in tests:
                tried += 1
                outcome = test.run(self.times.limit(test))
                if not outcome.passed:
                    return Result(mutation, FOUND, test.name, outcome.how, tried=tried)
        if mutation.equivalent:
            return Result(mutation, EQUIVALENT, how=mutation.equivalent, tried=tried)
        return Result(mutation, SURVIVED, how=f"{tried} tests pass", tried=tried)
