"""Maps that are worth nothing, and what publishes them."""

import rospy

from gated_robot import wait_for
from input_gate import set_fields
from tccm_monitor.msg import CuboidMap
from tccm_monitor.srv import GetCuboidMap

NAN = float("nan")


def change_first_cuboid(**fields):
    return lambda message: set_fields(**fields)(message.cuboids[0])


def set_viewpoint(message):
    message.viewpoint.x = NAN


def set_frame(message):
    message.header.frame_id = "base_link"


def reverse(message):
    message.cuboids.reverse()


def double(message):
    message.cuboids = [cuboid for cuboid in message.cuboids for _ in range(2)]


BAD_MAPS = {
    "a cell outside the grid": change_first_cuboid(cell=0xFFFFFFFF),
    "a top that is NaN": change_first_cuboid(top=NAN),
    "a top beyond all heights": change_first_cuboid(top=1e30),
    "a depth below 0": change_first_cuboid(depth=-1.0),
    "cuboids out of order": reverse,
    "cuboids that overlap": double,
    "a viewpoint that is NaN": set_viewpoint,
    "another frame": set_frame,
    "cells that do not fit": set_fields(cells_x=0xFFFFFFFF),
    "cells of no size": set_fields(cell_size=0.0),
    "cells of size NaN": set_fields(cell_size=NAN),
    "a quantum of 0": set_fields(height_quantum=0.0),
    "a thickness of NaN": set_fields(thickness=NAN),
    "no cells": set_fields(cells_x=0, cells_y=0),
}


def bad_map(alter):
    """A map that was sound, but for that."""
    get_map = rospy.ServiceProxy("get_cuboid_map", GetCuboidMap)

    def with_cuboids():  # in so short a window there may be none
        cuboid_map = get_map().map
        return cuboid_map if len(cuboid_map.cuboids) > 1 else None
    message = wait_for(with_cuboids)
    message.header.stamp = rospy.Time.now()
    alter(message)
    return message


def publish_bad_maps():
    """@return a timer that publishes one after the other."""
    publisher = rospy.Publisher("cuboid_map", CuboidMap, queue_size=10)
    maps = [bad_map(alter) for alter in BAD_MAPS.values()]
    count = [0]

    def publish(event):
        message = maps[count[0] % len(maps)]
        count[0] += 1
        message.header.stamp = rospy.Time.now()
        publisher.publish(message)
    return rospy.Timer(rospy.Duration(0.02), publish)
