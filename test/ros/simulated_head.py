"""The head of the simulated robot as its joints tell, and what can go wrong with it."""

import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String

from gated_robot import wait_for

TILT_MEAN, TILT_AMPLITUDE = 0.7854, 0.5236  # [rad]
NARROWED_TO = 0.2  # of the amplitude
TURNED_BY = 1.4  # [rad]


class SimulatedHead:
    def __init__(self):
        self._samples = []  # (stamp, position by joint)
        rospy.Subscriber("joint_states", JointState, self._take, queue_size=100,
                         tcp_nodelay=True)
        self._fault = rospy.Publisher("simulation/tilt_fault", String, queue_size=1)
        self._arm_stop = rospy.Publisher("arm_stop", Bool, queue_size=1)
        wait_for(lambda: self._fault.get_num_connections() and
                 self._arm_stop.get_num_connections() and self._samples)

    def _take(self, message):
        positions = dict(zip(message.name, message.position))
        self._samples.append((message.header.stamp.to_sec(), positions))

    def position(self, joint):
        return self._samples[-1][1][joint]

    def reach_until(self, joint, position):
        """The arm goes its way until a joint is beyond a position, and stays there."""
        def is_there():
            self._arm_stop.publish(self.position(joint) > position)
            return self.position(joint) > position
        reached = wait_for(is_there)
        self._arm_stop.publish(True)
        rospy.sleep(0.5)
        return reached

    def wait_until_it_looks_down(self):
        """As far as it does: at a turning point the tilt turns in time also where it narrows."""
        return wait_for(lambda: self.position("laser_tilt_joint") >
                        TILT_MEAN + 0.97 * TILT_AMPLITUDE)

    def set_fault(self, fault):
        """@return when that was."""
        self._fault.publish(fault)
        return rospy.get_time()

    def last(self, wanted, begin, end):
        """The stamp of the last joint state in that time that is as wanted of its positions and of
        those of the one before."""
        samples = [sample for sample in list(self._samples) if begin <= sample[0] <= end]
        return max((now[0] for before, now in zip(samples, samples[1:])
                    if wanted(now[1], before[1])), default=begin)


def tilts(now, before):
    return abs(now["laser_tilt_joint"] - before["laser_tilt_joint"]) > 1e-5


def looks_far_down(now, before):
    return now["laser_tilt_joint"] > TILT_MEAN + 1.01 * NARROWED_TO * TILT_AMPLITUDE


def turns(now, before):
    return abs(now["head_yaw_joint"] - before["head_yaw_joint"]) > 1e-5
