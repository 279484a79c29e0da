#include "monitor_config.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

const std::string kSource = TCCM_SOURCE_DIR;

std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

template <typename Config>
std::string errorOf(const std::string& yaml) {
  return errorOf([&] {
    Config config;
    load(YAML::Load(yaml), "a_nodelet", config);
  });
}

/// A YAML file that is gone afterwards.
class File {
 public:
  explicit File(const std::string& text)
      : path_(::testing::TempDir() + "monitor_config_test.yaml") {
    std::ofstream(path_) << text;
  }
  ~File() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(MonitorConfigTest, EveryShippedConfigurationLoads) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kSource + "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    EXPECT_EQ(errorOf([&] { (void)readMonitorConfig(entry.path().string()); }), "") << entry.path();
  }
  EXPECT_GE(files, 5U);
}

TEST(MonitorConfigTest, TheDefaultFileHoldsTheDefaultsOfEveryParameter) {
  MonitorConfig file = readMonitorConfig(kSource + "/config/default.yaml"), none;
  std::map<std::string, std::string> read, expected;
  const auto write = [](auto& values) {
    return [&values](const std::string& name, auto& section, const std::string&) {
      values[name] = tableOf(section).yaml();
    };
  };
  file.visitSections(write(read));
  none.visitSections(write(expected));
  EXPECT_EQ(read, expected);
}

/// A slip in the tables would read one parameter under two keys, or two under one.
TEST(MonitorConfigTest, NoKeyAndNoMemberStandsTwiceInASection) {
  MonitorConfig config;
  config.visitSections([](const std::string& name, auto& section, const std::string&) {
    const ParameterTable table = tableOf(section);
    std::set<std::string> keys;
    std::set<const void*> members;
    for (const auto& row : table.rows()) {
      EXPECT_TRUE(keys.insert(row.key).second) << name << "/" << row.key;
      const void* member =
          std::visit([](auto* m) { return static_cast<const void*>(m); }, row.member);
      EXPECT_TRUE(members.insert(member).second) << name << "/" << row.key;
      EXPECT_FALSE(row.meaning.empty()) << name << "/" << row.key;
    }
  });
}

struct Refused {
  const char* key;
  const char* value;
};

void PrintTo(const Refused& refused, std::ostream* out) {
  *out << refused.key << ": " << refused.value;
}

/// Each line names the key, and comes without line breaks.
void expectRefusal(const std::string& error, const std::string& key) {
  EXPECT_NE(error.find(key), std::string::npos) << "'" << error << "'";
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

std::string lineOf(const Refused& refused) {
  return std::string(refused.key) + ": " + refused.value;
}

class AssemblerRefusalTest : public ::testing::TestWithParam<Refused> {};
TEST_P(AssemblerRefusalTest, NamesItsKey) {
  expectRefusal(errorOf<AssemblerConfig>(lineOf(GetParam())), GetParam().key);
}
INSTANTIATE_TEST_SUITE_P(
    OutOfRange, AssemblerRefusalTest,
    ::testing::Values(
        Refused{"fixed_frame", "''"}, Refused{"fixed_frame", "/"}, Refused{"scan_beams_max", "0"},
        Refused{"mixed_pixel_separation_m", "-0.1"}, Refused{"self_filter_padding_m", "-0.1"},
        Refused{"self_filter_range_tolerance_m", "-0.1"},
        Refused{"self_filter_attached_padding_m", "-0.1"},
        Refused{"self_filter_lateness_s", "-0.1"}, Refused{"self_filter_grazing_m", "-0.1"},
        Refused{"self_filter_shadow_depth_m", ".nan"}, Refused{"body_sample_s", "0"},
        Refused{"joint_gap_max_s", "0"}, Refused{"joint_velocity_baseline_s", "-1"},
        Refused{"joint_samples_max", "0"}, Refused{"transform_gap_max_s", "0"},
        Refused{"transform_sample_s", "0"}, Refused{"transform_wait_max_s", ".inf"},
        Refused{"self_filter", "perhaps"}, Refused{"self_filter_links", "{a: 8}"},
        Refused{"self_filter_scale", "0.9"}, Refused{"self_filter_exceptions", "[{links: [a]}]"},
        Refused{"self_filter_exceptions", "[{padding_m: 0.1}]"},
        Refused{"self_filter_exceptions", "[{links: [a], padding_m: -0.1}]"},
        Refused{"self_filter_exceptions", "[{links: [a], pading_m: 0.1}]"},
        Refused{"self_filter_exceptions", "[7]"}));

class RobotRefusalTest : public ::testing::TestWithParam<Refused> {};
TEST_P(RobotRefusalTest, NamesItsKey) {
  expectRefusal(errorOf<RobotModel::Config>(lineOf(GetParam())), GetParam().key);
}
INSTANTIATE_TEST_SUITE_P(
    OutOfRange, RobotRefusalTest,
    ::testing::Values(Refused{"monitored_links", "{a: 8}"}, Refused{"link_groups", "[a, b]"},
                      Refused{"link_groups", "{arms: 7}"}, Refused{"fixed_joints", "{a: open}"},
                      Refused{"fixed_joints", "[a]"}, Refused{"apply_mesh_up_axis", "perhaps"},
                      Refused{"fit_primitives_max", "0"}, Refused{"fit_split_gain", "-1"}));

class MapperRefusalTest : public ::testing::TestWithParam<Refused> {};
TEST_P(MapperRefusalTest, NamesItsKey) {
  expectRefusal(errorOf<MapperConfig>(lineOf(GetParam())), GetParam().key);
}
INSTANTIATE_TEST_SUITE_P(
    OutOfRange, MapperRefusalTest,
    ::testing::Values(Refused{"area_origin_x_m", ".nan"}, Refused{"area_origin_y_m", ".inf"},
                      Refused{"area_size_x_m", "0"}, Refused{"area_size_y_m", "-1"},
                      Refused{"height_min_m", ".nan"}, Refused{"height_max_m", "-1.0"},
                      Refused{"height_max_m", "100.0"}, Refused{"cell_size_m", "-1"},
                      Refused{"cell_size_m", "soon"}, Refused{"height_quantum_m", "0"},
                      Refused{"thickness_m", "0"}, Refused{"window_scans", "-1"},
                      Refused{"window_scans", "1000000"}, Refused{"window_s", "-0.1"},
                      Refused{"window_tilt_periods", "0.75"}, Refused{"window_scans_max", "0"},
                      Refused{"window_returns_max", "0"}, Refused{"intervals_max", "0"},
                      Refused{"tilt_hysteresis_rad", "0"}, Refused{"scan_gap_max_s", "0"},
                      Refused{"time_jump_back_s", "-1"}, Refused{"marker_rate_hz", "0"},
                      Refused{"static_windows", "0"}));

class CheckerRefusalTest : public ::testing::TestWithParam<Refused> {};
TEST_P(CheckerRefusalTest, NamesItsKey) {
  expectRefusal(errorOf<CheckerConfig>(lineOf(GetParam())), GetParam().key);
}
INSTANTIATE_TEST_SUITE_P(
    OutOfRange, CheckerRefusalTest,
    ::testing::Values(
        Refused{"fixed_frame", "'//'"}, Refused{"primitive_scale", "0.5"},
        Refused{"collision_padding_m", "-0.01"}, Refused{"support_points", "0"},
        Refused{"support_height_m", "-0.1"}, Refused{"contacts_max", "0"},
        Refused{"occlusion_resolution_rad", "0"}, Refused{"occlusion_margin_m", "-0.1"},
        Refused{"occlusion_hidden_fraction", "0"}, Refused{"occlusion_hidden_fraction", "1.1"},
        Refused{"occlusion_silhouette_min_pixels", "-1"}, Refused{"horizon_s", "-0.1"},
        Refused{"horizon_s", "soon"}, Refused{"joint_timeout_s", "0"},
        Refused{"transform_timeout_s", "0"}, Refused{"scan_timeout_periods", "0.5"},
        Refused{"map_age_max_s", ".nan"}, Refused{"future_max_s", "-0.1"},
        Refused{"release_s", "-1"}, Refused{"attach_forget_padding_m", "-0.1"},
        Refused{"attach_forget_s", ".nan"}, Refused{"occlusion_scale", "0.5"},
        Refused{"occlusion_padding_m", "-0.1"}, Refused{"collision_exceptions", "{a: 1}"},
        Refused{"publish_rate_hz", "0"}, Refused{"marker_rate_hz", "-5"}));

TEST(MonitorConfigTest, TwoKindsOfWindowAreOneTooMany) {
  expectRefusal(errorOf<MapperConfig>("{window_scans: 40, window_s: 1.0}"), "window_s");
}

TEST(MonitorConfigTest, AWrongKeyOrSectionIsRefusedNamingIt) {
  const auto errorOfFile = [](const std::string& text) {
    const File file(text);
    return errorOf([&] { (void)readMonitorConfig(file.path()); });
  };
  expectRefusal(errorOfFile("collision_checker: {horizont_s: 1.0}"),
                "collision_checker/horizont_s");
  expectRefusal(errorOfFile("tccm_maper: {cell_size_m: 0.05}"), "tccm_maper");
  expectRefusal(errorOfFile("topics: {scans: /scan}"), "topics/scans");
  expectRefusal(errorOfFile("tccm_mapper: 7"), "tccm_mapper");
  EXPECT_NE(errorOfFile("tccm_mapper: {"), "");
}

TEST(MonitorConfigTest, AFileThatIsNotThereIsRefusedNamingIt) {
  expectRefusal(errorOf([] { (void)readMonitorConfig("/no/such/file.yaml"); }),
                "/no/such/file.yaml");
}

TEST(MonitorConfigTest, FixedFramesThatDifferAreRefused) {
  const File file("{tilt_scan_assembler: {fixed_frame: odom}}");
  expectRefusal(errorOf([&] { (void)readMonitorConfig(file.path()); }), "fixed_frame");
}

TEST(MonitorConfigTest, TheCoreGetsWhatTheFileSays) {
  const File file(
      "topics: {scan: /tilt_scan}\n"
      "monitored_robot: {capsule_links: [a], monitored_links: [b], fixed_joints: {c: 0.5},"
      " link_groups: {d: [e]}}\n"
      "tilt_scan_assembler: {fixed_frame: odom, self_filter: false,"
      " self_filter_exceptions: [{links: [a], scale: 1.1}, {links: [b], padding_m: 0.1}]}\n"
      "tccm_mapper: {cell_size_m: 0.05, window_scans: 40}\n"
      "collision_checker: {fixed_frame: odom, horizon_s: 0.25, collision_links: [b]}\n");
  const MonitorConfig settings = readMonitorConfig(file.path());
  EXPECT_EQ(settings.topics.scan, "/tilt_scan");
  EXPECT_EQ(settings.topics.joint_states, "/joint_states");
  const Monitor::Config config = settings.monitor();
  EXPECT_FALSE(config.sensors.front().scan.self_filter);
  EXPECT_EQ(settings.robot.capsule_links, std::vector<std::string>{"a"});
  EXPECT_EQ(settings.robot.monitored_links, std::vector<std::string>{"b"});
  EXPECT_EQ(settings.robot.fixed_joints.at("c"), 0.5);
  EXPECT_EQ(settings.robot.link_groups.at("d"), std::vector<std::string>{"e"});
  EXPECT_EQ(config.checker.pose.collision_use.links, std::vector<std::string>{"b"});
  ASSERT_EQ(config.sensors.front().scan.body.filtered.exceptions.size(), 2U);
  EXPECT_EQ(config.sensors.front().scan.body.filtered.exceptions[0].scale, 1.1);
  EXPECT_FALSE(config.sensors.front().scan.body.filtered.exceptions[0].padding_m);
  EXPECT_EQ(config.sensors.front().scan.body.filtered.exceptions[1].padding_m, 0.1);
  EXPECT_EQ(config.sensors.front().mapper.map.grid.cell_size_m, 0.05);
  EXPECT_EQ(config.sensors.front().mapper.window_scans, 40);
  EXPECT_EQ(config.checker.way.horizon_s, 0.25);
  EXPECT_EQ(config.checker.inputs.fixed_frame, "odom");
}

}  // namespace
}  // namespace tccm
