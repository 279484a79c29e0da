"""What a client that obeys tccm_monitor's permission does, apart from its node; to be copied."""

import collections
import math

import rospy
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from tccm_monitor.msg import MotionPermission

FUTURE_MAX = 0.05  # [s] a stamp may be ahead of this machine's clock
RETIME = 0.05  # [s] the commanded trajectory is published anew when it is off by this
ANNOUNCED_SCALE_MIN = 0.01  # no trajectory takes longer than messages can say
DT_MAX = 0.05  # [s] a cycle that comes later does not catch up

IDLE, CHECKING, MOVING, HELD, REFUSED = "IDLE", "CHECKING", "MOVING", "HELD", "REFUSED"

# One instant on two clocks [s]: the one of stamps, which may be simulated and may stand still, and
# one that always goes on.
Instant = collections.namedtuple("Instant", "stamp steady")


def rises(before, after):
    """Sequences are of 32 bits and wrap around."""
    return 0 < (after - before) % 2**32 < 2**31


class PermissionGate:
    """Says from the permissions heard so far whether the arms may move. Silence means no, on either
    clock."""

    def __init__(self):
        self.last = None
        self.defect = ""  # of the last one beside the one before
        self.news = 0.0  # when a stamp came that had not come before

    def hear(self, permission, now):
        """Every permission has to come here, in the order they came."""
        self.defect = ""
        if self.last and not rises(self.last.sequence, permission.sequence):
            self.defect = "the permission's sequence does not rise"
        elif self.last and permission.header.stamp < self.last.header.stamp:
            self.defect = "the permission's stamp goes back"
        if not self.last or permission.header.stamp != self.last.header.stamp:
            self.news = now.steady
        self.last = permission

    def objection(self, now):
        """Why the arms may not move now, one line for people; empty where they may."""
        last = self.last
        if not last:
            return "no permission was ever heard"
        if self.defect:
            return self.defect
        if not last.permitted or last.level > MotionPermission.SLOW:
            reason = " " + last.reasons[0] if last.reasons else ""
            return "not permitted:" + reason + (", " + last.detail if last.detail else "")
        if not 0.0 < last.speed_scale <= 1.0:
            return f"the permission's speed_scale is {last.speed_scale}"
        stamp, valid_until = last.header.stamp.to_sec(), last.valid_until.to_sec()
        if now.steady - self.news > valid_until - stamp:
            return "no new permission is heard"
        if now.stamp > valid_until:
            return "the permission has expired"
        if stamp > now.stamp + FUTURE_MAX:
            return "the permission's stamp lies in the future"
        return ""


def require_in_range(key, value, lowest, highest):
    if not lowest <= value <= highest:
        raise ValueError(f"{key}: {value} is outside [{lowest}, {highest}]")


class BadGoal(Exception):
    """Says in one line why a goal cannot be followed."""


def require(condition, complaint):
    if not condition:
        raise BadGoal(complaint)


def require_followable(trajectory):
    joints = len(trajectory.joint_names)
    require(0 < joints == len(set(trajectory.joint_names)), "its joints have no names, or the same")
    require(trajectory.points, "it has no points")
    before = -1.0
    for point in trajectory.points:
        require(len(point.positions) == joints and len(point.velocities) in (0, joints),
                "a point has not as many values as there are joints")
        require(all(map(math.isfinite, [*point.positions, *point.velocities])),
                "a value is not finite")
        seconds = point.time_from_start.to_sec()
        require(seconds >= 0.0 and seconds > before, "its points' times do not rise from 0 on")
        before = seconds


class GoalPath:
    """A joint trajectory as a way through joint space, from where the joints are: cubic between
    points where all of them state velocities, straight otherwise. Accelerations do not count."""

    def __init__(self, trajectory, positions, tolerance):
        """@param trajectory where its first point's time is 0, the joints have to be there; where
        it is above 0, they go there in that time.
        @param positions of the joints now, by name [rad] or [m]; others may be among them."""
        require_followable(trajectory)
        self.names = list(trajectory.joint_names)
        for name in self.names:
            require(name in positions, f"nobody publishes the position of {name}")
        first = trajectory.points[0]
        points = list(trajectory.points)
        if first.time_from_start:
            at_rest = [0.0] * len(self.names) if first.velocities else []
            points.insert(0, JointTrajectoryPoint(
                positions=[positions[name] for name in self.names], velocities=at_rest))
        self.cubic = all(point.velocities for point in points)
        self.points = [JointTrajectoryPoint(
            positions=point.positions, velocities=point.velocities if self.cubic else [],
            time_from_start=point.time_from_start) for point in points]
        self.times = [point.time_from_start.to_sec() for point in points]
        self.duration = self.times[-1]
        require(self.starts_at(positions, tolerance),
                "it begins elsewhere than where the joints are")

    def starts_at(self, positions, tolerance):
        """Whether the joints are at the path's first point."""
        return all(abs(positions[name] - at) <= tolerance
                   for name, at in zip(self.names, self.points[0].positions))

    def at(self, seconds):
        """Positions and velocities at a time from the start; beyond the end the last, at rest."""
        if seconds >= self.duration:
            return list(self.points[-1].positions), [0.0] * len(self.names)
        i = next(i for i in range(1, len(self.times)) if self.times[i] > seconds)
        a, b, T = self.points[i - 1], self.points[i], self.times[i] - self.times[i - 1]
        u = max(0.0, (seconds - self.times[i - 1]) / T)
        means = [(q1 - q0) / T for q0, q1 in zip(a.positions, b.positions)]
        if not self.cubic:
            return [q + u * T * mean for q, mean in zip(a.positions, means)], means
        ends = list(zip(a.positions, means, a.velocities, b.velocities))
        return ([q + T * (u * u * (3.0 - 2.0 * u) * mean + u * (1.0 - u)**2 * v0 +
                          u * u * (u - 1.0) * v1) for q, mean, v0, v1 in ends],
                [6.0 * u * (1.0 - u) * mean + (1.0 - u) * (1.0 - 3.0 * u) * v0 +
                 u * (3.0 * u - 2.0) * v1 for _, mean, v0, v1 in ends])

    def setpoint(self, seconds, scale, delay):
        """Position and velocity at a time, to be reached after a delay [s].
        @param scale of the speed: velocities are multiplied by it."""
        positions, velocities = self.at(seconds)
        return JointTrajectory(joint_names=self.names, points=[JointTrajectoryPoint(
            positions=positions, velocities=[scale * v for v in velocities],
            time_from_start=rospy.Duration(delay))])

    def rest(self, seconds=0.0, scale=1.0):
        """What is left from a time on, at that scale of the speed; begins at time 0."""
        message = self.setpoint(seconds, scale, 0.0)
        if not self.cubic:
            message.points[0].velocities = []
        for point, at in zip(self.points, self.times):
            if at > seconds:
                message.points.append(JointTrajectoryPoint(
                    positions=point.positions, velocities=[scale * v for v in point.velocities],
                    time_from_start=rospy.Duration((at - seconds) / scale)))
        return message


# What is to be published, None where nothing is. An empty trajectory cancels.
Output = collections.namedtuple("Output", "command trajectory", defaults=(None, None))


class GuardedMotion:
    """A motion that goes on only as long as it is permitted, and once held never goes on by itself.
    Reads no clock and knows no topic: what is to be published comes back from each call."""

    def __init__(self, lookahead=0.04, scale_change=4.0):
        """@param lookahead setpoints are to be reached so much later [s].
        @param scale_change how fast the scale of the speed may rise and fall [1/s]."""
        require_in_range("lookahead_s", lookahead, 0.002, 0.2)
        require_in_range("scale_change_per_s", scale_change, 0.1, 100.0)
        self.lookahead = lookahead
        self.scale_change = scale_change
        self.gate = PermissionGate()
        self.joints = []  # that were moved last
        self.state, self.reason = IDLE, ""
        self.path = None  # only while moving
        self.time = 0.0  # along the path [s]
        self.scale = 0.0  # of the speed
        self.last = 0.0  # stamp of the cycle before [s]
        # When the trajectory was published, from where, at what scale.
        self.announced = (0.0, 0.0, 1.0)

    @property
    def busy(self):
        return self.state in (MOVING, CHECKING)

    @property
    def state_text(self):
        return f"{self.state}: {self.reason}" if self.reason else self.state

    def hear(self, permission, now):
        self.gate.hear(permission, now)
        return self._hold_unless_permitted(now)

    def step(self, now):
        """To be called in each cycle."""
        output = self._hold_unless_permitted(now)
        if self.state != MOVING:
            return output
        if now.stamp < self.last:
            return self._hold("time jumps back")
        self._advance(now)
        command = self.path.setpoint(self.time + self.scale * self.lookahead, self.scale,
                                     self.lookahead)
        if self.time >= self.path.duration:
            self._enter(IDLE, "the goal is reached")
            return Output(command, self._nothing())
        return Output(command, self._announce(now) if self._trajectory_is_off(now) else None)

    def cancel(self):
        """The operator's own stop; nothing where nothing moves or is about to."""
        if self.state == CHECKING:
            self.refuse("cancelled")
        return self._hold("cancelled") if self.state == MOVING else Output()

    def begin_check(self):
        """A goal has come and is to be checked."""
        self._enter(CHECKING)

    def refuse(self, reason):
        """The goal is not free, or cannot be followed."""
        self._enter(REFUSED, reason)

    def start(self, path, now):
        """The goal is free: sets off where that is permitted."""
        objection = self.gate.objection(now)
        if objection:
            self.refuse(objection)
            return Output()
        self._enter(MOVING)
        self.path, self.time, self.scale, self.last = path, 0.0, 0.0, now.stamp
        return Output(None, self._announce(now))

    def _enter(self, state, reason=""):
        """The path does not outlive the motion: there is nothing left to resume."""
        self.state, self.reason, self.path = state, reason, None

    def _hold(self, reason):
        self._enter(HELD, reason)
        return Output(JointTrajectory(), self._nothing())

    def _hold_unless_permitted(self, now):
        objection = self.gate.objection(now) if self.state == MOVING else ""
        return self._hold(objection) if objection else Output()

    def _advance(self, now):
        dt = min(now.stamp - self.last, DT_MAX)
        self.last = now.stamp
        change_max = self.scale_change * dt
        change = max(-change_max, min(change_max, self.gate.last.speed_scale - self.scale))
        self.time += (self.scale + 0.5 * change) * dt
        self.scale += change

    def _trajectory_is_off(self, now):
        stamp, begin, scale = self.announced
        return abs(begin + scale * (now.stamp - stamp) - self.time) > RETIME

    def _announce(self, now):
        scale = max(self.gate.last.speed_scale, ANNOUNCED_SCALE_MIN)
        self.announced = (now.stamp, self.time, scale)
        message = self.path.rest(self.time, scale)
        message.header.stamp = rospy.Time.from_sec(now.stamp)
        self.joints = message.joint_names
        return message

    def _nothing(self):
        """Other arms may have trajectories of their own: only these joints' are over."""
        return JointTrajectory(joint_names=self.joints)
