"""The simulated robot behind its gates, the monitor that watches it, an operator who resets, and a client who sends goals
for its arm. What is said and what is true is kept until it is taken."""

import json
import random
import threading
import time

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryGoal
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Point
from sensor_msgs.msg import JointState, LaserScan, PointCloud2
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker, MarkerArray

import oracle
from input_gate import Gate, nothing, raw_type
from tccm_monitor.msg import MonitorStatus, MotionPermission

SIDE = "right_arm"
STOPS_BYTES = "kept for the next stop [bytes]"
ANSWER_S = 1.0
SURE_S = 30.0  # for what lasts until it is undone: an answer that comes too late would leave it
LOOKS_AGAIN_S = 4.0  # in which a sensor that turned away looks again at all that it used to
GOAL_HANGS_S = 20.0  # beyond what it should take at full speed
GIVES_UP_S = 0.5  # that a goal has to end in once nobody waits for it


def in_time(call, seconds=ANSWER_S):
    """roscpp's services have no time limit. @return what it returns, or None where it fails or takes too long."""
    answers = []

    def run():
        try:
            answers.append(call())
        except (rospy.ServiceException, rospy.exceptions.ROSException):
            pass  # nobody is there
    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(seconds)
    return answers[0] if answers else None


class Kept:
    """What came in, until it is taken."""

    def __init__(self):
        self.lock, self.items = threading.Lock(), []

    def add(self, item):
        with self.lock:
            self.items.append(item)

    def take(self):
        with self.lock:
            items, self.items = self.items, []
        return items

    def look(self):
        with self.lock:
            return list(self.items)


class ClockGate:
    """What clock_gate.cpp does, which passes the simulation's clock on."""

    def __init__(self):
        self.publisher = rospy.Publisher("clock_gate/change", String, queue_size=10, latch=True)

    def close(self, change):
        self.publisher.publish(String(change))

    def open(self):
        self.publisher.publish(String())


class Robot:
    """@var gates by topic, through which all that the monitor hears goes."""

    def __init__(self, options):
        self.permissions, self.truths, self.speeds, self.latencies = Kept(), Kept(), Kept(), Kept()
        self.status, self.palm, self.positions = None, None, {}
        self.serial, self.rate = None, options.rate
        self.heard_at = 0.0  # the last permission that permits, by the machine's clock
        self.resets, self.cleared, self.stops_bytes = 0, 0, 0
        self.gates = {"joint_states": Gate("joint_states", JointState), "scan": Gate("scan", LaserScan),
                      "/tf": Gate("/tf", TFMessage)}
        if "camera" in options.sensors:
            self.gates["camera_cloud"] = Gate("camera_cloud", PointCloud2)
        if options.clock == "simulated":
            self.gates["/clock"] = ClockGate()
        for topic, kind, take in (("motion_permission", MotionPermission, self.take_permission),
                                  ("monitor_status", MonitorStatus, self.take_status),
                                  ("raw/joint_states", raw_type(JointState), self.take_joints),
                                  ("simulation/truth", String, self.take_truth),
                                  ("/diagnostics", DiagnosticArray, self.take_diagnostics)):
            rospy.Subscriber(topic, kind, take, queue_size=1000, tcp_nodelay=True)
        self.boxes = rospy.Publisher("simulation/put", MarkerArray, queue_size=10)
        self.reset = rospy.ServiceProxy("reset", Trigger)

    def take_permission(self, message):
        now = time.monotonic()
        one = oracle.Permission(message.header.stamp.to_sec(), message.permitted, message.valid_until.to_sec(), now,
                                tuple(message.reasons))
        self.permissions.add(one)
        if message.permitted:
            self.heard_at = now

    def take_status(self, message):
        self.status = message
        if message.serial != self.serial and not message.stop:
            self.serial = message.serial
            self.latencies.add((time.monotonic(), message.ready_to_verdict_s))

    def take_joints(self, raw):
        """As they are, whatever the gate makes of them; it has subscribed to them unread."""
        message = JointState()
        message.deserialize(raw._buff)
        self.positions = dict(zip(message.name, message.position))
        speeds = [abs(v) for name, v in zip(message.name, message.velocity) if name.startswith("right_")]
        self.speeds.add((message.header.stamp.to_sec(), max(speeds, default=0.0)))

    def take_diagnostics(self, message):
        for status in message.status:
            for pair in status.values:
                if pair.key == STOPS_BYTES:
                    self.stops_bytes = max(self.stops_bytes, int(pair.value))

    def take_truth(self, message):
        content = json.loads(message.data)
        if content["event"] == "hand":
            self.palm = content["palm_m"]
            self.truths.add((content["stamp_s"], content["hand_obstacle_m"]))

    def is_permitted(self):
        return time.monotonic() - self.heard_at < 0.2 / self.rate

    def put(self, *boxes):
        """@param boxes (centre, edges) in base_link [m]; none: they go. @return when it was said."""
        message = MarkerArray()
        for centre, edges in boxes:
            marker = Marker(ns="put", type=Marker.CUBE)
            marker.pose.position = Point(*centre)
            marker.pose.orientation.w = 1.0
            marker.scale.x, marker.scale.y, marker.scale.z = edges
            message.markers.append(marker)
        self.boxes.publish(message)
        return rospy.get_time()

    def close(self):
        for topic, gate in self.gates.items():
            gate.close("stopped" if topic == "/clock" else nothing)


class Operator(threading.Thread):
    """Resets what holds, some time after the cause is over. Where the laser saw a hand only while it was turned away, its map
    has to be cleared, as the advice says.
    @var turned_back when it did so, None where the map was cleared since [s]"""

    def __init__(self, robot):
        super().__init__(daemon=True)
        self.robot, self.ends = robot, threading.Event()
        self.turned_back = None
        self.clear_map = rospy.ServiceProxy("laser/clear_map", Trigger)

    def run(self):
        while not self.ends.wait(0.2):
            status = self.robot.status
            if status and status.reason == "AWAITING_RESET":
                answer = in_time(self.robot.reset)
                self.robot.resets += bool(answer and answer.success)
            if status and status.reason == "EVIDENCE_OLD" and status.level == MotionPermission.STOP and \
                    self.turned_back and time.monotonic() - self.turned_back > LOOKS_AGAIN_S and in_time(self.clear_map):
                self.turned_back = None
                self.robot.cleared += 1


class Client(threading.Thread):
    """Sends goals for the arm, one after another, while motion is permitted.
    @var hung goals of which nothing was heard any more; only those whose gate lived all the time."""

    def __init__(self, robot, seed, log):
        super().__init__(daemon=True)
        self.robot, self.random, self.ends = robot, random.Random(seed), threading.Event()
        self.log = log
        self.joints = rospy.get_param(f"{SIDE}_controller/joints")
        self.begin = None
        self.done, self.failed, self.hung, self.gate_lost_at = 0, 0, [], 0.0

    def target(self):
        """Near where the arm began, above the table."""
        spread = {"shoulder_yaw": (-0.25, 0.25), "elbow": (0.0, 0.28), "wrist_yaw": (-0.5, 0.5),
                  "wrist_pitch": (-0.25, 0.25), "wrist_roll": (-0.5, 0.5)}
        target = []
        for joint, position in zip(self.joints, self.begin):
            way = next((value for name, value in spread.items() if name in joint), (0.0, 0.0))
            target.append(position + self.random.uniform(*way))
        return target

    def goal(self):
        """@return goal, and how long it takes at full speed [s]"""
        target = self.target()
        here = [self.robot.positions[joint] for joint in self.joints]
        furthest = max(abs(a - b) for a, b in zip(here, target))
        seconds = max(0.5, 1.5 * furthest / self.random.uniform(0.2, 0.6))
        return FollowJointTrajectoryGoal(trajectory=JointTrajectory(joint_names=self.joints, points=[
            JointTrajectoryPoint(positions=target, velocities=[0.0] * len(target),
                                 time_from_start=rospy.Duration(seconds))])), seconds

    def follow(self, client, seconds):
        begin = time.monotonic()
        while not self.ends.wait(0.02):
            state = client.get_state()
            if state not in (GoalStatus.PENDING, GoalStatus.ACTIVE):
                return state == GoalStatus.SUCCEEDED
            if time.monotonic() - begin > 10.0 * seconds + GOAL_HANGS_S:  # speed_scale_min is 0.1
                if self.gate_lost_at < begin:
                    self.hung.append(begin)
                return None
            if self.gate_lost_at > begin and time.monotonic() - self.gate_lost_at > 5.0:
                return None  # nobody is left to tell
        return None

    def tell(self, client, succeeded):
        result = client.get_result() if succeeded is not None else None
        with open(self.log, "a", encoding="utf-8") as log:
            print(f"{rospy.get_time():.3f} {client.get_goal_status_text() if result else 'nothing is heard'}: "
                  f"{result.error_code if result else ''} {result.error_string if result else ''}", file=log)

    def run(self):
        client = actionlib.SimpleActionClient(f"{SIDE}/follow_joint_trajectory", FollowJointTrajectoryAction)
        while not self.ends.is_set() and not client.wait_for_server(rospy.Duration(1.0)):
            pass
        while not self.ends.wait(0.1):
            if not self.robot.is_permitted() or not self.robot.positions:
                continue
            if not client.wait_for_server(rospy.Duration(0.001)):  # what is sent now would be lost
                continue
            self.begin = self.begin or [self.robot.positions[joint] for joint in self.joints]
            goal, seconds = self.goal()
            client.send_goal(goal)
            succeeded = self.follow(client, seconds)
            if succeeded is None:
                client.cancel_goal()
                self.ends.wait(GIVES_UP_S)
            self.done += bool(succeeded)
            self.failed += not succeeded
            self.tell(client, succeeded)
