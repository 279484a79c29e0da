"""Stands between the simulated robot and the monitor, topic by topic: what comes from raw/... goes
on as it is, or as a fault makes it."""

import collections
import struct
import threading

import rospy

STAMP_AT = {"rosgraph_msgs/Clock": 0, "tf2_msgs/TFMessage": 8}  # else behind the header's seq; of transforms the first's


def raw_type(message_type):
    """Passes messages of that type on unread."""
    return type("Raw" + message_type.__name__, (rospy.AnyMsg,),
                {name: getattr(message_type, name) for name in ("_type", "_md5sum", "_full_text")})


def stamp_of(raw):
    """Of a message that was not read. @return [s]; 0 of a list of no transforms"""
    begin = STAMP_AT.get(raw._type, 4)
    if len(raw._buff) < begin + 8:
        return 0.0
    seconds, nanoseconds = struct.unpack_from("<II", raw._buff, begin)
    return seconds + 1e-9 * nanoseconds


class Gate:
    """One topic. A change takes a message and returns the messages that go on in its place."""

    def __init__(self, topic, message_type, source=None, converted=None):
        """@param converted the type that the messages go on as, which a function `of` makes of one."""
        self.topic = topic
        self._message_type = message_type
        self._convert = converted.of if converted else None
        self._change = None
        self._remaining = 0
        self._lock = threading.Lock()
        self._passed = rospy.get_time()
        raw = raw_type(message_type)
        self.publisher = rospy.Publisher(topic, converted.message_type if converted else raw,
                                         queue_size=100)
        rospy.Subscriber(source or "raw/" + topic.lstrip("/"), raw, self._take, queue_size=100,
                         buff_size=1 << 22, tcp_nodelay=True)  # more than a camera's frame

    def _take(self, raw):
        with self._lock:
            change = self._change
            if self._remaining > 0:
                self._remaining -= 1
                if self._remaining == 0:
                    self._change = None
            if change is None:
                # A simulated clock may come later than what it stamped, for want of time.
                self._passed = max(rospy.get_time(), stamp_of(raw))
                if not self._convert:
                    self.publisher.publish(raw)
                    return
            message = self._message_type()
            message.deserialize(raw._buff)
            for changed in change(message) if change else [message]:
                self.publisher.publish(self._convert(changed) if self._convert else changed)

    def close(self, change, messages=0):
        """@param messages so many are changed; 0: all until open().
        @return when the last one went through as it was, or the gate was opened."""
        with self._lock:
            self._change = change
            self._remaining = messages
            return self._passed

    def open(self):
        """@return when that was."""
        with self._lock:
            self._change = None
            self._remaining = 0
            self._passed = rospy.get_time()
            return self._passed

    def is_open(self):
        return self._change is None


def nothing(message):
    """A change: the message is lost."""
    return []


def altered(alter):
    """A change that alters each message in place. @param alter a function of a message."""
    def change(message):
        alter(message)
        return [message]
    return change


def headers_of(message):
    """Of transforms there are many."""
    if hasattr(message, "transforms"):
        return [transform.header for transform in message.transforms]
    return [message.header]


def set_fields(**fields):
    """Sets fields of a message."""
    def alter(message):
        for name, value in fields.items():
            setattr(message, name, value)
    return alter


def dated(lead_s):
    """Stamped that much later than it was measured; earlier where it is negative."""
    def alter(message):
        for header in headers_of(message):
            header.stamp += rospy.Duration(lead_s)
    return altered(alter)


def delayed(seconds):
    """Comes that much later; at least, by less than a period."""
    waiting = collections.deque()

    def change(message):
        now = rospy.get_time()
        waiting.append((now, message))
        due = []
        while waiting and now - waiting[0][0] >= seconds:
            due.append(waiting.popleft()[1])
        return due
    return change


def frozen():
    """The first message again and again."""
    first = []

    def change(message):
        if not first:
            first.append(message)
        return first
    return change
