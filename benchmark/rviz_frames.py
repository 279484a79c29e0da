#!/usr/bin/python3
"""How many frames a second rviz shows of a large map that changes all the time, under software GL in
a virtual display. Needs a shell that knows the package (source build/devel/setup.bash)."""

import argparse
import io
import math
import os
import pathlib
import re
import socket
import struct
import subprocess
import sys
import tempfile

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(REPOSITORY / "test" / "ros"))
STAMP = 4  # where it begins in a message with a header
PHASES = 8

# So that each line comes at once, and is found.
LOGGING = """log4j.logger.ros=WARN
log4j.logger.ros.tccm_monitor.cuboid_map_display=DEBUG
"""


def isolated(folder):
    """A master of our own. @return its process."""
    with socket.socket() as free:
        free.bind(("localhost", 0))
        port = free.getsockname()[1]
    logging = pathlib.Path(folder) / "logging.conf"
    logging.write_text(LOGGING, encoding="utf-8")
    os.environ.update(ROS_MASTER_URI=f"http://localhost:{port}", ROS_HOSTNAME="localhost",
                      ROS_HOME=folder, ROSCONSOLE_CONFIG_FILE=str(logging))
    return subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def serialized(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return bytearray(buffer.getvalue())


def publish(options):
    """Publishes maps until the time is over."""
    import rospy
    from rviz_scene import waves
    from tccm_monitor.msg import CuboidMap
    rospy.init_node("rviz_frames")
    maps = [serialized(waves(options.cuboids, 2.0 * math.pi * i / PHASES,
                             options.layers)) for i in range(PHASES)]

    class Ready(CuboidMap):
        """Is not serialized anew each time."""
        __slots__ = ["buffer"]
        _has_header = False

        def __init__(self, buffer):
            self.buffer = buffer

        def serialize(self, buff):
            buff.write(self.buffer)
    publisher = rospy.Publisher("cuboid_map", CuboidMap, queue_size=1)
    rate, end = rospy.Rate(options.rate), rospy.Time.now() + rospy.Duration(options.duration)
    count = 0
    while rospy.Time.now() < end:
        now, buffer = rospy.Time.now(), maps[count % PHASES]
        struct.pack_into("<II", buffer, STAMP, now.secs, now.nsecs)
        publisher.publish(Ready(buffer))
        count += 1
        rate.sleep()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cuboids", type=int, default=20000)
    parser.add_argument("--layers", type=int, default=1, help="one above the other")
    parser.add_argument("--rate", type=float, default=20.0, help="of the maps [Hz]")
    parser.add_argument("--duration", type=float, default=30.0, help="[s]")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        master = isolated(folder)
        from rviz_window import Window
        log = pathlib.Path(folder) / "rviz.log"
        with open(log, "w", encoding="utf-8") as file:
            window = Window(str(REPOSITORY / "rviz" / "tccm_monitor.rviz"), "-f", "base_link",
                            log=file)
            try:
                publish(options)
            finally:
                window.close()
                master.terminate()
                master.wait()
        lines = re.findall(r"\d+ cuboids, .* ms", log.read_text(encoding="utf-8"))
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    print("\n".join(line for line in lines if line.startswith(f"{options.cuboids} ")))


if __name__ == "__main__":
    main()
