#!/usr/bin/python3
"""What the soak's oracle, and its look at memory, find where the answer is known."""

import dataclasses
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import oracle  # noqa: E402
from oracle import Permission, Span  # noqa: E402
from programs import Memory  # noqa: E402


def permissions(begin, end, permitted=True, period=0.02):
    count = int(round((end - begin) / period))
    return [Permission(begin + i * period, permitted, begin + i * period + 0.06, 100.0 + begin + i * period)
            for i in range(count)]


class OracleTest(unittest.TestCase):
    def test_a_fault_has_its_limit_and_a_period_until_it_has_to_stop(self):
        span = oracle.fault_span(10.0, 12.0, 0.3, "joints")
        self.assertAlmostEqual(span.begin, 10.32)
        self.assertEqual(span.end, 12.0)
        self.assertIsNone(oracle.fault_span(10.0, 10.3, 0.3, "shorter than its limit"))
        self.assertIsNone(oracle.fault_span(10.0, 12.0, None, "harmless"))

    def test_a_permission_within_is_a_false_clear_and_one_before_is_none(self):
        span = Span(10.32, 12.0, "joints")
        self.assertEqual(oracle.false_clears(permissions(9.0, 10.32), [span]), [])
        self.assertEqual(oracle.false_clears(permissions(9.0, 10.3) + permissions(10.3, 12.0, False), [span]), [])
        self.assertEqual(oracle.false_clears(permissions(12.01, 13.0), [span]), [])
        found = oracle.false_clears(permissions(9.0, 10.36), [span])
        self.assertEqual([one.what for one in found], ["false clear"])
        self.assertAlmostEqual(found[0].at, 10.32)

    def test_a_permission_that_holds_for_longer_is_a_false_clear(self):
        self.assertEqual(oracle.too_long_valid(permissions(0.0, 1.0), 0.06), [])
        self.assertEqual(len(oracle.too_long_valid(permissions(0.0, 1.0), 0.05)), 1)
        self.assertEqual(oracle.too_long_valid(permissions(0.0, 1.0, False), 0.05), [])

    def test_an_arm_may_move_until_it_can_have_halted(self):
        span = Span(10.0, 12.0, "joints")
        self.assertEqual(oracle.moves([(9.9, 0.5), (10.3, 0.4), (10.5, 0.0), (12.1, 0.5)], [span], 0.4), [])
        self.assertEqual([one.figure for one in oracle.moves([(10.3, 0.4), (10.5, 0.2), (10.6, 0.3)], [span], 0.4)],
                         [0.3])

    def test_what_is_near_has_to_stop_once_it_has_stood_long_enough(self):
        def truths(distance):
            return [(0.01 * i, distance) for i in range(500)]
        spans = oracle.near_spans(truths(0.005), 1.0)
        self.assertEqual(len(spans), 1)
        self.assertAlmostEqual(spans[0].begin, 1.0 + oracle.SEEN_S)
        self.assertEqual(oracle.near_spans(truths(0.1), 1.0), [])
        self.assertEqual(oracle.near_spans(truths(None), 1.0), [])
        self.assertEqual(oracle.near_spans(truths(0.005), 4.0), [])
        gone = [(stamp, 0.005 if stamp < 4.0 else None) for stamp, _ in truths(0.0)]
        self.assertAlmostEqual(oracle.near_spans(gone, 1.0)[0].end, 3.99)

    def test_a_hand_that_moves_in_contact_is_found_and_one_that_stands_is_not(self):
        truths = [(5.0, 0.01), (5.01, 0.0)]
        self.assertEqual(len(oracle.contacts(truths, [(5.01, 0.2)], 1.0, [])), 1)
        self.assertEqual(oracle.contacts(truths, [(5.01, 0.0)], 1.0, []), [])
        self.assertEqual(oracle.contacts(truths, [(5.01, 0.2)], 4.0, []), [])
        self.assertEqual(oracle.contacts(truths[:1], [(5.0, 0.2)], 1.0, []), [])
        self.assertEqual(oracle.contacts(truths, [(5.01, 0.2)], 1.0, [Span(5.0, 6.0, "moves out")]), [])

    def test_a_hand_in_contact_may_move_out_and_not_in(self):
        said = permissions(9.0, 10.0, False) + [dataclasses.replace(one, reasons=("MOVING_OUT",))
                                                for one in permissions(10.0, 11.0)] + permissions(11.0, 12.0)
        outs = oracle.moving_out(said, 0.1)
        self.assertEqual([round(at, 2) for out in outs for at in (out.begin, out.end)], [10.0, 11.14])
        left = oracle.without([Span(9.0, 12.0, "near"), Span(10.2, 10.8, "near"), Span(13.0, 14.0, "near")], outs)
        self.assertEqual([(round(span.begin, 2), round(span.end, 2)) for span in left],
                         [(9.0, 10.0), (11.14, 12.0), (13.0, 14.0)])
        self.assertEqual(len(oracle.false_clears(said, left)), 1)
        self.assertEqual(oracle.moving_out(permissions(10.0, 11.0)), [])
        self.assertEqual(oracle.ways_in([(10.1, 0.002), (10.5, 0.02)], outs), [])
        self.assertEqual(oracle.ways_in([(10.1, 0.2), (10.5, 0.1)], outs), [])  # out of something else
        self.assertEqual(oracle.ways_in([(10.1, None), (12.0, 0.0)], outs), [])
        self.assertEqual([one.at for one in oracle.ways_in([(10.1, 0.008), (10.5, 0.001), (11.0, 0.01)], outs)], [10.5])

    def test_stop_and_release_are_timed(self):
        said = permissions(0.0, 1.0) + permissions(1.0, 2.0, False) + permissions(2.0, 3.0)
        self.assertAlmostEqual(oracle.stopped_after(said, 0.9), 0.1)
        self.assertIsNone(oracle.stopped_after(said, 2.1))
        silent = permissions(0.0, 1.0) + permissions(2.0, 3.0)  # the last is valid until 1.04
        self.assertAlmostEqual(oracle.stopped_after(silent, 0.9), 0.14)
        self.assertAlmostEqual(oracle.stopped_after(permissions(0.0, 1.0) + permissions(2.0, 3.0, False), 0.9), 0.14)
        self.assertAlmostEqual(oracle.permitted_again(said, 101.5), 102.0)
        self.assertIsNone(oracle.permitted_again(said, 103.5))

    def test_the_longest_silence_counts_the_ends_too(self):
        said = permissions(0.0, 1.0) + permissions(1.5, 2.0)
        at, length = oracle.longest_silence(said, 100.0, 102.0)
        self.assertAlmostEqual(at, 100.98)
        self.assertAlmostEqual(length, 0.52)
        self.assertAlmostEqual(oracle.longest_silence(said, 100.0, 104.0)[1], 2.02)
        self.assertAlmostEqual(oracle.longest_silence([], 100.0, 104.0)[1], 4.0)


class MemoryTest(unittest.TestCase):
    @staticmethod
    def grown_kb(kilobytes_at, seconds=300):
        memory = Memory()
        for i in range(10 * seconds):
            memory.add(0.1 * i, kilobytes_at(0.1 * i))
        return memory.grown_kb

    def test_what_comes_and_goes_is_no_growth(self):
        self.assertEqual(self.grown_kb(lambda at: 50000), 0)
        self.assertEqual(self.grown_kb(lambda at: 50000 + (3000 if at % 20.0 < 9.0 else 0)), 0)

    def test_what_comes_and_stays_is(self):
        self.assertAlmostEqual(self.grown_kb(lambda at: 50000 + 10.0 * at), 2400, delta=50)
        self.assertEqual(self.grown_kb(lambda at: 50000 + (2000 if at > 280.0 else 0)), 2000)
        # A burst in the first minute is no licence.
        self.assertEqual(self.grown_kb(lambda at: 50000 + (9000 if at < 9.0 else 0) + (2000 if at > 90.0 else 0)), 2000)

    def test_a_short_life_tells_nothing(self):
        self.assertEqual(self.grown_kb(lambda at: 50000 + 100.0 * at, seconds=60), 0)


if __name__ == "__main__":
    unittest.main()
