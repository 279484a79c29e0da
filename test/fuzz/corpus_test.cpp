/// Inputs that fuzzing found, replayed: those that broke a promise once, and those that together
/// reach most of the code.

#include <gtest/gtest.h>

#include "fuzz/attached_objects_input.h"
#include "fuzz/clouds_input.h"
#include "fuzz/config_input.h"
#include "fuzz/corpus_replay.h"
#include "fuzz/joint_states_input.h"
#include "fuzz/maps_input.h"
#include "fuzz/mesh_input.h"
#include "fuzz/primitives_input.h"
#include "fuzz/robot_model_input.h"
#include "fuzz/scans_input.h"
#include "fuzz/trajectories_input.h"

namespace tccm {
namespace {

using test::replay;

TEST(CorpusTest, RobotDescriptionsAreTakenOrRefusedInOneLine) {
  EXPECT_GT(replay("robot_model", test::robotModelDefect), 50U);
}

TEST(CorpusTest, MeshFilesAreTakenOrRefusedInOneLine) {
  EXPECT_GT(replay("mesh", test::meshDefect), 20U);
}

TEST(CorpusTest, FilesOfPrimitivesAreTakenOrRefusedInOneLine) {
  EXPECT_GT(replay("primitives", test::primitivesDefect), 20U);
}

TEST(CorpusTest, ConfigurationsAreReadBackAsTheyWereOrRefusedInOneLine) {
  EXPECT_GT(replay("config", test::configDefect), 50U);
}

TEST(CorpusTest, AMapIsTheUnionOfItsScans) { EXPECT_GT(replay("scans", test::scansDefect), 10U); }

TEST(CorpusTest, AMapIsTheUnionOfItsClouds) { EXPECT_GT(replay("clouds", test::cloudsDefect), 5U); }

TEST(CorpusTest, MoreObstaclesAreNeverJudgedMilder) {
  EXPECT_GT(replay("maps", test::mapsDefect), 30U);
}

TEST(CorpusTest, JointsOfWhichNobodySpeaksAreNotKnown) {
  EXPECT_GT(replay("joint_states", test::jointStatesDefect), 40U);
}

TEST(CorpusTest, TrajectoriesAreJudgedAsTheyAreFollowed) {
  EXPECT_GT(replay("trajectories", test::trajectoriesDefect), 40U);
}

TEST(CorpusTest, WhatIsAttachedCounts) {
  EXPECT_GT(replay("attached_objects", test::attachedObjectsDefect), 30U);
}

TEST(CorpusTest, AMessageOfTwoLinesWouldBeFound) {
  EXPECT_EQ(test::brokenPromise([] { throw ConfigError("one line"); }), "");
  EXPECT_NE(test::brokenPromise([] { throw ConfigError("two\nlines"); }), "");
  EXPECT_NE(test::brokenPromise([] { throw ConfigError(""); }), "");
  EXPECT_NE(test::brokenPromise([] { throw std::runtime_error("another"); }), "");
}

}  // namespace
}  // namespace tccm
