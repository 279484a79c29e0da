#include "check/occlusion_check.h"

#include "check/situation.h"

namespace tccm {
namespace {

constexpr double kMoreVisible = 0.02;  // of a silhouette: the link comes out of its hiding place
constexpr int kWeightBits = 40;        // of the weight of a pixel at the horizon

/// NaN is not.
bool isSame(const Pose& one, const Pose& other) { return one.matrix() == other.matrix(); }

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
  for (int row = 0; row < buffer_.grid().rows(); ++row) {
    weight_of_row_.push_back(std::llround(std::ldexp(buffer_.grid().cosine(row), kWeightBits)));
  }
}

void OcclusionCheck::find(const Surroundings& around, const Body& body, PoseFindings& findings,
                          const Body* ahead, PoseFindings* ahead_findings) {
  for (PoseFindings* each : {&findings, ahead_findings}) {
    if (!each) continue;
    each->occluding_cuboids.clear();
    each->occluding_cuboids.reserve(around.size() * around.map.cuboids.capacity());
    each->links = links_;
  }
  for (const SensorView& view : around) {
    const bool is_first = view.map == around.begin()->map;
    const LookImage& looks = view.map->looks;
    const Question question = questionOf(*view.map, around.map.stamp);
    buffer_.begin(looks.empty() ? view.map->viewpoint : looks.viewpoint());
    draw(body, ahead, true);
    still_.assign(links_.size(), Tally());
    askSince({}, question, still_);
    const ZBuffer::Mark still = buffer_.mark();
    tallies_ = still_;
    if (ahead) {
      draw(*ahead, &body, false);
      askSince(still, question, tallies_);
      add(around.map, is_first, *ahead_findings);
      buffer_.takeBack(still);
      draw(body, ahead, false);
      tallies_ = still_;
      askSince(still, question, tallies_);
    }
    add(around.map, is_first, findings);
  }
  finish(around, findings);
  if (ahead) finish(around, *ahead_findings);
}

void OcclusionCheck::add(const CuboidMap& all, bool is_first, PoseFindings& findings) {
  if (is_first) {
    sumUp(all, findings.links, findings.occluding_cuboids);
    return;
  }
  other_ = links_;
  sumUp(all, other_, findings.occluding_cuboids);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    findings.links[i] = ofBoth(findings.links[i], other_[i]);
  }
}

void OcclusionCheck::finish(const Surroundings& around, PoseFindings& findings) const {
  if (around.size() > 1) {
    std::vector<std::uint32_t>& hiding = findings.occluding_cuboids;
    std::sort(hiding.begin(), hiding.end());
    hiding.erase(std::unique(hiding.begin(), hiding.end()), hiding.end());
  }
  findings.occlusion = std::any_of(findings.links.begin(), findings.links.end(),
                                   [this](const LinkVisibility& link) { return isOccluded(link); });
}

OcclusionCheck::Question OcclusionCheck::questionOf(const CuboidMap& map, Time newest) const {
  const Duration old = fromSeconds(old_periods_ * toSeconds(map.look_period));
  const bool ages_matter = old > Duration::zero();  // else no period is known yet
  return {map.looks, ages_matter ? map.looks.ticksAt(newest - old) : 0,
          map.looks.grid().rows() == buffer_.grid().rows(), static_cast<float>(config_.margin_m)};
}

/// As LookImage::at(), without its stamps.
inline ZBuffer::Sight OcclusionCheck::Question::of(const LookImage::Passes& passes,
                                                   float depth) const {
  const float least_mm = 1e3F * (depth - margin_m);
  for (const LookImage::Pass& pass : passes) {
    if (pass.end == Seen::kNever || pass.last < oldest) break;
    if (pass.end == Seen::kUnclear) continue;
    if (static_cast<float>(pass.range_mm) >= least_mm) return ZBuffer::Sight::kVisible;
    if (pass.end != Seen::kRobot) return ZBuffer::Sight::kOccluded;
  }
  return ZBuffer::Sight::kUnseen;
}

std::size_t OcclusionCheck::lookPixel(const Question& question, std::uint32_t pixel) const {
  if (question.same_grid) return pixel;
  return question.looks.grid().pixelOf(buffer_.grid().middle(pixel));
}

void OcclusionCheck::askSince(const ZBuffer::Mark& mark, const Question& question,
                              std::vector<Tally>& tallies) {
  // Copies, so that what is asked for each pixel stays in registers.
  const Question asked = question;
  const LookImage::Passes* passes = &asked.looks.passes(0);
  const float* depths = buffer_.depths();
  ZBuffer::Shown* shown = buffer_.editShown();
  for (std::size_t i = mark.runs; i < buffer_.runs().size(); ++i) {
    const auto [row, begin, end] = buffer_.runs()[i];
    const Weight weight = weight_of_row_[static_cast<std::size_t>(row)];
    for (std::uint32_t pixel = begin; pixel < end;) {
      // Mostly one primitive shows all along, and is visible.
      const std::uint32_t first = pixel, shape = shown[pixel].shape;
      Tally& tally = tallies[slot_of_shape_[shape]];
      for (; pixel < end && shown[pixel].shape == shape; ++pixel) {
        const std::size_t look_pixel = asked.same_grid ? pixel : lookPixel(asked, pixel);
        const ZBuffer::Sight sight = asked.of(passes[look_pixel], depths[pixel]);
        shown[pixel].sight = sight;
        if (sight != ZBuffer::Sight::kVisible) tally.addHidden(sight, weight);
      }
      tally.all += weight * static_cast<Weight>(pixel - first);
    }
  }
  const std::vector<ZBuffer::Hidden>& hidden = buffer_.hidden();
  for (std::size_t i = mark.hidden; i < hidden.size(); ++i) {
    const auto& [pixel, before] = hidden[i];
    if (before.sight == ZBuffer::Sight::kNotAsked) continue;
    // It counted; now what was drawn over it does.
    const Weight weight = weightOf(pixel);
    tallies[slot_of_shape_[before.shape]].add(before.sight, -weight);
    shown[pixel].sight = asked.of(passes[lookPixel(asked, pixel)], depths[pixel]);
    tallies[slot_of_shape_[shown[pixel].shape]].add(shown[pixel].sight, weight);
  }
}

OcclusionCheck::Weight OcclusionCheck::weightOf(std::uint32_t pixel) const {
  return weight_of_row_[static_cast<std::size_t>(buffer_.grid().rowOfPixel(pixel))];
}

void OcclusionCheck::sumUp(const CuboidMap& all, std::vector<LinkVisibility>& links,
                           std::vector<std::uint32_t>& hiding) {
  const bool all_visible = std::all_of(tallies_.begin(), tallies_.end(), [](const Tally& tally) {
    return tally.occluded == 0 && tally.unseen == 0;
  });
  if (!all_visible) buffer_.coverBy(all, config_.margin_m, hiding);
  for (const std::uint32_t index : buffer_.covered()) {
    const ZBuffer::Shown shown = buffer_.pixelAt(index);
    if (shown.sight != ZBuffer::Sight::kUnseen) continue;
    Tally& tally = tallies_[slot_of_shape_[shown.shape]];
    tally.unseen -= weightOf(index);
    tally.occluded += weightOf(index);
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    LinkVisibility& link = links[i];
    const auto whole = static_cast<double>(tallies_[i].all);
    link.silhouette = std::ldexp(whole, -kWeightBits);
    if (whole > 0.0) {
      link.occluded_fraction = static_cast<double>(tallies_[i].occluded) / whole;
      link.unseen_fraction = static_cast<double>(tallies_[i].unseen) / whole;
    }
    link.visible_fraction = std::max(0.0, 1.0 - link.occluded_fraction - link.unseen_fraction);
  }
}

/// From near to far: what is hidden already need not be drawn.
void OcclusionCheck::draw(const Body& body, const Body* other, bool stands) {
  order_.clear();
  for (std::uint32_t i = 0; i < body.shapes.size(); ++i) {
    if ((!other || isSame(body.poses[i], other->poses[i])) != stands) continue;
    order_.push_back({distance(body.shapes[i], body.poses[i].inverse() * buffer_.viewpoint()), i});
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [nearest, i] : order_) buffer_.draw(body.shapes[i], body.poses[i], i);
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
