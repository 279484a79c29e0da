#include "ros/stops/stop_recorder.h"

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sys/mount.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "ros/transform_history.h"
#include "support/temporary_folder.h"
#include "tccm_monitor/CheckerState.h"

namespace tccm {
namespace {

trajectory_msgs::JointTrajectory moving(const std::vector<std::string>& joints) {
  trajectory_msgs::JointTrajectory trajectory;
  trajectory.joint_names = joints;
  trajectory.points.resize(1);
  trajectory.points.front().time_from_start = ros::Duration(0.1);
  return trajectory;
}

class StopRecorderTest : public testing::Test {
 protected:
  StopRecorderTest() { verdict_.reasons = {Reason::kClear}; }

  /// What the checker said of itself.
  void say(bool stop, Reason reason = Reason::kClear) {
    verdict_.stop = stop;
    verdict_.reason = reason;
    verdict_.reasons = {reason};
    verdict_.stamp = now_;
    recorder_.fail(now_, {}, verdict_);
    now_ += std::chrono::milliseconds(20);
  }
  void command(const trajectory_msgs::JointTrajectory& trajectory) {
    recorder_.trajectory(now_, trajectory);
  }

  /// @return the joints of the trajectories that a stop's bag begins its newest part with.
  std::vector<std::vector<std::string>> known() {
    for (int i = 0; i < 2; ++i) {  // the second begins a part of its own
      const std::size_t written = recorder_.report().writer.written;
      say(false, verdict_.reason);
      say(true, verdict_.reason);
      while (recorder_.report().writer.written == written) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
    rosbag::Bag bag(recorder_.report().writer.last);
    tccm_monitor::CheckerState::ConstPtr last;
    const std::string topic = stopTopics({""}).at(topicIndex(StopTopicId::kState)).name;
    for (const rosbag::MessageInstance& message : rosbag::View(bag, rosbag::TopicQuery(topic))) {
      last = message.instantiate<tccm_monitor::CheckerState>();
    }
    state_ = *last;
    std::vector<std::vector<std::string>> joints;
    for (const auto& trajectory : last->trajectories) joints.push_back(trajectory.joint_names);
    return joints;
  }

  test::TemporaryFolder folder_;
  Time now_ = Time(std::chrono::seconds(100));
  Verdict verdict_;
  tccm_monitor::CheckerState state_;  ///< as known() read it
  StopRecorder recorder_{{folder_.path(), 5, 8.0}, {"a: 1", "<robot/>", "b: 2"}, {""}};
};

using Joints = std::vector<std::vector<std::string>>;

TEST_F(StopRecorderTest, AStopBeginsWithWhatIsCommanded) {
  command(moving({"shoulder"}));
  command(moving({"torso"}));
  command(moving({"shoulder", "elbow"}));
  EXPECT_EQ(known(), (Joints{{"torso"}, {"shoulder", "elbow"}}));
}

TEST_F(StopRecorderTest, OneThatNamesNoJointTakesAllBack) {
  command(moving({"shoulder"}));
  command({});
  EXPECT_EQ(known(), (Joints{{}}));
}

TEST_F(StopRecorderTest, WhatIsNotUnderstoodStaysUntilItIsTakenBack) {
  command(moving({"nobodys"}));
  say(true, Reason::kBadTrajectory);
  now_ += std::chrono::seconds(60);
  command(moving({"torso"}));
  EXPECT_EQ(known(), (Joints{{"nobodys"}, {"torso"}}));
  command(moving({"nobodys"}));
  say(true, Reason::kCollision);
  now_ += std::chrono::seconds(60);
  command(moving({"torso"}));
  EXPECT_EQ(known(), (Joints{{"torso"}}));
}

TEST_F(StopRecorderTest, ATrajectoryOfTheEndOfTimeIsWhatIsCommanded) {
  trajectory_msgs::JointTrajectory endless = moving({"shoulder"});
  endless.header.stamp = ros::TIME_MAX;
  command(endless);
  command(moving({"torso"}));
  EXPECT_EQ(known(), (Joints{{"shoulder"}, {"torso"}}));
}

TEST_F(StopRecorderTest, OfEverNewStaticFramesSoManyAreKnown) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms.front().header.frame_id = "base";
  for (int i = 0; i < 2500; ++i) {
    message.transforms.front().child_frame_id = "frame" + std::to_string(i);
    recorder_.transforms(now_, message, true);
  }
  known();
  EXPECT_EQ(state_.static_transforms.size(), TransformHistory::kNamesMax);
}

TEST_F(StopRecorderTest, AfterTimeBeganAnewNothingIsCommanded) {
  command(moving({"shoulder"}));
  recorder_.startAnew(now_);
  EXPECT_EQ(known(), Joints{});
}

/// Where it may not mount, it is skipped.
class StopRecorderOnFullDiskTest : public testing::Test {
 protected:
  void SetUp() override {
    if (::mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
      GTEST_SKIP() << "no small disk can be made here: that takes the right to mount";
    }
  }
  void TearDown() override { ::umount2(folder_.path().c_str(), MNT_DETACH); }

  test::TemporaryFolder folder_;
};

std::size_t openFiles() {
  const auto all = std::filesystem::directory_iterator("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

TEST_F(StopRecorderOnFullDiskTest, NothingIsLeftOfAStopThatCannotBeWritten) {
  std::string text;  // that cannot be compressed to what there is room for
  for (std::minstd_rand random(1); text.size() < 200'000;) {
    text += static_cast<char>(' ' + random() % 64);
  }
  const std::size_t open = openFiles();
  for (int i = 0; i < 3; ++i) {
    StopRecorder recorder({folder_.path(), 5, 8.0}, {text, "<robot/>", "b: 2"}, {""});
    Verdict verdict;
    for (const bool stops : {false, true}) {
      verdict.stop = stops;
      verdict.reason = stops ? Reason::kCollision : Reason::kClear;
      verdict.reasons = {verdict.reason};
      verdict.stamp += std::chrono::seconds(100);
      recorder.fail(verdict.stamp, {}, verdict);
    }
    while (recorder.report().writer.defect.empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    const std::string defect = recorder.report().writer.defect;
    EXPECT_NE(defect.find("No space left on device"), std::string::npos) << defect;
  }
  EXPECT_EQ(openFiles(), open);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace tccm
