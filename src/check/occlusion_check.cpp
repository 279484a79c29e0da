#include "tccm_monitor/check/occlusion_check.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

void OcclusionCheck::Config::validate() const {
  requireInRange("occlusion_resolution_rad", resolution_rad, 0.002, 0.2);
  requireInRange("occlusion_margin_m", margin_m, 0.0, 1.0);
  requireInRange("occlusion_hidden_fraction", hidden_fraction, 0.01, 1.0);
  requireInRange("occlusion_silhouette_min_pixels", silhouette_min_pixels, 0.0, 1000.0);
}

OcclusionCheck::OcclusionCheck(const Config& config, std::vector<std::uint32_t> link_of_shape)
    : config_((config.validate(), config)), buffer_(config.resolution_rad) {
  for (const std::uint32_t link : link_of_shape) {
    auto& links = result_.links;
    const auto found = std::find_if(links.begin(), links.end(),
                                    [link](const LinkVisibility& l) { return l.link == link; });
    slot_of_shape_.push_back(static_cast<std::uint32_t>(found - links.begin()));
    if (found == links.end()) links.push_back({link, 0.0, 1.0});
  }
  order_.reserve(link_of_shape.size());
  hidden_.resize(result_.links.size());
}

const OcclusionCheck::Result& OcclusionCheck::find(const CuboidMap& map, const Body& body) {
  buffer_.begin(map.viewpoint);
  result_.cuboids.clear();
  result_.cuboids.reserve(map.cuboids.capacity());
  drawFromNearToFar(map.viewpoint, body);
  for (std::uint32_t k = 0; k < map.cuboids.size(); ++k) {
    const auto silhouette = buffer_.silhouette(map, k);
    if (silhouette && buffer_.cover(*silhouette, config_.margin_m)) result_.cuboids.push_back(k);
  }
  countPixels();
  for (std::size_t i = 0; i < result_.links.size(); ++i) {
    LinkVisibility& link = result_.links[i];
    link.visible_fraction = link.silhouette > 0.0 ? 1.0 - hidden_[i] / link.silhouette : 1.0;
  }
  return result_;
}

void OcclusionCheck::countPixels() {
  std::fill(hidden_.begin(), hidden_.end(), 0.0);
  for (LinkVisibility& link : result_.links) link.silhouette = 0.0;
  // Pixels of a primitive mostly follow one another.
  const std::vector<std::uint32_t>& drawn = buffer_.drawn();
  for (std::size_t k = 0; k < drawn.size();) {
    const std::uint32_t shape = buffer_.pixelAt(drawn[k]).shape;
    double shown = 0.0, hidden = 0.0;
    for (; k < drawn.size() && buffer_.pixelAt(drawn[k]).shape == shape; ++k) {
      const double weight = buffer_.weightAt(drawn[k]);
      shown += weight;
      if (buffer_.pixelAt(drawn[k]).covered) hidden += weight;
    }
    result_.links[slot_of_shape_[shape]].silhouette += shown;
    hidden_[slot_of_shape_[shape]] += hidden;
  }
}

/// What is hidden already need not be drawn.
void OcclusionCheck::drawFromNearToFar(const Vector3& viewpoint, const Body& body) {
  order_.clear();
  for (std::uint32_t i = 0; i < body.shapes.size(); ++i) {
    order_.push_back({distance(body.shapes[i], body.poses[i].inverse() * viewpoint), i});
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [metres, i] : order_) buffer_.draw(body.shapes[i], body.poses[i], i);
}

bool OcclusionCheck::isOccluded(const LinkVisibility& link) const {
  return link.silhouette >= config_.silhouette_min_pixels &&
         1.0 - link.visible_fraction >= config_.hidden_fraction;
}

const LinkVisibility* OcclusionCheck::Result::worst() const {
  const auto least = std::min_element(links.begin(), links.end(), [](const auto& a, const auto& b) {
    return a.visible_fraction < b.visible_fraction;
  });
  return least == links.end() ? nullptr : &*least;
}

}  // namespace tccm
