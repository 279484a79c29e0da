#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "check/surroundings.h"
#include "check/z_buffer.h"
#include "config/parameter_table.h"
#include "tccm_monitor/cuboid_map.h"
#include "tccm_monitor/shape.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

struct Situation;

/// The index of a link's entry, made where there is none yet.
template <typename Entry>
std::size_t entryOf(std::uint32_t link, std::vector<Entry>& entries) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [link](const Entry& entry) { return entry.link == link; });
  const auto index = static_cast<std::size_t>(found - entries.begin());
  if (found == entries.end()) entries.emplace_back().link = link;
  return index;
}

/// Says which links are hidden from the sensor (paper, section IV.B): there the robot would move
/// blindly. Three answers for each direction: the newest look in it tells whether the sensor saw as
/// far as to the link, or something stood before; where the robot itself stood before, cuboids do,
/// held ones too; where there are none, or all looks are old, it is not known. Cuboids alone would
/// hide too much: they are as thick as a cell, and every pixel that they reach into counts.
class OcclusionCheck {
 public:
  struct Config {
    double resolution_rad = 0.035;
    double margin_m = 0.05;
    double hidden_fraction = 0.15;
    double silhouette_min_pixels = 2.0;
    bool stops = true;
    double slow_scale = 0.3;

    void describe(ParameterTable& table);
  };

  /// @param link_of_shape for each of the body's shapes the link it belongs to.
  /// @param old_periods looks that are older than so many tilt periods say nothing.
  /// @throws ConfigError
  OcclusionCheck(const Config& config, const std::vector<std::uint32_t>& link_of_shape,
                 double old_periods = 1.5);

  /// Of several sensors, the one that sees most of a link counts; what it does not see is hidden
  /// as far as any sensor says so.
  /// @param findings reused: the links, in the order of those handed over, the cuboids that a part
  /// of any link is hidden behind, and whether a link is occluded.
  /// @param ahead another pose of the same body: what stands where it stands here is drawn, and the
  /// looks are asked of it, for both at once.
  void find(const Surroundings& around, const Body& body, PoseFindings& findings,
            const Body* ahead = nullptr, PoseFindings* ahead_findings = nullptr);

  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const;
  /// The picture of the last find(), not of the body ahead.
  [[nodiscard]] const ZBuffer& picture() const { return buffer_; }

 private:
  /// Solid angles of pixels, in whole parts of one at the horizon: their sums are the same in any
  /// order.
  using Weight = std::int64_t;
  /// What shows of a link.
  struct Tally {
    Weight all = 0, occluded = 0, unseen = 0;

    void add(ZBuffer::Sight sight, Weight weight) {
      all += weight;
      addHidden(sight, weight);
    }
    void addHidden(ZBuffer::Sight sight, Weight weight) {
      if (sight == ZBuffer::Sight::kOccluded) occluded += weight;
      if (sight == ZBuffer::Sight::kUnseen) unseen += weight;
    }
  };
  /// What is asked of a sensor's looks.
  struct Question {
    const LookImage& looks;
    LookImage::Ticks oldest;  ///< that says something
    bool same_grid;           ///< as the picture's
    float margin_m;

    [[nodiscard]] ZBuffer::Sight of(const LookImage::Passes& passes, float depth) const;
  };

  /// Draws what stands where it stands in the other body, or all the rest. @param other null: all
  /// stands.
  void draw(const Body& body, const Body* other, bool stands);
  [[nodiscard]] Question questionOf(const CuboidMap& map, Time newest) const;
  /// The looks' pixel in the same direction.
  [[nodiscard]] std::size_t lookPixel(const Question& question, std::uint32_t pixel) const;
  [[nodiscard]] Weight weightOf(std::uint32_t pixel) const;
  /// Asks of all that was drawn since, and counts it.
  void askSince(const ZBuffer::Mark& mark, const Question& question, std::vector<Tally>& tallies);
  /// @param hiding cuboids, appended.
  void sumUp(const CuboidMap& all, std::vector<LinkVisibility>& links,
             std::vector<std::uint32_t>& hiding);
  /// What one sensor says of the picture, with what those before it said.
  void add(const CuboidMap& all, bool is_first, PoseFindings& findings);
  void finish(const Surroundings& around, PoseFindings& findings) const;

  Config config_;
  double old_periods_;
  std::vector<LinkVisibility> links_;       ///< none of which shows
  std::vector<LinkVisibility> other_;       ///< as a further sensor sees them, reused
  std::vector<std::size_t> slot_of_shape_;  ///< index into links_
  std::vector<Weight> weight_of_row_;       ///< of a pixel
  ZBuffer buffer_;
  std::vector<std::pair<double, std::uint32_t>> order_;  ///< distance of each shape, reused
  std::vector<Tally> still_, tallies_;  ///< of links_: of what stands at both poses, and of all
};

/// Whether the sensor sees the links that it should see, now and at the end of the way: where it
/// does not, the robot moves blindly. @param moving_out_scale while a hidden link comes out.
void judgeOcclusion(const Situation& situation, const OcclusionCheck::Config& config,
                    double moving_out_scale, std::vector<Cause>& causes);

}  // namespace tccm
