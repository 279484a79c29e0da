"""The programs of a soak: each can be killed, paused and started anew, and its memory is read."""

import os
import pathlib
import signal
import subprocess
import time

from roslib.packages import find_node

PAGE_KB = os.sysconf("SC_PAGE_SIZE") // 1024
END_S = 5.0  # that a program has until it is killed
SETTLES_S = 60.0  # after which memory has to stay
# glibc gives back what was freed, so that memory is what is used: else it keeps the most that it ever was, in pieces.
MALLOC = {"MALLOC_ARENA_MAX": "2", "MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "131072"}


def rss_kb(pid):
    """Resident memory, or None where there is no such process."""
    try:
        fields = pathlib.Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()
    except OSError:
        return None
    return int(fields[1]) * PAGE_KB if len(fields) > 1 else None


class Program:
    """@var down whether it is to be dead or paused now."""

    def __init__(self, name, command, log):
        self.name, self.command, self.log = name, command, log
        self.process, self.started, self.down = None, 0.0, False
        self.first_kb = 0  # the most that it had in its first SETTLES_S
        self.grown_kb, self.lived_s = 0, 0.0  # of the life in which it grew most; the longest life
        self.crashes = []

    def start(self):
        with open(self.log, "ab") as log:
            self.process = subprocess.Popen(self.command, stdout=log, stderr=subprocess.STDOUT,
                                            stdin=subprocess.DEVNULL, start_new_session=True,
                                            env={**os.environ, **MALLOC})
        self.started, self.first_kb, self.down = time.monotonic(), 0, False

    def signal(self, number):
        self.process.send_signal(number)

    def kill(self):
        self.down = True
        self.signal(signal.SIGKILL)
        self.process.wait()

    def end(self):
        """@return whether it ended by itself when it was asked to."""
        self.down = True
        if self.process is None or self.process.poll() is not None:
            return True
        self.signal(signal.SIGCONT)
        self.signal(signal.SIGTERM)
        try:
            self.process.wait(END_S)
            return True
        except subprocess.TimeoutExpired:
            self.kill()
            return False

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
            self.crashes.append(status)
            return status
        lived_s = time.monotonic() - self.started
        kilobytes = rss_kb(self.process.pid)
        if kilobytes and lived_s <= SETTLES_S:
            self.first_kb = max(self.first_kb, kilobytes)
        elif kilobytes:
            self.grown_kb = max(self.grown_kb, kilobytes - self.first_kb)
            self.lived_s = max(self.lived_s, lived_s)
        return None


def node(package, program, name, *arguments):
    return [find_node(package, program)[0], *arguments, f"__name:={name}"]


def nodelet(plugin, name, namespace="", *remappings):
    where = [f"__ns:=/{namespace}"] if namespace else []
    return node("nodelet", "nodelet", name, "standalone", f"tccm_monitor/{plugin}", *where, *remappings)
