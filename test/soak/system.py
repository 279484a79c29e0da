"""What runs in a soak: a master, the simulated robot, each nodelet as a process of its own."""

import os
import pathlib
import subprocess
import time

import rosgraph
import rospkg
import rospy
import yaml
from roslib.packages import find_node

from programs import Program, node, nodelet, trim_library

START_S = 30.0
SHARED = ("joint_states:=/joint_states", "attached_objects:=/attached_objects")
STOPS_FEW = 5  # stops that are kept at most in a folder that can be filled
STOPS_MB = 40  # of that folder
STOPS_MEMORY_MB = 64


def set_parameters(config, sensors, seed, stops, stops_max):
    """Half of the seeds have a short window, after which a stop is released sooner."""
    share = pathlib.Path(rospkg.RosPack().get_path("tccm_monitor"))
    rospy.set_param("robot_description", (share / "simulation/robot/dual_arm.urdf").read_text(encoding="utf-8"))
    content = yaml.safe_load(config.read_text(encoding="utf-8"))
    controllers = yaml.safe_load((share / "simulation/robot/arm_controllers.yaml").read_text(encoding="utf-8"))
    content["collision_checker"].update(stops_folder=str(stops), stops_max=stops_max, stops_memory_mb=STOPS_MEMORY_MB,
                                        sensors=[{"name": name} for name in sensors])
    if seed % 2:
        content["laser"]["tccm_mapper"]["window_s"] = 0.4
    for name, value in {**content, **controllers}.items():
        rospy.set_param(name, value)


class System:
    """@var programs by name."""

    def __init__(self, folder, options):
        self.folder, self.seed, self.sensors, self.stops_max = folder, options.seed, options.sensors, options.stops
        self.clock, self.rate, self.sanitizer = options.clock, options.rate, options.sanitizer
        self.stops = folder / "stops"
        self.stops.mkdir(parents=True, exist_ok=True)
        self.has_small_disk = self.stops_max <= STOPS_FEW and subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={STOPS_MB}m", "tmpfs", self.stops], check=False,
            stderr=subprocess.DEVNULL).returncode == 0
        self.programs = {}

    def add(self, name, command):
        if name != "master":
            command = ["env", f"LD_PRELOAD={self.sanitizer or trim_library()}", *command]
        self.programs[name] = Program(name, command, self.folder / f"{name}.log")

    def start_master(self):
        self.add("master", ["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]])
        self.programs["master"].start()
        deadline = time.monotonic() + START_S
        while not rosgraph.is_master_online():
            if time.monotonic() > deadline:
                raise RuntimeError("no master comes up")
            time.sleep(0.1)

    def start(self):
        self.start_master()
        set_parameters(pathlib.Path(__file__).parent / "monitored.yaml", self.sensors, self.seed, self.stops,
                       self.stops_max)
        rospy.set_param("/use_sim_time", self.clock == "simulated")
        rospy.set_param("simulation/publish_clock", self.clock == "simulated")
        rospy.set_param("simulation/clock_rate", self.rate)
        rospy.set_param("simulation/motion", "commanded")
        rospy.set_param("simulation/controllers", ["left_arm_controller", "right_arm_controller"])
        rospy.set_param("simulation/noise_m", 0.005)
        rospy.set_param("simulation/seed", self.seed)
        rospy.set_param("simulation/sensors", ",".join(self.sensors))
        rospy.set_param("simulation/camera", "head")
        rospy.set_param("simulation/camera_width", 96)
        self.add("simulation", node("tccm_monitor", "simulation_node", "simulation", "scan:=raw/scan",
                                    "joint_states:=raw/joint_states", "/tf:=raw/tf", "/clock:=raw/clock",
                                    "camera/depth/color/points:=raw/camera_cloud"))
        if self.clock == "simulated":
            self.add("clock_gate", node("tccm_monitor", "soak_clock_gate", "clock_gate"))
        self.add("laser_assembler", nodelet("TiltScanAssembler", "tilt_scan_assembler", "laser", "scan:=/scan", *SHARED))
        self.add("laser_mapper", nodelet("TccmMapper", "tccm_mapper", "laser", *SHARED))
        if "camera" in self.sensors:
            self.add("camera_assembler", nodelet("CloudAssembler", "cloud_assembler", "camera",
                                                 "cloud_in:=/camera_cloud", *SHARED))
            self.add("camera_mapper", nodelet("TccmMapper", "tccm_mapper", "camera", *SHARED))
        self.add("checker", nodelet("CollisionChecker", "collision_checker"))
        self.add("gate", nodelet("TrajectoryGate", "trajectory_gate"))
        for name, program in self.programs.items():
            if name != "master":
                program.start()

    def look(self):
        """Reads memory. @return (name, exit status) of those that ended by themselves; they are started anew."""
        ended = []
        for program in self.programs.values():
            status = program.look()
            if status is not None:
                ended.append((program.name, status))
                program.start()
        return ended

    def end(self):
        """@return (name, exit status) of those that did not end well, without status where they had to be killed."""
        ended = [(program.name, program.end()) for program in reversed(list(self.programs.values()))]
        return [one for one in ended if one[1] != 0]

    def replay_stops(self):
        """@return (how many stops were written and are there still, names of those that another verdict came of)"""
        program = find_node("tccm_monitor", "evaluate")[0]
        bags = sorted(self.stops.glob("*.bag"))
        others = [bag.name for bag in bags if subprocess.run([program, "--stop", bag], check=False,
                                                             stdout=subprocess.DEVNULL).returncode]
        return len(bags), others

    def remove_disk(self):
        if self.has_small_disk:
            subprocess.run(["umount", "--lazy", self.stops], check=False)


