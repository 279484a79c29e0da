#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/parameter_table.h"
#include "robot/link_mounts.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

struct UsedBody;

struct NearestRegion {
  double distance_m;
  std::uint32_t region;  ///< index into the regions
};

/// The regions that no link may enter: boxes that stand still in the fixed frame, or against a root
/// of the robot. A primitive that nothing moves against a region cannot enter it, and is not
/// checked against it: a wall may stand within the padding of the robot's base.
class KeepOut {
 public:
  static constexpr std::size_t kCountMax = 64;

  /// Those that are there from the start.
  struct Config {
    struct Region {
      std::string name;
      std::string frame;
      double center_x_m = 0.0, center_y_m = 0.0, center_z_m = 0.0;
      double size_x_m = 0.0, size_y_m = 0.0, size_z_m = 0.0;
      double roll_rad = 0.0, pitch_rad = 0.0, yaw_rad = 0.0;

      void describe(ParameterTable& table);
      [[nodiscard]] KeepOutRegion region() const;
    };
    std::vector<Region> regions = {};

    void describe(ParameterTable& table);
    /// @throws ConfigError naming the region and the key.
    void validate() const;
  };

  /// @throws ConfigError, also where a region's frame is neither the fixed frame nor that of a link
  /// that no joint moves.
  KeepOut(const Config& config, const RobotModel& model, const std::string& fixed_frame);

  /// From now on; one of the same name is replaced. @throws ConfigError, and nothing changes.
  void set(const KeepOutRegion& region, const RobotModel& model, const std::string& fixed_frame);
  /// @throws ConfigError where there is none of that name, or it is of the configuration.
  void remove(const std::string& name);
  /// The primitives that are asked about. @param body whose shapes are numbered as in questions.
  void take(const RobotModel& model, const UsedBody& body);
  /// Where the roots are from now on. @param roots_move whether one does, in the fixed frame.
  void place(const std::vector<Pose>& T_fixed_roots, bool roots_move);

  [[nodiscard]] std::size_t size() const { return regions_.size(); }
  /// Their frames are as transforms call them.
  [[nodiscard]] const std::vector<KeepOutRegion>& regions() const { return regions_; }
  [[nodiscard]] const std::string& name(std::uint32_t region) const {
    return regions_[region].name;
  }

  // Of a shape as the last place() has the regions. Exact, as overlaps() and distance() are. Work:
  // a test for each region.

  /// Hands each region that it touches to visit, until that returns false.
  /// @param index of the shape in the body.
  template <typename Visit>
  void visitTouched(const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index,
                    Visit&& visit) const {
    for (std::uint32_t i = 0; i < regions_.size(); ++i) {
      if (concerns(i, index) && touches(i, shape, T_fixed_shape) && !visit(i)) return;
    }
  }
  /// The nearest region that is nearer than that; at distance 0 the first that it touches.
  /// @param but these, in rising order.
  [[nodiscard]] std::optional<NearestRegion> nearest(
      const Shape& shape, const Pose& T_fixed_shape, std::uint32_t index, double nearer_than_m,
      const std::vector<std::uint32_t>* but = nullptr) const;
  [[nodiscard]] bool touches(std::uint32_t region, const Shape& shape,
                             const Pose& T_fixed_shape) const;
  [[nodiscard]] double distanceTo(std::uint32_t region, const Shape& shape,
                                  const Pose& T_fixed_shape) const;

 private:
  /// A region where it was placed last.
  struct Placed {
    std::optional<std::size_t> root;  ///< that it moves with, index; nothing: the fixed frame
    Pose T_root_box;                  ///< or in the fixed frame
    UprightBox box;                   ///< in its own frame
    Pose T_box_fixed = Pose::Identity();
  };
  void add(KeepOutRegion region, const RobotModel& model, const std::string& fixed_frame);
  /// Names its frame as transforms do. @throws ConfigError
  [[nodiscard]] static Placed resolve(KeepOutRegion& region, const RobotModel& model,
                                      const std::string& fixed_frame);
  /// Whether a shape can move against a region.
  [[nodiscard]] bool concerns(std::uint32_t region, std::uint32_t index) const;

  std::size_t configured_ = 0;  ///< the first regions
  std::vector<KeepOutRegion> regions_;
  std::vector<Placed> placed_;     ///< by region
  std::vector<LinkMount> mounts_;  ///< of the body's shapes
  bool roots_move_ = true;
};

}  // namespace tccm
