// Runs the program `evaluate` on a PR2 behind a really scanned table, and works out its verdicts
// once more from the dumped points, the recording and the robot's description: with KDL, FCL and
// nothing of this package.
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/dumped_map.h"
#include "support/kdl_robot.h"
#include "support/pr2_replay.h"
#include "support/primitives_by_fcl.h"
#include "support/recorded_motion.h"
#include "support/temporary_folder.h"

namespace tccm {
namespace {

using test::Evaluated;
using test::Nanoseconds;
using test::Row;
using test::Settings;

constexpr double kIterations = 1e-5;  // [m]; nearer than this, an iterative solver may err
constexpr double kBaselineS = 0.03;   // joint_velocity_baseline_s, by default
constexpr double kHysteresis = 0.05;  // [rad]; tilt_hysteresis_rad, as shipped
constexpr double kTiltPeriods = 1.1;  // window_tilt_periods, as shipped

/// Each replay is needed by several tests. What was fitted is remembered meanwhile in a folder that
/// is no one else's.
const Evaluated& evaluatedOnce(const Settings& settings) {
  static const test::TemporaryFolder ros_home;
  static std::map<std::string, Evaluated> known;
  setenv("ROS_HOME", ros_home.path().c_str(), 1);
  const std::string key = test::configOf(settings) + settings.bag;
  if (known.count(key) == 0) known.emplace(key, test::evaluate(settings));
  return known.at(key);
}

/// The robot's primitives, placed by KDL and held against a map by FCL.
class IndependentRobot {
 public:
  /// @param links those that match are held against the map.
  IndependentRobot(const YAML::Node& primitives, double padding_m, const std::string& links = "*")
      : robot_(test::readFile(test::urdfPath())) {
    for (const auto& link : primitives) {
      const auto name = link.first.as<std::string>();
      if (fnmatch(links.c_str(), name.c_str(), 0) != 0) continue;
      names_.insert(name);
      for (const auto& entry : link.second) links_[name].emplace_back(entry, padding_m);
    }
  }

  [[nodiscard]] const test::KdlRobot& robot() const { return robot_; }
  [[nodiscard]] const std::set<std::string>& links() const { return names_; }

  void place(const test::Positions& positions) {
    const auto poses = robot_.linkPoses(names_, positions);
    for (auto& [link, primitives] : links_) {
      for (auto& primitive : primitives) primitive.place(poses.at(link));
    }
  }

  [[nodiscard]] std::set<std::string> touching(const test::DumpedMap& map) const {
    std::set<std::string> touching;
    for (const auto& [link, primitives] : links_) {
      for (const auto& primitive : primitives) {
        const auto touches = [&](const auto& cuboid) { return primitive.touches(cuboid); };
        if (map.anyNear(primitive.bounds(), touches)) touching.insert(link);
      }
    }
    return touching;
  }

  /// The least signed distance to what is near [m].
  [[nodiscard]] double distance(const test::DumpedMap& map) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [link, primitives] : links_) {
      for (const auto& primitive : primitives) {
        map.anyNear(primitive.bounds(), [&](const auto& cuboid) {
          least = std::min(least, primitive.signedDistance(cuboid));
          return false;
        });
      }
    }
    return least;
  }

 private:
  test::KdlRobot robot_;
  std::set<std::string> names_;
  std::map<std::string, std::vector<test::PrimitiveByFcl>> links_;
};

/// Works out anew what evaluate says of each checked pose.
class Recount {
 public:
  Recount(const Settings& settings, const Evaluated& evaluated)
      : motion_(test::bagPath(settings.bag), "/joint_states", "/tilt_scan"),
        oldest_(test::oldestScans(motion_, "laser_tilt_mount_joint", kTiltPeriods, kHysteresis)),
        map_(evaluated.points, evaluated.summary.at("map")),
        robot_(evaluated.primitives, settings.padding_m, settings.links),
        horizon_s_(settings.horizon_s) {}

  /// @pre rows come in the order of the file.
  void compare(const Row& row) {
    const auto state = motion_.stateAt(row.stamp);
    ASSERT_TRUE(state) << row.stamp;
    if (row.scan > 0) map_.moveTo(oldest_[row.scan - 1] + 1, row.scan);
    const bool says_now = row.reason == "COLLISION" || row.reason == "MOVING_OUT";
    // Before there is a whole map INIT hides what only slows the robot down.
    if (row.reason == "INIT") return;
    const std::set<std::string> now = compareAt(motion_.states()[*state].positions, says_now, row);
    touched_.insert(now.begin(), now.end());
    // What touches now hides what is said of the pose ahead.
    if (says_now || !now.empty() || horizon_s_ == 0.0) return;
    compareWay(*state, row);
  }

  [[nodiscard]] std::size_t scansInWindow() const { return oldest_.size() - oldest_.back(); }
  [[nodiscard]] std::size_t differences() const { return differences_; }
  [[nodiscard]] const std::set<std::string>& touched() const { return touched_; }

 private:
  /// The poses on the way to the one ahead, none of them further from the next than a hand moves in
  /// 1/kPoses of the horizon. What touches at one of them by more than half a step has to be said,
  /// and what is said has to be found.
  void compareWay(std::size_t state, const Row& row) {
    constexpr int kPoses = 24;
    constexpr double kHalfStep = 0.01;
    // The way is looked along at places of its own, not at the pose ahead exactly.
    constexpr double kPlaces = 0.0025;  // [m] apart
    if (!row.collision) {
      for (int k = 1; k <= kPoses; k += k == 1 ? 7 : 8) {
        robot_.place(positionsAfter(state, horizon_s_ * k / kPoses));
        if (robot_.touching(map_).empty()) continue;
        const bool is_end = k == kPoses;
        EXPECT_LT(-robot_.distance(map_), is_end ? kPlaces : kHalfStep) << row.scan << ", " << k;
      }
      return;
    }
    // While a stop is being released no link is named.
    std::set<std::string> touched;
    const auto found = [&] {
      return row.link.empty() ? !touched.empty() : touched.count(row.link) == 1;
    };
    for (int k = kPoses; k >= 1 && !found(); --k) {
      robot_.place(positionsAfter(state, horizon_s_ * k / kPoses));
      touched.merge(robot_.touching(map_));
    }
    if (found()) return;
    ++differences_;
    ADD_FAILURE() << row.scan << ": nothing touches ahead with " << row.link;
  }

  [[nodiscard]] test::Positions positionsAfter(std::size_t state, double time_s) const {
    constexpr auto kBaseline = static_cast<Nanoseconds>(1e9 * kBaselineS);
    test::Positions velocities;
    for (const auto& joint : motion_.states()[state].positions) {
      velocities[joint.first] = motion_.velocity(state, joint.first, kBaseline);
    }
    return robot_.robot().ahead(motion_.states()[state].positions, velocities, time_s);
  }

  /// @return the links that touch by FCL.
  std::set<std::string> compareAt(const test::Positions& positions, bool says, const Row& row) {
    robot_.place(positions);
    const std::set<std::string> touching = robot_.touching(map_);
    if (says == touching.empty()) {
      ++differences_;
      EXPECT_LT(std::abs(robot_.distance(map_)), kIterations) << row.scan << ", " << row.reason;
    } else if (says) {
      EXPECT_EQ(touching.count(row.link), 1U) << row.scan << ", " << row.link;
    }
    return touching;
  }

  test::RecordedMotion motion_;
  std::vector<std::size_t> oldest_;
  test::DumpedMap map_;
  IndependentRobot robot_;
  double horizon_s_;
  std::size_t differences_ = 0;
  std::set<std::string> touched_;
};

/// Compares all checks. @return the links that touch at one of the present poses, by FCL.
std::set<std::string> expectAgreement(const Settings& settings, const Evaluated& evaluated) {
  const nlohmann::json& summary = evaluated.summary;
  EXPECT_EQ(summary.at("scans"), summary.at("scans_received"));  // else serials are not indices
  EXPECT_EQ(summary.at("checks"), evaluated.rows.size());
  Recount recount(settings, evaluated);
  EXPECT_EQ(summary.at("map").at("window_scans"), recount.scansInWindow());
  for (const Row& row : evaluated.rows) recount.compare(row);
  EXPECT_LT(1000 * recount.differences(), evaluated.rows.size());
  ::testing::Test::RecordProperty("differences", std::to_string(recount.differences()));
  return recount.touched();
}

class Pr2VerdictsTest : public ::testing::TestWithParam<Settings> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(test::bagPath(GetParam().bag))) GTEST_SKIP() << "no recordings";
    evaluated_ = &evaluatedOnce(GetParam());
  }

  const Evaluated* evaluated_ = nullptr;
};

class Pr2LinkVerdictsTest : public Pr2VerdictsTest {};

/// From the first row of a run to its last.
struct Spell {
  std::string reason;
  Nanoseconds begin;
  Nanoseconds end;
};

/// Runs of rows with the same answer, where a collision at the pose ahead is one as well.
std::vector<Spell> spellsOf(const std::vector<Row>& rows) {
  std::vector<Spell> spells;
  for (const Row& row : rows) {
    const bool now = row.reason == "COLLISION" || row.reason == "MOVING_OUT";
    const std::string reason = !row.collision ? "FREE" : now ? "COLLISION" : row.reason;
    if (spells.empty() || spells.back().reason != reason) spells.push_back({reason, row.stamp, 0});
    spells.back().end = row.stamp;
  }
  return spells;
}

std::vector<std::string> lastingReasons(const std::vector<Row>& rows) {
  constexpr Nanoseconds kLasting = 1'000'000'000;
  std::vector<std::string> reasons;
  for (const Spell& spell : spellsOf(rows)) {
    if (spell.end - spell.begin < kLasting) continue;
    if (reasons.empty() || reasons.back() != spell.reason) reasons.push_back(spell.reason);
  }
  return reasons;
}

TEST_P(Pr2VerdictsTest, EveryLinkOfBothArmsThatIsSolidIsMonitored) {
  constexpr std::size_t kLinksOfBothArms = 30;
  const IndependentRobot robot(evaluated_->primitives, GetParam().padding_m);
  std::set<std::string> arms = robot.robot().solidLinksFrom("l_shoulder_pan_link");
  arms.merge(robot.robot().solidLinksFrom("r_shoulder_pan_link"));
  EXPECT_EQ(arms.size(), kLinksOfBothArms);
  EXPECT_EQ(robot.links(), arms);
  EXPECT_EQ(evaluated_->summary.at("robot").at("links_monitored"), kLinksOfBothArms);
}

TEST_P(Pr2VerdictsTest, AgreesWithKdlAndFclAtEveryCheckedPose) {
  const std::set<std::string> touched = expectAgreement(GetParam(), *evaluated_);
  if (GetParam().bag == "both_arms_wave") {
    EXPECT_EQ(touched, std::set<std::string>());
  } else if (!GetParam().self_filter) {
    for (const char* link : {"l_forearm_link", "r_forearm_link", "l_wrist_flex_link"}) {
      EXPECT_EQ(touched.count(link), 1U) << link;
    }
  }
}

TEST_P(Pr2VerdictsTest, HandsThatDipTouchTwiceAndComeFreeAndWavingArmsTouchNothing) {
  std::vector<std::string> expected{"FREE"};
  if (GetParam().bag == "hands_dip_into_table") {
    expected = {"FREE", "COLLISION", "FREE", "COLLISION", "FREE"};
  }
  EXPECT_EQ(lastingReasons(evaluated_->rows), expected);
}

/// In a verdict on all links one that touches hides what is thought of the others.
TEST_P(Pr2LinkVerdictsTest, AgreesWithKdlAndFclWhereItsLinkIsCheckedAlone) {
  expectAgreement(GetParam(), *evaluated_);
  const auto& rows = evaluated_->rows;
  const auto touches = [](const Row& row) { return row.reason == "COLLISION"; };
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), touches));
  EXPECT_FALSE(std::all_of(rows.begin(), rows.end(), touches));
}

std::string nameOf(const ::testing::TestParamInfo<Settings>& info) {
  return info.param.bag + (info.param.horizon_s > 0.0 ? "_and_ahead" : "_now") +
         (info.param.self_filter ? "_self_filter" : "");
}

INSTANTIATE_TEST_SUITE_P(Recordings, Pr2VerdictsTest,
                         ::testing::Values(Settings{"both_arms_wave", 0.0, false},
                                           Settings{"both_arms_wave", 0.5, true},
                                           Settings{"hands_dip_into_table", 0.0, false},
                                           Settings{"hands_dip_into_table", 0.0, true},
                                           Settings{"hands_dip_into_table", 0.5, false},
                                           Settings{"hands_dip_into_table", 0.5, true}),
                         nameOf);

/// With so much padding that it touches something when the arms are down.
Settings linkAlone(const std::string& link, double padding_m) {
  return {"hands_dip_into_table", 0.5, false, padding_m, link};
}

INSTANTIATE_TEST_SUITE_P(
    Links, Pr2LinkVerdictsTest,
    ::testing::Values(linkAlone("?_shoulder_pan_link", 0.07),
                      linkAlone("?_shoulder_lift_link", 0.1),
                      linkAlone("?_upper_arm_roll_link", 0.06), linkAlone("?_upper_arm_link", 0.01),
                      linkAlone("?_elbow_flex_link", 0.01), linkAlone("?_forearm_roll_link", 0.01),
                      linkAlone("?_forearm_link", 0.01), linkAlone("?_wrist_flex_link", 0.01),
                      linkAlone("?_wrist_roll_link", 0.05), linkAlone("?_gripper_palm_link", 0.05),
                      linkAlone("?_gripper_?_finger_link", 0.06),
                      linkAlone("?_gripper_?_finger_tip_link", 0.15),
                      linkAlone("?_gripper_motor_accelerometer_link", 0.1)),
    [](const auto& info) {
      std::string name = info.param.links.substr(2);
      std::replace(name.begin(), name.end(), '?', 'x');
      return name;
    });

}  // namespace
}  // namespace tccm
