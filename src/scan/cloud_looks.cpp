#include "scan/cloud_looks.h"

#include <algorithm>
#include <cmath>

namespace tccm {
namespace {

constexpr std::size_t kSteps = 2000;      // so many neighbours tell how far they are apart
constexpr std::size_t kStepsLeast = 50;   // fewer do not
constexpr float kDirectionAlone = 0.01F;  // [m], where no range was measured

}  // namespace

void CloudLooks::Config::describe(ParameterTable& table) {
  table.add("look_block_rad", &block_rad, "rad", {0.005, 0.2},
            "of each block of directions so wide one look is taken: the nearest range in it tells "
            "how far was seen");
}

CloudLooks::CloudLooks(const Config& config)
    : config_(config), cube_(static_cast<int>(std::ceil(0.5 * M_PI / config.block_rad))) {
  steps_.reserve(kSteps + 1);
}

std::optional<std::size_t> CloudLooks::stepsInBlock(const Cloud& cloud, const CloudState& state,
                                                    std::size_t stride) {
  steps_.clear();
  const std::size_t every = std::max<std::size_t>(1, cloud.points.size() / kSteps);
  for (std::size_t i = 0; i + stride < cloud.points.size() && steps_.size() < kSteps; i += every) {
    if (stride == 1 && i % cloud.width + 1 == cloud.width) continue;
    if (state.ranges[i] == 0.0F || state.ranges[i + stride] == 0.0F) continue;
    steps_.push_back(
        (cloud.points[i + stride] / state.ranges[i + stride] - cloud.points[i] / state.ranges[i])
            .norm());
  }
  if (steps_.size() < kStepsLeast) return std::nullopt;
  const auto median = steps_.begin() + static_cast<std::ptrdiff_t>(steps_.size() / 2);
  std::nth_element(steps_.begin(), median, steps_.end());
  const double step = std::max(1e-4, static_cast<double>(*median));
  return static_cast<std::size_t>(std::max(1.0, std::round(config_.block_rad / step)));
}

std::optional<CloudLooks::Pitch> CloudLooks::pitchOf(const Cloud& cloud, const CloudState& state) {
  const auto columns = stepsInBlock(cloud, state, 1);
  const auto rows = stepsInBlock(cloud, state, cloud.width);
  if (!columns || !rows) return std::nullopt;
  return Pitch{cloud.width, cloud.height, *columns, *rows};
}

void CloudLooks::layOut(const Pitch& pitch) {
  const std::size_t blocks_wide = (pitch.width + pitch.columns - 1) / pitch.columns;
  const std::size_t blocks_high = (pitch.height + pitch.rows - 1) / pitch.rows;
  pitch_columns_ = pitch.columns;
  row_blocks_.resize(pitch.height);
  for (std::size_t i = 0; i < pitch.height; ++i) row_blocks_[i] = i / pitch.rows * blocks_wide;
  blocks_.resize(blocks_wide * blocks_high);
  last_directions_.assign(blocks_.size(), Eigen::Vector3f::Zero());
}

void CloudLooks::begin(const Cloud& cloud, const CloudState& state) {
  if (!cloud.organised()) {
    if (blocks_.size() != cube_.pixels()) blocks_.assign(cube_.pixels(), Block());
    pitch_.reset();
    for (const std::size_t block : touched_) blocks_[block] = Block();
    touched_.clear();
    return;
  }
  if (!pitch_ || pitch_->width != cloud.width || pitch_->height != cloud.height) {
    pitch_ = pitchOf(cloud, state);
    layOut(pitch_.value_or(Pitch{cloud.width, cloud.height, 8, 8}));
    touched_.clear();
  }
  std::fill(blocks_.begin(), blocks_.end(), Block());
}

void CloudLooks::finish(bool organised, const std::vector<CloudPlace>& places,
                        std::vector<Look>& looks) {
  looks.clear();
  if (!organised) {
    for (const std::size_t i : touched_) {
      finish(blocks_[i], blocks_[i].towards.normalized(), places, looks);
    }
    return;
  }
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (!blocks_[i].towards.isZero()) last_directions_[i] = blocks_[i].towards.normalized();
    finish(blocks_[i], last_directions_[i], places, looks);
  }
}

void CloudLooks::finish(const Block& block, const Eigen::Vector3f& direction,
                        const std::vector<CloudPlace>& places, std::vector<Look>& looks) const {
  if (direction.isZero()) return;  // nothing was ever measured there
  const bool is_unclear = block.kept == 0 || block.doubtful > block.kept;
  const Seen what = block.robot ? Seen::kRobot : is_unclear ? Seen::kUnclear : Seen::kSurface;
  const Pose& T_fixed_sensor = places[block.place].T_fixed_sensor;
  const float range = block.nearest > 0.0F ? block.nearest : kDirectionAlone;
  looks.push_back({T_fixed_sensor.translation(),
                   T_fixed_sensor * Vector3((range * direction).cast<double>()), what});
}

}  // namespace tccm
