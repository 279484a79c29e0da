#include "gate_client.h"

namespace {

using namespace gated;

class GoalsTest : public GateClient {};

TEST_F(GoalsTest, AFreeWayIsGoneToItsEnd) {
  const Outcome outcome = sendUntil([&] { return goalAlong(4, 12); }, isReached);
  EXPECT_TRUE(isReached(outcome)) << outcome.text;
  EXPECT_LT(distanceTo(furthest_), kReached);
  EXPECT_TRUE(comesToStand());
}

TEST_F(GoalsTest, AGoalIntoTheTableIsRejectedWithReasonLinkAndTime) {
  ASSERT_TRUE(isReached(arriveAt(ahead_)));
  ASSERT_TRUE(comesToStand());
  const ros::Time begun = ros::Time::now();
  std::vector<double> table = ahead_;
  table[0] += 0.6;  // the shoulder's pitch
  const std::string expected =
      "COLLISION, right_[a-z_]+_link touches the map after [0-9]+\\.[0-9]+ s";
  const Outcome outcome = sendUntil([&] { return goalTo(table); },
                                    [&](const Outcome& end) { return tells(end, expected); });
  EXPECT_TRUE(tells(outcome, expected)) << outcome.text;
  EXPECT_EQ(outcome.state, State::REJECTED);
  EXPECT_EQ(outcome.code, Result::INVALID_GOAL);
  EXPECT_LT(wayOf(samples(begun)), kAtRest);
}

TEST_F(GoalsTest, ACancelledGoalLeavesTheArmStanding) {
  ASSERT_TRUE(isReached(arriveAt(back_)));
  ASSERT_TRUE(isUnderWay([&] { return goalTo(ahead_); }, 0.3));
  client_.cancelGoal();
  EXPECT_EQ(outcomeOf(client_).state, State::PREEMPTED);
  EXPECT_TRUE(comesToStand());
  EXPECT_GT(distanceTo(ahead_), 0.3);
}

TEST_F(GoalsTest, AnotherClientsGoalTakesThePlaceOfTheOneBefore) {
  ASSERT_TRUE(isReached(arriveAt(back_)));
  Client other(kAction, true);
  ASSERT_TRUE(other.waitForServer(ros::Duration(kPatience_s)));
  ASSERT_TRUE(isUnderWay([&] { return goalTo(ahead_); }, 0.3));
  other.sendGoal(goalTo(back_));
  EXPECT_EQ(outcomeOf(client_).state, State::PREEMPTED);
  Outcome outcome = outcomeOf(other);
  if (!isReached(outcome)) outcome = arriveAt(back_);  // the machine is busy
  EXPECT_TRUE(isReached(outcome)) << outcome.text;
  EXPECT_LT(distanceTo(back_), kReached);
}

TEST_F(GoalsTest, OutOfAContactItGoesSlowlyAndInItDoesNotGo) {
  ASSERT_TRUE(isReached(arriveAt(ahead_)));
  ASSERT_TRUE(putHandIntoRegion(0.015));
  ASSERT_TRUE(waitFor([&] { return !lastTime("KEEP_OUT").isZero(); })) << lastPermission();
  EXPECT_FALSE(lastHeard()->permitted);

  const std::string into = "not free: KEEP_OUT, right_[a-z_]+ enters keep-out region 'ahead of";
  Outcome outcome = sendUntil([&] { return goalTo(furthest_); },
                              [&](const Outcome& end) { return tells(end, into); });
  EXPECT_TRUE(tells(outcome, into)) << outcome.text;
  EXPECT_EQ(outcome.state, State::REJECTED);
  EXPECT_LT(distanceTo(ahead_), kReached);

  constexpr double kTime_s = 1.5;
  const auto out = [&] { return goalTo(way_.points[7].positions, kTime_s, false); };
  CheckTrajectory question;
  question.request.trajectory = out().trajectory;
  ASSERT_TRUE(check_trajectory_.call(question));
  EXPECT_EQ(question.response.result, CheckTrajectory::Response::FREE);
  EXPECT_EQ(question.response.reason, "MOVING_OUT");

  const std::vector<double> start = positions();
  const ros::Time begun = ros::Time::now();
  // Once the hand is out, what has held since the contact holds again, until it is reset.
  outcome = sendUntil(out, [&](const Outcome& end) { return tells(end, "AWAITING_RESET"); });
  EXPECT_TRUE(tells(outcome, "AWAITING_RESET")) << outcome.text;
  const ros::Time left = lastTime("MOVING_OUT");
  ASSERT_GT(left, begun);
  double most = 0.0, way = 0.0;
  const std::vector<Sample> moved = samples(begun);
  for (auto from = moved.begin(), to = from; to != moved.end() && to->stamp <= left; ++to) {
    // Setpoints do not come as evenly as they were sent: over a tenth of a second that is little.
    while ((to->stamp - from->stamp).toSec() > 0.1) ++from;
    const double took_s = (to->stamp - from->stamp).toSec();
    for (std::size_t j = 0; j < start.size(); ++j) {
      const double full_speed = std::abs(way_.points[7].positions[j] - start[j]) / kTime_s;
      if (full_speed < 0.1) continue;
      way = std::max(way, std::abs(to->positions[j] - start[j]));
      if (took_s < 0.08) continue;
      const double speed = std::abs(to->positions[j] - from->positions[j]) / took_s;
      most = std::max(most, speed / full_speed);
    }
  }
  EXPECT_GT(way, 0.02);
  EXPECT_GT(most, 0.5 * kMovingOutScale);
  EXPECT_LE(most, 1.05 * kMovingOutScale);
  EXPECT_TRUE(comesToStand());
  EXPECT_FALSE(isInRegion());

  outcome = arriveAt(back_);
  EXPECT_TRUE(isReached(outcome)) << outcome.text;
}

class ObstacleTest : public GateClient {};

TEST_F(ObstacleTest, WhatAppearsAheadOfTheHandHoldsItUntilANewGoalLeadsAway) {
  const std::string seen = "COLLISION";
  Outcome outcome = sendUntil(
      [&] { return goalAlong(0, 12); },
      [&](const Outcome& end) { return end.state != State::REJECTED && tells(end, seen); });
  EXPECT_TRUE(tells(outcome, seen)) << outcome.text;
  EXPECT_EQ(outcome.state, State::ABORTED);
  EXPECT_EQ(outcome.code, Result::INVALID_GOAL);
  EXPECT_TRUE(comesToStand());
  EXPECT_GT(distanceTo(furthest_), 0.1);
  // Not on by itself, whatever is permitted again.
  const std::vector<double> there = positions();
  ASSERT_TRUE(waitFor([this] { return isPermitted(); })) << lastPermission();
  EXPECT_TRUE(comesToStand());
  EXPECT_LT(distanceTo(there), kAtRest);

  outcome = sendUntil([&] { return goalTo(furthest_); },
                      [&](const Outcome& end) { return tells(end, "not free: COLLISION"); });
  EXPECT_TRUE(tells(outcome, "not free: COLLISION")) << outcome.text;
  EXPECT_EQ(outcome.state, State::REJECTED);

  outcome = arriveAt(back_);
  EXPECT_TRUE(isReached(outcome)) << outcome.text;
  EXPECT_LT(distanceTo(back_), kReached);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "gate_obeys_test");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  return RUN_ALL_TESTS();
}
