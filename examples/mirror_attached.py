#!/usr/bin/env python3
"""Mirrors the list of shapes that a planner has attached to the robot, which it publishes on
planned_objects: what is new or other is attached, what is gone is detached. Copy and change."""
import time

import rospy
from tccm_monitor.msg import AttachedObjects  # only name, link and primitive are read
from tccm_monitor.srv import AttachObject, DetachObject

rospy.init_node("mirror_attached")
attach = rospy.ServiceProxy("attach_object", AttachObject)
detach = rospy.ServiceProxy("detach_object", DetachObject)
lists, ours = {"planner": {}, "monitor": {}}, set()


def hear(message, whose):
    lists[whose] = {shape.name: (shape.link, shape.primitive) for shape in message.objects}


rospy.Subscriber("planned_objects", AttachedObjects, hear, "planner")
rospy.Subscriber("attached_objects", AttachedObjects, hear, "monitor")
while not rospy.is_shutdown():
    planned, held = lists["planner"], lists["monitor"]
    ours = ours & held.keys() | planned.keys()  # what others have attached is left alone
    try:
        answers = [attach(name, *planned[name]) for name in planned if planned[name] != held.get(name)]
        answers += [detach(name) for name in ours & held.keys() - planned.keys()]
        for refused in [answer.message for answer in answers if not answer.success]:
            rospy.logerr_throttle(5.0, refused)  # and asked for again in the next round
    except rospy.ServiceException as error:
        rospy.logerr_throttle(5.0, error)
    time.sleep(0.5)
