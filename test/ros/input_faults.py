"""All that can be wrong with what the monitor hears: what is done to it, and what the monitor has
to say of it, how soon."""

import subprocess

import rospy
from dynamic_reconfigure.client import Client
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bad_maps import publish_bad_maps
from gated_robot import MANAGER
from input_gate import altered, dated, delayed, frozen, nothing, set_fields
from monitor_recorder import SCAN_PERIOD
from tccm_monitor.msg import MotionPermission

NAN, INFINITY = float("nan"), float("inf")
ROBOT_PERIOD = 0.01  # of joint states and transforms
JOINT_LIMIT = 0.1
TRANSFORM_LIMIT = 0.5
# A scan reaches the map with the next transform, and three periods without another are too long.
SCAN_LIMIT = 3.0 * SCAN_PERIOD + ROBOT_PERIOD
# Where scans go on, a map is missed when one of them was assembled after these three periods.
MAP_LIMIT = SCAN_LIMIT + SCAN_PERIOD


class Fault:
    """@param change what the gate makes of each message.
    @param limit seconds from the last sound message to the reason."""

    leaves = ()  # reasons that may come up when it ends, too shortly to be published

    def __init__(self, topic, change, reason, limit, level=MotionPermission.FAULT):
        self.topic = topic
        self.change = change
        self.reason = reason
        self.limit = limit
        self.level = level

    @property
    def holds(self):
        """Until it is reset."""
        return self.level == MotionPermission.FAULT

    def begin(self, robot):
        """@return when the last sound message went through."""
        return robot.gates[self.topic].close(self.change)

    def last_sound(self, robot, found, begin):
        """The same, once it was found at that time."""
        return begin

    def end(self, robot):
        return robot.gates[self.topic].open()


class NodeletDies(Fault):
    """@param topic what it says. @param hostile begins to publish something else instead."""

    leaves = ("NO_TRANSFORM",)  # there are none yet when it starts

    def __init__(self, name, nodelet_type, topic, limit, hostile=None):
        super().__init__(topic, None, "NO_MAP", limit)
        self.name, self.type, self.hostile = name, nodelet_type, hostile
        self._timer = None

    def begin(self, robot):
        if self.hostile:
            self._timer = self.hostile()
        now = rospy.get_time()
        subprocess.run(["rosrun", "nodelet", "nodelet", "unload", self.name, MANAGER], check=True)
        return now

    def last_sound(self, robot, found, begin):
        """It dies some time after the command to do so was given."""
        return max(stamp for stamp in robot.heard[self.topic] if stamp < found)

    def end(self, robot):
        now = rospy.get_time()
        robot.run(["rosrun", "nodelet", "nodelet", "load", self.type, MANAGER,
                   "__name:=" + self.name.lstrip("/")])
        if self._timer:
            self._timer.shutdown()
        return now


class NoTimeForChecks(Fault):
    """No check is as quick as is asked for."""

    def __init__(self):
        super().__init__(None, None, "CHECK_LATE", 0.0)
        self._client = None

    def _tune(self, periods):
        self._client = self._client or Client("collision_checker", timeout=10.0)
        self._client.update_configuration({"check_time_max_periods": periods})
        return rospy.get_time()

    def begin(self, robot):
        return self._tune(1e-6)

    def end(self, robot):
        before = rospy.get_time()  # it takes effect before the call returns
        self._tune(2.0)
        return before


class BadTrajectory(Fault):
    """@param sound what ends it."""

    def __init__(self, trajectory, sound):
        super().__init__(None, None, "BAD_TRAJECTORY", 0.0, MotionPermission.STOP)
        self.trajectory, self.sound = trajectory, sound
        self._publisher = None

    def _command(self, robot, trajectory):
        if not self._publisher:
            self._publisher = rospy.Publisher("trajectory", JointTrajectory, queue_size=1)
            while self._publisher.get_num_connections() == 0:
                rospy.sleep(0.01)
        now = rospy.get_time()
        self._publisher.publish(trajectory)
        return now

    def begin(self, robot):
        return self._command(robot, self.trajectory)

    def end(self, robot):
        return self._command(robot, self.sound)


def with_fields(**fields):
    return altered(set_fields(**fields))


def with_list(name, value_of):
    """@param value_of from the list as it was."""
    def alter(message):
        setattr(message, name, value_of(getattr(message, name)))
    return altered(alter)


def part(message, names):
    indices = [i for i, name in enumerate(message.name) if name in names]
    return JointState(header=message.header, name=[message.name[i] for i in indices],
                      position=[message.position[i] for i in indices],
                      velocity=[message.velocity[i] for i in indices])


def parts_of(message):
    """As several publishers would send them."""
    left, right = ({name for name in message.name if name.startswith(side)}
                   for side in ("left_", "right_"))
    return [part(message, names) for names in (left, right, set(message.name) - left - right)]


def without_joint(message):
    return [part(message, set(message.name) - {"right_elbow_joint"})]


def without_left_part(message):
    return parts_of(message)[1:]


def with_a_second_position(message):
    """As a second node would send it: the same joints with the same stamp, elsewhere."""
    second = JointState(header=message.header, name=message.name, velocity=message.velocity,
                        position=[position + 0.3 for position in message.position])
    return [message, second]


def one_in_twenty(ranges):
    """The other beams measure nothing."""
    return [r if i % 20 == 0 else NAN for i, r in enumerate(ranges)]


def with_rotation(**quaternion):
    def alter(message):
        for transform in message.transforms:
            for name, value in quaternion.items():
                setattr(transform.transform.rotation, name, value)
    return altered(alter)


def with_translation(value):
    def alter(message):
        for transform in message.transforms:
            transform.transform.translation.z = value
    return altered(alter)


def in_a_loop(message):
    for transform in message.transforms:
        if transform.child_frame_id == "torso_link":
            transform.header.frame_id = "right_palm_link"
    return [message]


def trajectory(names, *points):
    """@param points (time, positions)"""
    return JointTrajectory(joint_names=names, points=[
        JointTrajectoryPoint(positions=positions, time_from_start=rospy.Duration(seconds))
        for seconds, positions in points])


def joints(change, reason="NO_JOINTS", limit=JOINT_LIMIT):
    return Fault("joint_states", change, reason, limit)


def scans(change, reason="NO_MAP", limit=SCAN_LIMIT):
    return Fault("scan", change, reason, limit)


def transforms(change, reason="NO_TRANSFORM", limit=TRANSFORM_LIMIT):
    return Fault("/tf", change, reason, limit)


BAD_SCANS = {
    "no beams": with_fields(ranges=[]),
    "too many beams": with_list("ranges", lambda ranges: ranges * 10),
    "angle_increment NaN": with_fields(angle_increment=NAN),
    "angle_increment 0": with_fields(angle_increment=0.0),
    "angle_min infinite": with_fields(angle_min=INFINITY),
    "time_increment NaN": with_fields(time_increment=NAN),
    "time_increment negative": with_fields(time_increment=-1e-5),
    "range_max NaN": with_fields(range_max=NAN),
    "range_max below range_min": with_fields(range_max=0.0),
}
BAD_JOINTS = {
    "positions NaN": with_list("position", lambda positions: [NAN] * len(positions)),
    "positions infinite": with_list("position", lambda positions: [INFINITY] * len(positions)),
    "one position NaN": with_list("position", lambda positions: [NAN, *positions[1:]]),
    "fewer positions than names": with_list("position", lambda positions: positions[:-1]),
    "no positions": with_fields(position=[]),
    "no names": with_fields(name=[]),
    "one joint missing": without_joint,
}
BAD_TRANSFORMS = {
    "translation NaN": with_translation(NAN),
    "rotation NaN": with_rotation(w=NAN),
    "rotation 0": with_rotation(x=0.0, y=0.0, z=0.0, w=0.0),
    "rotation of length 2": with_rotation(x=0.0, y=0.0, z=0.0, w=2.0),
}


TORSO = ["torso_yaw_joint"]
NO_TRAJECTORY = JointTrajectory()
STAY = trajectory(TORSO, (0.2, [0.0]))
FAULTS = {
    "joint_states": {
        "stopped": joints(nothing),
        "late": joints(delayed(0.2)),
        "stamped in the past": joints(dated(-0.155)),
        "stamped in the future": joints(dated(1.0), "FUTURE_STAMP"),
        # The first of those that are all the same is sound.
        "frozen": joints(frozen(), limit=JOINT_LIMIT + ROBOT_PERIOD),
        "one of several publishers stopped": joints(without_left_part),
        "in degrees": joints(
            with_list("position", lambda positions: [57.3 * p for p in positions]),
            "JOINT_OUT_OF_RANGE", ROBOT_PERIOD),
        "velocities in ticks": joints(
            with_list("velocity", lambda velocities: [1e5 for _ in velocities]),
            "JOINT_OUT_OF_RANGE", ROBOT_PERIOD),
        "at two places": joints(with_a_second_position, "JOINT_CONTRADICTED", ROBOT_PERIOD),
        **{name: joints(change) for name, change in BAD_JOINTS.items()},
    },
    "scan": {
        "stopped": scans(nothing),
        "late": scans(delayed(1.0)),
        "stamped before all transforms": scans(dated(-3600.0), "NO_TRANSFORM",
                                              TRANSFORM_LIMIT),
        "stamped in the future": scans(dated(1.0), "FUTURE_STAMP"),
        "frozen": scans(frozen(), limit=MAP_LIMIT + SCAN_PERIOD),
        "of a frame that nobody knows": scans(
            altered(lambda scan: setattr(scan.header, "frame_id", "nowhere")), "NO_TRANSFORM",
            TRANSFORM_LIMIT + SCAN_PERIOD),  # the first of them is dropped for its other frame
        "all NaN": scans(with_list("ranges", lambda ranges: [NAN] * len(ranges)), "BLIND"),
        "one beam in twenty": scans(with_list("ranges", one_in_twenty), "BLIND"),
        "all too close": scans(with_list("ranges", lambda ranges: [-INFINITY] * len(ranges)),
                               "BLIND"),
        "all 0": scans(with_list("ranges", lambda ranges: [0.0] * len(ranges)), "BLIND"),
        **{name: scans(change) for name, change in BAD_SCANS.items()},
    },
    "tf": {
        "stopped": transforms(nothing),
        "late": transforms(delayed(1.0)),
        "stamped in the past": transforms(dated(-0.805)),
        "stamped in the future": transforms(dated(5.0), "FUTURE_STAMP"),
        "in a loop": transforms(in_a_loop),
        **{name: transforms(change) for name, change in BAD_TRANSFORMS.items()},
    },
    "nodelets": {
        "assembler dead": NodeletDies("/tilt_scan_assembler", "tccm_monitor/TiltScanAssembler",
                                      "scan_report", SCAN_LIMIT),
        "mapper dead": NodeletDies("/tccm_mapper", "tccm_monitor/TccmMapper", "cuboid_map",
                                   MAP_LIMIT),
        "mapper dead and maps forged": NodeletDies("/tccm_mapper", "tccm_monitor/TccmMapper",
                                                   "cuboid_map", MAP_LIMIT, publish_bad_maps),
        "checks too slow": NoTimeForChecks(),
        "unknown joint commanded": BadTrajectory(trajectory(["third_arm_joint"], (1.0, [0.0])),
                                                 NO_TRAJECTORY),
        "times not in order": BadTrajectory(trajectory(TORSO, (1.0, [0.0]), (0.5, [0.0])), STAY),
        "position NaN commanded": BadTrajectory(trajectory(TORSO, (1.0, [NAN])), NO_TRAJECTORY),
        "fewer positions than joints": BadTrajectory(trajectory(TORSO, (1.0, [])), STAY),
    },
}
