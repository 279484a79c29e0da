#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace tccm::test {

/// Hands each input of a corpus to what its fuzz target does with it.
/// @return how many inputs there are.
inline std::size_t replay(const std::string& corpus,
                          std::string (*defectOf)(const std::string& input)) {
  namespace fs = std::filesystem;
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

}  // namespace tccm::test
