"""Kinds of faults: what each does to the monitor or to the world, and how soon that has to stop the robot.

A kind is drawn once for each fault, with its own random numbers; `begin` and `end` do it and undo it.
"""

import time

import rospy
from std_msgs.msg import String

from input_gate import dated

# Of monitored.yaml; the docs say what each is for.
JOINTS_S = 0.3
LATE_S = 0.04  # that a machine which is busy may add on the way of the last message
SCANS_S = 10 * 0.028 + 0.01 + 0.028 + LATE_S  # no map; a scan may have waited for a transform, one may be under way
CLOUDS_S = 10 * 0.034 + 0.01 + 0.034 + LATE_S
TRANSFORMS_S = 0.5
MAP_AGE_S = 0.5
AT_ONCE_S = 0.02 + JOINTS_S  # with the next message; where that does not come for want of time, it is missed
CLOCK_S = 0.6  # half a second of the wall clock, and a check
MODEL_S = 1.3  # 5 of 10 comparisons, ten a second, and what a scan's transforms wait
STANDING_TILT_S = 2.4  # its longest stroke and a quarter of a period, and what it takes to find that
TILT_LEARNT_S = 8.0  # after which a mapper has come up and has seen the tilt turn

INPUT_RELEASE_S = 13.0  # what was taken for an obstacle leaves the map's window, is held for hold_s, then release_s
START_RELEASE_S = 15.0  # a process comes up besides


class Fault:
    """@var touches what of the system it changes; two at once touch different things.
    @var limit from its begin to the stop [s], None where nothing has to stop. @var release from its end until motion is
    permitted again [s]."""

    limit, release = None, INPUT_RELEASE_S
    lasts = (0.4, 2.0)
    is_by_wall = False  # whether the limit is one of the machine's clock, as the monitor's own is not to be relied on
    is_clear = True  # whether what the sensors see is passed on as it is, in time

    def __init__(self, name, *touches):
        self.name, self.touches = name, set(touches)

    def draw(self, random):
        self.length = random.uniform(*self.lasts)

    def begin(self, soak):
        """@return when, by the monitor's clock"""
        raise NotImplementedError

    def end(self, soak):
        """@return when, by the monitor's clock"""
        raise NotImplementedError

    def counts_anew_after(self, other):
        """Whether the limit counts from where another fault ends that came between."""
        del other
        return False

    def while_it_lasts(self, soak):
        """Called some times a second."""


class ClockFault(Fault):
    """@param change_of makes of random numbers what the clock's gate is told."""

    is_by_wall, is_clear = True, False

    def __init__(self, name, change_of, limit):
        super().__init__(f"clock {name}", "/clock", "processor")
        self.change_of, self.limit = change_of, limit

    def draw(self, random):
        super().draw(random)
        self.change = self.change_of(random)

    def begin(self, soak):
        soak.robot.gates["/clock"].close(self.change)
        return rospy.get_time()

    def end(self, soak):
        soak.robot.gates["/clock"].open()
        return rospy.get_time()


class TimeJump(Fault):
    """All that is heard is stamped earlier from now on, and later again at the end: as of a recording that is played from
    another place."""

    is_clear = False

    def __init__(self):
        super().__init__("time jumps", "/clock", "processor", "joint_states", "scan", "/tf", "camera_cloud")

    def draw(self, random):
        super().draw(random)
        self.way = random.uniform(0.3, 30.0)

    def begin(self, soak):
        for topic, gate in soak.robot.gates.items():
            gate.close(f"earlier {self.way}" if topic == "/clock" else dated(-self.way))
        return rospy.get_time()

    def end(self, soak):
        for gate in soak.robot.gates.values():
            gate.open()
        return rospy.get_time()


class TiltFault(Fault):
    """What the laser's tilt does. After a gap in the scans it has as long as before to go on. One whose mapper has just
    begun passes for a laser that does not tilt, where the window is set by seconds."""

    lasts = (3.0, 5.0)

    def __init__(self, fault, limit):
        super().__init__(f"tilt {fault}", "tilt", "laser_mapper")
        self.fault, self.limit_known = fault, limit
        self.is_clear = False

    def counts_anew_after(self, other):
        return True

    def say(self, soak, fault):
        soak.tilt.publish(String(fault))
        return rospy.get_time()

    def begin(self, soak):
        age = time.monotonic() - soak.system.programs["laser_mapper"].started
        self.limit = self.limit_known if age > TILT_LEARNT_S else None
        return self.say(soak, self.fault)

    def end(self, soak):
        if self.fault == "turned_away":
            soak.operator.turned_back = time.monotonic()
        return self.say(soak, "none")


class Starved(Fault):
    """Others take the processor."""

    is_clear = False

    def __init__(self):
        super().__init__("processor starved", "processor")

    def draw(self, random):
        super().draw(random)
        self.count = random.randrange(4, 10)

    def begin(self, soak):
        soak.spin(self.count)
        return rospy.get_time()

    def end(self, soak):
        soak.spin(0)
        return rospy.get_time()


class FullDisk(Fault):
    """Where stops are written there is no room."""

    def __init__(self):
        super().__init__("disk full", "disk")

    def begin(self, soak):
        soak.fill_disk()
        return rospy.get_time()

    def end(self, soak):
        soak.empty_disk()
        return rospy.get_time()


class Killed(Fault):
    """@param program of the monitor, that is killed and started anew. @param limit to the stop; None: it is the one that
    speaks, and is silent."""

    release, lasts = START_RELEASE_S, (0.3, 1.5)
    is_clear = False

    def __init__(self, program, limit, how="killed"):
        super().__init__(f"{program} {how}", program)
        self.program, self.limit, self.how = program, limit, how

    def begin(self, soak):
        program = soak.system.programs[self.program]
        if self.program == "gate":
            soak.client.gate_lost_at = time.monotonic()
        if self.how == "killed":
            program.kill()
        else:
            soak.tally.ended(self.program, program.end())
        return rospy.get_time()

    def end(self, soak):
        now = rospy.get_time()
        soak.system.programs[self.program].start()
        return now


class Paused(Fault):
    """A process stands still for a while."""

    lasts = (0.05, 2.5)
    is_clear = False

    def __init__(self, program, limit):
        super().__init__(f"{program} paused", program)
        self.program, self.limit = program, limit

    def begin(self, soak):
        soak.system.programs[self.program].pause()
        return rospy.get_time()

    def end(self, soak):
        now = rospy.get_time()
        soak.system.programs[self.program].go_on()
        if self.program == "gate":
            soak.client.gate_lost_at = time.monotonic()
        return now


def monitor_kinds():
    for program, limit in (("laser_assembler", SCANS_S), ("laser_mapper", SCANS_S), ("camera_assembler", CLOUDS_S),
                           ("camera_mapper", CLOUDS_S), ("checker", None), ("gate", None)):
        yield Killed(program, limit)
        yield Killed(program, limit, "ended")
        yield Paused(program, limit)


def all_kinds():
    """@return faults to draw, by name"""
    from disturbances import world_kinds  # pylint: disable=import-outside-toplevel,cyclic-import
    from inputs import Displaced, InputFault, input_kinds  # pylint: disable=import-outside-toplevel,cyclic-import
    kinds = [InputFault(*kind) for kind in input_kinds()] + [Displaced("right_elbow_link")]
    kinds += [TiltFault("frozen", STANDING_TILT_S), TiltFault("narrowed", None), TiltFault("turned_away", None)]
    kinds += [ClockFault("stopped", lambda random: "stopped", CLOCK_S),
              ClockFault("to and fro", lambda random: f"to_and_fro {random.uniform(0.5, 5.0)}", CLOCK_S),
              TimeJump()]
    kinds += [Starved(), FullDisk(), *monitor_kinds(), *world_kinds()]
    return {kind.name: kind for kind in kinds}
