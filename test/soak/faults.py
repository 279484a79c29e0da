"""Kinds of faults: what each does to the monitor or to the world, and how soon that has to stop the robot.

A kind is drawn once for each fault, with its own random numbers; `begin` and `end` do it and undo it.
"""

import math
import time

import rospy
from std_msgs.msg import String

import input_faults as known
from input_gate import altered, dated, delayed, frozen, headers_of, nothing

# Of monitored.yaml; the docs say what each is for.
JOINTS_S = 0.3
SCANS_S = 10 * 0.028 + 0.01 + 0.028  # no map; a scan may have waited for a transform, one may be under way
CLOUDS_S = 10 * 0.034 + 0.01 + 0.034
TRANSFORMS_S = 0.5
MAP_AGE_S = 0.5
AT_ONCE_S = 0.02 + JOINTS_S  # with the next message; where that does not come for want of time, it is missed
MODEL_S = 1.3  # 5 of 10 comparisons, ten a second, and what a scan's transforms wait
STANDING_TILT_S = 2.4  # its longest stroke and a quarter of a period, and what it takes to find that
EVIDENCE_S = None  # the other sensor may see the place

INPUT_RELEASE_S = 8.0  # a tilt period to be measured anew, the map's window, release_s
START_RELEASE_S = 15.0  # a process comes up besides


class Fault:
    """@var touches what of the system it changes; two at once touch different things.
    @var limit from its begin to the stop [s], None where nothing has to stop. @var release from its end until motion is
    permitted again [s]."""

    limit, release = None, INPUT_RELEASE_S
    lasts = (0.4, 2.0)
    why = ""
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

    def while_it_lasts(self, soak):
        """Called some times a second."""


class InputFault(Fault):
    """@param change_of makes of random numbers what the gate does with each message."""

    def __init__(self, name, topic, change_of, limit=None):
        super().__init__(name, topic)
        self.topic, self.change_of, self.limit = topic, change_of, limit
        self.is_clear = limit is not None or topic in ("joint_states", "/tf")

    def draw(self, random):
        super().draw(random)
        self.change = self.change_of(random)

    def begin(self, soak):
        return soak.robot.gates[self.topic].close(self.change)

    def end(self, soak):
        return soak.robot.gates[self.topic].open()


def lost(share):
    """A change: so many of the messages are lost, at random."""
    def of(random):
        return lambda message: [] if random.random() < share else [message]
    return of


def doubled(random):
    del random
    return lambda message: [message, message]


def reordered(random):
    """Each comes in its turn, or after the next."""
    waiting = []

    def change(message):
        if not waiting and random.random() < 0.4:
            waiting.append(message)
            return []
        return [message] + [waiting.pop() for _ in range(len(waiting))]
    return change


def fields_of(message, path=()):
    """@return the paths of all numbers in a message, those of lists by one of their places."""
    paths = []
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, (bool, str, bytes)):
            continue
        if isinstance(value, (int, float)):
            paths.append((*path, name))
        elif isinstance(value, (list, tuple)) and value:
            paths.append((*path, name, None))
        elif hasattr(value, "__slots__") and not hasattr(value, "to_sec"):
            paths += fields_of(value, (*path, name))
    return paths


def corrupted(random):
    """A change: of each message one number, always of the same field, is another."""
    choice, value = random.random(), random.choice((math.nan, math.inf, -math.inf, 0.0, -1.0, 1e30, -1e-30, 4e9))

    def put(owner, path):
        if path[0] is None:  # the owner is a list
            place = random.randrange(len(owner))
            if isinstance(owner[place], float):
                owner[place] = value
            elif hasattr(owner[place], "__slots__"):
                inner = fields_of(owner[place])
                put(owner[place], inner[int(choice * len(inner))])
            return
        current = getattr(owner, path[0])
        if len(path) > 1:
            if path[1] is None:
                current = list(current)
                setattr(owner, path[0], current)
            put(current, path[1:])
        elif isinstance(current, float):
            setattr(owner, path[0], value)
        else:
            setattr(owner, path[0], random.choice((0, 1, 255, 65535)) if math.isfinite(value) else 0)

    def change(message):
        paths = fields_of(message)
        put(message, paths[int(choice * len(paths))])
        try:
            return [type(message)().deserialize(serialized(message))]
        except Exception:  # pylint: disable=broad-except  # such a message cannot be sent
            return []
    return change


def serialized(message):
    import io  # pylint: disable=import-outside-toplevel
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def constant(change_of):
    """@param change_of makes a new change, without random numbers."""
    return lambda random: change_of()


def between(change_of, low, high):
    return lambda random: change_of(random.uniform(low, high))


def displaced(child, offset):
    def alter(message):
        for transform in message.transforms:
            if transform.child_frame_id == child:
                transform.transform.translation.x += offset
    return altered(alter)


def two_frames(random):
    del random
    count = [0]

    def alter(message):
        count[0] += 1
        if count[0] % 2:
            message.header.frame_id = "right_palm_link"
    return altered(alter)


def elsewhere(random):
    """As of a second publisher, whose joints are elsewhere, by far more than noise."""
    apart = random.uniform(0.1, 0.5)

    def change(message):
        second = known.JointState(header=message.header, name=message.name, velocity=message.velocity,
                                  position=[position + apart for position in message.position])
        return [message, second]
    return change


def nan_ranges(share):
    def alter(message):
        message.ranges = [r if i % 20 == 0 and share < 1.0 else math.nan for i, r in enumerate(message.ranges)]
    return altered(alter)


def nan_points(message):
    message.data = b"\x00\x00\xc0\x7f" * (len(message.data) // 4)


def stamped_now(message):
    """Later than it was measured, within what is taken."""
    for header in headers_of(message):
        header.stamp = rospy.Time.now()


def input_kinds():
    for topic, limit, far in (("joint_states", JOINTS_S, AT_ONCE_S), ("scan", SCANS_S, SCANS_S),
                              ("camera_cloud", CLOUDS_S, CLOUDS_S), ("/tf", TRANSFORMS_S, TRANSFORMS_S)):
        yield f"{topic} stopped", topic, constant(lambda: nothing), limit
        yield f"{topic} late", topic, between(delayed, 0.8, 1.5), max(limit, MAP_AGE_S)
        yield f"{topic} a little late", topic, between(delayed, 0.02, 0.12), None
        yield f"{topic} lost at times", topic, lost(0.3), None
        yield f"{topic} twice", topic, doubled, None
        yield f"{topic} out of order", topic, reordered, None
        yield f"{topic} frozen", topic, constant(frozen), limit + 0.034
        yield f"{topic} with a field corrupted", topic, corrupted, None
        yield f"{topic} stamped in the future", topic, between(dated, 6.0, 100.0), max(far, limit)
        yield f"{topic} stamped in the past", topic, between(lambda s: dated(-s), 3600.0, 4000.0), \
            max(limit, TRANSFORMS_S + 0.034)
    for name, change in known.BAD_JOINTS.items():
        yield f"joint_states {name}", "joint_states", lambda random, change=change: change, JOINTS_S
    for name, change in known.BAD_SCANS.items():
        yield f"scan {name}", "scan", lambda random, change=change: change, SCANS_S
    for name, change in known.BAD_TRANSFORMS.items():
        yield f"/tf {name}", "/tf", lambda random, change=change: change, TRANSFORMS_S
    yield "joint_states one publisher stopped", "joint_states", constant(lambda: known.without_left_part), JOINTS_S
    yield "joint_states in degrees", "joint_states", constant(
        lambda: known.with_list("position", lambda all_: [57.3 * p for p in all_])), AT_ONCE_S
    yield "joint_states velocities in ticks", "joint_states", constant(
        lambda: known.with_list("velocity", lambda all_: [1e5] * len(all_))), AT_ONCE_S
    yield "joint_states at two places", "joint_states", elsewhere, AT_ONCE_S
    yield "scan all NaN", "scan", constant(lambda: nan_ranges(1.0)), SCANS_S
    yield "scan one beam in twenty", "scan", constant(lambda: nan_ranges(0.05)), SCANS_S
    yield "scan of two frames", "scan", two_frames, SCANS_S
    yield "camera_cloud all NaN", "camera_cloud", constant(lambda: altered(nan_points)), CLOUDS_S
    yield "camera_cloud of two frames", "camera_cloud", two_frames, CLOUDS_S
    yield "/tf in a loop", "/tf", constant(lambda: known.in_a_loop), TRANSFORMS_S
    yield "/tf a link elsewhere", "/tf", between(lambda x: displaced("right_elbow_link", x), 0.08, 0.5), MODEL_S
    yield "/tf the head elsewhere", "/tf", between(lambda x: displaced("head_link", x), 0.1, 0.5), None


class TiltFault(Fault):
    """What the laser's tilt does."""

    lasts = (3.0, 5.0)

    def __init__(self, fault, limit):
        # One whose mapper has just begun passes for a laser that does not tilt, where the window is set by seconds.
        super().__init__(f"tilt {fault}", "tilt", "laser_mapper")
        self.fault, self.limit = fault, limit
        self.is_clear = False

    def say(self, soak, fault):
        soak.tilt.publish(String(fault))
        return rospy.get_time()

    def begin(self, soak):
        return self.say(soak, self.fault)

    def end(self, soak):
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
            program.end()
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
    from disturbances import world_kinds  # pylint: disable=import-outside-toplevel
    kinds = [InputFault(*kind) for kind in input_kinds()]
    kinds += [TiltFault("frozen", STANDING_TILT_S), TiltFault("narrowed", None), TiltFault("turned_away", None)]
    kinds += [Starved(), FullDisk(), *monitor_kinds(), *world_kinds()]
    return {kind.name: kind for kind in kinds}
