#!/usr/bin/python3
"""Joint states lack velocities, or say 0 while the robot moves: said once, and the obstacle ahead
is found from the positions."""

import rospy
import rostest
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState

from input_faults import with_fields, with_list
from input_gate import Gate
from monitor_recorder import START, Recorder, Recording, wait_for_nodelets
from named_subtests import NamedSubTests

SETTLED = START + 2.6
PATIENCE = 0.15  # after the first beam on the obstacle: it takes three returns
CHANGES = {"missing": with_fields(velocity=[]),
           "zero": with_list("velocity", lambda velocities: [0.0] * len(velocities))}
SAID = {"missing": "is published without a velocity",
        "zero": "is published with velocity 0 while it moves"}


class VelocitiesTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.log = []
        rospy.Subscriber("/rosout", Log, cls.log.append, queue_size=1000)
        cls.recorders = {name: Recorder(name + "/") for name in CHANGES}
        for name, change in CHANGES.items():
            Gate(name + "/joint_states", JointState, source="/joint_states").close(change)
            wait_for_nodelets(name + "/")
        recording = Recording("collision")
        cls.truth = recording.truth
        recording.play().wait()

    def test_the_robot_may_move_before_the_obstacle_is_there(self):
        for name, recorder in self.recorders.items():
            with self.subTest(velocities=name):
                before = recorder.between(SETTLED, self.truth["obstacle_appeared_s"])
                self.assertGreater(len(before), 50)
                self.assertEqual({status.reason for status in before}, {"CLEAR"})

    def test_the_collision_ahead_is_found_all_the_same(self):
        first_beam = self.truth["first_beam_s"]
        for name, recorder in self.recorders.items():
            with self.subTest(velocities=name):
                index = recorder.find(lambda status: status.reason == "COLLISION_AHEAD", SETTLED)
                self.assertIsNotNone(index, recorder.changes())
                found = recorder.statuses[index]
                self.assertGreater(found.header.stamp.to_sec(), first_beam)
                self.assertLess(found.header.stamp.to_sec(), first_beam + PATIENCE)
                self.assertTrue(found.link.startswith("right_"), found.link)
                self.assertGreater(found.time_to_contact_s, 0.0)

    def test_it_is_said_once(self):
        for name in CHANGES:
            with self.subTest(velocities=name):
                said = [message.msg for message in self.log
                        if message.name.startswith(f"/{name}/") and
                        "Velocities are taken from positions" in message.msg]
                self.assertEqual(len(said), 1, said)
                self.assertIn(SAID[name], said[0])


if __name__ == "__main__":
    rospy.init_node("velocities_test")
    rostest.rosrun("tccm_monitor", "velocities", VelocitiesTest)
