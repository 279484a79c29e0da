#!/usr/bin/python3
"""What monitor_node loads into another's manager ends with it, is loaded anew where a monitor_node
that was killed left it, and monitor_node ends where the manager or the master does."""

import os
import signal
import socket
import subprocess
import unittest
import xmlrpc.client

import roslib.packages
import rospy
import rostest
from nodelet.srv import NodeletList

from gated_robot import MANAGER, pid_of_manager
from waiting import PATIENCE, wait_for

NODELETS = {"/collision_checker", "/tccm_mapper", "/tilt_scan_assembler"}


def free_port():
    with socket.socket() as free:
        free.bind(("localhost", 0))
        return free.getsockname()[1]


def answers(master):
    try:
        return master.getPid("/manager_test")[0] == 1
    except OSError:
        return False


class ManagerTest(unittest.TestCase):
    def setUp(self):
        self.list = rospy.ServiceProxy(MANAGER + "/list", NodeletList)
        self.list.wait_for_service(PATIENCE)

    def start_as(self, environment, *command):
        process = subprocess.Popen(command, env=environment)

        def end():
            process.kill()
            process.wait()
        self.addCleanup(end)
        return process

    def start(self, environment=None):
        """@return a process that has loaded everything."""
        process = subprocess.Popen(
            [roslib.packages.find_node("tccm_monitor", "monitor_node")[0], "__name:=tccm_monitor",
             "_manager:=" + MANAGER], stderr=subprocess.PIPE, text=True, env=environment)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        process.kill()
        process.wait()
        process.stderr.close()

    def loaded(self):
        return set(self.list().nodelets)

    def test_1_what_is_loaded_ends_with_it(self):
        for stop in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(stop.name):
                process = self.start()
                wait_for(lambda: self.loaded() == NODELETS)
                process.send_signal(stop)
                self.assertEqual(process.wait(PATIENCE), 0)
                self.assertEqual(self.loaded(), set())

    def test_2_what_was_left_is_loaded_anew(self):
        process = self.start()
        wait_for(lambda: self.loaded() == NODELETS)
        self.end(process)
        self.assertEqual(self.loaded(), NODELETS)
        process = self.start()
        missing = {f"{nodelet} was left in {MANAGER}" for nodelet in NODELETS}
        while missing:
            line = process.stderr.readline()
            self.assertNotEqual(line, "", missing)
            missing = {words for words in missing if words not in line}
        wait_for(lambda: self.loaded() == NODELETS)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(PATIENCE), 0)
        self.assertEqual(self.loaded(), set())

    def test_3_without_the_master_it_ends_and_says_so(self):
        environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
        master = self.start_as(environment, "rosmaster", "--core", "-p",
                               environment["ROS_MASTER_URI"].rsplit(":", 1)[1])
        parameters = xmlrpc.client.ServerProxy(environment["ROS_MASTER_URI"])
        wait_for(lambda: answers(parameters))
        for name, value in rospy.get_param("/").items():
            parameters.setParam("/manager_test", "/" + name, value)
        self.start_as(environment, roslib.packages.find_node("nodelet", "nodelet")[0], "manager",
                      "__name:=" + MANAGER.strip("/"))
        process = self.start(environment)
        wait_for(lambda: any(topic == "/trajectory" for topic, _ in
                             parameters.getSystemState("/manager_test")[2][1]))
        master.terminate()
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 1)
        self.assertIn(f"The ROS master at {environment['ROS_MASTER_URI']} is gone", said)

    def test_4_without_the_manager_it_ends(self):
        process = self.start()
        wait_for(lambda: self.loaded() == NODELETS)
        os.kill(pid_of_manager(), signal.SIGKILL)
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 1)
        self.assertIn(f"The nodelet manager {MANAGER} is gone", said)


if __name__ == "__main__":
    rospy.init_node("manager_test")
    rostest.rosrun("tccm_monitor", "manager", ManagerTest)
