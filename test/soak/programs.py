"""The programs of a soak: each can be killed, paused and started anew, and its memory is read."""

import collections
import os
import pathlib
import signal
import subprocess
import time

from roslib.packages import find_node

PAGE_KB = os.sysconf("SC_PAGE_SIZE") // 1024
END_S = 10.0  # that a program has until it is killed
SETTLES_S = 60.0  # after which memory has to stay
STAYS_S = 10.0  # what is given back sooner was a burst, as of queues while something stood still
# glibc can give back what was freed only in its first arena. What is allocated is filled at once: pools that are reserved
# at the start count from then on, and what is read before it was written shows.
MALLOC = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "131072",
          "MALLOC_PERTURB_": "165"}
TRIM = "libtccm_monitor_soak_memory.so"  # trim_memory.cpp


def trim_library():
    folders = os.environ.get("LD_LIBRARY_PATH", "").split(":")
    path = next((path for path in (pathlib.Path(folder) / TRIM for folder in folders if folder) if path.exists()), None)
    if path is None:
        raise RuntimeError(f"{TRIM} is in no folder of LD_LIBRARY_PATH: build with CATKIN_ENABLE_TESTING")
    return str(path)


def rss_kb(pid):
    """Resident memory, or None where there is no such process."""
    try:
        fields = pathlib.Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()
    except OSError:
        return None
    return int(fields[1]) * PAGE_KB if len(fields) > 1 else None


class Memory:
    """What stays of a process's memory: the least that it had in any STAYS_S [kB].
    @var first_kb the most of that until SETTLES_S. @var grown_kb how much more there was later."""

    def __init__(self):
        self.first_kb, self.grown_kb = 0, 0
        self._recent = collections.deque()

    def add(self, lived_s, kilobytes):
        self._recent.append((lived_s, kilobytes))
        if lived_s - self._recent[0][0] < STAYS_S:
            return
        while lived_s - self._recent[0][0] > STAYS_S:
            self._recent.popleft()
        stays_kb = min(kilobytes for _, kilobytes in self._recent)
        if lived_s <= SETTLES_S:
            self.first_kb = max(self.first_kb, stays_kb)
        else:
            self.grown_kb = max(self.grown_kb, stays_kb - self.first_kb)


class Program:
    """@var down whether it is to be dead or paused now."""

    def __init__(self, name, command, log):
        self.name, self.command, self.log = name, command, log
        self.process, self.started, self.down = None, 0.0, False
        self.memory = Memory()  # in this life
        self.grown_most, self.lived_s = self.memory, 0.0  # in that in which it grew most; the longest life

    def start(self):
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(self.command, stdout=log, stderr=subprocess.STDOUT,
                                            stdin=subprocess.DEVNULL, start_new_session=True,
                                            env={**os.environ, **MALLOC})
        self.started, self.memory, self.down = time.monotonic(), Memory(), False

    def signal(self, number):
        self.process.send_signal(number)

    def kill(self):
        self.down = True
        self.signal(signal.SIGKILL)
        self.process.wait()

    def end(self):
        """Asks it to, as roslaunch does. @return its exit status, or None where it had to be killed."""
        self.down = True
        if self.process is None or self.process.poll() is not None:
            return 0
        self.signal(signal.SIGCONT)
        self.signal(signal.SIGINT)
        try:
            return self.process.wait(END_S)
        except subprocess.TimeoutExpired:
            self.kill()
            return None

    def pause(self):
        self.down = True
        self.signal(signal.SIGSTOP)

    def go_on(self):
        self.signal(signal.SIGCONT)
        self.down = False

    def look(self):
        """Reads its memory. @return how it ended, where nobody ended it."""
        if self.process is None or self.down:
            return None
        status = self.process.poll()
        if status is not None:
            return status
        lived_s = time.monotonic() - self.started
        kilobytes = rss_kb(self.process.pid)
        if kilobytes:
            self.memory.add(lived_s, kilobytes)
            if lived_s > SETTLES_S:
                self.lived_s = max(self.lived_s, lived_s)
                self.grown_most = max(self.memory, self.grown_most, key=lambda memory: memory.grown_kb)
        return None


def node(package, program, name, *arguments):
    return [find_node(package, program)[0], *arguments, f"__name:={name}"]


def nodelet(plugin, name, namespace="", *remappings):
    where = [f"__ns:=/{namespace}"] if namespace else []
    return node("nodelet", "nodelet", name, "standalone", f"tccm_monitor/{plugin}", *where, *remappings)
