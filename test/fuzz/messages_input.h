#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "fuzz/fuzzed_checker.h"
#include "fuzz/mapped_union.h"
#include "ros/cloud_reader.h"
#include "ros/cloud_scan.h"
#include "ros/conversions.h"
#include "scan/scan_assembler.h"

/// What the fuzz target of messages and the test of its corpus do with an input: a byte that
/// chooses the kind of message, and its fields.
namespace tccm::test {

/// Small, near to what is usual, or anything.
inline std::uint32_t fuzzedSize(ByteReader& bytes, std::uint32_t usual) {
  const std::uint8_t kind = bytes.byte();
  if (kind < 0xd0U) return usual;
  if (kind < 0xe0U) return kind & 0xfU;
  if (kind < 0xf0U) return usual + (kind & 0xfU) - 8U;
  return static_cast<std::uint32_t>(bytes.bits(4));
}

inline ros::Time fuzzedStamp(ByteReader& bytes) {
  return bytes.seldom() ? ros::Time(static_cast<std::uint32_t>(bytes.bits(4)), 999999999U)
                        : ros::Time(100, static_cast<std::uint32_t>(bytes.bits(3)));
}

inline void runLaserScan(ByteReader& bytes) {
  sensor_msgs::LaserScan message;
  message.header.stamp = fuzzedStamp(bytes);
  message.angle_min = static_cast<float>(bytes.number(-1.0, 0.0));
  message.angle_increment = static_cast<float>(bytes.number(0.01, 0.2));
  message.time_increment = static_cast<float>(bytes.number(0.0, 1e-3));
  message.range_min = static_cast<float>(bytes.number(0.0, 0.1));
  message.range_max = static_cast<float>(bytes.number(1.0, 10.0));
  for (std::size_t i = bytes.count(20); i > 0; --i) {
    message.ranges.push_back(static_cast<float>(bytes.number(0.1, 5.0)));
  }
  message.angle_max =
      message.angle_min + static_cast<float>(message.ranges.size()) * message.angle_increment;
  if (bytes.seldom()) message.angle_max = static_cast<float>(bytes.number(-3.0, 3.0));
  LaserScan scan;
  fromMessage(message, scan);
  promise(scan.ranges.size() == message.ranges.size(), "a beam gets lost");
  const std::string defect = defectOf(scan, 18);
  if (!defect.empty()) return requireOneLine(defect);
  promise(scan.lastBeamTime() - scan.stamp <= std::chrono::seconds(1), "a scan is too long");
  PosePath path;
  path.add(scan.stamp, Pose::Identity());
  path.add(scan.stamp + std::chrono::seconds(2), Pose::Identity());
  AssembledScan assembled;
  const std::string dropped = ScanAssembler().assemble(scan, path, {}, assembled);
  promise(dropped.empty() || dropped == "blind", "it is dropped as '" + dropped + "'");
  if (!dropped.empty()) return;
  ScanReturns returns;
  returns.viewpoint.setConstant(NAN);
  sensor_msgs::PointCloud2 cloud;
  toMessage(assembled, "map", cloud);
  const std::string refused = fromMessage(cloud, returns);
  promise(refused.empty(), "what was written is refused: " + refused);
  const BeamCounts counts = assembled.counts();
  promise(returns.points.size() == counts[static_cast<std::size_t>(BeamKind::kReturn)],
          "a return gets lost on its way");
  promise(returns.looks.size() == assembled.beams.size(), "a look gets lost on its way");
}

/// Of names that are understood, and of others.
inline sensor_msgs::PointField fuzzedField(ByteReader& bytes, std::uint32_t offset) {
  sensor_msgs::PointField field;
  field.name = bytes.oneOf<const char*>({"x", "y", "z", "t", "time", "timestamp", "intensity",
                                         "offset_time", "stamp\n", "vp_x", "kind", ""});
  field.offset = fuzzedSize(bytes, offset);
  field.datatype = bytes.oneOf<std::uint8_t>({7, 8, 6, 2, 0, 255});
  field.count = fuzzedSize(bytes, 1);
  return field;
}

inline sensor_msgs::PointCloud2 fuzzedCloudMessage(ByteReader& bytes) {
  sensor_msgs::PointCloud2 message;
  message.header.stamp = fuzzedStamp(bytes);
  const std::uint8_t kind = bytes.byte();
  std::uint32_t offset = 0;
  for (const char* const name : {"x", "y", "z"}) {
    message.fields.emplace_back();
    message.fields.back().name = name;
    message.fields.back().offset = offset;
    message.fields.back().datatype = (kind & 1U) != 0 ? 8 : 7;
    message.fields.back().count = 1;
    offset += (kind & 1U) != 0 ? 8 : 4;
  }
  for (unsigned i = kind >> 1U & 3U; i > 0; --i, offset += 8) {
    message.fields.push_back(fuzzedField(bytes, offset));
  }
  if (bytes.seldom()) message.fields.erase(message.fields.begin());
  message.point_step = fuzzedSize(bytes, offset);
  message.width = fuzzedSize(bytes, 1U + (kind >> 3U & 7U));
  message.height = fuzzedSize(bytes, 1U + (kind >> 6U & 3U));
  const std::uint64_t row = std::uint64_t{message.width} * message.point_step;
  message.row_step = fuzzedSize(bytes, static_cast<std::uint32_t>(row));
  message.is_bigendian = bytes.seldom();
  const std::uint64_t size = std::min<std::uint64_t>(row * message.height, 4096);
  const std::string data = bytes.text(fuzzedSize(bytes, static_cast<std::uint32_t>(size)));
  message.data.assign(data.begin(), data.end());
  if (!bytes.seldom()) message.data.resize(size);
  message.data.shrink_to_fit();
  return message;
}

inline void runCloud(ByteReader& bytes) {
  const sensor_msgs::PointCloud2 message = fuzzedCloudMessage(bytes);
  CloudLimits limits;
  limits.points_max = 500;
  Cloud cloud;
  const std::string defect = CloudReader(limits).read(message, cloud);
  if (!defect.empty()) return requireOneLine(defect);
  promise(cloud.points.size() == std::size_t{message.width} * message.height, "a point is lost");
  promise(cloud.points.size() <= limits.points_max, "there are more points than may be");
  promise(cloud.offsets_s.empty() || cloud.offsets_s.size() == cloud.points.size(),
          "a point has no time");
  promise(cloud.last() >= cloud.first() &&
              toSeconds(cloud.last() - cloud.first()) <= limits.duration_max_s + 1e-5,
          "a cloud takes longer than it may");
  for (std::size_t i = 0; i < cloud.offsets_s.size(); ++i) {
    const auto offset = static_cast<double>(cloud.offsets_s[i]);
    promise(!isMeasured(cloud.points[i]) ||
                (offset >= cloud.first_offset_s && offset <= cloud.last_offset_s),
            "a point's time lies beyond its cloud's");
  }
}

/// A scan_cloud with some of its bytes changed.
inline void runScanCloud(ByteReader& bytes) {
  AssembledScan scan;
  scan.stamp = Time(std::chrono::seconds(100));
  for (std::size_t i = bytes.count(8); i > 0; --i) {
    Beam beam;
    beam.p_fixed = {bytes.number(-1.0, 1.0), bytes.number(-1.0, 1.0), bytes.number(0.0, 1.0)};
    beam.viewpoint = {bytes.number(-1.0, 1.0), 0.0, 1.0};
    beam.tilt = bytes.number(-1.0, 1.0);
    beam.kind = static_cast<BeamKind>(bytes.count(7));
    scan.beams.push_back(beam);
  }
  sensor_msgs::PointCloud2 message;
  toMessage(scan, "map", message);
  message.width = fuzzedSize(bytes, message.width);
  message.height = fuzzedSize(bytes, message.height);
  message.point_step = fuzzedSize(bytes, message.point_step);
  for (std::size_t i = bytes.count(4); i > 0; --i) {
    if (!message.data.empty()) message.data[bytes.count(message.data.size() - 1)] = bytes.byte();
    message.fields[bytes.count(message.fields.size() - 1)].offset = fuzzedSize(bytes, 0);
  }
  ScanReturns returns;
  const std::string defect = fromMessage(message, returns);
  if (!defect.empty()) return requireOneLine(defect);
  for (const Vector3& point : returns.points) promise(point.allFinite(), "a point is not finite");
  for (const Look& look : returns.looks) {
    promise(look.end.allFinite() && look.viewpoint.allFinite(), "a look is not finite");
  }
  Mapper::Config config = smallMapper();
  Mapper mapper(config);
  MappedUnion expected(config);
  expected.follow(returns, mapper.add(returns), mapper);
}

inline void runCloudScan(ByteReader& bytes) {
  ScanReturns written;
  written.stamp = Time(std::chrono::seconds(100));
  written.viewpoint = {bytes.number(-1.0, 1.0), 0.0, 1.0};
  for (std::size_t i = bytes.count(8); i > 0; --i) {
    const Vector3 point(bytes.number(-1.0, 1.0), bytes.number(-1.0, 1.0), bytes.number(0.0, 1.0));
    written.points.push_back(point);
    written.looks.push_back({written.viewpoint, point, static_cast<Seen>(1 + bytes.count(3))});
  }
  tccm_monitor::CloudScan message;
  toMessage(written, "map", message);
  const std::size_t shorter = bytes.seldom() ? bytes.count(12) : 0;
  message.points.resize(message.points.size() - std::min(shorter, message.points.size()));
  ScanReturns read;
  const std::string defect = fromMessage(message, read);
  if (!defect.empty()) return requireOneLine(defect);
  for (const Vector3& point : read.points) promise(point.allFinite(), "a point is not finite");
  for (const Look& look : read.looks) {
    promise(look.end.allFinite() && look.viewpoint.allFinite(), "a look is not finite");
  }
}

inline void fuzzHead(ByteReader& bytes, tccm_monitor::CuboidMap& message) {
  for (double* number :
       {&message.origin_x, &message.origin_y, &message.cell_size, &message.height_min,
        &message.height_max, &message.height_quantum, &message.thickness, &message.viewpoint.x,
        &message.looks.resolution, &message.looks.viewpoint.z}) {
    if (bytes.seldom()) *number = bytes.number(0.01, 1.0);
  }
  message.cells_x = fuzzedSize(bytes, message.cells_x);
  message.cells_y = fuzzedSize(bytes, message.cells_y);
  message.header.stamp = fuzzedStamp(bytes);
  if (bytes.seldom()) message.self_share = static_cast<float>(bytes.number(0.0, 1.0));
  if (bytes.seldom()) message.look_period.sec = static_cast<std::int32_t>(bytes.bits(4));
  if (bytes.seldom()) message.window.sec = static_cast<std::int32_t>(bytes.bits(4));
  if (bytes.seldom()) message.hold.nsec = static_cast<std::int32_t>(bytes.bits(4));
  if (bytes.seldom()) message.looks.row_begin = fuzzedSize(bytes, 1);
  if (bytes.seldom()) message.looks.end.resize(bytes.count(400));
  if (bytes.seldom() && !message.looks.end.empty()) message.looks.end.back() = bytes.byte();
}

inline void runCuboidMap(ByteReader& bytes) {
  CuboidMap map = fuzzedMap();
  addCuboids(bytes, 5, map);
  tccm_monitor::CuboidMap message;
  toMessage(map, "map", message);
  fuzzHead(bytes, message);
  for (std::size_t i = bytes.count(3); i > 0 && !message.cuboids.empty(); --i) {
    tccm_monitor::Cuboid& cuboid = message.cuboids[bytes.count(message.cuboids.size() - 1)];
    cuboid.cell = fuzzedSize(bytes, cuboid.cell);
    cuboid.top = static_cast<float>(bytes.number(0.0, 0.8));
    cuboid.depth = static_cast<float>(bytes.number(0.0, 0.2));
    cuboid.points = fuzzedSize(bytes, cuboid.points);
    cuboid.held = bytes.byte();
    cuboid.appeared = bytes.byte();
  }
  CuboidMap read;
  const std::string defect = fromMessage(message, read);
  if (!defect.empty()) return requireOneLine(defect);
  promise(read.cell_begin.size() == read.grid.cells() + std::size_t{1}, "it lacks its index");
  for (std::size_t i = 0; i < read.cuboids.size(); ++i) {
    const Cuboid& cuboid = read.cuboids[i];
    promise(cuboid.cell < read.grid.cells() && cuboid.bottom < cuboid.top, "a cuboid is none");
    promise(
        i == 0 || read.cuboids[i - 1].cell < cuboid.cell ||
            (read.cuboids[i - 1].cell == cuboid.cell && read.cuboids[i - 1].top <= cuboid.bottom),
        "cuboids are out of order");
  }
  promise(read.viewpoint.allFinite() && read.looks.viewpoint().allFinite(), "no viewpoint");
  promise(!read.self_share || (*read.self_share >= 0.0 && *read.self_share <= 1.0), "no share");
  tccm_monitor::CuboidMap again;
  CuboidMap reread;
  toMessage(read, "map", again);
  const std::string refused = fromMessage(again, reread);
  promise(refused.empty(), "what was written is refused: " + refused);
  promise(reread.cuboids.size() == read.cuboids.size() && reread.grid == read.grid,
          "what was written is another map");
  for (std::size_t i = 0; i < read.cuboids.size(); ++i) {
    promise(reread.cuboids[i].bottom == read.cuboids[i].bottom &&
                reread.cuboids[i].top == read.cuboids[i].top,
            "a cuboid is written at other heights");
  }
}

/// An attached object.
inline void runAttachedObject(ByteReader& bytes) {
  tccm_monitor::AttachedObject message;
  message.name = bytes.text(bytes.count(4));
  message.link = bytes.oneOf<const char*>({"hand", "arm", "nobody"});
  message.primitive.shape =
      bytes.oneOf<const char*>({"box", "cylinder", "capsule", "sphere", "", "Box", "\n"});
  message.primitive.radius = bytes.number(0.01, 0.1);
  message.primitive.length = bytes.number(0.0, 0.1);
  message.primitive.size.x = bytes.number(0.01, 0.1);
  message.primitive.size.y = message.primitive.size.z = bytes.number(0.01, 0.1);
  const double angle = bytes.number(-3.0, 3.0);
  message.primitive.pose.position.x = bytes.number(-0.1, 0.1);
  message.primitive.pose.orientation.w = std::cos(0.5 * angle);
  message.primitive.pose.orientation.z = std::sin(0.5 * angle);
  if (bytes.seldom()) message.primitive.pose.orientation.x = bytes.number(-0.1, 0.1);
  const AttachedObject object = fromMessage(message);
  promise(isRigid(object.primitive.pose), "a pose is not rigid");
  const RobotModel holding = fuzzedRobot()->holding({object});
  promise(holding.shapes().size() == 4, "an object gets lost");
  const tccm_monitor::Primitive again = toMessage(object.primitive);
  const PlacedShape read = fromMessage(again, "what was written");
  promise(name(read.shape) == message.primitive.shape, "a shape becomes another");
  promise(std::abs(boundingRadius(read.shape) - boundingRadius(object.primitive.shape)) <=
              1e-9 * boundingRadius(read.shape),
          "a shape changes its size");
  promise((read.pose.matrix() - object.primitive.pose.matrix()).cwiseAbs().maxCoeff() < 1e-6,
          "a pose changes on its way");
}

/// What reading messages broke of its promises, or nothing.
inline std::string messagesDefect(const std::string& input) {
  ByteReader bytes(input);
  return brokenPromise([&] {
    switch (bytes.byte() % 6) {
      case 0:
        return runLaserScan(bytes);
      case 1:
        return runCloud(bytes);
      case 2:
        return runScanCloud(bytes);
      case 3:
        return runCloudScan(bytes);
      case 4:
        return runCuboidMap(bytes);
      default:
        return runAttachedObject(bytes);
    }
  });
}

}  // namespace tccm::test
