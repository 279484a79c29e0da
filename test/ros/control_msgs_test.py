"""control_msgs/FollowJointTrajectory in Python is what ROS's package has, whoever generated it."""

import sys
import unittest

from control_msgs import msg

sys.dont_write_bytecode = True

MD5_SUMS = {
    "FollowJointTrajectoryAction": "bc4f9b743838566551c0390c65f1a248",
    "FollowJointTrajectoryActionGoal": "cff5c1d533bf2f82dd0138d57f4304bb",
    "FollowJointTrajectoryActionResult": "c4fb3b000dc9da4fd99699380efcc5d9",
    "FollowJointTrajectoryActionFeedback": "d8920dc4eae9fc107e00999cce4be641",
    "FollowJointTrajectoryGoal": "69636787b6ecbde4d61d711979bc7ecb",
    "FollowJointTrajectoryResult": "493383b18409bfb604b4e26c676401d2",
    "FollowJointTrajectoryFeedback": "10817c60c2486ef6b33e97dcd87f4474",
    "JointTolerance": "f544fe9c16cf04547e135dd6063ff5be",
}
ERROR_CODES = {
    "SUCCESSFUL": 0,
    "INVALID_GOAL": -1,
    "INVALID_JOINTS": -2,
    "OLD_HEADER_TIMESTAMP": -3,
    "PATH_TOLERANCE_VIOLATED": -4,
    "GOAL_TOLERANCE_VIOLATED": -5,
}


class ControlMsgsTest(unittest.TestCase):
    def test_types_and_md5_sums_are_those_of_ros_package(self):
        for name, md5_sum in MD5_SUMS.items():
            with self.subTest(message=name):
                message = getattr(msg, name)
                self.assertEqual((message._type, message._md5sum), (f"control_msgs/{name}", md5_sum))

    def test_error_codes_are_those_of_ros_package(self):
        for name, code in ERROR_CODES.items():
            self.assertEqual(getattr(msg.FollowJointTrajectoryResult, name), code, name)


if __name__ == "__main__":
    unittest.main()
