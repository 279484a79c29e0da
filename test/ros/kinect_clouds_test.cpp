/// Clouds of real depth cameras, from the file through reader and stage into the map.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "map/mapper.h"
#include "ros/cloud_reader.h"
#include "scan/cloud_stage.h"
#include "support/shared_data.h"
#include "tools/cloud_folder.h"

namespace tccm {
namespace {

constexpr std::uint32_t kTable = 1, kFirstObject = 20;

/// Nothing where there is no such file.
std::optional<sensor_msgs::PointCloud2> cloudOf(const std::string& name) {
  const std::string path = test::sharedDataFolder() + "/clouds/" + name;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return readPcd(path).message;
}

/// What a cuboid occupies.
UprightBox boxOf(const CuboidMap& map, const Cuboid& cuboid) { return map.box(cuboid); }

double distanceTo(const UprightBox& box, const Vector3& p) { return box.exteriorDistance(p); }

/// A recorded frame, with the table's plane at z = 0.8 m of the fixed frame.
class Frame {
 public:
  explicit Frame(const sensor_msgs::PointCloud2& message) {
    EXPECT_EQ(CloudReader(CloudLimits()).read(message, cloud_), "");
    for (const auto& field : message.fields) {
      if (field.name != "label") continue;
      for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
        std::uint32_t label;
        std::memcpy(&label, &message.data[i * message.point_step + field.offset], 4);
        labels_.push_back(label);
      }
    }
    cloud_.stamp = Time(fromSeconds(10.0));
    placeTable();
  }

  [[nodiscard]] const Cloud& cloud() const { return cloud_; }
  [[nodiscard]] const Pose& sensorPose() const { return T_fixed_sensor_; }
  /// The measured points of each object, in the fixed frame.
  [[nodiscard]] std::map<std::uint32_t, std::vector<Vector3>> objects() const {
    std::map<std::uint32_t, std::vector<Vector3>> objects;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
      if (labels_[i] < kFirstObject || !isMeasured(cloud_.points[i])) continue;
      objects[labels_[i]].push_back(T_fixed_sensor_ * cloud_.points[i].cast<double>());
    }
    return objects;
  }
  [[nodiscard]] std::vector<Vector3> points() const {
    std::vector<Vector3> points;
    for (const Eigen::Vector3f& p : cloud_.points) {
      if (isMeasured(p)) points.push_back(T_fixed_sensor_ * p.cast<double>());
    }
    return points;
  }

 private:
  /// The plane of least squares through what is labelled as the table; without labels the camera
  /// is taken to look level.
  void placeTable() {
    Vector3 mean = Vector3::Zero();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    double count = 0.0;
    std::vector<Vector3> table;
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      if (labels_[i] != kTable || !isMeasured(cloud_.points[i])) continue;
      table.push_back(cloud_.points[i].cast<double>());
      mean += table.back();
      count += 1.0;
    }
    if (count > 0.0) mean /= count;
    for (const Vector3& p : table) spread += (p - mean) * (p - mean).transpose();
    Vector3 up(0.0, -1.0, 0.0);
    if (count > 0.0) {
      up = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
    }
    if (up.y() > 0.0) up = -up;
    const Vector3 ahead = (Vector3::UnitZ() - up.z() * up).normalized();
    Eigen::Matrix3d R_fixed_sensor;
    R_fixed_sensor << ahead.transpose(), up.cross(ahead).transpose(), up.transpose();
    T_fixed_sensor_.linear() = R_fixed_sensor;
    T_fixed_sensor_.translation() = Vector3(0.0, 0.0, 0.8 - (R_fixed_sensor * mean).z());
  }

  Cloud cloud_;
  std::vector<std::uint32_t> labels_;
  Pose T_fixed_sensor_ = Pose::Identity();
};

/// Five equal frames in a window.
CuboidMap mapOf(const Frame& frame, CloudStage& stage) {
  Mapper::Config config;
  config.window_s = 0.1;
  config.looks.pass_gap_s = 0.001;
  config.map.returns_max = 2000000;
  config.map.grid.size_x_m = 4.0;
  config.map.grid.size_y_m = 4.0;
  config.map.grid.origin_y_m = -2.0;
  config.map.grid.height_min_m = -1.0;
  config.map.grid.height_max_m = 3.0;
  Mapper mapper(config);
  PosePath path;
  path.add(Time(fromSeconds(9.0)), frame.sensorPose());
  path.add(Time(fromSeconds(12.0)), frame.sensorPose());
  Cloud cloud = frame.cloud();
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(stage.assemble(cloud, path, {}), "");
    EXPECT_EQ(mapper.add(stage.returns()).dropped, "");
    cloud.stamp += std::chrono::milliseconds(33);
  }
  CuboidMap map;
  mapper.reserve(map);
  mapper.snapshot(map);
  EXPECT_TRUE(map.complete);
  EXPECT_FALSE(map.overflowed);
  return map;
}

CloudStage::Config kinect() {
  CloudStage::Config config;
  config.self_filter = false;
  return config;
}

/// Cuboids by their cells, to ask for those around a place.
class Cuboids {
 public:
  explicit Cuboids(const CuboidMap& map) {
    for (const Cuboid& cuboid : map.cuboids) {
      const UprightBox box = boxOf(map, cuboid);
      boxes_[key(box.center())].push_back(box);
    }
  }
  [[nodiscard]] double distanceOf(const Vector3& p) const {
    double nearest = 1.0;
    const auto [x, y] = key(p);
    for (long i = -3; i <= 3; ++i) {
      for (long k = -3; k <= 3; ++k) {
        const auto found = boxes_.find({x + i, y + k});
        if (found == boxes_.end()) continue;
        for (const UprightBox& box : found->second) nearest = std::min(nearest, distanceTo(box, p));
      }
    }
    return nearest;
  }

 private:
  static std::pair<long, long> key(const Vector3& p) {
    return {std::lround(std::floor(p.x() / 0.02)), std::lround(std::floor(p.y() / 0.02))};
  }
  std::map<std::pair<long, long>, std::vector<UprightBox>> boxes_;
};

/// Points by voxels of 50 mm, to ask whether one lies within 50 mm of a box.
class Points {
 public:
  explicit Points(const std::vector<Vector3>& points) {
    for (const Vector3& p : points) voxels_[key(p)].push_back(p);
  }
  [[nodiscard]] bool anyNear(const UprightBox& box) const {
    const auto low = key(box.min() - Vector3::Constant(0.05));
    const auto high = key(box.max() + Vector3::Constant(0.05));
    for (int x = low[0]; x <= high[0]; ++x) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int z = low[2]; z <= high[2]; ++z) {
          const auto found = voxels_.find({x, y, z});
          if (found == voxels_.end()) continue;
          for (const Vector3& p : found->second) {
            if (distanceTo(box, p) <= 0.05) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  static std::array<int, 3> key(const Vector3& p) {
    std::array<int, 3> key;
    for (std::size_t k = 0; k < 3; ++k) {
      key[k] = static_cast<int>(std::floor(p[static_cast<int>(k)] / 0.05));
    }
    return key;
  }
  std::map<std::array<int, 3>, std::vector<Vector3>> voxels_;
};

void expectNothingElse(const Frame& frame, const CuboidMap& map) {
  const Points points(frame.points());
  std::size_t alone = 0;
  for (const Cuboid& cuboid : map.cuboids) alone += points.anyNear(boxOf(map, cuboid)) ? 0 : 1;
  EXPECT_EQ(alone, 0U);
}

TEST(KinectCloudsTest, EachObjectOnATableHasCuboidsWhereItIsAndNoneStandsElsewhere) {
  for (const char* name : {"learn3", "learn17", "learn25", "learn33"}) {
    const auto message = cloudOf(std::string("kinect_tabletop/") + name + ".pcd");
    if (!message) GTEST_SKIP() << "no recorded clouds in " << test::sharedDataFolder();
    const Frame frame(*message);
    CloudStage stage(kinect(), nullptr);
    const CuboidMap map = mapOf(frame, stage);
    const Cuboids cuboids(map);
    std::size_t judged = 0;
    double least = 1.0;
    for (const auto& [label, points] : frame.objects()) {
      if (points.size() <= 300) continue;
      ++judged;
      const auto near = std::count_if(points.begin(), points.end(), [&](const Vector3& p) {
        return cuboids.distanceOf(p) <= 0.03;
      });
      const double share = static_cast<double>(near) / static_cast<double>(points.size());
      least = std::min(least, share);
      EXPECT_GE(share, 0.95) << name << " label " << label << ", " << points.size() << " points";
    }
    expectNothingElse(frame, map);
    EXPECT_GE(judged, 1U) << name;
    const auto removed = stage.counts()[static_cast<std::size_t>(BeamKind::kMixedPixel)];
    std::printf("%s: %zu objects, least share %.4f, %zu cuboids, %zu points removed of %zu\n", name,
                judged, least, map.cuboids.size(), removed, frame.points().size());
    EXPECT_LE(static_cast<double>(removed), 0.02 * static_cast<double>(frame.points().size()));
  }
}

TEST(KinectCloudsTest, NothingStandsInTheAirOfAnOffice) {
  for (const char* name : {"kinect_office/capture0001", "kinect_office/capture0002",
                           "pr2_stereo/table_scene_mug_stereo_textured"}) {
    const auto message = cloudOf(std::string(name) + ".pcd");
    if (!message) GTEST_SKIP() << "no recorded clouds in " << test::sharedDataFolder();
    const Frame frame(*message);
    CloudStage stage(kinect(), nullptr);
    const CuboidMap map = mapOf(frame, stage);
    EXPECT_GT(map.cuboids.size(), 100U);
    expectNothingElse(frame, map);
  }
}

}  // namespace
}  // namespace tccm
