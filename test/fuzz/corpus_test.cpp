/// Inputs that fuzzing found, replayed: those that broke a promise once, and those that together
/// reach most of the code.

#include <gtest/gtest.h>

#include "fuzz/corpus_replay.h"
#include "fuzz/mesh_input.h"
#include "fuzz/primitives_input.h"
#include "fuzz/robot_model_input.h"

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

TEST(CorpusTest, AMessageOfTwoLinesWouldBeFound) {
  EXPECT_EQ(test::brokenPromise([] { throw ConfigError("one line"); }), "");
  EXPECT_NE(test::brokenPromise([] { throw ConfigError("two\nlines"); }), "");
  EXPECT_NE(test::brokenPromise([] { throw ConfigError(""); }), "");
  EXPECT_NE(test::brokenPromise([] { throw std::runtime_error("another"); }), "");
}

}  // namespace
}  // namespace tccm
