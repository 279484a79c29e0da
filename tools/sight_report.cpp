// What the sensor did not see: its section of the summary, and the dump of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "report.h"
#include "report_figures.h"

namespace tccm {
namespace {

using Json = nlohmann::ordered_json;

Json meanOf(double sum, std::size_t count) {
  if (count == 0) return nullptr;
  return rounded(sum / static_cast<double>(count));
}

Json byReason(const std::map<Reason, std::size_t>& counts, std::size_t checks) {
  Json fractions = Json::object();
  for (const auto& [reason, count] : counts) fractions[name(reason)] = fraction(count, checks);
  return fractions;
}

/// With six decimals; empty where it is not known.
std::string textOf(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.6f", *value);
  return text;
}

/// What a line says of a link: of its silhouette, and of its way.
struct Sight {
  const LinkVisibility* silhouette = nullptr;
  const LinkEvidence* way = nullptr;
};

void dumpLine(const Verdict& verdict, const std::string& link, bool ahead, const Sight& sight,
              CsvFile& file) {
  std::string figures;
  const auto add = [&figures](std::optional<double> value) { figures += "," + textOf(value); };
  const LinkVisibility* silhouette = sight.silhouette;
  add(silhouette ? std::optional(silhouette->visible_fraction) : std::nullopt);
  add(silhouette ? std::optional(silhouette->occluded_fraction) : std::nullopt);
  add(silhouette ? std::optional(silhouette->unseen_fraction) : std::nullopt);
  add(sight.way ? std::optional(sight.way->unseen_fraction) : std::nullopt);
  add(sight.way ? sight.way->age_s : std::nullopt);
  add(sight.way ? sight.way->next_look_s : std::nullopt);
  file.line("%s,%u,%s,%d%s", stampText(verdict.stamp).c_str(), verdict.serial, link.c_str(), ahead,
            figures.c_str());
}

}  // namespace

Json sightOf(const Totals& totals, const CuboidMap* newest) {
  const SightTotals& sight = totals.sight;
  const bool any_age = sight.ages > 0;
  return {{"held",
           {{"mean", meanOf(static_cast<double>(sight.held_sum), totals.scans_mapped)},
            {"max", totals.scans_mapped > 0 ? Json(sight.held_max) : Json(nullptr)},
            {"last", newest ? Json(heldIn(*newest)) : Json(nullptr)}}},
          {"unseen_fraction",
           {{"mean", meanOf(sight.unseen_sum, sight.checks)},
            {"above_max", fraction(sight.unseen_above, sight.checks)}}},
          {"evidence_age_s",
           {{"mean", meanOf(sight.age_sum_s, sight.ages)},
            {"max", any_age ? Json(rounded(sight.age_max_s)) : Json(nullptr)}}},
          {"governed_scale",
           {{"mean", meanOf(sight.governed_sum, sight.checks)},
            {"min", sight.checks > 0 ? Json(rounded(sight.governed_min)) : Json(nullptr)}}},
          {"slow_by_reason", byReason(totals.slow_reasons, totals.checks)},
          {"stop_by_reason", byReason(totals.stop_reasons, totals.checks)}};
}

void dumpVisibility(const Verdict& verdict, const Checker& checker, CsvFile& file) {
  if (!verdict.placed) return;
  const std::vector<std::string>& names = checker.model()->links();
  const std::vector<LinkEvidence>& ways = checker.evidence().findings().links;
  const auto wayOf = [&ways](std::size_t link) -> const LinkEvidence* {
    for (const LinkEvidence& way : ways) {
      if (way.link == link) return &way;
    }
    return nullptr;
  };
  const auto isDrawn = [&verdict](std::size_t link) {
    const auto& links = verdict.now.links;
    return std::any_of(links.begin(), links.end(),
                       [link](const LinkVisibility& other) { return other.link == link; });
  };
  for (const LinkVisibility& link : verdict.now.links) {
    dumpLine(verdict, names[link.link], false, {&link, wayOf(link.link)}, file);
  }
  for (const LinkEvidence& way : ways) {
    if (!isDrawn(way.link)) dumpLine(verdict, names[way.link], false, {nullptr, &way}, file);
  }
  for (const LinkVisibility& link : verdict.ahead.links) {
    dumpLine(verdict, names[link.link], true, {&link, nullptr}, file);
  }
}

}  // namespace tccm
