/// Inputs that fuzzing found, replayed: those that broke a promise once, and those that together
/// reach most of the code.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/mesh_input.h"
#include "fuzz/primitives_input.h"
#include "fuzz/robot_model_input.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

using DefectOf = std::string (*)(const std::string& input);

/// @return how many inputs there are.
std::size_t replay(const std::string& corpus, DefectOf defectOf) {
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::directory_iterator(fs::path(TCCM_SOURCE_DIR) / "test/fuzz/corpus" / corpus)) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    const std::string input{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    EXPECT_EQ(defectOf(input), "") << corpus << "/" << path.filename().string();
  }
  return files.size();
}

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
