#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sight/look.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// How far what sensors measured of a robot lies outside its model.
class OwnReturns {
 public:
  static constexpr double kNear = 0.1;  ///< [m]; what lies further away is not the robot

  /// How far outside something was measured.
  struct Outside {
    double exact_m;       ///< as it was measured
    double with_noise_m;  ///< or nearer, where the range may be wrong by the filters' tolerance
  };
  struct Point {
    std::size_t shape;  ///< the nearest
    Vector3 p_shape;    ///< in its frame
    double outside_m;
  };
  /// What came of a link that enough was measured near to.
  struct OfLink {
    std::string link;
    std::size_t points = 0;  ///< nearer than kNear
    double reach_m = 0.0;    ///< nothing of the robot's lies further out
    bool is_apart = false;   ///< what was measured lies beside the model, by about the median
    double median_m = 0.0;
  };

  explicit OwnReturns(std::shared_ptr<const RobotModel> model);

  /// @param T_fixed_shapes the model's shapes at the scan. @param lowest_m what lies lower is the
  /// floor.
  void add(const ScanReturns& returns, const std::vector<Pose>& T_fixed_shapes, double lowest_m);

  /// Links of which that can be told, in the model's order: no surroundings begin where they end.
  [[nodiscard]] std::vector<OfLink> links() const;
  /// Some of what was added, for a picture; nothing of what is inside.
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  /// Where the shapes were last.
  [[nodiscard]] const std::vector<Pose>& shapePoses() const { return T_fixed_shapes_; }

 private:
  static constexpr std::size_t kBins = 20;
  static constexpr double kBin = kNear / kBins;  ///< [m]
  [[nodiscard]] static std::size_t binOf(double outside_m);
  using Histogram = std::array<std::size_t, kBins>;  ///< up to kNear

  struct Histograms {
    Histogram exact{}, with_noise{};
  };

  [[nodiscard]] static std::optional<OfLink> judge(const Histograms& histograms);

  std::shared_ptr<const RobotModel> model_;
  std::vector<Histograms> histograms_;  ///< by link
  std::vector<Point> points_;
  std::vector<Pose> T_fixed_shapes_;
};

/// The returns over the model, coloured by how far they lie outside.
/// @throws InputError where it could not be drawn.
void drawOwnReturns(const RobotModel& model, const OwnReturns& own, const std::string& picture);

}  // namespace tccm
