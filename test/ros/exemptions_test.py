#!/usr/bin/python3
"""What links may touch: in frames that move, with goals, listed and lifted. What the checker answers
of a pose in which a link touches the table shows whether an exemption is in force."""

import time

import rospy
import rostest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from monitor_recorder import Recorder, wait_for_nodelets
from named_subtests import NamedSubTests
from tccm_monitor.msg import Primitive
from tccm_monitor.srv import (AddExemption, AddExemptionRequest, CheckState, CheckStateRequest,
                              CheckStateResponse, CheckTrajectory, LiftExemption, ListExemptions,
                              ReportGoal)
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from waiting import PATIENCE, wait_for

OWNER = "/grasping"
JOINTS = ["right_elbow_joint", "right_shoulder_pitch_joint"]


def ball(radius, x=0.0):
    primitive = Primitive(shape="sphere", radius=radius)
    primitive.pose.position.x = x
    primitive.pose.orientation.w = 1.0
    return primitive


def known(ask):
    """@return the first answer that is one: a machine that is busy lets inputs grow old."""
    def answer():
        response = ask()
        is_one = response.result not in (CheckStateResponse.UNKNOWN, CheckStateResponse.FAULT)
        return response if is_one else None
    return wait_for(answer)


class ExemptionsTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.recorder = Recorder()
        cls.transforms = rospy.Publisher("/tf", TFMessage, queue_size=10)
        cls.add = rospy.ServiceProxy("add_exemption", AddExemption)
        cls.lift = rospy.ServiceProxy("lift_exemption", LiftExemption)
        cls.list = rospy.ServiceProxy("list_exemptions", ListExemptions)
        cls.report = rospy.ServiceProxy("report_goal", ReportGoal)
        cls.check_state = rospy.ServiceProxy("check_state", CheckState)
        cls.check_trajectory = rospy.ServiceProxy("check_trajectory", CheckTrajectory)
        wait_for_nodelets()
        wait_for(lambda: cls.recorder.statuses and cls.recorder.statuses[-1].known)
        wait_for(lambda: cls.transforms.get_num_connections() > 0)
        cls.positions, cls.link = [], ""

    def setUp(self):
        # Where the machine stood still the map lacks scans, and another link may touch.
        if not self.positions or self.link_that_touches(self.positions) != self.link:
            type(self).positions, type(self).link = self.pose_that_touches()

    @classmethod
    def ask(cls, positions):
        request = CheckStateRequest()
        request.state.name, request.state.position = JOINTS, positions
        return known(lambda: cls.check_state(request))

    @classmethod
    def pose_that_touches(cls):
        """Positions at which one link alone touches, and that link; it is so a little to either side,
        too, so that no noise of what is seen undoes it."""
        for elbow in range(0, -80, -8):
            links = [None, None]  # which one touches alone at the pitches before
            for pitch in range(-120, 121):
                links.append(cls.link_that_touches([0.02 * elbow, 0.01 * pitch]))
                if links[-1] and len(set(links[-3:])) == 1:
                    return [0.02 * elbow, 0.01 * (pitch - 1)], links[-1]
        raise AssertionError("no pose in which one link alone touches")

    @classmethod
    def link_that_touches(cls, positions):
        """@return the link, or None where none touches, or several do."""
        answer = cls.ask(positions)
        if answer.result != CheckStateResponse.COLLISION:
            return None
        cls.add(owner="search", link=answer.link, region=ball(9.0), duration=rospy.Duration(9))
        alone = cls.ask(positions).result != CheckStateResponse.COLLISION
        cls.lift("search", "")
        return answer.link if alone else None

    def tearDown(self):
        self.report(OWNER, "", False)
        self.lift(OWNER, "")
        self.assertTrue(self.touches())

    def touches(self):
        return self.ask(self.positions).result == CheckStateResponse.COLLISION

    def exempt(self, seconds=30.0, region=None, **more):
        request = AddExemptionRequest(owner=OWNER, link=self.link, region=region or ball(9.0),
                                      duration=rospy.Duration(seconds), **more)
        answer = self.add(request)
        self.assertTrue(answer.success, answer.message)
        return answer

    def the_one(self):
        """The only one that is listed."""
        exemptions = self.list().exemptions
        self.assertEqual(len(exemptions), 1)
        return exemptions[0]

    def send_frame(self, seconds_old=0.0, x=0.0):
        stamped = TransformStamped(child_frame_id="cup")
        stamped.header.frame_id = "base_link"
        stamped.header.stamp = rospy.Time.now() - rospy.Duration(seconds_old)
        stamped.transform.translation.x = x
        stamped.transform.rotation.w = 1.0
        self.transforms.publish(TFMessage([stamped]))
        time.sleep(0.03)  # never two of one stamp

    def test_one_is_listed_with_all_that_it_is_and_lifted(self):
        answer = self.exempt()
        self.assertEqual(answer.message, "")
        self.assertFalse(self.touches())
        listed = self.the_one()
        self.assertEqual((listed.owner, listed.link, listed.frame, listed.with_goal, listed.why_not),
                         (OWNER, self.link, "", False, ""))
        self.assertEqual(listed.region, ball(9.0))
        self.assertEqual(listed.pose, ball(9.0).pose)
        self.assertEqual(listed.until, answer.until)
        wait_for(lambda: self.recorder.statuses[-1].exemptions == [listed])
        for owner, link in (("nobody", ""), (OWNER, "foot")):
            refused = self.lift(owner, link)
            self.assertEqual((refused.success, refused.lifted), (False, 0))
            self.assertIn(owner, refused.message)
        self.assertFalse(self.touches())
        lifted = self.lift(OWNER, self.link)
        self.assertEqual((lifted.success, lifted.lifted, lifted.message), (True, 1, ""))
        self.assertTrue(self.touches())
        self.assertEqual(self.list().exemptions, [])

    def test_a_duration_of_zero_ends_one(self):
        self.exempt()
        self.exempt(seconds=0.0)
        self.assertEqual(self.list().exemptions, [])
        self.assertTrue(self.touches())

    def test_a_region_moves_with_a_link_also_to_a_pose_that_is_asked_about(self):
        # Where the robot is, the link is far from what it touches in that pose.
        self.exempt(region=ball(0.35), frame="/" + self.link)
        listed = self.the_one()
        self.assertEqual((listed.frame, listed.why_not), (self.link, ""))
        self.assertNotEqual(listed.pose.position, listed.region.pose.position)
        self.assertFalse(self.touches())
        there = listed.region
        there.pose = listed.pose
        self.exempt(region=there)
        self.assertTrue(self.touches(), "it does not lie there")

    def test_a_region_in_a_frame_counts_while_the_frame_is_heard_of(self):
        answer = self.exempt(frame="cup")
        self.assertIn("'cup'", answer.message)
        self.assertIn("'cup'", self.the_one().why_not)
        self.assertEqual(self.the_one().pose.orientation.w, 0.0)
        self.assertTrue(self.touches())

        def counts():
            self.send_frame(x=1.0)
            return not self.touches()
        wait_for(counts)
        self.send_frame(x=1.0)
        wait_for(lambda: [e.pose.position.x for e in self.recorder.statuses[-1].exemptions] == [1])
        self.assertEqual(self.the_one().why_not, "")
        shown = self.shown()
        self.assertEqual([marker.pose.position.x for marker in shown], [1.0])
        wait_for(lambda: "transform_timeout_s" in self.the_one().why_not)
        self.assertTrue(self.touches())
        wait_for(lambda: [e for e in self.recorder.statuses[-1].exemptions if e.why_not])
        self.assertEqual(self.shown(fresh=False), [])
        self.send_frame(seconds_old=-2.0)
        wait_for(lambda: "future" in self.the_one().why_not)
        self.assertTrue(self.touches())

    def shown(self, fresh=True):
        """The regions in the markers."""
        for _ in range(2):  # the second was drawn after this call
            if fresh:
                self.send_frame(x=1.0)
            message = rospy.wait_for_message("robot_markers", MarkerArray, PATIENCE)
        return [marker for marker in message.markers if marker.ns == "exemptions"]

    def test_with_a_goal_it_counts_from_the_goals_begin_to_its_end(self):
        way = JointTrajectory(joint_names=JOINTS)
        way.points = [JointTrajectoryPoint(positions=self.positions)]  # it begins there

        def result():
            return known(lambda: self.check_trajectory(way)).result
        answer = self.exempt(with_goal=True)
        self.assertIn("waits for a goal", answer.message)
        self.assertIn("waits for a goal", self.the_one().why_not)
        self.assertEqual(result(), CheckStateResponse.COLLISION)
        self.assertTrue(self.report("/other", "/other-1", True).success)
        self.assertEqual(result(), CheckStateResponse.COLLISION)
        for arm in "left", "right":
            self.assertTrue(self.report(OWNER, arm, True).success)
        self.assertNotEqual(result(), CheckStateResponse.COLLISION, "at once")
        self.assertEqual(self.the_one().why_not, "")
        self.assertLessEqual((self.the_one().until - rospy.Time.now()).to_sec(), 30.0)
        self.report(OWNER, "left", False)
        self.assertNotEqual(result(), CheckStateResponse.COLLISION)
        self.report(OWNER, "right", False)
        self.assertEqual(result(), CheckStateResponse.COLLISION)
        self.assertEqual(self.list().exemptions, [])
        self.report("/other", "", False)

    def test_a_goal_without_names_is_refused(self):
        for owner, goal, under_way in (("", "1", True), (OWNER, "", True), ("", "1", False)):
            answer = self.report(owner, goal, under_way)
            self.assertFalse(answer.success)
            self.assertTrue(answer.message)


if __name__ == "__main__":
    rospy.init_node("exemptions_test")
    rostest.rosrun("tccm_monitor", "exemptions", ExemptionsTest)
