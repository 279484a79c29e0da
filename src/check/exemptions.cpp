#include "check/exemptions.h"

#include <algorithm>

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
  if (!is_one) throw ConfigError("link: '" + link + "' means more than one link");
}

}  // namespace

void Exemptions::Config::describe(ParameterTable& table) {
  table.add("exemption_max_s", &duration_max_s, "s", {0.0, 3600.0}, "no exemption lasts longer");
  table.add("exemptions_max", &count_max, "", {0, 1000}, "in force at once");
}

void Exemptions::add(Time now, const Exemption& exemption, double duration_s,
                     const RobotModel& model) {
  if (exemption.owner.empty()) throw ConfigError("owner: an exemption has to say whose it is");
  if (exemption.link.empty()) throw ConfigError("link: an exemption is for one link");
  requireOneLink(model, exemption.link);
  requireInRange("duration", duration_s, 0.0, config_.duration_max_s);
  validate(exemption.region.shape, "region");
  if (!isRigid(exemption.region.pose)) {
    throw ConfigError("region: its pose is none, or lies beyond 1000 km");
  }
  if (boundingRadius(exemption.region.shape) > kRegionMax) {
    throw ConfigError("region: it is larger than 1000 km; lengths are in metres");
  }
  std::vector<Exemption> list = list_;
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&exemption](const Exemption& other) {
                              return other.owner == exemption.owner && other.link == exemption.link;
                            }),
             list.end());
  if (duration_s > 0.0) {
    if (list.size() >= static_cast<std::size_t>(config_.count_max)) {
      throw ConfigError("exemptions_max: so many are in force already");
    }
    list.push_back(exemption);
    list.back().until = now + fromSeconds(duration_s);
  }
  list_ = std::move(list);
}

bool Exemptions::expire(Time now) {
  const auto ended = std::remove_if(list_.begin(), list_.end(), [now](const Exemption& exemption) {
    return now >= exemption.until;
  });
  const bool any = ended != list_.end();
  list_.erase(ended, list_.end());
  return any;
}

ExemptRegions Exemptions::regionsOf(const RobotModel& model,
                                    const std::vector<std::size_t>& shapes) const {
  if (list_.empty()) return {};
  ExemptRegions regions(shapes.size());
  for (const Exemption& exemption : list_) {
    const std::vector<std::size_t> exempt = shapesOf(model, exemption.link).shapes;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (std::find(exempt.begin(), exempt.end(), shapes[i]) == exempt.end()) continue;
      regions[i].push_back(exemption.region);
    }
  }
  return regions;
}

}  // namespace tccm
