#include "check/exemptions.h"

#include <algorithm>
#include <string_view>

#include "base/duration_text.h"
#include "base/line_of.h"
#include "base/printable.h"
#include "robot/link_use.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kRegionMax = 1e6;  // [m]

const LinkUse::Keys kKeys{"link", "link", "scale", "padding", "exceptions"};

UsedShapes shapesOf(const RobotModel& model, const std::string& link) {
  LinkUse use;
  use.links = {link};
  use.all_objects = false;
  return model.shapesFor(use, kKeys);
}

/// There is no exemption for everything.
void requireOneLink(const RobotModel& model, const std::string& link) {
  const std::vector<std::size_t> shapes = shapesOf(model, link).shapes;
  const bool is_one = std::all_of(shapes.begin(), shapes.end(), [&](std::size_t shape) {
    return model.shapes()[shape].link == model.shapes()[shapes.front()].link;
  });
  if (!is_one)
    throw ConfigError(printable("link: '" + link + "' means more than one link", kLineMax));
}

/// Where on the robot a frame lies.
struct Carrier {
  std::size_t link;  ///< index into the model's links
  Pose T_link_frame;
};

/// Of a link of the robot, or of one that is fixed to one. Nothing where transforms have to place
/// it: because it is no link, or moves by joints that nobody has to publish.
std::optional<Carrier> carrierOf(const RobotModel& model, const std::string& frame) {
  const JointTree& tree = model.frames();
  auto at = std::find_if(tree.links.begin(), tree.links.end(), [&](const std::string& link) {
    return link == frame || model.frameOf(link) == frame;
  });
  Carrier carrier{0, Pose::Identity()};
  while (at != tree.links.end()) {
    const std::vector<std::string>& links = model.links();
    const auto link = std::find(links.begin(), links.end(), *at);
    if (link != links.end()) {
      carrier.link = static_cast<std::size_t>(link - links.begin());
      return carrier;
    }
    const auto child = static_cast<std::size_t>(at - tree.links.begin());
    const auto joint = std::find_if(tree.joints.begin(), tree.joints.end(),
                                    [child](const auto& any) { return any.child == child; });
    if (joint == tree.joints.end() || joint->motion != RobotJoint::Motion::kFixed) break;
    carrier.T_link_frame = joint->T_parent_joint * carrier.T_link_frame;
    at = tree.links.begin() + static_cast<std::ptrdiff_t>(joint->parent);
  }
  return std::nullopt;
}

bool isSameOwner(const std::string& one, const std::string& other) {
  const auto name = [](const std::string& owner) {
    return std::string_view(owner).substr(std::min(owner.size(), owner.find_first_not_of('/')));
  };
  return name(one) == name(other);
}

void validateRegion(const PlacedShape& region) {
  validate(region.shape, "region");
  if (!isRigid(region.pose)) {
    throw ConfigError("region: its pose is none, or lies beyond 1000 km");
  }
  if (boundingRadius(region.shape) > kRegionMax) {
    throw ConfigError("region: it is larger than 1000 km; lengths are in metres");
  }
}

}  // namespace

void Exemptions::Config::describe(ParameterTable& table) {
  table.add("exemption_max_s", &duration_max_s, "s", {0.0, 3600.0},
            "no exemption lasts longer, nor waits longer for a goal");
  table.add("exemptions_max", &count_max, "", {0, 1000}, "in force or waiting at once");
}

void Exemptions::add(Time now, const Exemption& exemption, double duration_s,
                     const RobotModel& model) {
  if (exemption.owner.empty()) throw ConfigError("owner: an exemption has to say whose it is");
  if (exemption.link.empty()) throw ConfigError("link: an exemption is for one link");
  requireOneLink(model, exemption.link);
  requireInRange("duration", duration_s, 0.0, config_.duration_max_s);
  validateRegion(exemption.region);
  const auto known = std::find_if(list_.begin(), list_.end(), [&exemption](const auto& other) {
    return other.owner == exemption.owner && other.link == exemption.link;
  });
  const bool is_new = known == list_.end();
  if (is_new && duration_s > 0.0 && list_.size() >= static_cast<std::size_t>(config_.count_max)) {
    throw ConfigError("exemptions_max: so many are in force or wait already");
  }
  Anchor anchor{fromSeconds(duration_s)};
  ExemptRegion region{exemption.region, {}, false};
  if (const auto carrier = carrierOf(model, exemption.frame)) {
    region.link = carrier->link;
    region.placed.pose = carrier->T_link_frame * exemption.region.pose;
  } else {
    anchor.by_transform = !exemption.frame.empty();
  }
  if (!is_new) erase(static_cast<std::size_t>(known - list_.begin()));
  if (duration_s == 0.0) return;
  list_.push_back(exemption);
  anchors_.push_back(anchor);
  regions_.push_back(region);
  begin(now, list_.size() - 1);
  if (!exemption.with_goal || hasGoal(exemption.owner)) return;
  anchors_.back().begun = false;
  list_.back().until = now + fromSeconds(config_.duration_max_s);
}

void Exemptions::begin(Time now, std::size_t i) {
  anchors_[i].begun = true;
  list_[i].until = now + anchors_[i].duration;
}

void Exemptions::erase(std::size_t i) {
  const auto at = static_cast<std::ptrdiff_t>(i);
  list_.erase(list_.begin() + at);
  anchors_.erase(anchors_.begin() + at);
  regions_.erase(regions_.begin() + at);
}

std::size_t Exemptions::lift(const std::string& owner, const std::string& link) {
  std::size_t lifted = 0;
  for (std::size_t i = list_.size(); i-- > 0;) {
    if (list_[i].owner != owner || !(link.empty() || list_[i].link == link)) continue;
    erase(i);
    ++lifted;
  }
  return lifted;
}

bool Exemptions::hasGoal(const std::string& owner) const {
  return std::any_of(goals_.begin(), goals_.end(),
                     [&](const Goal& goal) { return isSameOwner(goal.owner, owner); });
}

bool Exemptions::endGoals(const std::string& owner, const std::string& id) {
  const auto ended = std::remove_if(goals_.begin(), goals_.end(), [&](const Goal& goal) {
    return isSameOwner(goal.owner, owner) && (id.empty() || goal.id == id);
  });
  const bool any = ended != goals_.end();
  goals_.erase(ended, goals_.end());
  return any;
}

void Exemptions::endWithGoalsOf(const std::string& owner) {
  if (hasGoal(owner)) return;
  for (std::size_t i = list_.size(); i-- > 0;) {
    if (list_[i].with_goal && anchors_[i].begun && isSameOwner(list_[i].owner, owner)) erase(i);
  }
}

void Exemptions::reportGoal(Time now, const std::string& owner, const std::string& goal,
                            bool under_way) {
  if (owner.empty()) throw ConfigError("owner: a goal has to say whose it is");
  if (under_way && goal.empty()) throw ConfigError("goal: one that begins has to have a name");
  const bool any_ended = endGoals(owner, goal);
  if (!under_way) {
    if (any_ended) endWithGoalsOf(owner);
    return;
  }
  goals_.push_back({owner, goal});
  if (goals_.size() > kGoalsMax) {
    const std::string oldest = goals_.front().owner;
    goals_.erase(goals_.begin());
    endWithGoalsOf(oldest);
  }
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (!anchors_[i].begun && isSameOwner(list_[i].owner, owner)) begin(now, i);
  }
}

void Exemptions::setFrame(const std::string& frame, Time stamp, const Pose& T_fixed_frame,
                          bool is_static) {
  if (!isRigid(T_fixed_frame)) return;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    Anchor& anchor = anchors_[i];
    if (!anchor.by_transform || list_[i].frame != frame) continue;
    anchor.placed = true;
    anchor.is_static = is_static;
    anchor.stamp = stamp;
    regions_[i].placed.pose = T_fixed_frame * list_[i].region.pose;
  }
}

Exemption::State Exemptions::stateOf(Time now, const Limits& limits, std::size_t i) const {
  using State = Exemption::State;
  const Anchor& anchor = anchors_[i];
  if (!anchor.begun) return State::kAwaitsGoal;
  if (!anchor.by_transform) return State::kInForce;
  if (!anchor.placed) return State::kNoTransform;
  if (anchor.is_static) return State::kInForce;
  const Duration age = now - anchor.stamp;
  if (-age > fromSeconds(limits.future_max_s)) return State::kTransformOfFuture;
  return age > fromSeconds(limits.timeout_s) ? State::kTransformOld : State::kInForce;
}

bool Exemptions::update(Time now, const Limits& limits) {
  bool any_ended = false;
  for (std::size_t i = list_.size(); i-- > 0;) {
    if (now >= list_[i].until) {
      erase(i);
      any_ended = true;
      continue;
    }
    list_[i].state = stateOf(now, limits, i);
    list_[i].transform_age = anchors_[i].placed ? now - anchors_[i].stamp : Duration::zero();
    regions_[i].in_force = list_[i].state == Exemption::State::kInForce;
  }
  return any_ended;
}

void Exemptions::clear() {
  list_.clear();
  anchors_.clear();
  regions_.clear();
  goals_.clear();
}

std::vector<std::string> Exemptions::frames() const {
  std::vector<std::string> frames;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const std::string& frame = list_[i].frame;
    const bool is_known = std::find(frames.begin(), frames.end(), frame) != frames.end();
    if (anchors_[i].by_transform && !is_known) frames.push_back(frame);
  }
  return frames;
}

ExemptRegions Exemptions::regionsOf(const RobotModel& model,
                                    const std::vector<std::size_t>& shapes) const {
  if (list_.empty()) return {};
  ExemptRegions regions{regions_, std::vector<std::vector<std::size_t>>(shapes.size())};
  for (std::size_t k = 0; k < list_.size(); ++k) {
    const std::vector<std::size_t> exempt = shapesOf(model, list_[k].link).shapes;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (std::find(exempt.begin(), exempt.end(), shapes[i]) == exempt.end()) continue;
      regions.of_shapes[i].push_back(k);
    }
  }
  return regions;
}

std::string whyNotInForce(const Exemption& exemption, const Exemptions::Limits& limits) {
  using State = Exemption::State;
  const char* const frame = exemption.frame.c_str();
  const Duration age = exemption.transform_age;
  switch (exemption.state) {
    case State::kInForce:
      return "";
    case State::kAwaitsGoal:
      return lineOf("it waits for a goal of '%.100s'", exemption.owner.c_str());
    case State::kNoTransform:
      return lineOf("no transform from its frame '%.100s' to the fixed frame was heard of", frame);
    case State::kTransformOld:
      return lineOf("its frame '%.100s' was not heard of for %s, at most %s (transform_timeout_s)",
                    frame, durationText(age).c_str(),
                    durationText(fromSeconds(limits.timeout_s)).c_str());
    case State::kTransformOfFuture:
      return lineOf(
          "the pose of its frame '%.100s' is stamped in the future, by %s, at most %s "
          "(transform_future_max_s)",
          frame, durationText(-age).c_str(),
          durationText(fromSeconds(limits.future_max_s)).c_str());
  }
  return "";
}

}  // namespace tccm
