"""What the rostests share: they play a recording of the simulated robot and write down what the
nodelets say meanwhile. All times are seconds of the recording's own clock."""

import json
import os
import subprocess
import time

import rosbag
import rosgraph
import rospy
from catkin.find_in_workspaces import find_in_workspaces
from std_msgs.msg import Bool

from tccm_monitor.msg import MonitorStatus

START = 1000.0  # when every recording begins
TILT_PERIOD = 1.575
SCAN_PERIOD = 0.028
PUBLISH_PERIOD = 0.02
# What a loaded machine may add to the limits: the clock's step and the way through this program.
SLACK = 0.04
# Between two permissions, where the machine itself may stand still. That most come in time is looked
# at too: share_in_time().
GAP_MAX = 2.0
FLAGS = ("stop", "collision", "occlusion")


def share_in_time(times):
    """@return of the time in which something comes every PUBLISH_PERIOD the share that goes by without
    its being half a period late. A machine that stands still costs little of it, silence much."""
    steps = [b - a for a, b in zip(times, times[1:])]
    return sum(step for step in steps if step < 1.5 * PUBLISH_PERIOD) / sum(steps)


class Recording:
    def __init__(self, name):
        folder = find_in_workspaces(["share"], "tccm_monitor", "test_recordings")[0]
        self.bag = os.path.join(folder, name + ".bag")
        with open(os.path.join(folder, name + ".json"), encoding="utf-8") as file:
            self.truth = json.load(file)

    def last(self, topic):
        """When the last message of a topic was recorded."""
        with rosbag.Bag(self.bag) as bag:
            return max(stamp.to_sec() for _, _, stamp in bag.read_messages(topics=[topic]))

    def play(self):
        """@return the player, once the recording's time has begun."""
        player = subprocess.Popen(
            ["rosbag", "play", "--quiet", "--clock", "--hz=200", "--delay=1.5", self.bag],
            stdin=subprocess.DEVNULL)
        wait_until(START)
        return player


class Recorder:
    """Everything that one checker publishes, in the order it came."""

    def __init__(self, namespace=""):
        self.statuses = []
        self.flags = {flag: [] for flag in FLAGS}
        for flag in FLAGS:
            rospy.Subscriber(namespace + flag, Bool, self._take_flag, callback_args=flag,
                             queue_size=1000)
        rospy.Subscriber(namespace + "monitor_status", MonitorStatus, self.statuses.append,
                         queue_size=1000)

    def _take_flag(self, message, flag):
        self.flags[flag].append((rospy.get_time(), message.data))

    def between(self, begin, end):
        """The statuses of the checks in that time."""
        return [status for status in self.statuses
                if begin <= status.header.stamp.to_sec() < end]

    def flag_between(self, flag, begin, end):
        return [value for stamp, value in self.flags[flag] if begin <= stamp < end]

    def find(self, wanted, begin=0.0, after=-1):
        """The index of the first status that is as wanted, from the time `begin` on and after that
        index: several statuses may have one stamp. None where there is none."""
        for index, status in enumerate(self.statuses):
            if index > after and status.header.stamp.to_sec() >= begin and wanted(status):
                return index
        return None

    def first(self, wanted, begin=0.0, after=-1):
        """The stamp of that status."""
        index = self.find(wanted, begin, after)
        return None if index is None else self.statuses[index].header.stamp.to_sec()

    def changes(self):
        """(stamp, reason) wherever the reason is another than before."""
        changes = []
        for status in self.statuses:
            if not changes or changes[-1][1] != status.reason:
                changes.append((status.header.stamp.to_sec(), status.reason))
        return changes


def wait_until(stamp, patience=30.0):
    """@param patience seconds of the wall clock."""
    deadline = time.monotonic() + patience
    while rospy.get_time() < stamp:
        if time.monotonic() > deadline:
            raise AssertionError(f"the recording's time does not reach {stamp} s")
        time.sleep(0.002)


def wait_for_nodelets(namespace="", patience=30.0):
    """Until all three have subscribed to what they need."""
    for service in ("check_state", "get_cuboid_map", "clear_map"):
        rospy.wait_for_service(namespace + service, patience)
    deadline = time.monotonic() + patience
    assembler = rospy.resolve_name(namespace + "tilt_scan_assembler")
    while True:
        subscribers = dict(rosgraph.Master("/recorder").getSystemState()[1])
        # All nodelets of a manager are known by its name, so that the topic alone can tell.
        if len(subscribers.get("/scan", [])) >= (2 if namespace else 1):
            return
        if time.monotonic() > deadline:
            raise AssertionError(f"{assembler} does not listen to scans")
        time.sleep(0.05)
