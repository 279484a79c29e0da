#!/usr/bin/python3
"""Nodelets start and end at random moments while inputs stream and services are called: nothing
crashes, nothing hangs, and what was loaded serves everything that it should."""

import argparse
import random
import signal
import subprocess
import threading
import time
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rosservice
import rostest
from dynamic_reconfigure.srv import Reconfigure
from nodelet.srv import NodeletLoad, NodeletLoadRequest, NodeletUnload
from std_srvs.srv import Trigger

from gated_robot import MANAGER, pid_of_manager, wait_for

HANG = 5.0  # seconds
TYPES = {"tilt_scan_assembler": "TiltScanAssembler", "tccm_mapper": "TccmMapper",
         "collision_checker": "CollisionChecker"}
SERVICES = {"tilt_scan_assembler": [], "tccm_mapper": ["/clear_map", "/get_cuboid_map"],
            "collision_checker": ["/check_state", "/check_trajectory", "/add_exemption",
                                  "/lift_exemption", "/list_exemptions", "/report_goal", "/reset",
                                  "/attach_object", "/detach_object",
                                  "/collision_checker/set_parameters"]}
CRASHES = {-signal.SIGSEGV, -signal.SIGABRT, -signal.SIGBUS, -signal.SIGFPE, -signal.SIGILL}


class Callers:
    """Call services again and again, whether or not somebody serves them. Also measure how long
    the master takes to answer, since whoever starts or ends has to wait for it."""

    def __init__(self):
        self.answers = 0
        self.slowest_master = 0.0
        self._going_on = True
        calls = [(rospy.ServiceProxy("reset", Trigger), []),
                 (rospy.ServiceProxy("clear_map", Trigger), []),
                 (rospy.ServiceProxy("collision_checker/set_parameters", Reconfigure),
                  [Reconfigure._request_class().config])]
        self._threads = [threading.Thread(target=self._call, args=call) for call in calls]
        self._threads.append(threading.Thread(target=self._ask_master))
        for thread in self._threads:
            thread.start()

    def end(self):
        self._going_on = False
        for thread in self._threads:
            thread.join()

    def _call(self, proxy, arguments):
        while self._going_on:
            try:
                proxy(*arguments)
                self.answers += 1
            except (rospy.ServiceException, rospy.ROSException):
                pass
            time.sleep(0.003)

    def _ask_master(self):
        master = ServerProxy(rosgraph.get_master_uri())
        while self._going_on:
            begin = time.monotonic()
            master.getPid("/test")
            self.slowest_master = max(self.slowest_master, time.monotonic() - begin)
            time.sleep(0.05)


class StartAndEndTest(unittest.TestCase):
    times, seed = 6, 1

    @classmethod
    def setUpClass(cls):
        cls.load = rospy.ServiceProxy(MANAGER + "/load_nodelet", NodeletLoad)
        cls.unload = rospy.ServiceProxy(MANAGER + "/unload_nodelet", NodeletUnload)
        cls.load.wait_for_service(20.0)
        wait_for(lambda: pid_of_manager())

    def setUp(self):
        self.random = random.Random(self.seed)
        self.callers = Callers()
        self.addCleanup(self.callers.end)
        self.slowest = 0.0

    def timed(self, what, call):
        """@return what `call` returns, which has to be soon."""
        begin = time.monotonic()
        result = call()
        took = time.monotonic() - begin
        self.slowest = max(self.slowest, took)
        self.assertLess(took, HANG, f"{what} (the master's slowest answer took "
                                    f"{self.callers.slowest_master:.1f} s)")
        return result

    def begin(self, name):
        request = NodeletLoadRequest(name="/" + name, type="tccm_monitor/" + TYPES[name])
        self.assertTrue(self.timed("load " + name, lambda: self.load(request)).success)
        services = set(rosservice.get_service_list())
        missing = [service for service in SERVICES[name] if service not in services]
        self.assertEqual(missing, [], "loaded, but it lacks services")

    def test_in_a_manager(self):
        pid = pid_of_manager()
        loaded, order = set(), list(TYPES) * (2 * self.times)
        self.random.shuffle(order)
        for name in order:  # each either starts or ends
            if name in loaded:
                unloading = self.timed("unload " + name, lambda: self.unload("/" + name))
                self.assertTrue(unloading.success)
                loaded.remove(name)
            else:
                self.begin(name)
                loaded.add(name)
            self.assertEqual(pid_of_manager(), pid, "the manager died")
            time.sleep(self.random.choice((0.0, 0.3)) * self.random.random())
        for name in loaded:
            self.unload("/" + name)
        self.assertGreater(self.callers.answers, 10)
        self.tell(2 * self.times * len(TYPES), "loads and unloads in a manager")

    def test_alone(self):
        commands = {name: ["rosrun", "nodelet", "nodelet", "standalone", "tccm_monitor/" + name]
                    for name in TYPES.values()}
        commands["monitor_node"] = ["rosrun", "tccm_monitor", "monitor_node"]
        order = list(commands) * self.times
        self.random.shuffle(order)
        for name in order:
            process = subprocess.Popen(commands[name] + ["__name:=alone"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1.2 * self.random.random())
            process.send_signal(signal.SIGINT)
            code = self.timed("end of " + name, lambda: process.wait(timeout=2 * HANG))
            self.assertNotIn(code, CRASHES, name)
        self.tell(self.times * len(commands), "starts and ends alone")

    def tell(self, count, what):
        print(f"{count} {what}: slowest {self.slowest:.2f} s, the master's slowest answer "
              f"{self.callers.slowest_master:.2f} s, {self.callers.answers} calls answered")


if __name__ == "__main__":
    rospy.init_node("start_and_end_test")
    parser = argparse.ArgumentParser()
    parser.add_argument("--times", type=int, default=StartAndEndTest.times)
    parser.add_argument("--seed", type=int, default=StartAndEndTest.seed)
    settings, _ = parser.parse_known_args(rospy.myargv()[1:])
    StartAndEndTest.times, StartAndEndTest.seed = settings.times, settings.seed
    rostest.rosrun("tccm_monitor", "start_and_end", StartAndEndTest)
