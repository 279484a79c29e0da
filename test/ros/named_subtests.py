"""rosunit counts what fails in a subTest, and says neither that it failed nor which it was."""

import contextlib
import unittest


class NamedSubTests(unittest.TestCase):
    """Here a test fails with the names of its subtests that did, and what they say."""

    @contextlib.contextmanager
    def subTest(self, msg=None, **params):
        names = [] if msg is None else [str(msg)]
        try:
            yield
        except AssertionError as error:
            names += [f"{key}={value}" for key, value in params.items()]
            failures = self.__dict__.setdefault("failed_subtests", [])
            if not failures:
                self.addCleanup(self.tell_failures)
            failures.append(f"{', '.join(names)}: {error}")

    def tell_failures(self):
        failures = self.__dict__.pop("failed_subtests")
        self.fail("\n" + "\n".join(failures))
