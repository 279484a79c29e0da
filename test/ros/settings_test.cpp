#include "ros/settings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "support/error_of.h"

namespace tccm {
namespace {

const std::string kSource = TCCM_SOURCE_DIR;

using test::errorOf;

template <auto read>
std::string errorReading(const std::string& yaml) {
  return errorOf([&] {
    Parameters parameters(YAML::Load(yaml), "a_nodelet");
    (void)read(parameters);
  });
}

/// A YAML file that is gone afterwards.
class File {
 public:
  explicit File(const std::string& text) : path_(::testing::TempDir() + "settings_test.yaml") {
    std::ofstream(path_) << text;
  }
  ~File() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(SettingsTest, EveryShippedConfigurationLoads) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kSource + "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    EXPECT_EQ(errorOf([&] { (void)readMonitorSettings(entry.path().string()); }), "")
        << entry.path();
  }
  EXPECT_GE(files, 5U);
}

/// The keys of each section of config/default.yaml, which lists them all.
std::map<std::string, YAML::Node> defaultFile() {
  std::map<std::string, YAML::Node> sections;
  for (const auto& section : YAML::LoadFile(kSource + "/config/default.yaml")) {
    sections[section.first.as<std::string>()] = section.second;
  }
  return sections;
}

template <typename Settings>
std::vector<std::string> unreadKeys(Settings (*read)(Parameters&), const std::string& section) {
  Parameters parameters(defaultFile().at(section), section);
  (void)read(parameters);
  return parameters.unknownKeys();
}

TEST(SettingsTest, TheDefaultFileHoldsTheDefaults) {
  // Each value, changed by itself to its default, changes nothing: compared through the emitter.
  const MonitorSettings file = readMonitorSettings(kSource + "/config/default.yaml");
  const MonitorSettings none = readMonitorSettings("");
  EXPECT_EQ(file.assembler.fixed_frame, none.assembler.fixed_frame);
  EXPECT_EQ(file.assembler.self_filter, none.assembler.self_filter);
  EXPECT_EQ(file.assembler.assembler.scan_beams_max, none.assembler.assembler.scan_beams_max);
  EXPECT_EQ(file.assembler.assembler.mixed_pixel.separation_m,
            none.assembler.assembler.mixed_pixel.separation_m);
  EXPECT_EQ(file.robot.text(), none.robot.text());
  EXPECT_EQ(file.assembler.body.filtered.expansion.scale,
            none.assembler.body.filtered.expansion.scale);
  EXPECT_EQ(file.assembler.body.filtered.expansion.padding_m,
            none.assembler.body.filtered.expansion.padding_m);
  EXPECT_EQ(file.assembler.body.attached_padding_m, none.assembler.body.attached_padding_m);
  EXPECT_EQ(file.assembler.body.lateness_s, none.assembler.body.lateness_s);
  EXPECT_EQ(file.assembler.assembler.body.range_tolerance_m,
            none.assembler.assembler.body.range_tolerance_m);
  EXPECT_EQ(file.assembler.assembler.body.grazing_m, none.assembler.assembler.body.grazing_m);
  EXPECT_EQ(file.assembler.assembler.body.shadow_depth_m,
            none.assembler.assembler.body.shadow_depth_m);
  EXPECT_EQ(file.assembler.transform_wait_max_s, none.assembler.transform_wait_max_s);
  EXPECT_TRUE(Grid(file.mapper.mapper.map.grid) == Grid(none.mapper.mapper.map.grid));
  EXPECT_EQ(file.mapper.mapper.map.thickness_m, none.mapper.mapper.map.thickness_m);
  EXPECT_EQ(file.mapper.mapper.map.scans_max, none.mapper.mapper.map.scans_max);
  EXPECT_EQ(file.mapper.mapper.map.returns_max, none.mapper.mapper.map.returns_max);
  EXPECT_EQ(file.mapper.mapper.map.intervals_max, none.mapper.mapper.map.intervals_max);
  EXPECT_EQ(file.mapper.mapper.window_tilt_periods, none.mapper.mapper.window_tilt_periods);
  EXPECT_EQ(file.mapper.mapper.tilt.hysteresis_rad, none.mapper.mapper.tilt.hysteresis_rad);
  EXPECT_EQ(file.mapper.mapper.scan_gap_max_s, none.mapper.mapper.scan_gap_max_s);
  const Checker::Config &a = file.checker.checker, &b = none.checker.checker;
  EXPECT_EQ(a.pose.collision_use.expansion.scale, b.pose.collision_use.expansion.scale);
  EXPECT_EQ(a.pose.collision_use.expansion.padding_m, b.pose.collision_use.expansion.padding_m);
  EXPECT_EQ(a.pose.occlusion_use.expansion.scale, b.pose.occlusion_use.expansion.scale);
  EXPECT_EQ(a.pose.occlusion_use.expansion.padding_m, b.pose.occlusion_use.expansion.padding_m);
  EXPECT_EQ(a.pose.collision.support_points, b.pose.collision.support_points);
  EXPECT_EQ(a.pose.collision.support_height_m, b.pose.collision.support_height_m);
  EXPECT_EQ(a.pose.occlusion.resolution_rad, b.pose.occlusion.resolution_rad);
  EXPECT_EQ(a.pose.occlusion.margin_m, b.pose.occlusion.margin_m);
  EXPECT_EQ(a.pose.occlusion.hidden_fraction, b.pose.occlusion.hidden_fraction);
  EXPECT_EQ(a.way.horizon_s, b.way.horizon_s);
  EXPECT_EQ(a.inputs.joint_timeout_s, b.inputs.joint_timeout_s);
  EXPECT_EQ(a.inputs.transform_timeout_s, b.inputs.transform_timeout_s);
  EXPECT_EQ(a.inputs.scan_timeout_periods, b.inputs.scan_timeout_periods);
  EXPECT_EQ(a.inputs.map_age_max_s, b.inputs.map_age_max_s);
  EXPECT_EQ(file.checker.publish_rate_hz, none.checker.publish_rate_hz);
}

TEST(SettingsTest, EveryKeyOfTheDefaultFileIsRead) {
  EXPECT_TRUE(unreadKeys(readRobotSettings, "monitored_robot").empty());
  EXPECT_TRUE(unreadKeys(readAssemblerSettings, "tilt_scan_assembler").empty());
  EXPECT_TRUE(unreadKeys(readMapperSettings, "tccm_mapper").empty());
  EXPECT_TRUE(unreadKeys(readCheckerSettings, "collision_checker").empty());
}

/// The keys in backquotes at the start of a table's rows that look like parameters.
std::set<std::string> documentedKeys(const std::string& readme) {
  std::set<std::string> keys;
  const std::regex row("^\\| *((?:`[a-z0-9_]+`[, ]*)+)\\|");
  const std::regex key("`([a-z0-9_]+)`");
  std::ifstream file(readme);
  std::smatch match;
  for (std::string line; std::getline(file, line);) {
    if (!std::regex_search(line, match, row)) continue;
    const std::string cell = match[1];
    for (std::sregex_iterator it(cell.begin(), cell.end(), key), end; it != end; ++it) {
      keys.insert((*it)[1]);
    }
  }
  return keys;
}

TEST(SettingsTest, EveryParameterIsInTheReadme) {
  const std::string readme = kSource + "/README.md";
  if (!std::filesystem::exists(readme)) GTEST_SKIP() << "there is no README.md";
  const std::set<std::string> documented = documentedKeys(readme);
  for (const auto& [name, section] : defaultFile()) {
    if (name == "topics") continue;
    for (const auto& entry : section) {
      EXPECT_EQ(documented.count(entry.first.as<std::string>()), 1U)
          << name << "/" << entry.first << " is missing";
    }
  }
}

TEST(SettingsTest, EveryParameterInTheReadmeExists) {
  const std::string readme = kSource + "/README.md";
  if (!std::filesystem::exists(readme)) GTEST_SKIP() << "there is no README.md";
  std::set<std::string> read{"time_jump_back_s"};
  for (const auto& [name, section] : defaultFile()) {
    for (const auto& entry : section) read.insert(entry.first.as<std::string>());
  }
  const std::regex with_unit(".*_(m|s|hz|rad|scans|periods|links|max|points|frame|fraction)");
  for (const std::string& key : documentedKeys(readme)) {
    if (!std::regex_match(key, with_unit)) continue;
    EXPECT_EQ(read.count(key), 1U) << key << " is read by nothing";
  }
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

/// By one of the nodelets.
using Reading = std::string (*)(const std::string& yaml);
class RefusalTest : public ::testing::TestWithParam<std::tuple<Reading, Refused>> {};

TEST_P(RefusalTest, NamesItsKey) {
  const auto& [errorReadingIt, refused] = GetParam();
  expectRefusal(errorReadingIt(lineOf(refused)), refused.key);
}

template <auto read, typename... Lines>
auto refusedBy(const Lines&... lines) {
  return ::testing::Combine(::testing::Values(&errorReading<read>), ::testing::Values(lines...));
}

INSTANTIATE_TEST_SUITE_P(
    Assembler, RefusalTest,
    refusedBy<readAssemblerSettings>(
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

INSTANTIATE_TEST_SUITE_P(Robot, RefusalTest,
                         refusedBy<readRobotSettings>(
                             Refused{"monitored_links", "{a: 8}"}, Refused{"link_groups", "[a, b]"},
                             Refused{"link_groups", "{arms: 7}"},
                             Refused{"fixed_joints", "{a: open}"}, Refused{"fixed_joints", "[a]"},
                             Refused{"apply_mesh_up_axis", "perhaps"},
                             Refused{"fit_primitives_max", "0"}, Refused{"fit_split_gain", "-1"}));

INSTANTIATE_TEST_SUITE_P(Mapper, RefusalTest,
                         refusedBy<readMapperSettings>(
                             Refused{"area_origin_x_m", ".nan"}, Refused{"area_origin_y_m", ".inf"},
                             Refused{"area_size_x_m", "0"}, Refused{"area_size_y_m", "-1"},
                             Refused{"height_min_m", ".nan"}, Refused{"height_max_m", "-1.0"},
                             Refused{"height_max_m", "100.0"}, Refused{"cell_size_m", "-1"},
                             Refused{"cell_size_m", "soon"}, Refused{"height_quantum_m", "0"},
                             Refused{"thickness_m", "0"}, Refused{"window_scans", "-1"},
                             Refused{"window_scans", "1000000"}, Refused{"window_s", "-0.1"},
                             Refused{"window_tilt_periods", "0.75"},
                             Refused{"window_scans_max", "0"}, Refused{"window_returns_max", "0"},
                             Refused{"intervals_max", "0"}, Refused{"tilt_hysteresis_rad", "0"},
                             Refused{"scan_gap_max_s", "0"}, Refused{"time_jump_back_s", "-1"},
                             Refused{"marker_rate_hz", "0"}, Refused{"static_windows", "0"}));

INSTANTIATE_TEST_SUITE_P(
    Checker, RefusalTest,
    refusedBy<readCheckerSettings>(
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

TEST(SettingsTest, TwoKindsOfWindowAreOneTooMany) {
  expectRefusal(errorReading<readMapperSettings>("{window_scans: 40, window_s: 1.0}"), "window_s");
}

TEST(MonitorSettingsTest, AWrongKeyOrSectionIsRefusedNamingIt) {
  const auto errorOfFile = [](const std::string& text) {
    const File file(text);
    return errorOf([&] { (void)readMonitorSettings(file.path()); });
  };
  expectRefusal(errorOfFile("collision_checker: {horizont_s: 1.0}"),
                "collision_checker/horizont_s");
  expectRefusal(errorOfFile("tccm_maper: {cell_size_m: 0.05}"), "tccm_maper");
  expectRefusal(errorOfFile("topics: {scans: /scan}"), "topics/scans");
  expectRefusal(errorOfFile("tccm_mapper: 7"), "tccm_mapper");
  EXPECT_NE(errorOfFile("tccm_mapper: {"), "");
}

TEST(MonitorSettingsTest, AFileThatIsNotThereIsRefusedNamingIt) {
  expectRefusal(errorOf([] { (void)readMonitorSettings("/no/such/file.yaml"); }),
                "/no/such/file.yaml");
}

TEST(MonitorSettingsTest, FixedFramesThatDifferAreRefused) {
  const File file("{tilt_scan_assembler: {fixed_frame: odom}}");
  expectRefusal(errorOf([&] { (void)readMonitorSettings(file.path()); }), "fixed_frame");
}

TEST(MonitorSettingsTest, TheCoreGetsWhatTheFileSays) {
  const File file(
      "topics: {scan: /tilt_scan}\n"
      "monitored_robot: {capsule_links: [a], monitored_links: [b], fixed_joints: {c: 0.5},"
      " link_groups: {d: [e]}}\n"
      "tilt_scan_assembler: {fixed_frame: odom, self_filter: false,"
      " self_filter_exceptions: [{links: [a], scale: 1.1}, {links: [b], padding_m: 0.1}]}\n"
      "tccm_mapper: {cell_size_m: 0.05, window_scans: 40}\n"
      "collision_checker: {fixed_frame: odom, horizon_s: 0.25, collision_links: [b]}\n");
  const MonitorSettings settings = readMonitorSettings(file.path());
  EXPECT_EQ(settings.scan_topic, "/tilt_scan");
  EXPECT_EQ(settings.joint_states_topic, "/joint_states");
  const Monitor::Config config = settings.monitorConfig();
  EXPECT_FALSE(config.self_filter);
  EXPECT_EQ(settings.robot.capsule_links, std::vector<std::string>{"a"});
  EXPECT_EQ(settings.robot.monitored_links, std::vector<std::string>{"b"});
  EXPECT_EQ(settings.robot.fixed_joints.at("c"), 0.5);
  EXPECT_EQ(settings.robot.link_groups.at("d"), std::vector<std::string>{"e"});
  EXPECT_EQ(config.checker.pose.collision_use.links, std::vector<std::string>{"b"});
  ASSERT_EQ(config.body.filtered.exceptions.size(), 2U);
  EXPECT_EQ(config.body.filtered.exceptions[0].scale, 1.1);
  EXPECT_FALSE(config.body.filtered.exceptions[0].padding_m);
  EXPECT_EQ(config.body.filtered.exceptions[1].padding_m, 0.1);
  EXPECT_EQ(config.mapper.map.grid.cell_size_m, 0.05);
  EXPECT_EQ(config.mapper.window_scans, 40);
  EXPECT_EQ(config.checker.way.horizon_s, 0.25);
  EXPECT_EQ(config.checker.inputs.fixed_frame, "odom");
}

}  // namespace
}  // namespace tccm
