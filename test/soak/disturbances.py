"""Kinds of faults that are no faulty input: things that come near, others that publish and call nonsense, parameters."""

import math
import time

import rospy
from dynamic_reconfigure.client import Client
from geometry_msgs.msg import Vector3
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

import bad_maps
from faults import AT_ONCE_S, Fault
from robot import SURE_S, in_time
from tccm_monitor.msg import CuboidMap, Primitive
from tccm_monitor.srv import AddExemption, AttachObject, CheckTrajectory, DetachObject, GetCuboidMap, SetKeepOut


class PlateNear(Fault):
    """A thin plate lies over the hand, as near as it is drawn; where it is near enough, that has to stop the robot."""

    lasts, is_clear = (3.0, 4.5), True

    def __init__(self):
        super().__init__("plate over the hand", "world")

    def draw(self, random):
        super().draw(random)
        self.gap = random.choice((0.005, 0.01, 0.03, 0.08, 0.15))
        self.edges = [random.uniform(0.06, 0.15), random.uniform(0.06, 0.15), 0.004]

    def begin(self, soak):
        x, y, z = soak.robot.palm
        now = soak.robot.put(([x, y, z + soak.HAND_HALF_M + self.gap], self.edges))
        soak.put_at = now
        return now

    def end(self, soak):
        soak.put_at = math.inf
        return soak.robot.put()


class WallBefore(PlateNear):
    """Something stands between the sensors and the hand."""

    def __init__(self):
        Fault.__init__(self, "wall before the hand", "world")

    def begin(self, soak):
        x, y, z = soak.robot.palm
        soak.put_at = rospy.get_time()
        return soak.robot.put(([x - 0.2, 0.7 * y, z + 0.15], [0.02, 0.3, 0.3]))


class KeptOut(Fault):
    """A region that none may enter, around the hand."""

    lasts, limit = (0.5, 1.5), 0.1

    def __init__(self):
        super().__init__("kept out", "keep_out", "checker")  # which forgets it with its end

    def call(self, soak, remove):
        region = SetKeepOut._request_class(name="soak", frame="base_link", remove=remove)
        region.pose.orientation.w = 1.0
        if not remove:
            region.pose.position.x, region.pose.position.y, region.pose.position.z = soak.robot.palm
            region.size = Vector3(0.6, 0.6, 0.6)
        answer = soak.call("set_keep_out", SetKeepOut, region, seconds=SURE_S)
        return bool(answer and answer.success)

    def begin(self, soak):
        self.is_set = self.call(soak, False)
        return rospy.get_time() if self.is_set else None

    def end(self, soak):
        now = rospy.get_time()
        while not self.call(soak, True):  # else it would stay
            if soak.is_over():
                break
            time.sleep(0.1)
        return now


class Nonsense(Fault):
    """Services are asked what makes no sense, many times a second."""

    def __init__(self, name, call):
        super().__init__(name, name)
        self.ask = call

    def draw(self, random):
        super().draw(random)
        self.random = random

    def begin(self, soak):
        return rospy.get_time()

    def while_it_lasts(self, soak):
        self.ask(soak, self.random)

    def end(self, soak):
        return rospy.get_time()


def wild(random):
    return random.choice((0.0, 0.3, -0.5, 2.0, 1e6, math.nan, math.inf, -math.inf, 1e300))


def ask_trajectory(soak, random):
    names = random.sample(soak.client.joints + ["nobodys_joint", ""], random.randrange(0, 5))
    points = [JointTrajectoryPoint(positions=[wild(random) for _ in range(random.randrange(0, 6))],
                                   time_from_start=rospy.Duration(random.uniform(0.0, 5.0)))
              for _ in range(random.randrange(0, 6))]
    soak.call("check_trajectory", CheckTrajectory,
              CheckTrajectory._request_class(JointTrajectory(joint_names=names, points=points)))


def wild_primitive(random):
    primitive = Primitive(shape=random.choice(("box", "sphere", "cone", "", "cylinder")), radius=wild(random),
                          length=wild(random), size=Vector3(*(wild(random) for _ in range(3))))
    primitive.pose.position.x, primitive.pose.orientation.w = wild(random), wild(random)
    return primitive


def ask_attach(soak, random):
    name = random.choice(("", "soak", "x" * 200))
    link = random.choice(("right_palm_link", "nobodys_link", ""))
    soak.call("attach_object", AttachObject, AttachObject._request_class(name, link, wild_primitive(random)))
    soak.call("detach_object", DetachObject, DetachObject._request_class("soak"))


def ask_exemption(soak, random):
    request = AddExemption._request_class(owner="soak", link=random.choice(("right_palm_link", "*", "")),
                                          region=wild_primitive(random), frame=random.choice(("", "nobodys_frame")),
                                          duration=rospy.Duration(0.1), with_goal=random.random() < 0.5)
    soak.call("add_exemption", AddExemption, request)


class Forged(Fault):
    """Another node publishes maps that are worth nothing, as a sensor's mapper would."""

    is_clear = False

    def __init__(self, sensor):
        super().__init__(f"{sensor}'s maps forged", f"{sensor}_maps")
        self.sensor, self.message = sensor, None

    def begin(self, soak):
        self.publisher = rospy.Publisher(f"{self.sensor}/cuboid_map", CuboidMap, queue_size=10)
        self.alterations = list(bad_maps.BAD_MAPS.values())
        return rospy.get_time()

    def while_it_lasts(self, soak):
        answer = soak.call(f"{self.sensor}/get_cuboid_map", GetCuboidMap)
        if answer and len(answer.map.cuboids) > 1 and self.alterations:
            answer.map.header.stamp = rospy.Time.now()
            self.alterations[soak.random.randrange(len(self.alterations))](answer.map)
            self.publisher.publish(answer.map)

    def end(self, soak):
        self.publisher.unregister()
        return rospy.get_time()


class Cleared(Fault):
    """Somebody has a map forgotten."""

    is_clear = False

    def __init__(self, sensor):
        super().__init__(f"{sensor}'s map cleared", f"{sensor}_maps")
        self.sensor = sensor

    def begin(self, soak):
        soak.call(f"{self.sensor}/clear_map", Trigger)
        return rospy.get_time()

    def end(self, soak):
        return rospy.get_time()


class BadCommand(Fault):
    """What an arm is said to be commanded cannot be understood, until it is taken back."""

    limit = AT_ONCE_S

    def __init__(self, name, trajectory):
        super().__init__(f"commanded {name}", "trajectory", "checker", "gate")
        self.trajectory = trajectory

    def begin(self, soak):
        soak.trajectory.publish(self.trajectory)
        return rospy.get_time()

    def while_it_lasts(self, soak):
        soak.trajectory.publish(self.trajectory)  # the gate says what it commands, too

    def end(self, soak):
        now = rospy.get_time()
        soak.trajectory.publish(JointTrajectory())
        return now


class Tuned(Fault):
    """@param limit where that has to stop the robot."""

    def __init__(self, name, values, limit=None):
        super().__init__(f"tuned {name}", "parameters", "checker")
        self.values, self.limit = values, limit

    def update(self, values):
        """@return whether it was taken."""
        def tune():
            client = Client("collision_checker", timeout=SURE_S)
            try:
                return client.update_configuration(values)
            finally:
                client.close()
        return bool(in_time(tune, SURE_S))

    def begin(self, soak):
        self.defaults = soak.tuned
        return rospy.get_time() if self.update(self.values) else None

    def end(self, soak):
        now = rospy.get_time()
        while not self.update({name: self.defaults[name] for name in self.values}) and not soak.is_over():
            time.sleep(0.1)  # else it would stay
        return now


def world_kinds():
    yield PlateNear()
    yield WallBefore()
    yield KeptOut()
    yield Nonsense("wild questions", ask_trajectory)
    yield Nonsense("wild objects", ask_attach)
    yield Nonsense("wild exemptions", ask_exemption)
    for sensor in ("laser", "camera"):
        yield Forged(sensor)
        yield Cleared(sensor)
    torso = ["torso_yaw_joint"]
    for name, joints, positions, seconds in (("an unknown joint", ["third_arm_joint"], [0.0], 1.0),
                                             ("NaN", torso, [math.nan], 1.0), ("backwards", torso, [0.0], -1.0),
                                             ("fewer positions", torso, [], 1.0)):
        yield BadCommand(name, JointTrajectory(joint_names=joints, points=[
            JointTrajectoryPoint(positions=positions, time_from_start=rospy.Duration.from_sec(seconds))]))
    yield Tuned("no time for checks", {"check_time_max_periods": 1e-6}, 0.1)
    yield Tuned("a larger padding", {"collision_padding_m": 0.05})
    yield Tuned("a longer horizon", {"horizon_s": 1.0})


