"""A made recording of a robot whose hand slides along a rail before a laser, for the programs' tests."""
import genpy
import rosbag
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState, LaserScan
from tf2_msgs.msg import TFMessage

START = 1000.0
LASER = (0.5, 0.013, 1.0)

CONFIG = """
topics: {scan: /tilt_scan}
tilt_scan_assembler: {fixed_frame: base_link, mixed_pixel_separation_m: 0, self_filter: false}
tccm_mapper: {window_scans: 5, area_origin_x_m: 0.2, area_origin_y_m: -0.5, height_max_m: 1.5}
collision_checker: {fixed_frame: base_link, support_points: 1, horizon_s: 0.0,
                    hold_until_reset: false,
                    collision_padding_m: 0.01, check_occlusion: false}
"""

URDF = """<robot name="sliding">
  <link name="base_link"/>
  <link name="carriage"/>
  <link name="hand"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="slide" type="prismatic">
    <parent link="base_link"/><child link="carriage"/><axis xyz="1 0 0"/><origin xyz="0 0.013 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="carriage"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>
"""


def stamped(seconds):
    return genpy.Time.from_sec(START + seconds)


def transform(seconds, parent, child, xyz=(0.0, 0.0, 0.0)):
    t = TransformStamped()
    t.header.stamp, t.header.frame_id, t.child_frame_id = stamped(seconds), parent, child
    t.transform.translation.x, t.transform.translation.y, t.transform.translation.z = xyz
    t.transform.rotation.w = 1.0
    return t


def scan_at(seconds, ranges=(0.3,)):
    scan = LaserScan(angle_min=0.0, angle_max=0.1 * max(0, len(ranges) - 1), angle_increment=0.1,
                     scan_time=0.05, range_min=0.1, range_max=5.0, ranges=list(ranges))
    scan.header.stamp, scan.header.frame_id = stamped(seconds), "/laser"
    return scan


def joint_at(seconds, **positions):
    state = JointState(name=list(positions), position=list(positions.values()))
    state.header.stamp = stamped(seconds)
    return state


def named(message, type_name):
    return {"type": type_name, "md5sum": message._md5sum, "message_definition": message._full_text}


class Stream:
    """Messages of a robot whose hand slides through what its laser sees at x = 0.8, and out again."""

    def __init__(self, duration_s=4.0):
        self.duration_s = duration_s
        self.messages = [("/tf_static", TFMessage([transform(0.0, "/base_link", "/mount", LASER)]), 0.0)]
        for k in range(int(duration_s * 100)):
            t = k * 0.01
            self.messages.append(("/tf", TFMessage([transform(t, "/mount", "/laser")]), t))
            if k % 2 == 0:
                self.messages.append(("/joint_states", joint_at(t, slide=self.slide(t)), t))
            else:
                self.messages.append(("/joint_states", joint_at(t, lift=1.0), t))
            if k % 5 == 0:
                self.messages.append(("/tilt_scan", scan_at(t), t))

    def slide(self, t):
        """From 0.4 to 0.8 and back within the stream's length."""
        return 0.4 + 0.4 * (1.0 - abs(1.0 - 2.0 * t / self.duration_s))

    def write(self, path, compression="none", tf_type=None):
        with rosbag.Bag(path, "w", compression=compression) as bag:
            for topic, message, t in self.messages:
                header = None
                if tf_type and topic == "/tf":
                    header = dict(named(message, tf_type), topic=topic)
                bag.write(topic, message, stamped(t), connection_header=header)
