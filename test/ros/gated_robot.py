"""The robot behind its gates, and all that is said of it."""

import subprocess
import time
from xmlrpc.client import ServerProxy

import rosgraph
import rosnode
import rospy
from sensor_msgs.msg import JointState, LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from input_gate import Gate, nothing
from monitor_recorder import Recorder
from tccm_monitor.msg import MotionPermission, ScanReport

MANAGER = "/tccm_monitor_manager"
PATIENCE = 15.0  # seconds


def wait_for(what, patience=PATIENCE):
    """@return what `what` returns, once that is something; None where it never is."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        value = what()
        if value:
            return value
        time.sleep(0.004)
    return None


def pid_of_manager():
    return ServerProxy(rosgraph.Master("/test").lookupNode(MANAGER)).getPid("/test")[2]


class GatedRobot:
    def __init__(self):
        self.recorder = Recorder()
        self.permissions = []
        self.reports = []
        self.heard = {"scan_report": [], "cuboid_map": []}  # when, of what the nodelets say
        rospy.Subscriber("motion_permission", MotionPermission, self.permissions.append,
                         queue_size=1000, tcp_nodelay=True)
        rospy.Subscriber("scan_report", ScanReport, self._take_report, queue_size=1000,
                         tcp_nodelay=True)
        rospy.Subscriber("cuboid_map", rospy.AnyMsg, self._take_map, queue_size=1000,
                         tcp_nodelay=True)
        self.gates = {topic: Gate(topic, message_type)
                      for topic, message_type in (("joint_states", JointState),
                                                  ("scan", LaserScan), ("/tf", TFMessage))}
        self._processes = []
        self._reset = rospy.ServiceProxy("reset", Trigger)
        rospy.wait_for_service("reset", PATIENCE)
        self.pid = pid_of_manager()

    def run(self, command):
        """Until tear_down()."""
        self._processes.append(subprocess.Popen(command))

    def tear_down(self):
        for gate in self.gates.values():
            gate.close(nothing)
        for process in self._processes:
            process.terminate()
            process.wait()

    def _take_report(self, report):
        self.reports.append(report)
        self.heard["scan_report"].append(rospy.get_time())

    def _take_map(self, message):
        if message._connection_header["callerid"] == MANAGER:
            self.heard["cuboid_map"].append(rospy.get_time())

    def reset(self):
        return self._reset()

    def status(self):
        return self.recorder.statuses[-1] if self.recorder.statuses else None

    def may_move(self):
        return bool(self.permissions) and self.permissions[-1].level == MotionPermission.OK

    def wait_until_it_may_move(self):
        """Resets what holds, also where it was a busy machine that stopped the robot.
        @return the permission, or None."""
        def moves():
            if self.may_move():
                return self.permissions[-1]
            status = self.status()
            if status and status.reason == "AWAITING_RESET":
                self.reset()
                time.sleep(0.1)
            return None
        return wait_for(moves)

    def wait_for_permissions_until(self, stamp):
        wait_for(lambda: self.permissions and self.permissions[-1].header.stamp.to_sec() > stamp)

    def permissions_between(self, begin, end):
        return [permission for permission in self.permissions
                if begin <= permission.header.stamp.to_sec() < end]

    def first_permission(self, wanted, begin):
        """The first from the time `begin` on that is as wanted, or None."""
        for permission in list(self.permissions):
            if permission.header.stamp.to_sec() >= begin and wanted(permission):
                return permission
        return None

    def manager_lives(self):
        return rosnode.rosnode_ping(MANAGER, max_count=1) and pid_of_manager() == self.pid
