#!/usr/bin/python3
"""Runs the real nodelets and the gate, with a simulated arm behind it, under random faults of every kind, and has an
oracle judge what they say.

Faults come one at a time, or two at once; before each, motion has to be permitted again. The seed draws them: the same
one does the same in the same order.

Exit status: 0 all held; 1 something did not, see the table; 2 wrong arguments, or it could not be run.
"""

import argparse
import dataclasses
import json
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE), str(HERE.parent / "ros")]

import rospy  # noqa: E402
from std_msgs.msg import String  # noqa: E402
from trajectory_msgs.msg import JointTrajectory  # noqa: E402
from dynamic_reconfigure.client import Client as Tuner  # noqa: E402

import faults  # noqa: E402
import oracle  # noqa: E402
import report  # noqa: E402
import robot  # noqa: E402
import system  # noqa: E402

STARTS_S = 60.0  # that all has to come up
TWO_AT_ONCE = 0.5  # the share of episodes with two faults
PAUSES_S = (0.5, 2.5)  # of sound work between two episodes
SILENT_S = 1.0  # between permissions, where nobody was to be silent
LATE_S = 4.0  # that a busy machine may add to a release
SENSORS = {"scan", "laser_assembler", "laser_mapper", "camera_cloud", "camera_assembler", "camera_mapper"}
QUIETS = {"processor", "checker", "master"}  # faults of what speaks
VALID_S = 0.06


class Soak:
    """What faults are given. @var put_at since when something stands before the robot, by the monitor's clock."""

    HAND_HALF_M = 0.05

    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.random = None  # one of each episode's own
        self.system = system.System(folder, options)
        self.robot = self.operator = self.client = None
        self.kinds = chosen_kinds(options)
        self.put_at, self.spinners, self.interrupted = float("inf"), [], False
        self.tally = report.Tally(options.episode - 1)
        self.begun = time.monotonic()

    def patience(self, seconds):
        """Of the monitor's clock. @return by the machine's [s]"""
        return seconds / self.options.rate

    def is_over(self):
        return self.interrupted or rospy.is_shutdown()

    def call(self, name, kind, *arguments, seconds=robot.ANSWER_S):
        """@return the answer, or None where nobody gives one in time: who should may be paused."""
        return robot.in_time(lambda: rospy.ServiceProxy(name, kind)(*arguments), seconds)

    def spin(self, count):
        for process in self.spinners:
            process.kill()
            process.wait()
        self.spinners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]

    def fill_disk(self):
        if not self.system.has_small_disk:  # it cannot be made here: the folder is gone instead
            shutil.rmtree(self.system.stops, ignore_errors=True)
            return
        try:
            with open(self.system.stops / "filler", "wb") as file:
                while True:
                    file.write(bytes(1 << 16))
        except OSError:
            pass

    def empty_disk(self):
        self.system.stops.mkdir(exist_ok=True)
        (self.system.stops / "filler").unlink(missing_ok=True)

    def look(self):
        """Once in a while: has anything ended by itself?"""
        for name, status in self.system.look():
            self.tally.crash(name, status, [fault.name for fault in self.now])

    def wait_until_permitted(self, patience_s):
        deadline = time.monotonic() + patience_s
        while time.monotonic() < deadline and not self.is_over():
            if self.robot.is_permitted():
                return True
            self.look()
            time.sleep(0.02)
        return False

    def take_everything(self):
        return (self.robot.permissions.take(), self.robot.truths.take(), self.robot.speeds.take())

    def drawn_faults(self):
        """One, or two that touch different things: those of this episode of the seed, whatever was before."""
        names = sorted(self.kinds)
        chosen = [self.kinds[self.random.choice(names)]]
        if self.random.random() < TWO_AT_ONCE:
            others = [self.kinds[name] for name in names if not self.kinds[name].touches & chosen[0].touches]
            if others:
                chosen.append(self.random.choice(others))
        for fault in chosen:
            fault.draw(self.random)
        return chosen

    def start(self):
        self.now = []
        self.system.start()
        rospy.init_node("soak", anonymous=True, disable_signals=True)
        self.robot = robot.Robot(self.options)
        self.tilt = rospy.Publisher("simulation/tilt_fault", String, queue_size=10)
        self.trajectory = rospy.Publisher("trajectory", JointTrajectory, queue_size=10)
        self.operator = robot.Operator(self.robot)
        self.client = robot.Client(self.robot, self.options.seed, self.folder / "goals.log")
        self.operator.start()
        self.client.start()
        if not self.wait_until_permitted(self.patience(STARTS_S)):
            status = self.robot.status
            raise RuntimeError("motion is not permitted at first: " +
                               (f"{status.reason} {status.detail}" if status else "the checker says nothing"))
        tuner = Tuner("collision_checker", timeout=10.0)
        self.tuned = tuner.get_configuration(timeout=10.0)
        tuner.close()

    def run(self):
        self.start()
        end = time.monotonic() + 60.0 * self.options.minutes
        while time.monotonic() < end and not self.is_over():
            self.random = random.Random(f"{self.options.seed} {self.tally.last + 1}")
            pause = time.monotonic() + self.random.uniform(*PAUSES_S)
            drawn = self.drawn_faults()
            apart = self.random.uniform(0.0, 0.5)
            self.take_everything()
            while time.monotonic() < pause:
                self.look()
                time.sleep(0.02)
            self.robot.palm_then = self.robot.palm
            self.episode(drawn, apart)

    def episode(self, drawn, apart):
        """@param apart between the beginnings of two [s]"""
        self.now = drawn
        spans, walls, begun = [], [], []
        begin_wall, put_at = time.monotonic(), None
        for number, fault in enumerate(drawn):
            if number:
                self.last(apart, begun)
            begin = fault.begin(self)
            if begin is not None:
                begun.append((fault, begin, time.monotonic()))
            if "world" in fault.touches:
                put_at = self.put_at
        ended = []
        is_clock_sound = not any("/clock" in fault.touches for fault in drawn)
        limits = limits_of(drawn)
        lasting = sorted(begun, key=lambda one: one[2] + one[0].length)
        for number, (fault, begin, wall) in enumerate(lasting):
            self.last(wall + fault.length - time.monotonic(), lasting[number:])
            end = fault.end(self)
            begin = max([begin] + [at for other, at in ended if fault.counts_anew_after(other)])
            ended.append((fault, end))
            if fault.is_by_wall:
                walls.append(oracle.fault_span(wall, time.monotonic(), limits[fault.name], fault.name))
            elif not is_clock_sound:
                continue  # it cannot be said when this began
            else:
                spans.append(oracle.fault_span(begin, end, limits[fault.name], fault.name))
        self.judge(begun, [one for one in spans if one], [one for one in walls if one], begin_wall, put_at)
        self.now = []

    def last(self, seconds, lasting):
        """So long."""
        until = time.monotonic() + seconds
        while not self.is_over():
            for fault, _, _ in lasting:
                fault.while_it_lasts(self)
            self.look()
            left = until - time.monotonic()
            if left <= 0.0:
                return
            time.sleep(min(left, 0.05))

    def judge(self, begun, spans, walls, begin_wall, put_at):
        """Waits until motion is permitted again, and says what was wrong.
        @param spans, walls when nothing might be permitted, by the monitor's clock and by the machine's."""
        over = time.monotonic()
        release = self.patience(max((fault.release for fault, _, _ in begun), default=faults.INPUT_RELEASE_S))
        found = []
        reasons = []
        if not self.wait_until_permitted_after(over, release + LATE_S, reasons) and not self.is_over():
            why = " and ".join(fault.name for fault, _, _ in begun)
            found.append(oracle.Found("outlasts", f"{why}: {', '.join(reasons)}: {self.robot.status.detail}",
                                      rospy.get_time(), time.monotonic() - over))
            self.wait_until_permitted(self.patience(STARTS_S))
        permissions, truths, speeds = self.take_everything()
        is_clear = all(fault.is_clear for fault, _, _ in begun)
        if put_at is not None and is_clear:
            outs = oracle.moving_out(permissions)
            spans = spans + oracle.without(oracle.near_spans(truths, put_at), outs)
            found += oracle.contacts(truths, speeds, put_at, outs) + oracle.ways_in(truths, outs)
        found += oracle.false_clears(permissions, spans) + oracle.moves(speeds, spans)
        found += oracle.false_clears([dataclasses.replace(one, stamp=one.received) for one in permissions], walls)
        found += oracle.too_long_valid(permissions, VALID_S)
        touched = set().union(*(fault.touches for fault, _, _ in begun))
        if not touched & QUIETS:
            at, length = oracle.longest_silence(permissions, begin_wall, over)
            if length > SILENT_S:
                found.append(oracle.Found("silent", "no permission is heard, neither for nor against", at, length))
        again = oracle.permitted_again(permissions, over)
        for fault, begin, _ in begun:
            self.tally.add(fault, oracle.stopped_after(permissions, begin), again and again - over)
        self.tally.episode([fault.name for fault, _, _ in begun], found, spans + walls)
        report.show(self, begun, found)

    def wait_until_permitted_after(self, wall, patience_s, reasons):
        """@param reasons all that holds meanwhile is added, and since when after `wall`."""
        deadline, last = wall + patience_s, None
        while time.monotonic() < deadline and not self.is_over():
            if self.robot.heard_at > wall:
                return True
            status = self.robot.status
            if status and status.reason != last:
                last = status.reason
                reasons.append(f"{last} from {time.monotonic() - wall:.1f} s on")
            self.look()
            time.sleep(0.01)
        return False

    def end(self):
        """Also where it was not started to its end."""
        for thread in (self.client, self.operator):
            if thread:
                thread.ends.set()
        self.spin(0)
        if self.robot:
            self.robot.close()
        for name, status in self.system.end():
            self.tally.ended(name, status)
        self.tally.replayed = self.system.replay_stops()
        self.system.remove_disk()


def limits_of(drawn):
    """Of two at once one may hide that a sensor's map is missing, as scans are waited for where transforms are, until the
    map is too old. @return by name"""
    least = faults.MAP_AGE_S + faults.LATE_S if len(drawn) > 1 else 0.0
    return {fault.name: max(fault.limit, least) if fault.limit and fault.touches & SENSORS else fault.limit
            for fault in drawn}


def chosen_kinds(options):
    """By name."""
    return {name: kind for name, kind in faults.all_kinds().items()
            if options.only in name and ("camera" in options.sensors or "camera" not in name)
            and (options.stops <= system.STOPS_FEW or "disk" not in kind.touches)
            and (options.clock == "simulated" or "/clock" not in kind.touches)}


def sensors_of(text):
    if text not in ("laser", "laser,camera"):
        raise argparse.ArgumentTypeError("has to be laser or laser,camera")
    return text.split(",")


def positive(text):
    value = float(text)
    if not 0.0 < value < 1e5:
        raise argparse.ArgumentTypeError("has to be above 0")
    return value


def options():
    parser = argparse.ArgumentParser(prog="soak", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=positive, default=5.0, help="how long (%(default)g)")
    parser.add_argument("--seed", type=int, default=1, help="of the faults, the robot's noise and its goals (%(default)d)")
    parser.add_argument("--episode", type=int, default=1, metavar="N", help="begins with this one of the seed's (%(default)d)")
    parser.add_argument("--only", default="", metavar="TEXT", help="only faults with this in their names")
    parser.add_argument("--sensors", type=sensors_of, default=["laser", "camera"], help="laser or laser,camera (both)")
    parser.add_argument("--clock", choices=("wall", "simulated"), help="the monitor's; a simulated one has faults of its "
                        "own (every other two seeds)")
    parser.add_argument("--rate", type=positive, default=1.0, metavar="R", help="seconds of a simulated clock in one of the "
                        "machine's (%(default)g); at another only crashes tell something, as the oracle uses both clocks")
    parser.add_argument("--stops", type=int, default=system.STOPS_FEW, metavar="N",
                        help="how many stops are kept and replayed at the end (%(default)d)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for soak.json and the programs' logs")
    parser.add_argument("--sanitizer", default="", metavar="FILES", help="libraries that the nodelets were built to run "
                        "with (scripts/sanitize)")
    parser.add_argument("--list", action="store_true", help="all kinds of faults, and ends")
    chosen = parser.parse_args()
    chosen.clock = chosen.clock or ("simulated" if chosen.seed % 4 >= 2 or chosen.rate != 1.0 else "wall")
    if chosen.clock == "wall" and chosen.rate != 1.0:
        parser.error("--rate: only a simulated clock has another")
    return chosen


def main():
    chosen = options()
    kinds = chosen_kinds(chosen)
    if chosen.list:
        print("\n".join(sorted(kinds)))
        return 0
    if not kinds:
        print(f"soak: --only: no fault has '{chosen.only}' in its name; --list has them", file=sys.stderr)
        return 2
    folder = chosen.out or pathlib.Path(tempfile.mkdtemp(prefix="tccm_monitor_soak_"))
    folder.mkdir(parents=True, exist_ok=True)
    soak = Soak(chosen, folder)

    def interrupt(_number, _frame):
        soak.interrupted = True
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, interrupt)
    try:
        soak.run()
    except RuntimeError as error:
        print(f"soak: {error}; logs are in {folder}", file=sys.stderr)
        return 2
    finally:
        soak.end()
    result = report.result(soak)
    (folder / "soak.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    report.print_table(result)
    print(f"written  {folder / 'soak.json'}")
    return 0 if result["holds"] else 1


if __name__ == "__main__":
    sys.exit(main())
