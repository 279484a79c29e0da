#include "fit/mesh_partition.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>

#include "fit/enclosing.h"
#include "fit/points.h"

namespace tccm {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSpareParts = 3;  // cut finer than asked for, then joined again
constexpr int kSpreadCuts = 9;          // slices of a part, at least
using Points = std::vector<Vector3>;

Points thinned(const Points& points) {
  static const std::vector<Vector3> kDirections = hemisphereDirections(80);
  return extremePoints(points, kDirections);
}

Points together(const Points& a, const Points& b) {
  Points both = a;
  both.insert(both.end(), b.begin(), b.end());
  return thinned(both);
}

struct Split {
  Plane plane;
  double volume_m3 = kInfinity;  ///< of both sides, roughly
};

/// A part of the mesh, with what was found out about it.
struct Piece {
  MeshPart mesh;
  Points extreme;
  double volume_m3;  ///< of a primitive around it, roughly
  std::optional<Split> split;
};

/// Pieces are shared between partitions.
using Pieces = std::vector<std::shared_ptr<Piece>>;

double totalVolume(const Pieces& pieces) {
  return std::accumulate(pieces.begin(), pieces.end(), 0.0,
                         [](double sum, const auto& piece) { return sum + piece->volume_m3; });
}

/// The lowest and the highest.
std::pair<double, double> rangeAlong(const Vector3& direction, const Points& points) {
  std::pair<double, double> range(kInfinity, -kInfinity);
  for (const Vector3& p : points) {
    range.first = std::min(range.first, direction.dot(p));
    range.second = std::max(range.second, direction.dot(p));
  }
  return range;
}

/// Heights to cut at, rising: evenly spread, and beside the largest faces that are parallel to the
/// cut.
std::vector<double> cutHeights(const MeshPart& mesh, const Vector3& normal) {
  constexpr std::size_t kLedges = 4;
  const auto [low, high] = rangeAlong(normal, mesh.vertices());
  const double aside = 1e-4 * (high - low);
  std::vector<std::pair<double, double>> ledges;  // area, height
  for (const auto& [height, area] : mesh.ledges(normal)) {
    if (ledges.empty() || height > ledges.back().second + aside) ledges.emplace_back(0.0, height);
    ledges.back().first += area;
  }
  std::stable_sort(ledges.begin(), ledges.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  ledges.resize(std::min(kLedges, ledges.size()));

  std::vector<double> heights;
  const auto add = [&heights, lowest = low, highest = high](double height) {
    if (height > lowest && height < highest) heights.push_back(height);
  };
  for (int i = 1; i < kSpreadCuts; ++i) add(low + (high - low) * i / kSpreadCuts);
  for (const auto& ledge : ledges) {
    add(ledge.second - aside);
    add(ledge.second + 2.0 * aside);
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

/// Tried for the axes of primitives and as normals of cuts.
std::vector<Vector3> likelyAxes(const Points& extreme) {
  constexpr double kLeastAngle = 0.1;  // [rad]
  std::vector<Vector3> axes;
  const PlacedShape box = enclosingBox(extreme);
  for (int i = 0; i < 3; ++i) axes.emplace_back(box.pose.linear().col(i));
  for (int i = 0; i < 3; ++i) addIfDifferent(axes, Vector3::Unit(i), kLeastAngle);
  const Eigen::Matrix3d principal = principalAxes(extreme);
  for (int i = 0; i < 3; ++i) addIfDifferent(axes, principal.col(i), kLeastAngle);
  return axes;
}

/// A part cut along a direction at rising heights, and the slices between them, thinned.
std::pair<std::vector<double>, std::vector<Points>> slicesAlong(const MeshPart& mesh,
                                                                const Vector3& normal) {
  const std::vector<double> heights = cutHeights(mesh, normal);
  std::vector<Points> slices = mesh.slices(normal, heights);
  std::transform(slices.begin(), slices.end(), slices.begin(), thinned);
  return {heights, slices};
}

/// Several parallel cuts, the topmost first.
struct ParallelCuts {
  std::vector<Plane> planes;
  double volume_m3 = kInfinity;
};

/// The best cuts along one direction: with the last cut below slice i, the rest is the same
/// question with one cut less for the slices before i.
/// @param runs [i][j]: the volume around the slices from i to before j
void improve(std::vector<ParallelCuts>& best, const Vector3& normal,
             const std::vector<double>& heights, const std::vector<std::vector<double>>& runs) {
  const std::size_t count = runs.size();
  std::vector<double> least(runs.front());               // for the slices before j, without a cut
  std::vector<std::vector<std::size_t>> last_cut_below;  // by the number of cuts, then j
  for (ParallelCuts& cuts : best) {
    std::vector<double> next(count + 1, kInfinity);
    last_cut_below.emplace_back(count + 1, 0);
    for (std::size_t j = 2; j <= count; ++j) {
      for (std::size_t i = 1; i < j; ++i) {
        const double total = least[i] + runs[i][j];
        if (total >= next[j]) continue;
        next[j] = total;
        last_cut_below.back()[j] = i;
      }
    }
    least = next;
    if (least[count] >= cuts.volume_m3) continue;
    cuts = {{}, least[count]};
    std::size_t j = count;
    for (auto below = last_cut_below.rbegin(); below != last_cut_below.rend(); ++below) {
      j = (*below)[j];
      cuts.planes.push_back({normal, heights[j - 1]});
    }
  }
}

class Cutter {
 public:
  explicit Cutter(const Mesh& mesh) : whole_(mesh), axes_(likelyAxes(thinned(whole_.vertices()))) {}

  [[nodiscard]] Pieces whole() const { return {piece(whole_)}; }

  /// Cuts the piece in two that gains most. False where none gains.
  bool cutFurther(Pieces& pieces) const {
    constexpr double kLeastGain = 0.01;  // of the volume
    double most = kLeastGain * totalVolume(pieces);
    std::shared_ptr<Piece>* chosen = nullptr;
    for (std::shared_ptr<Piece>& piece : pieces) {
      if (!piece->split) piece->split = bestSplit(piece->mesh);
      const double gain = piece->volume_m3 - piece->split->volume_m3;
      if (gain <= most) continue;
      most = gain;
      chosen = &piece;
    }
    if (!chosen) return false;
    auto [below, above] = (*chosen)->mesh.cut((*chosen)->split->plane);
    *chosen = piece(std::move(below));
    pieces.push_back(piece(std::move(above)));
    return true;
  }

  /// Joins the two pieces that lose least by it.
  void joinTwo(Pieces& pieces) const {
    std::size_t first = 0;
    std::size_t second = 1;
    double least = kInfinity;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (std::size_t j = i + 1; j < pieces.size(); ++j) {
        const double joined = roughVolume(together(pieces[i]->extreme, pieces[j]->extreme));
        const double loss = joined - pieces[i]->volume_m3 - pieces[j]->volume_m3;
        if (loss >= least) continue;
        least = loss;
        first = i;
        second = j;
      }
    }
    pieces[first] = piece(MeshPart::joined(pieces[first]->mesh, pieces[second]->mesh));
    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(second));
  }

  /// Element i: i + 1 parallel cuts that leave the smallest primitives.
  [[nodiscard]] std::vector<ParallelCuts> parallelCuts(std::size_t cuts_max) const {
    std::vector<ParallelCuts> best(cuts_max);
    for (const Vector3& normal : axes_) {
      const auto [heights, slices] = slicesAlong(whole_, normal);
      improve(best, normal, heights, runVolumes(slices));
    }
    return best;
  }

  [[nodiscard]] Pieces cutAlong(const ParallelCuts& cuts) const {
    Pieces pieces;
    MeshPart rest = whole_;
    for (const Plane& plane : cuts.planes) {
      auto [below, above] = rest.cut(plane);
      pieces.push_back(piece(std::move(above)));
      rest = std::move(below);
    }
    pieces.push_back(piece(std::move(rest)));
    return pieces;
  }

 private:
  /// At most the smallest primitive with one of the likely axes; 0 for no points.
  [[nodiscard]] double roughVolume(const Points& extreme) const {
    constexpr double kLeastAngle = 0.05;  // [rad]
    if (extreme.empty()) return 0.0;
    std::vector<Vector3> axes = axes_;
    const Eigen::Matrix3d principal = principalAxes(extreme);
    addIfDifferent(axes, principal.col(0), kLeastAngle);
    addIfDifferent(axes, principal.col(2), kLeastAngle);
    return enclosingVolumeAlong(extreme, axes);
  }

  [[nodiscard]] std::shared_ptr<Piece> piece(MeshPart mesh) const {
    Points extreme = thinned(mesh.vertices());
    const double rough = roughVolume(extreme);
    return std::make_shared<Piece>(Piece{std::move(mesh), std::move(extreme), rough, {}});
  }

  /// Around the first of the slices, the first two, and so on.
  template <typename Slice>
  [[nodiscard]] std::vector<double> growingVolumes(Slice slice, Slice end) const {
    std::vector<double> volumes;
    Points points;
    for (; slice != end; ++slice) {
      points = together(points, *slice);
      volumes.push_back(roughVolume(points));
    }
    return volumes;
  }

  [[nodiscard]] std::vector<std::vector<double>> runVolumes(
      const std::vector<Points>& slices) const {
    std::vector<std::vector<double>> volumes;
    for (auto first = slices.begin(); first != slices.end(); ++first) {
      const std::vector<double> growing = growingVolumes(first, slices.end());
      volumes.emplace_back(slices.size() + 1 - growing.size(), 0.0);
      volumes.back().insert(volumes.back().end(), growing.begin(), growing.end());
    }
    return volumes;
  }

  [[nodiscard]] Split bestSplit(const MeshPart& mesh) const {
    Split best;
    for (const Vector3& normal : axes_) {
      const auto [heights, slices] = slicesAlong(mesh, normal);
      const std::vector<double> below = growingVolumes(slices.begin(), slices.end() - 1);
      const std::vector<double> above = growingVolumes(slices.rbegin(), slices.rend() - 1);
      for (std::size_t i = 0; i < heights.size(); ++i) {
        const double both = below[i] + above[heights.size() - 1 - i];
        if (both < best.volume_m3) best = {{normal, heights[i]}, both};
      }
    }
    if (best.volume_m3 < kInfinity) refine(mesh, best);
    return best;
  }

  /// Moves the cut between the heights that were tried.
  void refine(const MeshPart& mesh, Split& split) const {
    const Vector3 normal = split.plane.normal;
    const auto [low, high] = rangeAlong(normal, mesh.vertices());
    const double spacing = (high - low) / kSpreadCuts;
    for (double step = 0.5 * spacing; step > 0.05 * spacing; step *= 0.5) {
      const double height = split.plane.height_m;
      for (const double moved : {height - step, height + step}) {
        if (!(moved > low && moved < high)) continue;
        const std::vector<Points> sides = mesh.slices(normal, {moved});
        const double both = roughVolume(thinned(sides[0])) + roughVolume(thinned(sides[1]));
        if (both < split.volume_m3) split = {{normal, moved}, both};
      }
    }
  }

  MeshPart whole_;
  std::vector<Vector3> axes_;
};

}  // namespace

std::vector<std::vector<MeshPart>> partitions(const Mesh& mesh, std::size_t parts_max) {
  const Cutter cutter(mesh);
  std::map<std::size_t, Pieces> found;  // by the number of parts
  const auto keepBetter = [&](const Pieces& pieces) {
    if (pieces.size() > parts_max) return;
    const auto [known, is_new] = found.emplace(pieces.size(), pieces);
    if (!is_new && totalVolume(pieces) < totalVolume(known->second)) known->second = pieces;
  };
  Pieces pieces = cutter.whole();
  keepBetter(pieces);
  if (parts_max > 1) {
    while (pieces.size() < parts_max + kSpareParts && cutter.cutFurther(pieces)) keepBetter(pieces);
    while (pieces.size() > 2) {
      cutter.joinTwo(pieces);
      keepBetter(pieces);
    }
    for (const ParallelCuts& cuts : cutter.parallelCuts(parts_max - 1)) {
      if (cuts.volume_m3 < kInfinity) keepBetter(cutter.cutAlong(cuts));
    }
  }
  std::vector<std::vector<MeshPart>> result;
  for (const auto& [count, known] : found) {
    std::vector<MeshPart>& parts = result.emplace_back();
    for (const auto& piece : known) {
      if (!piece->mesh.vertices().empty()) parts.push_back(piece->mesh);
    }
  }
  return result;
}

}  // namespace tccm
