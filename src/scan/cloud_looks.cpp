#include "scan/cloud_looks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tccm {
namespace {

constexpr std::size_t kSteps = 2000;      // so many neighbours tell how far they are apart
constexpr std::size_t kStepsLeast = 50;   // fewer do not
constexpr float kDirectionAlone = 0.01F;  // [m], where no range was measured
constexpr float kDoubtDepth = 0.05F;      // [m] that what is nearest may be before what was kept

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

std::optional<float> CloudLooks::stepOf(const Cloud& cloud, const CloudState& state,
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
  return std::max(1e-4F, *median);
}

std::optional<CloudLooks::Pitch> CloudLooks::pitchOf(const Cloud& cloud, const CloudState& state) {
  const auto across = stepOf(cloud, state, 1);
  const auto down = stepOf(cloud, state, cloud.width);
  if (!across || !down) return std::nullopt;
  const auto inBlock = [this](float step) {
    return static_cast<std::size_t>(std::max(1.0, std::round(config_.block_rad / step)));
  };
  return Pitch{cloud.width, cloud.height, inBlock(*across), inBlock(*down),
               std::max(*across, *down)};
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

void CloudLooks::Columns::clear(std::size_t width) {
  for (std::vector<float>* least : {&nearest, &nearest_kept}) {
    least->assign(width, std::numeric_limits<float>::infinity());
  }
  for (std::vector<std::uint16_t>* points : {&returns, &thinned, &unknown}) {
    points->assign(width, 0);
  }
  robot.assign(width, 0);
  rows = 0;
}

void CloudLooks::Columns::add(const float* ranges, const BeamKind* kinds) {
  constexpr float kNone = std::numeric_limits<float>::infinity();
  const std::size_t width = nearest.size();
  float* const least = nearest.data();
  for (std::size_t i = 0; i < width; ++i) {
    const float range = ranges[i] > 0.0F ? ranges[i] : kNone;
    least[i] = std::min(least[i], range);
  }
  float* const least_kept = nearest_kept.data();
  for (std::size_t i = 0; i < width; ++i) {
    const float range = kinds[i] == BeamKind::kReturn ? ranges[i] : kNone;
    least_kept[i] = std::min(least_kept[i], range);
  }
  // A loop each, over what nothing else can be: then a compiler does many columns at once.
  const auto count = [&](std::vector<std::uint16_t>& points, BeamKind kind) {
    std::uint16_t* const of = points.data();
    for (std::size_t i = 0; i < width; ++i) {
      of[i] = static_cast<std::uint16_t>(of[i] + (kinds[i] == kind ? 1 : 0));
    }
  };
  count(returns, BeamKind::kReturn);
  count(thinned, BeamKind::kThinned);
  count(unknown, BeamKind::kUnknown);
  std::uint8_t* const is_robot = robot.data();
  for (std::size_t i = 0; i < width; ++i) {
    is_robot[i] = static_cast<std::uint8_t>(is_robot[i] | (kinds[i] == BeamKind::kSelf ? 1 : 0));
  }
  ++rows;
}

/// What the columns have gathered becomes that of a row of blocks. Points that were thinned out
/// share the fate of those that were judged.
void CloudLooks::closeBlocks(std::size_t first, std::size_t width) {
  for (std::size_t begin = 0; begin < width; begin += pitch_columns_) {
    Block& block = blocks_[first++];
    const std::size_t end = std::min(begin + pitch_columns_, width);
    float nearest = std::numeric_limits<float>::infinity();
    float nearest_kept = nearest;
    std::uint32_t returns = 0, thinned = 0, unknown = 0;
    for (std::size_t i = begin; i < end; ++i) {
      nearest = std::min(nearest, columns_.nearest[i]);
      nearest_kept = std::min(nearest_kept, columns_.nearest_kept[i]);
      returns += columns_.returns[i];
      thinned += columns_.thinned[i];
      unknown += columns_.unknown[i];
      block.robot |= columns_.robot[i] != 0;
    }
    block.nearest = std::isinf(nearest) ? 0.0F : nearest;
    block.nearest_kept = nearest_kept;
    const auto points = static_cast<std::uint32_t>(columns_.rows * (end - begin));
    const std::uint32_t judged = points - thinned - unknown;
    block.kept = returns + (judged > 0 ? thinned * returns / judged : 0);
    block.doubtful = points - block.kept;
  }
  columns_.clear(width);
}

void CloudLooks::begin(const Cloud& cloud, const CloudState& state) {
  if (!cloud.organised()) {
    if (blocks_.size() != cube_.pixels()) blocks_.assign(cube_.pixels(), Block());
    pitch_.reset();
    for (const std::size_t block : touched_) blocks_[block] = Block();
    touched_.clear();
    return;
  }
  if (!isLaidOutFor(cloud)) {
    pitch_ = pitchOf(cloud, state);
    layOut(pitch_.value_or(Pitch{cloud.width, cloud.height, 8, 8, 0.0F}));
    touched_.clear();
  }
  std::fill(blocks_.begin(), blocks_.end(), Block());
  columns_.clear(cloud.width);
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
  const bool is_unclear = block.kept == 0 || block.doubtful > block.kept ||
                          block.nearest + kDoubtDepth < block.nearest_kept;
  const Seen what = block.robot ? Seen::kRobot : is_unclear ? Seen::kUnclear : Seen::kSurface;
  const Pose& T_fixed_sensor = places[block.place].T_fixed_sensor;
  const float range = block.nearest > 0.0F ? block.nearest : kDirectionAlone;
  looks.push_back({T_fixed_sensor.translation(),
                   T_fixed_sensor * Vector3((range * direction).cast<double>()), what});
}

}  // namespace tccm
