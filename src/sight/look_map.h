#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/bytes_of.h"
#include "base/index_set.h"
#include "config/parameter_table.h"
#include "sight/look.h"
#include "tccm_monitor/look_image.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// Keeps the image of where the sensor looked lately, scan by scan. Directions are those from one
/// viewpoint, the mean of where the tilting sensor is; where that moves, all that was seen is put
/// into its directions from there.
class LookMap {
 public:
  struct Config {
    double resolution_rad = 0.035;
    double spread_rad = 0.03;
    double pass_gap_s = 0.1;

    void describe(ParameterTable& table);
  };

  /// Allocates all that it will ever use. @throws ConfigError
  explicit LookMap(const Config& config);

  /// A scan's looks. @pre stamps do not fall. @param is_pass whether they are a pass of their own,
  /// however shortly they follow others.
  void add(Time stamp, const std::vector<Look>& looks, bool is_pass = false);
  void clear();

  [[nodiscard]] const LookImage& image() const { return image_; }
  /// The pixels where the last scan's looks have changed more than when a pass was last, if they
  /// did not change the viewpoint too.
  [[nodiscard]] const IndexSet& changed() const { return changed_; }
  [[nodiscard]] std::size_t memoryBytes() const {
    return 2 * (image_.memoryBytes() + bytesOf(aims_)) + changed_.memoryBytes();
  }

 private:
  using Ticks = LookImage::Ticks;
  using Pass = LookImage::Pass;
  /// The best look of a pass: the one that came nearest to the pixel's middle.
  struct Aim {
    Eigen::Vector3f end = Eigen::Vector3f::Zero();
    float aim = -4.0F;  ///< cosine of the angle to the pixel's middle, less where it is unclear
    Ticks stamp = 0;
    Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();  ///< the image's, then
  };
  using Aims = std::array<Aim, LookImage::kPasses>;
  struct Beam {
    Vector3 end;
    Vector3 direction;
    double range = 0.0;
    Seen what = Seen::kNever;
    std::size_t pixel = 0;  ///< that it falls into
    double aim = 0.0;       ///< as Aim's, at that pixel
  };
  void follow(const Vector3& viewpoint);
  void moveTo(const Vector3& viewpoint);
  /// @param follower is where the beam before fell. @return false where it has no direction.
  [[nodiscard]] bool aimAt(const Vector3& end, Seen what, PixelFollower& follower,
                           Beam& beam) const;
  /// Hands row, column and aim to note for each pixel that the beam speaks for.
  template <typename Note>
  void spread(const Beam& beam, Note&& note) const;
  void note(const Beam& beam, Ticks now);
  void note(int row, int column, Pass newest, const Aim& aimed);
  void noteAgain(int row, int column, std::size_t k, const Pass& found, const Aim& old, float aim);

  Config config_;
  LookImage image_;
  double spread_cosine_;
  DirectionGrid::Around spread_;  ///< the pixels that a beam may speak for
  Ticks pass_gap_;
  Ticks gap_ = 0;  ///< of the scan that is added
  std::vector<Aims> aims_;
  IndexSet changed_;
  bool started_ = false;
  Vector3 mean_viewpoint_ = Vector3::Zero();  ///< lately
  LookImage old_image_;                       ///< before a move
  std::vector<Aims> old_aims_;
};

}  // namespace tccm
