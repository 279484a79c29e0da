#!/usr/bin/python3
"""The same box on a table as a depth image, of which depth_image_proc makes a cloud."""

import rospy
import rostest
from sensor_msgs.msg import CameraInfo, Image

from cloud_test import FOCAL, HEIGHT, RATE, WIDTH, CloudTest, scene


def camera_info():
    info = CameraInfo(width=WIDTH, height=HEIGHT, distortion_model="plumb_bob", D=[0.0] * 5)
    info.K = [FOCAL, 0.0, WIDTH / 2.0, 0.0, FOCAL, HEIGHT / 2.0, 0.0, 0.0, 1.0]
    info.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    info.P = [FOCAL, 0.0, WIDTH / 2.0, 0.0, 0.0, FOCAL, HEIGHT / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    return info


class DepthImageTest(CloudTest):
    # These are of clouds alone.
    test_wrong_layouts_are_counted_and_reported = None
    test_a_mapper_without_a_window_says_what_to_set = None

    @classmethod
    def publish(cls):
        images = rospy.Publisher("/depth", Image, queue_size=10)
        infos = rospy.Publisher("/depth_info", CameraInfo, queue_size=10)
        image = Image(width=WIDTH, height=HEIGHT, encoding="32FC1", step=4 * WIDTH)
        image.data = scene()[:, 2].tobytes()
        info = camera_info()
        while not cls.ended:
            image.header.stamp = info.header.stamp = rospy.Time.now()
            image.header.frame_id = info.header.frame_id = "camera_optical"
            images.publish(image)
            infos.publish(info)
            rospy.sleep(1.0 / RATE)


if __name__ == "__main__":
    rospy.init_node("depth_image_test")
    rostest.rosrun("tccm_monitor", "depth_image", DepthImageTest)
