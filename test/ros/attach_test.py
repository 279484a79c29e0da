#!/usr/bin/python3
"""What the hand holds: the services, the list for all nodelets, the map that lets go of what was
seen of it, the status and the markers."""

import math
import time

import numpy
import rospy
import rostest
from rosgraph_msgs.msg import Log
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from monitor_recorder import Recorder, wait_for_nodelets
from named_subtests import NamedSubTests
from tccm_monitor.msg import AttachedObject, AttachedObjects, CuboidMap, Primitive
from tccm_monitor.srv import AttachObject, CheckState, CheckStateResponse, DetachObject
from waiting import PATIENCE, wait_for

HAND = "right_palm_link"
RADIUS = 0.04
FORGET_PADDING = 0.08  # the default
CELL_DOUBT = 0.015  # how far a point may be from its cell's centre


def ball(position, radius=RADIUS):
    primitive = Primitive(shape="sphere", radius=radius)
    primitive.pose.position.x, primitive.pose.position.y, primitive.pose.position.z = position
    primitive.pose.orientation.w = 1.0
    return primitive


def cuboids_of(cuboid_map):
    """Middle and bottom of the cell's column, and its top, of each cuboid [m]."""
    cells = numpy.array([cuboid.cell for cuboid in cuboid_map.cuboids])
    top = numpy.array([cuboid.top for cuboid in cuboid_map.cuboids])
    depth = numpy.array([cuboid.depth for cuboid in cuboid_map.cuboids])
    x = cuboid_map.origin_x + (cells % cuboid_map.cells_x + 0.5) * cuboid_map.cell_size
    y = cuboid_map.origin_y + (cells // cuboid_map.cells_x + 0.5) * cuboid_map.cell_size
    return numpy.stack([x, y, top - depth, top], axis=1)


def distance_to(point, cuboids):
    """From a point to the columns' middle lines."""
    z = numpy.clip(point[2], cuboids[:, 2], cuboids[:, 3])
    return numpy.sqrt((cuboids[:, 0] - point[0]) ** 2 + (cuboids[:, 1] - point[1]) ** 2 +
                      (z - point[2]) ** 2)


def matrix_of(transform):
    x, y, z, w = (getattr(transform.rotation, axis) for axis in "xyzw")
    p = transform.translation
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p.x],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p.y],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p.z],
        [0.0, 0.0, 0.0, 1.0]])


def hand_by_tf():
    """The hand in base_link; the simulation sends its whole tree at once."""
    message = rospy.wait_for_message("/tf", TFMessage, PATIENCE)
    above = {stamped.child_frame_id: stamped for stamped in message.transforms}
    pose, frame = numpy.eye(4), HAND
    while frame != "base_link":
        pose = matrix_of(above[frame].transform) @ pose
        frame = above[frame].header.frame_id
    return pose


class AttachTest(NamedSubTests):
    @classmethod
    def setUpClass(cls):
        cls.recorder, cls.unheard = Recorder(), Recorder("unheard/")
        cls.lists, cls.maps = [], []
        rospy.Subscriber("attached_objects", AttachedObjects, cls.lists.append, queue_size=100)
        rospy.Subscriber("cuboid_map", CuboidMap, cls.maps.append, queue_size=1000)
        cls.attach_object = rospy.ServiceProxy("attach_object", AttachObject)
        cls.detach_object = rospy.ServiceProxy("detach_object", DetachObject)
        cls.check_state = rospy.ServiceProxy("check_state", CheckState)
        wait_for_nodelets()
        wait_for(lambda: cls.maps and cls.maps[-1].complete)
        wait_for(lambda: cls.recorder.statuses and cls.recorder.statuses[-1].known)
        cls.T_base_hand = hand_by_tf()
        cls.place = cls.place_of_something_seen()
        cls.place_in_hand = (numpy.linalg.inv(cls.T_base_hand) @ [*cls.place, 1.0])[:3]

    @classmethod
    def place_of_something_seen(cls):
        """On top of the cuboid that is nearest to the middle of the hand."""
        cuboids = cuboids_of(cls.maps[-1])
        nearest = cuboids[numpy.argmin(distance_to(cls.T_base_hand[:3, 3], cuboids))]
        return nearest[[0, 1, 3]]

    def setUp(self):
        self.detach_all()

    def tearDown(self):
        self.detach_all()

    def detach_all(self):
        """Nothing is attached, as far as anybody says."""
        self.assertTrue(self.detach_object("").success)
        self.wait_for_attached([])

    def attach(self, name="ball", primitive=None):
        answer = self.attach_object(name, HAND, primitive or ball(self.place_in_hand))
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.message, "")
        return answer

    def wait_for_attached(self, names, patience=PATIENCE):
        wait_for(lambda: self.recorder.statuses[-1].attached_objects == names, patience)
        wait_for(lambda: self.lists and [o.name for o in self.lists[-1].objects] == names, patience)

    def markers(self, topic):
        """Markers by namespace, of a message that was drawn after this call."""
        rospy.wait_for_message(topic, MarkerArray, PATIENCE)
        message = rospy.wait_for_message(topic, MarkerArray, PATIENCE)
        counts = {}
        for marker in message.markers:
            counts[marker.ns] = counts.get(marker.ns, 0) + 1
        return counts

    def test_what_is_attached_is_in_the_status_within_a_second(self):
        self.attach()
        self.wait_for_attached(["ball"], patience=1.0)

    def test_it_never_touches_what_was_seen_of_it(self):
        for _ in range(3):
            self.attach()
            self.wait_for_attached(["ball"])
            time.sleep(0.3)  # scans that were under way
            self.detach_all()
        self.assertEqual({status.detail for status in self.recorder.statuses
                          if "ball" in status.detail}, set())

    def test_a_list_for_all_nodelets_is_latched(self):
        self.attach()
        wait_for(lambda: len(self.lists[-1].objects) == 1)
        latest = self.lists[-1]
        self.assertEqual(latest._connection_header["latching"], "1")
        self.assertEqual(latest.header.frame_id, "base_link")
        attached = latest.objects[0]
        self.assertEqual((attached.name, attached.link), ("ball", HAND))
        self.assertEqual(attached.primitive, ball(self.place_in_hand))
        self.assertAlmostEqual(attached.forget_padding, FORGET_PADDING)
        # The clock may go on between the one and the other.
        self.assertAlmostEqual((attached.forget_until - latest.header.stamp).to_sec(), 0.2,
                               delta=0.05)
        at = attached.attached_at.position
        self.assertLess(math.dist((at.x, at.y, at.z), self.place), 0.005)

    def test_what_was_seen_of_it_leaves_the_map_and_nothing_else_does(self):
        wait_for(lambda: self.near(self.maps[-1]) > 0)
        before = len(self.maps)
        self.attach()
        wait_for(lambda: len(self.lists[-1].objects) == 1)
        stamp = self.lists[-1].header.stamp
        wait_for(lambda: self.maps[-1].attached_stamp == stamp)
        first = next(index for index, message in enumerate(self.maps[before:], before)
                     if message.attached_stamp == stamp)
        took, untold = self.maps[first], self.maps[first - 1]
        self.assertEqual(took.serial, untold.serial, "at once, without waiting for a scan")
        self.assertGreater(self.near(untold), 0)
        self.assertEqual(self.near(took), 0)
        self.assertEqual(self.far(took), self.far(untold))
        self.assertTrue(took.complete)
        for message in self.maps[first:]:
            self.assertEqual(self.near(message), 0)

    def near(self, cuboid_map):
        """How many cuboids are wholly where the object was seen."""
        apart = distance_to(self.place, cuboids_of(cuboid_map))
        return int(numpy.count_nonzero(apart < RADIUS + FORGET_PADDING - CELL_DOUBT))

    def far(self, cuboid_map):
        cuboids = cuboids_of(cuboid_map)
        # A cuboid loses no more than its part near the object.
        apart = numpy.hypot(cuboids[:, 0] - self.place[0], cuboids[:, 1] - self.place[1])
        beside = apart > RADIUS + FORGET_PADDING + 2.0 * CELL_DOUBT
        return {tuple(cuboid) for cuboid in numpy.round(cuboids[beside], 4)}

    def test_it_is_drawn_as_the_self_filter_and_the_checks_take_it(self):
        robot, filtered = self.markers("robot_markers"), self.markers("self_filter_markers")
        self.assertEqual(set(robot), {"now", "ahead", "occlusion", "evidence age", "status"})
        self.assertEqual(set(filtered), {"self filter"})
        self.attach()
        self.wait_for_attached(["ball"])
        more = self.markers("robot_markers")
        self.assertEqual(more["now"], robot["now"] + 1)
        self.assertEqual(more["ahead"], robot["ahead"] + 1)
        self.assertEqual(self.markers("self_filter_markers")["self filter"],
                         filtered["self filter"] + 1)
        self.detach_all()
        self.assertEqual(self.markers("robot_markers"), robot)
        self.assertEqual(self.markers("self_filter_markers"), filtered)

    def test_what_is_no_good_is_refused_with_its_reason_and_changes_nothing(self):
        self.attach()
        self.wait_for_attached(["ball"])
        stamp, model = self.lists[-1].header.stamp, self.markers("robot_markers")
        good = ball(self.place_in_hand)
        cone = ball(self.place_in_hand)
        cone.shape = "cone"
        unturned = ball(self.place_in_hand)
        unturned.pose.orientation.w = 0.0
        nowhere = ball((float("nan"), 0.0, 0.0))
        for name, link, primitive, reason in (
                ("ball", "right_plam_link", good, "right_plam_link"),
                ("ball", "", good, "link ''"),
                ("", HAND, good, "name"),
                ("ball", HAND, cone, "cone"),
                ("ball", HAND, unturned, "quaternion"),
                ("ball", HAND, nowhere, "finite"),
                ("ball", HAND, ball(self.place_in_hand, radius=-0.04), "radius"),
                ("ball", HAND, ball(self.place_in_hand, radius=0.0), "radius"),
                ("ball", HAND, ball(self.place_in_hand, radius=float("nan")), "radius"),
                ("ball", HAND, ball(self.place_in_hand, radius=40.0), "metres"),
                ("ball", HAND, Primitive(), "orientation")):
            with self.subTest(reason=reason):
                answer = self.attach_object(name, link, primitive)
                self.assertFalse(answer.success)
                self.assertIn(reason, answer.message)
                self.assertNotIn("\n", answer.message)
        time.sleep(0.2)
        self.assertEqual(self.lists[-1].header.stamp, stamp)
        self.assertEqual(self.recorder.statuses[-1].attached_objects, ["ball"])
        self.assertEqual(self.markers("robot_markers"), model)

    def test_what_the_self_filter_cannot_take_keeps_it_from_nothing_else(self):
        before = self.markers("self_filter_markers")["self filter"]
        publisher = rospy.Publisher("attached_objects", AttachedObjects, queue_size=5)
        wait_for(lambda: publisher.get_num_connections() >= 3)  # ours, the mirror's, the manager's
        good = AttachedObject(name="ball", link=HAND, primitive=ball(self.place_in_hand))
        good.attached_at.orientation.w = 1.0
        bad = AttachedObject(name="cup", link="foot", primitive=ball(self.place_in_hand))
        for objects, more in (([good, bad], 1), ([bad], 0)):
            message = AttachedObjects(objects=objects)
            message.header.frame_id = "base_link"
            message.header.stamp = rospy.Time.now()
            publisher.publish(message)
            wait_for(lambda stamp=message.header.stamp: self.maps[-1].attached_stamp == stamp)
            self.assertEqual(self.markers("self_filter_markers")["self filter"], before + more)
        publisher.unregister()

    def test_one_two_all_and_unknown_ones_are_detached(self):
        answer = self.detach_object("ball")
        self.assertFalse(answer.success)
        self.assertEqual(answer.message, "no object 'ball' is attached")
        for name in ("ball", "cup", "lid"):
            self.attach(name)
        self.wait_for_attached(["ball", "cup", "lid"])
        stamps = [message.header.stamp for message in self.lists]
        self.assertEqual(len(stamps), len(set(stamps)), "a stamp tells lists apart")
        self.assertTrue(self.detach_object("cup").success)
        self.wait_for_attached(["ball", "lid"])
        self.assertFalse(self.detach_object("cup").success)
        self.assertEqual(len(self.lists[-1].objects), 2)
        self.assertTrue(self.detach_object("").success)
        self.wait_for_attached([])
        self.assertTrue(self.detach_object("").success, "nothing is left, as was asked for")

    def test_an_object_of_the_same_name_is_replaced(self):
        self.attach()
        self.wait_for_attached(["ball"])
        self.attach(primitive=ball(self.place_in_hand, radius=0.05))
        wait_for(lambda: self.lists[-1].objects[0].primitive.radius == 0.05)
        self.assertEqual(len(self.lists[-1].objects), 1)
        time.sleep(0.2)
        names = {tuple(status.attached_objects) for status in self.recorder.statuses[-5:]}
        self.assertEqual(names, {("ball",)})

    def test_a_planners_list_is_mirrored_and_what_others_attached_is_left_alone(self):
        publisher = rospy.Publisher("planned_objects", AttachedObjects, queue_size=5)
        wait_for(lambda: publisher.get_num_connections() > 0)
        errors = []
        rospy.Subscriber("/rosout", Log, lambda log: errors.append(log.msg), queue_size=100)

        def plan(**radii):
            publisher.publish(objects=[
                AttachedObject(name=name, link=links.get(name, HAND),
                               primitive=ball(self.place_in_hand, radius))
                for name, radius in radii.items()])

        def wait_for_held(**radii):
            wait_for(lambda: {shape.name: shape.primitive.radius
                              for shape in self.lists[-1].objects} == radii)
        links = {"stone": "foot"}
        self.attach("saw")
        plan(bolt=0.04, nut=0.03)
        wait_for_held(saw=RADIUS, bolt=0.04, nut=0.03)
        plan(bolt=0.05, nut=0.03)
        wait_for_held(saw=RADIUS, bolt=0.05, nut=0.03)
        plan(stone=0.04, nut=0.03)
        wait_for_held(saw=RADIUS, nut=0.03)
        wait_for(lambda: [error for error in errors if "'foot'" in error])
        links.clear()
        plan(stone=0.04, nut=0.03)
        wait_for_held(saw=RADIUS, nut=0.03, stone=0.04)
        self.assertTrue(self.detach_object("nut").success)
        wait_for_held(saw=RADIUS, nut=0.03, stone=0.04)  # it is still in the planner's hand
        plan()
        wait_for_held(saw=RADIUS)
        publisher.unregister()

    def test_what_was_let_go_of_is_seen_again(self):
        self.attach()
        wait_for(lambda: self.near(self.maps[-1]) == 0)
        self.detach_all()
        wait_for(lambda: self.near(self.maps[-1]) > 0)

    def test_what_was_let_go_of_stops_the_robot_until_a_whole_window_has_looked(self):
        wait_for(lambda: self.recorder.statuses[-1].known)
        self.attach(primitive=ball(self.place_in_hand))
        self.wait_for_attached(["ball"])
        let_go = rospy.Time.now()
        self.detach_all()
        wait_for(lambda: "let go" in self.recorder.statuses[-1].detail)
        self.assertTrue(self.recorder.statuses[-1].stop)
        self.assertFalse(self.recorder.statuses[-1].known)
        known = wait_for(lambda: next((status for status in self.recorder.statuses[-1:]
                                       if status.known), None))
        checked = wait_for(lambda: next((heard for heard in self.maps
                                         if heard.header.stamp == known.map_stamp), None))
        self.assertGreaterEqual(checked.header.stamp - checked.window, let_go)

    def test_what_no_map_takes_into_account_is_checked_all_the_same_and_no_state_is_free_before(self):
        wait_for(lambda: self.unheard.statuses and self.unheard.statuses[-1].known)
        attach = rospy.ServiceProxy("unheard/attach_object", AttachObject)
        check = rospy.ServiceProxy("unheard/check_state", CheckState)
        # Where nothing was seen, so that it touches nothing.
        high = (numpy.linalg.inv(self.T_base_hand) @ [0.6, 0.0, 1.9, 1.0])[:3]
        for attempt in range(20):  # on a busy machine the answers may come too late to tell
            name = f"ball {attempt}"
            called = time.monotonic()
            self.assertTrue(attach(name, HAND, ball(high)).success)
            answer = check(self.question())
            before = self.unheard.statuses[-1].attached_objects
            if time.monotonic() - called < 0.4 and answer.result != CheckStateResponse.FAULT:
                break
        self.assertEqual((answer.result, answer.reason), (CheckStateResponse.UNKNOWN, "INIT"))
        self.assertIn("attached", answer.detail)
        self.assertNotIn(name, before)
        wait_for(lambda: name in self.unheard.statuses[-1].attached_objects)
        self.assertNotIn("attached", check(self.question()).detail)
        self.assertEqual(self.recorder.statuses[-1].attached_objects, [], "each has its own hand")

    def test_each_object_has_half_a_second_of_its_own_to_be_taken_by_a_map(self):
        wait_for(lambda: self.unheard.statuses and self.unheard.statuses[-1].known)
        attach = rospy.ServiceProxy("unheard/attach_object", AttachObject)
        check = rospy.ServiceProxy("unheard/check_state", CheckState)
        high = (numpy.linalg.inv(self.T_base_hand) @ [0.6, 0.0, 1.9, 1.0])[:3]
        for attempt in range(20):  # on a busy machine the answers may come too late to tell
            self.assertTrue(attach(f"first {attempt}", HAND, ball(high)).success)
            time.sleep(0.35)
            called = time.monotonic()
            self.assertTrue(attach(f"second {attempt}", HAND, ball(high)).success)
            time.sleep(0.3)  # beyond the first one's
            answer = check(self.question())
            if time.monotonic() - called < 0.4 and answer.result != CheckStateResponse.FAULT:
                break
        self.assertEqual((answer.result, answer.reason), (CheckStateResponse.UNKNOWN, "INIT"))
        self.assertIn("attached", answer.detail)

    @staticmethod
    def question():
        request = CheckState._request_class()
        request.state.name = ["right_elbow_joint"]
        request.state.position = [-1.0]
        return request


if __name__ == "__main__":
    rospy.init_node("attach_test")
    rostest.rosrun("tccm_monitor", "attach", AttachTest)
