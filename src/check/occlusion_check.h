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
  /// @param like another of the same robot that has found, and with which body: what is drawn first
  /// and stands where it stood then is not drawn anew.
  void find(const Surroundings& around, const Body& body, PoseFindings& findings,
            const OcclusionCheck* like = nullptr, const Body* like_body = nullptr);

  [[nodiscard]] bool isOccluded(const LinkVisibility& link) const;
  /// The picture of the last find().
  [[nodiscard]] const ZBuffer& picture() const { return buffer_; }

 private:
  /// From one sensor. @param links reused. @param hiding cuboids, appended.
  void lookFrom(const CuboidMap& sensor, const CuboidMap& all, std::vector<LinkVisibility>& links,
                std::vector<std::uint32_t>& hiding);
  void drawFromNearToFar(const Vector3& viewpoint, const Body& body, const OcclusionCheck* like,
                         const Body* like_body);
  enum class PixelSight : std::uint8_t { kVisible, kOccluded, kUnseen };
  /// Counts the pixels of each link. @param newest scan of any sensor: by it looks are old, also of
  /// one that has failed.
  void askLooks(const CuboidMap& map, Time newest, std::vector<LinkVisibility>& links);
  [[nodiscard]] double weightOf(std::uint32_t pixel) const;
  void sumUp(std::vector<LinkVisibility>& links) const;
  /// Unseen: cuboids must tell.
  [[nodiscard]] PixelSight sightOf(const LookImage::Passes& passes, float depth,
                                   LookImage::Ticks oldest) const;

  Config config_;
  double old_periods_;
  std::vector<LinkVisibility> links_;       ///< none of which shows
  std::vector<LinkVisibility> other_;       ///< as a further sensor sees them, reused
  std::vector<std::size_t> slot_of_shape_;  ///< index into links_
  ZBuffer buffer_;
  std::vector<std::pair<double, std::uint32_t>> order_;  ///< distance of each shape, reused
  /// The pixels that the looks do not show, and what they say of them, reused.
  std::vector<std::pair<std::uint32_t, PixelSight>> not_visible_;
};

/// Whether the sensor sees the links that it should see, now and at the end of the way: where it
/// does not, the robot moves blindly. @param moving_out_scale while a hidden link comes out.
void judgeOcclusion(const Situation& situation, const OcclusionCheck::Config& config,
                    double moving_out_scale, std::vector<Cause>& causes);

}  // namespace tccm
