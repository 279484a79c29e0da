"""Kinds of faults of what the monitor hears: what is made of each message."""

import io
import math

import input_faults as known
from faults import AT_ONCE_S, CLOUDS_S, JOINTS_S, MAP_AGE_S, MODEL_S, SCANS_S, TRANSFORMS_S, Fault
from input_gate import altered, dated, delayed, frozen, nothing


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


class Displaced(InputFault):
    """Transforms have a link elsewhere than joint states do. A checker that begins anew compares anew."""

    def __init__(self, link):
        super().__init__("/tf a link elsewhere", "/tf", between(lambda x: displaced(link, x), 0.08, 0.5), MODEL_S)

    def counts_anew_after(self, other):
        return "checker" in other.touches


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
        yield f"{topic} stamped in the past", topic, between(lambda s: dated(-s), 100.0, 900.0), \
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
    yield "/tf the head elsewhere", "/tf", between(lambda x: displaced("head_link", x), 0.1, 0.5), None
