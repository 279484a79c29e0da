#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "gate/gated_motion.h"

namespace tccm::test {

using End = GatedMotion::End;

inline constexpr double kCycle = 0.005;            // [s]
inline constexpr double kPermissionPeriod = 0.02;  // [s]
inline constexpr double kLookahead = 0.04;         // [s]
/// From 0 to 10 rad at 1 rad/s.
inline JudgedGoal tenRadians() {
  JudgedGoal goal;
  goal.way.names = {"a"};
  goal.way.points.resize(2);
  goal.way.points[0].positions = {0.0};
  goal.way.points[1].positions = {10.0};
  goal.way.points[1].time_s = 10.0;
  goal.tolerances.path.resize(1);
  goal.tolerances.end.resize(1);
  return goal;
}

inline JudgedGoal smoothTenRadians() {
  JudgedGoal goal = tenRadians();
  goal.way.points.clear();
  for (int i = 0; i <= 10; ++i) {
    const double u = 0.1 * i;
    goal.way.points.push_back(
        {10.0 * u, {10.0 * u * u * (3.0 - 2.0 * u)}, {6.0 * u * (1.0 - u)}, {}});
  }
  return goal;
}

/// A motion, the time, a monitor that permits as it is told, and an arm that follows.
class GatedMotionTest : public ::testing::Test {
 protected:
  [[nodiscard]] Instant now() const {
    return {Time(fromSeconds(1000.0 + elapsed_)), fromSeconds(5.0 + elapsed_)};
  }

  void permit(double scale = 1.0) {
    HeardPermission heard;
    heard.stamp = now().stamp;
    heard.valid_until = heard.stamp + fromSeconds(2.5 * kPermissionPeriod);
    heard.sequence = ++sequence_;
    heard.permitted = scale > 0.0;
    heard.speed_scale = scale;
    heard.why = "COLLISION, told so";
    gate_.hear(heard, now());
  }

  void setOff(JudgedGoal goal = tenRadians()) {
    permit();
    goal.start = std::max(goal.start, now().stamp);
    motion_.begin(goal, now(), gate_);
    ends_.clear();
    tell();
  }

  void tell() {
    told_ = motion_.rest(now());
    told_at_ = elapsed_;
    ++tellings_;
  }

  void step() {
    const GatedMotion::Step step = motion_.step(now(), gate_, {arm_ + off_}, {});
    if (step.end != End::kNone) {
      ends_.push_back(step.end);
      text_ = step.text;
      EXPECT_FALSE(motion_.active());
      EXPECT_EQ(step.setpoint, nullptr);
      return;
    }
    if (step.setpoint == nullptr) return;
    arm_ = motion_.desired().positions[0];
    setpoint_ = *step.setpoint;
    if (step.is_retimed) tell();
  }

  /// @param scale of the permissions meanwhile; below 0: silence.
  void run(double seconds, double scale = 1.0) {
    const double end = elapsed_ + seconds - 0.5 * kCycle;
    for (int cycle = 0; elapsed_ < end; ++cycle) {
      elapsed_ += kCycle;
      if (cycle % 4 == 3 && scale >= 0.0) permit(scale);
      if (motion_.active()) step();
    }
  }

  [[nodiscard]] double position() const { return setpoint_.positions.at(0); }
  [[nodiscard]] double velocity() const { return setpoint_.velocities.at(0); }
  [[nodiscard]] bool endedOnceWith(End end) const {
    return ends_ == std::vector<End>{end} && !motion_.active();
  }

  GatedMotion::Config config_;
  GatedMotion motion_{config_};
  PermissionGate gate_;
  double elapsed_ = 0.0;
  std::uint32_t sequence_ = 0;
  double arm_ = 0.0, off_ = 0.0;
  GoalPath::Sample setpoint_;
  JointTrajectory told_;
  double told_at_ = 0.0;
  int tellings_ = 0;
  std::vector<End> ends_;
  std::string text_;
};

}  // namespace tccm::test
