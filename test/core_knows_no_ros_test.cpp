/// The core builds and runs without ROS: none of its files includes a header of it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace tccm {
namespace {

namespace fs = std::filesystem;

const std::regex kForeignInclude(
    R"(^\s*#\s*include\s*[<"](ros|rosbag|rosgraph|nodelet|pluginlib|tf|tf2|tf2_\w+|pcl|pcl_\w+|)"
    R"(\w+_msgs|std_srvs|diagnostic_updater|dynamic_reconfigure|message_filters|)"
    R"(nodelets|rviz|tccm_monitor/[A-Z]\w*\.h|simulation|experiments|tools)[/">.])");

bool isForeign(const std::string& line) { return std::regex_search(line + "/", kForeignInclude); }

/// Checks every file below a folder but those in ros/, nodelets/ and rviz/. @return how many.
int expectNoForeignInclude(const fs::path& folder) {
  int files = 0;
  for (auto entry = fs::recursive_directory_iterator(folder);
       entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = entry->path().filename();
    if (entry->is_directory() && (name == "ros" || name == "nodelets" || name == "rviz")) {
      entry.disable_recursion_pending();
      continue;
    }
    const std::string extension = entry->path().extension();
    if (extension != ".h" && extension != ".cpp") continue;
    ++files;
    std::ifstream file(entry->path());
    for (std::string line; std::getline(file, line);) {
      EXPECT_FALSE(isForeign(line)) << entry->path() << ": " << line;
    }
  }
  return files;
}

TEST(CoreKnowsNoRosTest, NoHeaderOfTheCoreIncludesRos) {
  EXPECT_GT(expectNoForeignInclude(fs::path(TCCM_SOURCE_DIR) / "include" / "tccm_monitor"), 3);
}

TEST(CoreKnowsNoRosTest, NoSourceOfTheCoreIncludesRos) {
  EXPECT_GT(expectNoForeignInclude(fs::path(TCCM_SOURCE_DIR) / "src"), 10);
}

TEST(CoreKnowsNoRosTest, ForeignIncludesWouldBeFound) {
  for (const char* line :
       {"#include <ros/ros.h>", "#include <sensor_msgs/LaserScan.h>", " # include <tf2/time.h>",
        "#include <tf2_ros/buffer.h>", "#include \"pcl_conversions/pcl_conversions.h\"",
        "#include <tccm_monitor/CuboidMap.h>", "#include \"ros/conversions.h\"",
        "#include \"nodelets/markers.h\"", "#include \"simulation/world.h\""}) {
    EXPECT_TRUE(isForeign(line)) << line;
  }
  for (const char* line : {"#include <vector>", "#include \"map/cuboid_map.h\"",
                           "#include <urdf_parser/urdf_parser.h>", "#include <Eigen/Geometry>"}) {
    EXPECT_FALSE(isForeign(line)) << line;
  }
}

}  // namespace
}  // namespace tccm
