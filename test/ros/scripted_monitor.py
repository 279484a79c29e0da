"""A monitor that says what a test tells it to."""

import threading
import time

import rospy

from tccm_monitor.msg import MotionPermission
from tccm_monitor.srv import (CheckTrajectory, CheckTrajectoryResponse, ReportGoal,
                              ReportGoalResponse)

PERMISSION_PERIOD = 0.02
# Where silence is not what is tested: a busy machine may be late.
PATIENT_VALIDITY = 0.4


class Rate:
    """Calls a function at a steady pace, in a thread of its own, until it is stopped."""

    def __init__(self, period, function):
        self.period, self.function = period, function
        self.stopped = threading.Event()
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        due = time.monotonic()
        while not self.stopped.wait(max(0.0, due - time.monotonic())):
            self.function()
            due += self.period

    def stop(self):
        self.stopped.set()
        self.thread.join()


class ScriptedMonitor:
    """Publishes permissions and answers questions as told."""

    def __init__(self):
        self.lock = threading.Lock()
        self.result, self.reason = CheckTrajectoryResponse.FREE, ""
        self.answer_after = 0.0  # [s]
        self.questions = []
        self.goals = []  # (owner, id, whether it is under way, questions until then)
        self.sent = []  # when
        self.sequence = 0
        self.permit()
        self.publisher = rospy.Publisher("motion_permission", MotionPermission, queue_size=1,
                                         tcp_nodelay=True)
        self.service = rospy.Service("check_trajectory", CheckTrajectory, self.answer)
        self.reports = rospy.Service("report_goal", ReportGoal, self.note)
        self.rate = None

    def permit(self, level=MotionPermission.OK, scale=1.0, reasons=(), age=0.0,
               validity=PATIENT_VALIDITY, rising=True):
        """@param age of the stamps [s]. @return when."""
        with self.lock:
            self.script = (level, scale, reasons, age, validity, rising)
        return time.monotonic()

    def speak(self):
        self.rate = Rate(PERMISSION_PERIOD, self.publish)

    def fall_silent(self):
        self.rate.stop()

    def is_silent(self):
        return self.rate is None or self.rate.stopped.is_set()

    def publish(self):
        with self.lock:
            level, scale, reasons, age, validity, rising = self.script
        self.sequence += rising
        message = MotionPermission(sequence=self.sequence, level=level, speed_scale=scale,
                                   permitted=level <= MotionPermission.SLOW, reasons=reasons)
        message.header.stamp = rospy.Time.now() - rospy.Duration(age)
        message.valid_until = message.header.stamp + rospy.Duration(validity)
        self.sent.append(time.monotonic())
        self.publisher.publish(message)

    def note(self, report):
        self.goals.append((report.owner, report.goal, report.under_way, len(self.questions)))
        return ReportGoalResponse(success=True)

    def answer(self, question):
        self.questions.append(question.trajectory)
        time.sleep(self.answer_after)
        return CheckTrajectoryResponse(result=self.result, reason=self.reason,
                                       detail="as the test says", time_from_start=1.25,
                                       link="left_hand_link")
