"""A made recording of any robot that stands still before a depth camera, which sees the floor alone."""

import xml.etree.ElementTree as ElementTree

import numpy
import rosbag
import rospy
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState, PointCloud2, PointField
from tf2_msgs.msg import TFMessage

WIDTH, HEIGHT, FOCAL = 160, 120, 140.0
CAMERA, TARGET = numpy.array([2.0, 0.0, 1.6]), numpy.array([0.3, 0.0, 0.6])  # above the floor [m]


def root_link(robot):
    children = {joint.find("child").get("link") for joint in robot.findall("joint")}
    return next(link.get("name") for link in robot.findall("link") if link.get("name") not in children)


def resting(robot):
    """@return joints, and positions within their limits."""
    positions = {}
    for joint in robot.findall("joint"):
        if joint.get("type") in ("fixed", "floating", "planar") or joint.find("mimic") is not None:
            continue
        limit = joint.find("limit")
        lower, upper = -1.0, 1.0
        if joint.get("type") != "continuous" and limit is not None:
            lower, upper = (float(limit.get(end, 0.0)) for end in ("lower", "upper"))
        positions[joint.get("name")] = 0.0 if lower <= 0.0 <= upper else 0.5 * (lower + upper)
    return list(positions), list(positions.values())


def axes():
    """@return the camera's x, y and z, side by side."""
    z = (TARGET - CAMERA) / numpy.linalg.norm(TARGET - CAMERA)
    x = numpy.cross(z, [0.0, 0.0, 1.0])
    x /= numpy.linalg.norm(x)
    return numpy.stack([x, numpy.cross(z, x), z], axis=1)


def camera_transform(parent, floor_m, stamp):
    transform = TransformStamped(child_frame_id="camera_optical")
    transform.header.frame_id, transform.header.stamp = parent, stamp
    place, turn, at = transform.transform.translation, transform.transform.rotation, axes()
    place.x, place.y, place.z = CAMERA + [0.0, 0.0, floor_m]
    turn.w = 0.5 * numpy.sqrt(1.0 + numpy.trace(at))
    turn.x, turn.y, turn.z = (numpy.array([at[2, 1] - at[1, 2], at[0, 2] - at[2, 0],
                                           at[1, 0] - at[0, 1]]) / (4.0 * turn.w))
    return transform


def cloud(stamp, random):
    across, down = numpy.meshgrid(numpy.arange(WIDTH), numpy.arange(HEIGHT))
    rays = numpy.stack([(across - WIDTH / 2) / FOCAL, (down - HEIGHT / 2) / FOCAL,
                        numpy.ones_like(across)], axis=-1)
    slope = (rays @ axes().T)[..., 2]
    depth = numpy.where(slope < -0.2, -CAMERA[2] / numpy.minimum(slope, -0.2), numpy.nan)
    depth *= 1.0 + 0.002 * random.standard_normal(depth.shape)
    message = PointCloud2(height=HEIGHT, width=WIDTH, point_step=12, row_step=12 * WIDTH,
                          data=(rays * depth[..., None]).astype(numpy.float32).tobytes())
    message.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate("xyz")]
    message.header.stamp, message.header.frame_id = stamp, "camera_optical"
    return message


def write(bag, urdf, floor_m=0.0, seconds=6.0):
    """@param urdf text. @param floor_m where the floor lies in the robot's root."""
    robot = ElementTree.fromstring(urdf)
    names, positions = resting(robot)
    random = numpy.random.default_rng(1)
    with rosbag.Bag(str(bag), "w") as out:
        begin = rospy.Time(1000)
        out.write("/tf_static", TFMessage([camera_transform(root_link(robot), floor_m, begin)]), begin)
        for k in range(int(100 * seconds)):
            now = begin + rospy.Duration.from_sec(0.01 * k)
            states = JointState(name=names, position=positions, velocity=[0.0] * len(names))
            states.header.stamp = now
            out.write("/joint_states", states, now)
            if k % 7 == 0:
                out.write("/camera/depth/points", cloud(now, random), now)
