#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "sight/look.h"
#include "streams.h"

namespace tccm {

/// What a tilting laser sees of a table before a pair of arms that move: 666 beams over 244 degrees
/// from 1.5 m above, a scan in 28 ms, 56 scans to a tilt of 60 degrees and back. A fifth of its
/// returns lie in the map's default area. A beam that meets an arm ends on the robot.
class TiltingStream {
 public:
  static constexpr int kBeams = 666;
  static constexpr int kScansInPeriod = 56;
  static constexpr int kPeriods = 4;  ///< until all repeats itself, the arms too

  TiltingStream() {
    std::mt19937 engine(2);
    for (int k = 0; k < kPeriods * kScansInPeriod; ++k) scans_.push_back(scanAt(k, engine));
  }
  [[nodiscard]] std::size_t scans() const { return scans_.size(); }
  /// @param i counts on from period to period; so do the stamps.
  void get(std::size_t i, ScanReturns& scan) const {
    scan = scans_[i % scans_.size()];
    scan.stamp = Time(fromSeconds(1.0)) + static_cast<int>(i) * kScan;
  }
  static constexpr Duration kScan = std::chrono::milliseconds(28);

 private:
  using Thing = streams::Thing;

  /// Walls around the scene, and more of the floor.
  static std::vector<Thing> surroundings() {
    std::vector<Thing> things = streams::scene();
    things.insert(things.end(), {{Box{{4.0, 4.0, 0.005}}, {0.0, 0.0, 0.01}},
                                 {Box{{0.1, 4.0, 2.0}}, {3.5, 0.0, 2.0}},
                                 {Box{{4.0, 0.1, 2.0}}, {0.0, 2.5, 2.0}},
                                 {Box{{4.0, 0.1, 2.0}}, {0.0, -2.5, 2.0}}});
    return things;
  }
  /// Two forearms over the table, to and fro in two periods of the tilt, and in four.
  static std::vector<Thing> arms(double periods) {
    const double left = 0.25 * std::sin(M_PI * periods),
                 right = 0.2 * std::sin(0.5 * M_PI * periods);
    return {{Box{{0.25, 0.05, 0.05}}, {0.55, 0.3 + left, 1.0}},
            {Box{{0.25, 0.05, 0.05}}, {0.6, -0.35 + right, 0.95}}};
  }
  ScanReturns scanAt(int k, std::mt19937& engine) const {
    constexpr double kRangeMax = 10.0;
    std::normal_distribution<double> noise(0.0, 0.01);
    const std::vector<Thing> robot = arms(static_cast<double>(k) / kScansInPeriod);
    ScanReturns scan;
    for (int i = 0; i < kBeams; ++i) {
      // Its laser turns 40 times a second.
      const double when = k + 0.6 * i / kBeams;
      const double tilt =
          M_PI / 180.0 * (45.0 + 30.0 * std::sin(2.0 * M_PI * when / kScansInPeriod));
      if (i == 0) scan.tilt = tilt;
      const Eigen::AngleAxisd down(tilt, Vector3::UnitY());
      scan.viewpoint = Vector3(0.0, 0.0, 1.5) + down * Vector3(0.0, 0.0, 0.03);
      const double angle = M_PI / 180.0 * (-122.0 + 244.0 / (kBeams - 1) * i);
      const Ray ray{scan.viewpoint, down * Vector3(std::cos(angle), std::sin(angle), 0.0)};
      const double surface = streams::rangeTo(things_, ray), arm = streams::rangeTo(robot, ray);
      const double range = std::min(surface, arm);
      const Vector3 end = ray.at(std::min(kRangeMax, range + noise(engine)));
      const Seen what = range > kRangeMax ? Seen::kNothing
                        : arm < surface   ? Seen::kRobot
                                          : Seen::kSurface;
      scan.looks.push_back({scan.viewpoint, end, what});
      if (what == Seen::kSurface) scan.points.push_back(end);
    }
    return scan;
  }

  std::vector<Thing> things_ = surroundings();
  std::vector<ScanReturns> scans_;
};

}  // namespace tccm
