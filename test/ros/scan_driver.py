#!/usr/bin/python3
"""Stands for a laser's driver: passes on the scans that the simulation measures, in a process of
its own, so that it can die while the arm lives on."""

import rospy
from sensor_msgs.msg import LaserScan

if __name__ == "__main__":
    rospy.init_node("scan_driver")
    scans = rospy.Publisher("scan", LaserScan, queue_size=10)
    rospy.Subscriber("laser", LaserScan, scans.publish, queue_size=10, tcp_nodelay=True)
    rospy.spin()
