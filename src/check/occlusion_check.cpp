#include "check/occlusion_check.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

void OcclusionCheck::Config::describe(ParameterTable& table) {
  table.add("occlusion_resolution_rad", &resolution_rad, "rad", {0.002, 0.2},
            "edge of a pixel of the Z-buffer; finer than the scans are is of no use");
  table.add("occlusion_margin_m", &margin_m, "m", {0.0, 1.0},
            "a cuboid hides only what lies behind it by more");
  table.add("occlusion_hidden_fraction", &hidden_fraction, "", {0.01, 1.0},
            "a link is occluded from this hidden share of its silhouette on", Tunable::kYes);
  table.add("occlusion_silhouette_min_pixels", &silhouette_min_pixels, "pixels", {0.0, 1000.0},
            "a smaller silhouette is not judged");
}

OcclusionCheck::OcclusionCheck(const Config& config, std::vector<std::uint32_t> link_of_shape,
                               double old_periods)
    : config_(validated(config)), old_periods_(old_periods), buffer_(config.resolution_rad) {
  for (const std::uint32_t link : link_of_shape) {
    auto& links = result_.links;
    const auto found = std::find_if(links.begin(), links.end(),
                                    [link](const LinkVisibility& l) { return l.link == link; });
    slot_of_shape_.push_back(static_cast<std::uint32_t>(found - links.begin()));
    if (found == links.end()) {
      links.emplace_back();
      links.back().link = link;
    }
  }
  order_.reserve(link_of_shape.size());
  sights_.reserve(buffer_.grid().pixels());
}

const OcclusionCheck::Result& OcclusionCheck::find(const CuboidMap& map, const Body& body) {
  const Vector3& viewpoint = map.looks.empty() ? map.viewpoint : map.looks.viewpoint();
  buffer_.begin(viewpoint);
  result_.cuboids.clear();
  result_.cuboids.reserve(map.cuboids.capacity());
  drawFromNearToFar(viewpoint, body);
  askLooks(map);
  if (buffer_.canBeCovered()) {
    for (std::uint32_t k = 0; k < map.cuboids.size(); ++k) {
      const auto silhouette = buffer_.silhouette(map, k);
      if (silhouette && buffer_.cover(*silhouette, config_.margin_m)) result_.cuboids.push_back(k);
    }
  }
  countPixels();
  return result_;
}

/// As LookImage::at(), without its stamps.
OcclusionCheck::PixelSight OcclusionCheck::sightOf(const LookImage::Passes& passes,
                                                   const ZBuffer::Pixel& drawn,
                                                   LookImage::Ticks oldest) const {
  const float least_mm = 1e3F * (drawn.depth - static_cast<float>(config_.margin_m));
  for (const LookImage::Pass& pass : passes) {
    if (pass.end == Seen::kNever || pass.last < oldest) break;
    if (pass.end == Seen::kUnclear) continue;
    if (static_cast<float>(pass.range_mm) >= least_mm) return PixelSight::kVisible;
    if (pass.end != Seen::kRobot) return PixelSight::kOccluded;
  }
  return PixelSight::kUnseen;
}

void OcclusionCheck::askLooks(const CuboidMap& map) {
  const LookImage& looks = map.looks;
  const Duration old = fromSeconds(old_periods_ * toSeconds(map.look_period));
  const bool ages_matter = old > Duration::zero();  // else no period is known yet
  const LookImage::Ticks oldest = ages_matter ? looks.ticksAt(map.stamp - old) : 0;
  const bool same_grid = looks.grid().rows() == buffer_.rows();
  sights_.clear();
  for (const std::uint32_t pixel : buffer_.drawn()) {
    const std::size_t look_pixel =
        same_grid ? pixel : looks.grid().pixelOf(buffer_.grid().middle(pixel));
    sights_.push_back(sightOf(looks.passes(look_pixel), buffer_.pixelAt(pixel), oldest));
    if (sights_.back() == PixelSight::kVisible) buffer_.markSeen(pixel);
  }
}

void OcclusionCheck::countPixels() {
  for (LinkVisibility& link : result_.links) {
    link.silhouette = link.occluded_fraction = link.unseen_fraction = 0.0;
  }
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    const std::uint32_t pixel = buffer_.drawn()[i];
    const ZBuffer::Pixel& drawn = buffer_.pixelAt(pixel);
    LinkVisibility& link = result_.links[slot_of_shape_[drawn.shape]];
    const double weight = buffer_.weightAt(pixel);
    link.silhouette += weight;
    if (sights_[i] == PixelSight::kVisible) continue;
    const bool is_occluded = sights_[i] == PixelSight::kOccluded || drawn.covered;
    (is_occluded ? link.occluded_fraction : link.unseen_fraction) += weight;
  }
  for (LinkVisibility& link : result_.links) {
    if (link.silhouette > 0.0) {
      link.occluded_fraction /= link.silhouette;
      link.unseen_fraction /= link.silhouette;
    }
    link.visible_fraction = std::max(0.0, 1.0 - link.occluded_fraction - link.unseen_fraction);
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
         link.occluded_fraction >= config_.hidden_fraction;
}

const LinkVisibility* OcclusionCheck::Result::worst() const {
  const auto most = std::max_element(links.begin(), links.end(), [](const auto& a, const auto& b) {
    return a.occluded_fraction < b.occluded_fraction;
  });
  return most == links.end() ? nullptr : &*most;
}

}  // namespace tccm
