#include "check/occlusion_check.h"

#include "check/situation.h"

namespace tccm {
namespace {

constexpr double kMoreVisible = 0.02;  // of a silhouette: the link comes out of its hiding place

/// Whether what the robot does uncovers every link that is hidden now, and hides no other.
bool comesOut(const Situation& situation) {
  // The links are the same at both poses.
  for (std::size_t i = 0; i < situation.here.links.size(); ++i) {
    const LinkVisibility& now = situation.here.links[i];
    const LinkVisibility& then = situation.ahead.links[i];
    if (situation.check_here.isOccluded(now)) {
      if (then.occluded_fraction > now.occluded_fraction - kMoreVisible) return false;
    } else if (situation.check_here.isOccluded(then)) {
      return false;
    }
  }
  return true;
}

/// A link as two sensors see it.
LinkVisibility ofBoth(const LinkVisibility& one, const LinkVisibility& other) {
  LinkVisibility both = one.visible_fraction >= other.visible_fraction ? one : other;
  both.occluded_fraction = std::min(1.0 - both.visible_fraction,
                                    std::max(one.occluded_fraction, other.occluded_fraction));
  both.unseen_fraction = std::max(0.0, 1.0 - both.visible_fraction - both.occluded_fraction);
  return both;
}

}  // namespace

void OcclusionCheck::Config::describe(ParameterTable& table) {
  table.add("occlusion_resolution_rad", &resolution_rad, "rad", {0.002, 0.2},
            "edge of a pixel of the Z-buffer; finer than the scans are is of no use");
  table.add("occlusion_margin_m", &margin_m, "m", {0.0, 1.0},
            "a cuboid hides only what lies behind it by more");
  table.add("occlusion_hidden_fraction", &hidden_fraction, "", {0.01, 1.0},
            "a link is occluded from this hidden share of its silhouette on", Tunable::kYes);
  table.add("occlusion_silhouette_min_pixels", &silhouette_min_pixels, "pixels", {0.0, 1000.0},
            "a smaller silhouette is not judged");
  table.add("occlusion_stops", &stops, "a hidden link stops the robot; `false`: it slows it down",
            Tunable::kYes);
  table.add("occlusion_slow_scale", &slow_scale, "", {0.0, 1.0}, "to this speed scale");
}

OcclusionCheck::OcclusionCheck(const Config& config,
                               const std::vector<std::uint32_t>& link_of_shape, double old_periods)
    : config_(validated(config)), old_periods_(old_periods), buffer_(config.resolution_rad) {
  for (const std::uint32_t link : link_of_shape) slot_of_shape_.push_back(entryOf(link, links_));
  order_.reserve(link_of_shape.size());
}

void OcclusionCheck::find(const Surroundings& around, const Body& body, PoseFindings& findings,
                          const OcclusionCheck* like, const Body* like_body) {
  std::vector<std::uint32_t>& hiding = findings.occluding_cuboids;
  hiding.clear();
  hiding.reserve(around.size() * around.map.cuboids.capacity());
  findings.links = links_;
  for (const SensorView& view : around) {
    const bool is_first = view.map == around.begin()->map;
    const LookImage& looks = view.map->looks;
    drawFromNearToFar(looks.empty() ? view.map->viewpoint : looks.viewpoint(), body, like,
                      like_body);
    lookFrom(*view.map, around.map, is_first ? findings.links : other_, hiding);
    if (is_first) continue;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      findings.links[i] = ofBoth(findings.links[i], other_[i]);
    }
  }
  if (around.size() > 1) {
    std::sort(hiding.begin(), hiding.end());
    hiding.erase(std::unique(hiding.begin(), hiding.end()), hiding.end());
  }
  findings.occlusion = std::any_of(findings.links.begin(), findings.links.end(),
                                   [this](const LinkVisibility& link) { return isOccluded(link); });
}

void OcclusionCheck::lookFrom(const CuboidMap& sensor, const CuboidMap& all,
                              std::vector<LinkVisibility>& links,
                              std::vector<std::uint32_t>& hiding) {
  links = links_;
  askLooks(sensor, all.stamp, links);
  buffer_.coverBy(all, config_.margin_m, hiding);
  sumUp(links);
}

/// As LookImage::at(), without its stamps.
OcclusionCheck::PixelSight OcclusionCheck::sightOf(const LookImage::Passes& passes, float depth,
                                                   LookImage::Ticks oldest) const {
  const float least_mm = 1e3F * (depth - static_cast<float>(config_.margin_m));
  for (const LookImage::Pass& pass : passes) {
    if (pass.end == Seen::kNever || pass.last < oldest) break;
    if (pass.end == Seen::kUnclear) continue;
    if (static_cast<float>(pass.range_mm) >= least_mm) return PixelSight::kVisible;
    if (pass.end != Seen::kRobot) return PixelSight::kOccluded;
  }
  return PixelSight::kUnseen;
}

void OcclusionCheck::askLooks(const CuboidMap& map, Time newest,
                              std::vector<LinkVisibility>& links) {
  const LookImage& looks = map.looks;
  const Duration old = fromSeconds(old_periods_ * toSeconds(map.look_period));
  const bool ages_matter = old > Duration::zero();  // else no period is known yet
  const LookImage::Ticks oldest = ages_matter ? looks.ticksAt(newest - old) : 0;
  const bool same_grid = looks.grid().rows() == buffer_.grid().rows();
  not_visible_.clear();
  not_visible_.reserve(buffer_.grid().pixels());
  const std::vector<std::uint32_t>& drawn = buffer_.drawn();
  for (std::size_t i = 0; i < drawn.size();) {
    // The pixels of a primitive mostly follow one another: the sum stays in a register.
    const std::uint32_t shape = buffer_.pixelAt(drawn[i]).shape;
    LinkVisibility& link = links[slot_of_shape_[shape]];
    double silhouette = link.silhouette;
    for (; i < drawn.size() && buffer_.pixelAt(drawn[i]).shape == shape; ++i) {
      const std::uint32_t pixel = drawn[i];
      silhouette += weightOf(pixel);
      const std::size_t look_pixel =
          same_grid ? pixel : looks.grid().pixelOf(buffer_.grid().middle(pixel));
      const PixelSight sight =
          sightOf(looks.passes(look_pixel), buffer_.pixelAt(pixel).depth, oldest);
      if (sight == PixelSight::kVisible) {
        buffer_.markSeen(pixel);
      } else {
        not_visible_.push_back({pixel, sight});
      }
    }
    link.silhouette = silhouette;
  }
}

/// Solid angle of a pixel, relative to one at the horizon.
double OcclusionCheck::weightOf(std::uint32_t pixel) const {
  return buffer_.grid().cosine(buffer_.grid().rowOfPixel(pixel));
}

void OcclusionCheck::sumUp(std::vector<LinkVisibility>& links) const {
  for (const auto& [pixel, sight] : not_visible_) {
    const ZBuffer::Pixel& drawn = buffer_.pixelAt(pixel);
    LinkVisibility& link = links[slot_of_shape_[drawn.shape]];
    const bool is_occluded = sight == PixelSight::kOccluded || drawn.covered;
    (is_occluded ? link.occluded_fraction : link.unseen_fraction) += weightOf(pixel);
  }
  for (LinkVisibility& link : links) {
    if (link.silhouette > 0.0) {
      link.occluded_fraction /= link.silhouette;
      link.unseen_fraction /= link.silhouette;
    }
    link.visible_fraction = std::max(0.0, 1.0 - link.occluded_fraction - link.unseen_fraction);
  }
}

/// What is hidden already need not be drawn.
void OcclusionCheck::drawFromNearToFar(const Vector3& viewpoint, const Body& body,
                                       const OcclusionCheck* like, const Body* like_body) {
  order_.clear();
  for (std::uint32_t i = 0; i < body.shapes.size(); ++i) {
    order_.push_back({distance(body.shapes[i], body.poses[i].inverse() * viewpoint), i});
  }
  std::sort(order_.begin(), order_.end());
  std::size_t same = 0;
  if (like && like->buffer_.viewpoint() == viewpoint && like->order_.size() == order_.size()) {
    const auto isSame = [&](std::size_t k) {
      const std::uint32_t i = order_[k].second;
      return like->order_[k].second == i && like_body->poses[i].matrix() == body.poses[i].matrix();
    };
    while (same < order_.size() && isSame(same)) ++same;
  }
  if (same > 0) {
    buffer_.beginAs(like->buffer_, same);
  } else {
    buffer_.begin(viewpoint);
  }
  for (std::size_t k = same; k < order_.size(); ++k) {
    const std::uint32_t i = order_[k].second;
    buffer_.draw(body.shapes[i], body.poses[i], i);
  }
}

bool OcclusionCheck::isOccluded(const LinkVisibility& link) const {
  return link.silhouette >= config_.silhouette_min_pixels &&
         link.occluded_fraction >= config_.hidden_fraction;
}

void judgeOcclusion(const Situation& situation, const OcclusionCheck::Config& config,
                    double moving_out_scale, std::vector<Cause>& causes) {
  if (!situation.here.occlusion && !situation.ahead.occlusion) return;
  const bool ahead = !situation.here.occlusion;
  const std::string link =
      situation.check_here.mostHiddenLink(ahead ? situation.ahead : situation.here);
  if (!ahead && comesOut(situation)) {
    causes.push_back(Cause::slowing(Reason::kMovingOut, moving_out_scale,
                                    link + " comes out of where it is hidden", link));
    return;
  }
  const Reason reason = ahead ? Reason::kOcclusionAhead : Reason::kOcclusion;
  const std::string text = link + " is hidden from the sensor" + (ahead ? " ahead" : "");
  causes.push_back(config.stops ? Cause::stopping(reason, text, link)
                                : Cause::slowing(reason, config.slow_scale, text, link));
}

}  // namespace tccm
