#include "check/model_agreement.h"

#include <gtest/gtest.h>

#include "simulation/robot/dual_arm.h"
#include "support/checker_fixture.h"
#include "support/told_transforms.h"

namespace tccm {
namespace {

using simulation::dualArm;
using simulation::linkIndex;
using test::Random;
using test::Telling;
using test::ToldRobot;

constexpr unsigned kMembers = 25;
constexpr double kTold = 3.0;  // [s]
const char* const kLaser = "laser_link";

/// Index of the joint above a link.
const RobotJoint& jointAbove(const RobotModel& model, const std::string& link) {
  for (const RobotJoint& joint : model.joints()) {
    if (model.links()[joint.child] == link) return joint;
  }
  throw std::out_of_range(link);
}

bool isBelow(const RobotModel& model, std::size_t link, std::size_t above) {
  for (const RobotJoint& joint : model.joints()) {
    if (joint.child == link) return joint.parent == above || isBelow(model, joint.parent, above);
  }
  return false;
}

std::string randomLink(Random& random) {
  const auto model = dualArm();
  const int joint = random.integer(0, static_cast<int>(model->joints().size()) - 1);
  return model->links()[model->joints()[static_cast<std::size_t>(joint)].child];
}

/// Transforms put a link elsewhere, with all that hangs on it.
/// @param D what T_parent_link is multiplied by.
auto displaced(const std::string& link, const Pose& D) {
  const auto model = dualArm();
  const std::size_t index = linkIndex(*model, link);
  return [model, index, D](const std::string& name, const Posture& posture, const Pose& truth) {
    const std::size_t i = linkIndex(*model, name);
    if (i != index && !isBelow(*model, i, index)) return truth;
    const Pose& T_root_link = posture.T_fixed_links[index];
    return Pose(T_root_link * D * T_root_link.inverse() * truth);
  };
}

Pose moved(const Vector3& by) {
  Pose pose = Pose::Identity();
  pose.translation() = by;
  return pose;
}

struct Heard {
  Cause cause;
  std::vector<ModelAgreement::Compared> compared;
};

Heard hear(const Telling& telling, unsigned seed, const RobotModel::Config& config = {},
           double seconds = kTold) {
  const auto model = test::modelOf(simulation::dualArmUrdf(), config);
  ModelAgreement agreement(model, {});
  agreement.watchSensor(kLaser);
  ToldRobot robot(dualArm(), telling, seed);
  robot.tell(agreement, seconds);
  return {agreement.cause(), agreement.compared()};
}

testing::AssertionResult disagrees(const Heard& heard) {
  if (heard.cause.reason == Reason::kModelDisagrees) return testing::AssertionSuccess();
  double worst = 0.0;
  for (const auto& frame : heard.compared) worst = std::max(worst, frame.worst_m);
  return testing::AssertionFailure() << "at most " << worst << " m apart";
}

testing::AssertionResult agrees(const Heard& heard) {
  if (heard.cause.reason != Reason::kClear)
    return testing::AssertionFailure() << heard.cause.detail;
  for (const auto& frame : heard.compared) {
    if (frame.comparisons >= 5) continue;
    return testing::AssertionFailure() << frame.link << " was hardly compared";
  }
  return testing::AssertionSuccess();
}

TEST(ModelAgreementTest, ALinkThatTfPutsElsewhereIsAFaultThatTellsHowFarAndWhere) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    const std::string link = randomLink(random);
    const double far = random.uniform(0.04, 1.0);
    telling.lie = displaced(link, moved(far * random.direction()));
    const Heard heard = hear(telling, seed);
    EXPECT_TRUE(disagrees(heard)) << seed << " " << link;
    char metres[20];
    std::snprintf(metres, sizeof metres, "%.3f m off", far);
    EXPECT_NE(heard.cause.detail.find(metres), std::string::npos) << heard.cause.detail;
    EXPECT_NE(heard.cause.detail.find("model_tolerance_m is 0.03"), std::string::npos);
    EXPECT_LT(heard.cause.detail.size(), 400U);
    EXPECT_EQ(heard.cause.level, Level::kFault);
    const auto model = dualArm();
    const std::size_t named = linkIndex(*model, heard.cause.link);
    EXPECT_TRUE(heard.cause.link == link || isBelow(*model, named, linkIndex(*model, link)));
  }
}

TEST(ModelAgreementTest, ASensorThatIsMountedElsewhereOrTurnedIsAFault) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    Pose D = moved(random.uniform(0.04, 1.0) * random.direction());
    if (seed % 2 == 0) {
      D = Pose::Identity();
      // The tilt turns while it is compared: some hundredths of a radian may be its stamps.
      D.rotate(Eigen::AngleAxisd(random.uniform(0.1, 3.1), random.direction()));
    }
    telling.lie = displaced(kLaser, D);
    RobotModel::Config config;  // in which the laser is no link with a shape of its own
    config.ignored_links = {kLaser};
    const Heard heard = hear(telling, seed, config);
    EXPECT_TRUE(disagrees(heard)) << seed;
    EXPECT_EQ(heard.cause.link, kLaser) << seed;
  }
}

TEST(ModelAgreementTest, ALinkThatIsTurnedAgainstTheUrdfIsAFault) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    Pose D = Pose::Identity();
    D.rotate(Eigen::AngleAxisd(random.uniform(0.6, 3.0), random.direction()));
    const std::string link = randomLink(random);
    telling.lie = displaced(link, D);
    EXPECT_TRUE(disagrees(hear(telling, seed))) << seed << " " << link;
  }
}

/// A link that hangs at some distance from its parent, and that offset.
std::pair<std::string, Vector3> someOffsetLink(Random& random) {
  const auto model = dualArm();
  while (true) {
    const std::string link = randomLink(random);
    const Vector3 offset = jointAbove(*model, link).T_parent_joint.translation();
    if (offset.norm() >= 0.05) return {link, offset};
  }
}

TEST(ModelAgreementTest, MillimetresForMetresAndTheReverseAreAFault) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    const auto [link, offset] = someOffsetLink(random);
    const double factor = seed % 2 == 0 ? 1000.0 : 0.001;
    // In the link's own frame, whose joint may have turned it: the length alone counts here.
    telling.lie = displaced(link, moved((factor - 1.0) * offset));
    const Heard heard = hear(telling, seed);
    EXPECT_TRUE(disagrees(heard)) << seed << " " << link;
    EXPECT_EQ(heard.cause.detail.find("in millimetres?") != std::string::npos, factor > 1.0);
  }
}

TEST(ModelAgreementTest, AJointThatTfSeesAtAnotherAngleIsAFault) {
  for (unsigned seed = 0; seed < 2 * kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    const auto joint = static_cast<std::size_t>(random.integer(0, 18));
    const bool is_mirrored = seed % 2 == 0;
    const double offset = (random.chance(0.5) ? 1.0 : -1.0) * random.uniform(0.3, 1.5);
    double least = 1.0;
    telling.other_joints = [&](std::vector<double>& positions) {
      least = std::min(least, std::abs(positions[joint]));
      positions[joint] = is_mirrored ? -positions[joint] : positions[joint] + offset;
    };
    const Heard heard = hear(telling, seed);
    if (is_mirrored && least < 0.3) continue;  // about zero nothing tells it
    EXPECT_TRUE(disagrees(heard)) << seed << dualArm()->variables()[joint].name;
  }
}

TEST(ModelAgreementTest, AMirroredMountIsAFault) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    const auto [link, offset] = someOffsetLink(random);
    telling.lie = displaced(link, moved(-2.0 * offset));
    EXPECT_TRUE(disagrees(hear(telling, seed))) << seed << " " << link;
  }
}

TEST(ModelAgreementTest, ASloppyRobotIsNone) {
  for (unsigned seed = 0; seed < 2 * kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    telling.joints_hz = random.uniform(15.0, 500.0);
    telling.tf_hz = random.uniform(10.0, 100.0);
    telling.joints_late_s = random.chance(0.5) ? random.uniform(0.0, 0.5) : 0.0;
    telling.tf_late_s = random.chance(0.5) ? random.uniform(0.0, 0.5) : 0.0;
    telling.tf_dated_s = random.chance(0.5) ? random.uniform(-0.06, 0.06) : 0.0;
    telling.jitter_s = random.chance(0.5) ? random.uniform(0.0, 0.01) : 0.0;
    telling.rounding = random.chance(0.5) ? 1e-3 : 0.0;
    telling.speed = random.uniform(0.0, 2.0);
    EXPECT_TRUE(agrees(hear(telling, seed))) << seed;
  }
}

TEST(ModelAgreementTest, CalibrationsOfAFewMillimetresAreNone) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    Pose D = moved(random.uniform(0.0, 0.008) * random.direction());
    D.rotate(Eigen::AngleAxisd(random.uniform(0.0, 0.012), random.direction()));
    telling.lie = displaced(randomLink(random), D);
    EXPECT_TRUE(agrees(hear(telling, seed))) << seed;
  }
}

TEST(ModelAgreementTest, ATransformDatedFarAheadIsComparedWhereJointStatesAre) {
  Telling telling;
  telling.speed = 0.0;
  telling.tf_dated_s = 2.0;
  EXPECT_EQ(hear(telling, 1).cause.reason, Reason::kClear);
  telling.lie = displaced("left_palm_link", moved({0.0, 0.1, 0.0}));
  EXPECT_TRUE(disagrees(hear(telling, 1, {}, 6.0)));
}

TEST(ModelAgreementTest, OneWrongTransformInSevenIsNoFaultAndEveryOtherIsOne) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Telling telling;
    int told = 0;
    const auto lie = displaced("left_palm_link", moved({0.0, 0.5, 0.0}));
    telling.tf_hz = 10.0;
    const int every = seed % 2 == 0 ? 7 : 2;
    telling.lie = [&](const std::string& link, const Posture& posture, const Pose& truth) {
      if (link == "base_link") ++told;
      return told % every == 0 ? lie(link, posture, truth) : truth;
    };
    const Heard heard = hear(telling, seed, {}, 6.0);
    bool did_disagree = false;
    for (const auto& frame : heard.compared) did_disagree = did_disagree || frame.did_disagree;
    EXPECT_EQ(did_disagree, every == 2) << seed;
  }
}

TEST(ModelAgreementTest, ATrustedFrameIsNotComparedAndWhatHangsOnItIsFromThere) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    Telling telling;
    const std::string link = randomLink(random);
    RobotModel::Config config;
    config.trusted_frames = {link};
    telling.lie = displaced(link, random.pose(0.5));
    EXPECT_TRUE(agrees(hear(telling, seed, config))) << seed << " " << link;
  }
}

TEST(ModelAgreementTest, BelowATrustedFrameALieIsFound) {
  Telling telling;
  RobotModel::Config config;
  config.trusted_frames = {"left_elbow_link"};
  telling.lie = displaced("left_palm_link", moved({0.0, 0.06, 0.0}));
  const Heard heard = hear(telling, 1, config);
  EXPECT_TRUE(disagrees(heard));
  EXPECT_NE(heard.cause.detail.find("'left_elbow_link'"), std::string::npos) << heard.cause.detail;
}

TEST(ModelAgreementTest, ItEndsOnceTheyAgreeAndOnceNothingIsHeardOfTheFrame) {
  const auto model = dualArm();
  ModelAgreement agreement(model, {});
  Telling telling;
  telling.lie = displaced("left_palm_link", moved({0.0, 0.06, 0.0}));
  ToldRobot robot(model, telling, 1);
  robot.tell(agreement, kTold);
  ASSERT_EQ(agreement.cause().reason, Reason::kModelDisagrees);
  robot.telling().lie = {};
  robot.tell(agreement, kTold);
  EXPECT_EQ(agreement.cause().reason, Reason::kClear);
  EXPECT_FALSE(agreement.firstDisagreement().empty());
  robot.telling().lie = telling.lie;
  robot.tell(agreement, kTold);
  ASSERT_EQ(agreement.cause().reason, Reason::kModelDisagrees);
  for (int i = 0; i < 30; ++i) {
    agreement.compare(ToldRobot::at(robot.now() + 0.1 * i),
                      {[](const auto&, const auto&) { return std::nullopt; },
                       [](const auto&, const auto&, Time) { return std::nullopt; }});
  }
  EXPECT_EQ(agreement.cause().reason, Reason::kClear);
}

TEST(ModelAgreementTest, TimeThatBeginsAnewForgetsAll) {
  const auto model = dualArm();
  ModelAgreement agreement(model, {});
  Telling telling;
  telling.lie = displaced("left_palm_link", moved({0.0, 0.06, 0.0}));
  ToldRobot robot(model, telling, 1);
  robot.tell(agreement, kTold);
  agreement.reset();
  EXPECT_EQ(agreement.cause().reason, Reason::kClear);
  ToldRobot again(model, telling, 1);
  again.tell(agreement, kTold);
  EXPECT_EQ(agreement.cause().reason, Reason::kModelDisagrees);
}

TEST(ModelAgreementTest, ItTellsWhatIsNotComparedAndWhy) {
  using namespace test;
  const auto model = modelOf(
      robotOf(linkOf("base") + ballLink("hand") + ballLink("other") +
              jointOf("slide", "prismatic", "base", "hand", axisOf("1 0 0") + limitOf("-1", "1")) +
              jointOf("weld", "fixed", "base", "other")));
  ModelAgreement agreement(model, {});
  agreement.watchSensor("camera");
  EXPECT_EQ(agreement.notCompared(), std::vector<std::string>{"camera: the URDF does not know it"});
  const ModelAgreement::Transforms transforms{
      [](const std::string&,
         const std::string& frame) -> std::optional<ModelAgreement::Transforms::Newest> {
        if (frame == "other") return std::nullopt;
        return ModelAgreement::Transforms::Newest{ToldRobot::at(100.0), Pose::Identity(), true};
      },
      [](const auto&, const auto&, Time) { return std::nullopt; }};
  for (int i = 0; i < 30; ++i) agreement.compare(ToldRobot::at(100.0 + 0.1 * i), transforms);
  EXPECT_EQ(agreement.notCompared(),
            (std::vector<std::string>{"camera: the URDF does not know it",
                                      "hand: no joint state has 'slide'",
                                      "other: tf does not have it in 'base'"}));
}

TEST(ModelAgreementTest, WhatTransformsPlaceAnyhowCannotDisagree) {
  using namespace test;
  for (const std::string type : {"floating", "planar"}) {
    const auto model =
        modelOf(robotOf(ballLink("base") + ballLink("cart") + ballLink("mast") +
                        jointOf("hitch", type, "base", "cart") +
                        jointOf("weld", "fixed", "cart", "mast", "<origin xyz=\"0 0 1\"/>")));
    const ModelAgreement agreement(model, {});
    const auto compared = agreement.compared();
    ASSERT_EQ(compared.size(), 1U);
    EXPECT_EQ(compared[0].link, "mast");
    EXPECT_EQ(compared[0].reference, "cart");
  }
}

TEST(ModelAgreementTest, EverNewSensorsAreNotRemembered) {
  ModelAgreement agreement(dualArm(), {});
  for (int i = 0; i < 10000; ++i) agreement.watchSensor("laser" + std::to_string(i));
  EXPECT_LE(agreement.notCompared().size(), 16U);
}

TEST(ModelAgreementTest, APrefixIsPutBeforeEveryLink) {
  for (unsigned seed = 0; seed < kMembers; ++seed) {
    Random random(seed);
    RobotModel::Config config;
    config.tf_prefix = random.chance(0.5) ? "left" : "/robots/left";
    const auto model = test::modelOf(simulation::dualArmUrdf(), config);
    ModelAgreement agreement(model, {});
    agreement.watchSensor(model->frameOf(kLaser));
    Telling telling;
    const std::string link = randomLink(random);
    if (seed % 2 == 0) telling.lie = displaced(link, moved(0.1 * random.direction()));
    ToldRobot robot(model, telling, seed);
    robot.tell(agreement, kTold);
    EXPECT_EQ(agreement.cause().reason, seed % 2 == 0 ? Reason::kModelDisagrees : Reason::kClear);
    EXPECT_TRUE(agreement.notCompared().empty());
    EXPECT_EQ(agreement.compared().back().link, kLaser);
  }
}

/// The slider robot, whose hand tf puts elsewhere.
class ModelAgreementInCheckerTest : public test::CheckerFixture {
 protected:
  const Verdict& runTelling(double aside, double from, double to) {
    for (double now = from; now < to; now += test::kScanPeriod) {
      feed(now, clear_);
      checker_->agreement().compare(
          test::at(now),
          {[aside, now](const std::string&, const std::string& frame)
               -> std::optional<ModelAgreement::Transforms::Newest> {
             const double y = frame == "other" ? 0.5 : aside;
             return ModelAgreement::Transforms::Newest{test::at(now), moved({0.0, y, 0.5}), false};
           },
           [aside](const std::string&, const std::string& frame, Time) -> std::optional<Pose> {
             return moved({0.0, frame == "other" ? 0.5 : aside, 0.5});
           }});
      check(now);
    }
    return check(to);
  }
};

TEST_F(ModelAgreementInCheckerTest, ADisagreementIsAFaultThatAwaitsAReset) {
  config_.permission.hold_until_reset = true;
  remake();
  EXPECT_EQ(runTelling(0.0, 100.0, 103.0).reason, Reason::kClear);
  const Verdict& verdict = runTelling(0.05, 103.0, 106.0);
  EXPECT_EQ(verdict.reason, Reason::kModelDisagrees);
  EXPECT_EQ(verdict.link, "hand");
  EXPECT_EQ(checker_->checkState(test::at(106.0), {"slide"}, {0.0}).cause.reason,
            Reason::kModelDisagrees);
  EXPECT_EQ(
      checker_->checkTrajectory(test::at(106.0), {{"slide"}, {{0.0, {0.0}, {}, {}}}}).cause.reason,
      Reason::kModelDisagrees);
  EXPECT_EQ(runTelling(0.0, 106.0, 110.0).reason, Reason::kAwaitingReset);
  EXPECT_EQ(checker_->reset(), "");
  EXPECT_EQ(runTelling(0.0, 110.0, 113.0).reason, Reason::kClear);
}

TEST_F(ModelAgreementInCheckerTest, WithinTheToleranceItIsNone) {
  EXPECT_EQ(runTelling(0.029, 100.0, 103.0).reason, Reason::kClear);
  config_.inputs.agreement.tolerance_m = 0.02;
  checker_->reconfigure(config_);
  EXPECT_EQ(runTelling(0.029, 103.0, 106.0).reason, Reason::kModelDisagrees);
}

}  // namespace
}  // namespace tccm
