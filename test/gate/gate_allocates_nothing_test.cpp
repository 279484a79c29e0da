/// A cycle of a motion takes no memory from the heap while it goes on: an allocation may take
/// arbitrarily long.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gate/gated_motion.h"
#include "support/counted_allocations.h"

namespace tccm {
namespace {

constexpr double kCycle = 0.005;  // [s]

TEST(GateAllocatesNothingTest, InACycleWhateverSetsThePace) {
  using Pace = GatedMotion::Pace;
  for (const Pace pace : {Pace::kSetpoints, Pace::kPlans, Pace::kMeasured}) {
    JudgedGoal goal;
    for (int joint = 0; joint < 7; ++joint) {
      goal.way.names.push_back("a_joint_with_a_long_name_" + std::to_string(joint));
    }
    for (int i = 0; i <= 20; ++i) {
      goal.way.points.push_back({0.5 * i, std::vector<double>(7, 0.1 * i),
                                 std::vector<double>(7, 0.2), std::vector<double>(7, 0.0)});
    }
    goal.tolerances.path.resize(7, {0.5, 0.0, 0.0});
    goal.tolerances.end.resize(7, {0.5, 0.0, 0.0});
    GatedMotion::Config config;
    config.pace = pace;
    GatedMotion motion(config);
    PermissionGate gate;
    HeardPermission heard;
    heard.permitted = true;
    double elapsed_s = 0.0;
    const auto now = [&elapsed_s] {
      return Instant{Time(fromSeconds(1000.0 + elapsed_s)), fromSeconds(5.0 + elapsed_s)};
    };
    const auto permit = [&] {
      heard.stamp = now().stamp;
      heard.valid_until = heard.stamp + fromSeconds(0.05);
      ++heard.sequence;
      heard.speed_scale = heard.sequence % 8 < 4 ? 1.0 : 0.6;
      heard.why = heard.sequence % 8 < 4 ? "" : "SLOW COLLISION_AHEAD: the palm comes too near";
      gate.hear(heard, now());
    };
    test::allocations = 0;
    std::vector<double> positions(7), velocities(7, 0.2);
    permit();
    motion.begin(goal, now(), gate);
    for (int i = 0; i < 1000; ++i) {
      elapsed_s += kCycle;
      test::is_counting = i > 100;
      if (i % 4 == 0) permit();
      ASSERT_EQ(motion.step(now(), gate, positions, velocities).end, GatedMotion::End::kNone);
      positions = motion.desired().positions;
    }
    test::is_counting = false;
    EXPECT_EQ(test::allocations, 0) << static_cast<int>(pace);
  }
}

}  // namespace
}  // namespace tccm
