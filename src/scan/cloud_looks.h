#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "config/parameter_table.h"
#include "geometry/direction_cube.h"
#include "scan/cloud_body_filter.h"
#include "scan/cloud_filters.h"
#include "sight/look.h"

namespace tccm {

/// One look for each block of neighbouring directions: the nearest range that was measured there
/// tells how far it was seen, one point of the robot's makes it a look at the robot. Where most of
/// it is unknown or was filtered out, or what is nearest was, the direction alone is known: a point
/// in the air beside an outline is no surface that hides anything.
class CloudLooks {
 public:
  struct Config {
    double block_rad = 0.0175;

    void describe(ParameterTable& table);
  };

  explicit CloudLooks(const Config& config);

  /// @param place_of the place of a point, by its index in the cloud. @param looks reused.
  template <typename PlaceOf>
  void take(const Cloud& cloud, const CloudState& state, const std::vector<CloudPlace>& places,
            const PlaceOf& place_of, std::vector<Look>& looks) {
    begin(cloud, state);
    for (std::size_t row = 0; row < cloud.height; ++row) addRow(cloud, state, row, place_of);
    finish(cloud.organised(), places, looks);
  }

  // The same row by row: begin() once the ranges are known, each row once its kinds are.
  /// Then begin() needs no ranges: it has seen an organised cloud of that size.
  [[nodiscard]] bool isLaidOutFor(const Cloud& cloud) const {
    return cloud.organised() && pitch_ && pitch_->width == cloud.width &&
           pitch_->height == cloud.height;
  }
  void begin(const Cloud& cloud, const CloudState& state);
  /// The angle between neighbours of an organised cloud, along rows or columns, whichever is larger
  /// [rad]; 0: not known, or blocks have one row or column alone. Once begun.
  [[nodiscard]] float stepRad() const {
    return pitch_ && pitch_->columns > 1 && pitch_->rows > 1 ? pitch_->step_rad : 0.0F;
  }
  template <typename PlaceOf>
  void addRow(const Cloud& cloud, const CloudState& state, std::size_t row,
              const PlaceOf& place_of) {
    const std::size_t first = row * cloud.width;
    if (!cloud.organised()) {
      for (std::size_t i = 0; i < cloud.width; ++i) {
        const std::size_t block = blockOf(cloud.points[i]);
        if (block != kNoBlock)
          add(blocks_[block], cloud.points[i], state.ranges[i], state.kinds[i], place_of(i));
      }
      return;
    }
    columns_.add(&state.ranges[first], &state.kinds[first]);
    std::size_t index = row_blocks_[row];
    for (std::size_t begin = 0; begin < cloud.width; begin += pitch_columns_, ++index) {
      const std::size_t end = first + std::min(begin + pitch_columns_, cloud.width);
      Block& block = blocks_[index];
      Eigen::Vector3f towards = block.towards;
      for (std::size_t i = first + begin; i < end; ++i) {
        if (state.kinds[i] == BeamKind::kThinned) continue;  // others point there
        const Eigen::Vector3f& point = cloud.points[i];
        if (state.ranges[i] > 0.0F) {
          // Within a block the time hardly differs.
          if (block.points == 0) block.place = static_cast<std::uint32_t>(place_of(i));
          ++block.points;
          towards += point * (1.0F / state.ranges[i]);
        } else if (isMeasured(point)) {
          towards += point.normalized();  // out of limits
        }
      }
      block.towards = towards;
    }
    if (row + 1 == cloud.height || row_blocks_[row + 1] != row_blocks_[row]) {
      closeBlocks(row_blocks_[row], cloud.width);
    }
  }
  void finish(bool organised, const std::vector<CloudPlace>& places, std::vector<Look>& looks);

 private:
  struct Block {
    Eigen::Vector3f towards = Eigen::Vector3f::Zero();            ///< sum of unit vectors
    float nearest = 0.0F;                                         ///< [m]; 0: none measured
    float nearest_kept = std::numeric_limits<float>::infinity();  ///< [m]; infinite: none
    std::uint32_t kept = 0;
    std::uint32_t doubtful = 0;  ///< unknown, or filtered out
    std::uint32_t points = 0;    ///< that towards is of, with a range
    std::uint32_t place = 0;     ///< of the nearest of them, or of the first
    bool robot = false;
  };
  /// How many columns and rows of an organised cloud make a block.
  struct Pitch {
    std::size_t width, height;  ///< of the cloud
    std::size_t columns, rows;
    float step_rad;  ///< as stepRad()
  };
  /// What is known of the rows of a block, column by column: a loop over columns is fast.
  struct Columns {
    std::vector<float> nearest;                            ///< [m]; infinite: none measured
    std::vector<float> nearest_kept;                       ///< likewise, of returns
    std::vector<std::uint16_t> returns, thinned, unknown;  ///< points
    std::vector<std::uint8_t> robot;                       ///< whether any is its
    std::uint16_t rows = 0;

    void clear(std::size_t width);
    void add(const float* ranges, const BeamKind* kinds);
  };
  static constexpr std::size_t kNoBlock = static_cast<std::size_t>(-1);

  /// @return nothing where too few neighbours were measured to tell.
  [[nodiscard]] std::optional<Pitch> pitchOf(const Cloud& cloud, const CloudState& state);
  [[nodiscard]] std::optional<float> stepOf(const Cloud& cloud, const CloudState& state,
                                            std::size_t stride);
  void layOut(const Pitch& pitch);
  void closeBlocks(std::size_t first, std::size_t width);
  [[nodiscard]] std::size_t blockOf(const Eigen::Vector3f& point) {
    if (!isMeasured(point)) return kNoBlock;
    const std::size_t pixel = cube_.pixelOf(point);
    if (blocks_[pixel].kept + blocks_[pixel].doubtful == 0) touched_.push_back(pixel);
    return pixel;
  }
  /// Of a cloud that is not organised.
  static void add(Block& block, const Eigen::Vector3f& point, float range, BeamKind kind,
                  std::size_t place) {
    const bool is_kept = kind == BeamKind::kReturn;
    block.kept += is_kept ? 1 : 0;
    if (is_kept) block.nearest_kept = std::min(block.nearest_kept, range);
    block.doubtful += is_kept ? 0 : 1;
    block.robot |= kind == BeamKind::kSelf;
    if (range == 0.0F) {
      if (isMeasured(point)) block.towards += point.normalized();  // out of limits
      return;
    }
    block.towards += point * (1.0F / range);
    if (block.nearest > 0.0F && block.nearest <= range) return;
    block.nearest = range;
    block.place = static_cast<std::uint32_t>(place);
  }
  void finish(const Block& block, const Eigen::Vector3f& direction,
              const std::vector<CloudPlace>& places, std::vector<Look>& looks) const;

  Config config_;
  DirectionCube cube_;
  std::optional<Pitch> pitch_;
  std::size_t pitch_columns_ = 1;
  Columns columns_;
  std::vector<std::size_t> row_blocks_;  ///< the first of each row of an organised cloud
  std::vector<Block> blocks_;
  std::vector<std::size_t> touched_;              ///< of a cloud that is not organised, in order
  std::vector<Eigen::Vector3f> last_directions_;  ///< of an organised cloud's blocks, as last seen
  std::vector<float> steps_;
};

}  // namespace tccm
