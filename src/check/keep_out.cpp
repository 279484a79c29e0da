#include "check/keep_out.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/frame_name.h"
#include "base/printable.h"
#include "check/pose_check.h"
#include "geometry/distance.h"
#include "geometry/overlap.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kSizeMin = 0.001, kSizeMax = 1000.0;  // [m]
constexpr double kCenterMax = 1000.0;                  // [m]
constexpr double kTurnMax = 6.3;                       // [rad], a whole turn
constexpr std::size_t kNameMax = 60;                   // characters, so that a line has room for it

bool isAmong(const std::vector<std::uint32_t>* regions, std::uint32_t region) {
  return regions && std::binary_search(regions->begin(), regions->end(), region);
}

void requireName(const std::string& name) {
  const bool has_control = std::any_of(name.begin(), name.end(), [](char c) {
    return std::iscntrl(static_cast<unsigned char>(c)) != 0;
  });
  if (!name.empty() && name.size() <= kNameMax && !has_control) return;
  throw ConfigError("name: a region needs one, in one line of at most " + std::to_string(kNameMax) +
                    " characters");
}

/// @throws ConfigError where an earlier one has the same name.
void requireOnce(const std::vector<KeepOut::Config::Region>& regions, std::size_t i) {
  const auto end = regions.begin() + static_cast<std::ptrdiff_t>(i);
  const bool is_known = std::any_of(
      regions.begin(), end, [&](const auto& region) { return region.name == regions[i].name; });
  if (is_known) throw ConfigError("name: '" + regions[i].name + "' is given twice");
}

void requireGeometry(const KeepOutRegion& region) {
  const Vector3 size = 2.0 * region.box.half_extents;
  const char* const axes[] = {"size_x_m", "size_y_m", "size_z_m"};
  for (int i = 0; i < 3; ++i) requireInRange(axes[i], size[i], kSizeMin, kSizeMax);
  if (!isRigid(region.T_frame_box)) throw ConfigError("its pose is none");
  const char* const places[] = {"center_x_m", "center_y_m", "center_z_m"};
  for (int i = 0; i < 3; ++i) {
    requireInRange(places[i], region.T_frame_box.translation()[i], -kCenterMax, kCenterMax);
  }
}

/// The links that a region may stand still against.
std::string framesOf(const RobotModel& model, const std::vector<LinkMount>& mounts) {
  std::string names;
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    if (!mounts[i].moves) names += (names.empty() ? "'" : ", '") + model.links()[i] + "'";
  }
  return names;
}

}  // namespace

void KeepOut::Config::Region::describe(ParameterTable& table) {
  table.add("name", &name, "by which verdicts name it");
  table.add("frame", &frame,
            "a link that no joint moves, such as the base; empty: the fixed frame");
  const Range places{-kCenterMax, kCenterMax}, sizes{kSizeMin, kSizeMax},
      turns{-kTurnMax, kTurnMax};
  table.add("center_x_m", &center_x_m, "m", places, "of the box's middle");
  table.add("center_y_m", &center_y_m, "m", places, "of the box's middle");
  table.add("center_z_m", &center_z_m, "m", places, "of the box's middle");
  table.add("size_x_m", &size_x_m, "m", sizes, "the box's full edge");
  table.add("size_y_m", &size_y_m, "m", sizes, "the box's full edge");
  table.add("size_z_m", &size_z_m, "m", sizes, "the box's full edge");
  table.add("roll_rad", &roll_rad, "rad", turns, "about the frame's x, before pitch");
  table.add("pitch_rad", &pitch_rad, "rad", turns, "about the frame's y, before yaw");
  table.add("yaw_rad", &yaw_rad, "rad", turns, "about the frame's z");
}

KeepOutRegion KeepOut::Config::Region::region() const {
  KeepOutRegion region{name, frame, Box{0.5 * Vector3(size_x_m, size_y_m, size_z_m)}};
  region.T_frame_box.translate(Vector3(center_x_m, center_y_m, center_z_m))
      .rotate(Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ()) *
              Eigen::AngleAxisd(pitch_rad, Vector3::UnitY()) *
              Eigen::AngleAxisd(roll_rad, Vector3::UnitX()));
  return region;
}

void KeepOut::Config::describe(ParameterTable& table) {
  table.addList("keep_out", regions,
                "at most " + std::to_string(kCountMax) +
                    " boxes that no link may enter, as `[{name: wall, center_x_m: 1.0, size_x_m: "
                    "0.1, size_y_m: 2.0, size_z_m: 2.0}]`; all keys stand in docs/interfaces.md");
}

void KeepOut::Config::validate() const {
  if (regions.size() > kCountMax) {
    throw ConfigError("keep_out: " + std::to_string(regions.size()) + " regions, at most " +
                      std::to_string(kCountMax) + " are allowed");
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const std::string owner = "keep_out[" + std::to_string(i) + "]/";
    try {
      requireName(regions[i].name);
      Region copy = regions[i];
      tableOf(copy).requireRanges();
      requireOnce(regions, i);
    } catch (const ConfigError& error) {
      throw ConfigError(owner + error.what());
    }
  }
}

KeepOut::KeepOut(const Config& config, const RobotModel& model, const std::string& fixed_frame) {
  config.validate();
  regions_.reserve(kCountMax);
  placed_.reserve(kCountMax);
  for (std::size_t i = 0; i < config.regions.size(); ++i) {
    try {
      add(config.regions[i].region(), model, fixed_frame);
    } catch (const ConfigError& error) {
      throw ConfigError("keep_out[" + std::to_string(i) + "]/" + error.what());
    }
  }
  configured_ = regions_.size();
}

KeepOut::Placed KeepOut::resolve(KeepOutRegion& region, const RobotModel& model,
                                 const std::string& fixed_frame) {
  Placed placed{std::nullopt, region.T_frame_box,
                UprightBox(-region.box.half_extents, region.box.half_extents)};
  const std::string frame = withoutSlash(region.frame);
  region.frame.clear();
  if (frame.empty() || frame == withoutSlash(fixed_frame)) return placed;
  const std::vector<LinkMount> mounts = linkMounts(model);
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    const std::string& link = model.links()[i];
    if ((link != frame && model.frameOf(link) != frame) || mounts[i].moves) continue;
    region.frame = model.frameOf(link);
    placed.root = mounts[i].root;
    placed.T_root_box = mounts[i].T_root_link * region.T_frame_box;
    return placed;
  }
  throw ConfigError("frame: '" + printable(frame, kLineMax) + "' is neither the fixed frame '" +
                    withoutSlash(fixed_frame) +
                    "' nor a link that no joint moves: " + framesOf(model, mounts));
}

void KeepOut::add(KeepOutRegion region, const RobotModel& model, const std::string& fixed_frame) {
  const Placed placed = resolve(region, model, fixed_frame);
  const auto known =
      std::find_if(regions_.begin(), regions_.end(),
                   [&region](const KeepOutRegion& other) { return other.name == region.name; });
  const auto i = static_cast<std::size_t>(known - regions_.begin());
  if (i < configured_) {
    throw ConfigError("name: '" + region.name +
                      "' is a region of the configuration: it is changed there");
  }
  if (known != regions_.end()) {
    regions_[i] = std::move(region);
    placed_[i] = placed;
    return;
  }
  if (regions_.size() >= kCountMax) {
    throw ConfigError("there are " + std::to_string(kCountMax) +
                      " regions already: remove one first");
  }
  regions_.push_back(std::move(region));
  placed_.push_back(placed);
}

void KeepOut::set(const KeepOutRegion& region, const RobotModel& model,
                  const std::string& fixed_frame) {
  requireName(region.name);
  requireGeometry(region);
  add(region, model, fixed_frame);
}

void KeepOut::remove(const std::string& name) {
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    if (regions_[i].name != name) continue;
    if (i < configured_) {
      throw ConfigError("name: '" + name + "' is a region of the configuration: it stays");
    }
    regions_.erase(regions_.begin() + static_cast<std::ptrdiff_t>(i));
    placed_.erase(placed_.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
  throw ConfigError(printable("name: there is no region '" + name + "'", kLineMax));
}

void KeepOut::take(const RobotModel& model, const UsedBody& body) {
  const std::vector<LinkMount> of_links = linkMounts(model);
  mounts_.clear();
  for (const std::uint32_t link : body.links) mounts_.push_back(of_links[link]);
}

void KeepOut::place(const std::vector<Pose>& T_fixed_roots, bool roots_move) {
  roots_move_ = roots_move;
  for (Placed& placed : placed_) {
    const Pose T_box_root = placed.T_root_box.inverse();
    placed.T_box_fixed =
        placed.root ? T_box_root * T_fixed_roots[*placed.root].inverse() : T_box_root;
  }
}

bool KeepOut::concerns(std::uint32_t region, std::uint32_t index) const {
  const LinkMount& mount = mounts_[index];
  return mount.moves || (roots_move_ && placed_[region].root != mount.root);
}

bool KeepOut::touches(std::uint32_t region, const Shape& shape, const Pose& T_fixed_shape) const {
  const Placed& placed = placed_[region];
  const Vector3 centre = placed.T_box_fixed * T_fixed_shape.translation();
  const double radius = boundingRadius(shape);
  if (placed.box.squaredExteriorDistance(centre) > radius * radius) return false;
  return overlaps(shape, placed.T_box_fixed * T_fixed_shape, placed.box);
}

double KeepOut::distanceTo(std::uint32_t region, const Shape& shape,
                           const Pose& T_fixed_shape) const {
  const Placed& placed = placed_[region];
  return distance(shape, placed.T_box_fixed * T_fixed_shape, placed.box);
}

std::optional<NearestRegion> KeepOut::nearest(const Shape& shape, const Pose& T_fixed_shape,
                                              std::uint32_t index, double nearer_than_m,
                                              const std::vector<std::uint32_t>* but) const {
  std::optional<NearestRegion> best;
  const double radius = boundingRadius(shape);
  for (std::uint32_t i = 0; i < regions_.size() && nearer_than_m > 0.0; ++i) {
    if (!concerns(i, index) || isAmong(but, i)) continue;
    const Placed& placed = placed_[i];
    const double reach = nearer_than_m + radius;
    const Vector3 centre = placed.T_box_fixed * T_fixed_shape.translation();
    if (placed.box.squaredExteriorDistance(centre) >= reach * reach) continue;
    const Separation apart =
        separation(shape, placed.T_box_fixed * T_fixed_shape, placed.box, nearer_than_m);
    if (apart.distance_m >= nearer_than_m) continue;
    nearer_than_m = apart.distance_m;
    best = NearestRegion{apart.distance_m, i};
  }
  return best;
}

}  // namespace tccm
