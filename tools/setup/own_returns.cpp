#include "own_returns.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "geometry/point_distance.h"
#include "scan/scan_assembler.h"
#include "tools/robot_picture.h"

namespace tccm {
namespace {

constexpr std::size_t kPointsOfScan = 2000;
constexpr std::size_t kPointsDrawn = 20000;
constexpr std::size_t kPointsMin = 200;  // of a link
constexpr double kSurface = 0.02;        // [m]: a surface that is where the model has it
constexpr double kSurfaceShareMin = 0.2;
constexpr double kApartShareMin = 0.8;  // around the median: one surface, and no clutter
constexpr double kGapShare = 0.002;     // a bin with less of what lies further in is empty

/// The least distance of a point that may lie further or nearer on its beam.
double nearestOnBeam(const Shape& shape, const Pose& T_shape_fixed, const Vector3& p,
                     const Vector3& beam) {
  constexpr double kStep = 0.01;  // [m]
  const double tolerance_m = BodyFilter().range_tolerance_m;
  double least_m = OwnReturns::kNear;
  for (double along = -tolerance_m; along <= tolerance_m + 1e-9; along += kStep) {
    least_m = std::min(least_m,
                       std::visit(PointDistance{T_shape_fixed * Vector3(p + along * beam)}, shape));
  }
  return least_m;
}

}  // namespace

OwnReturns::OwnReturns(std::shared_ptr<const RobotModel> model)
    : model_(std::move(model)), histograms_(model_->links().size()) {}

void OwnReturns::add(const ScanReturns& returns, const std::vector<Pose>& T_fixed_shapes,
                     double lowest_m) {
  T_fixed_shapes_ = T_fixed_shapes;
  const std::vector<LinkShape>& shapes = model_->shapes();
  std::vector<Pose> T_shapes_fixed;
  std::vector<UprightBox> around;
  const Vector3 near = Vector3::Constant(kNear);
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    T_shapes_fixed.push_back(T_fixed_shapes[s].inverse());
    const UprightBox box = bounds(shapes[s].shape, T_fixed_shapes[s]);
    around.emplace_back(box.min() - near, box.max() + near);
  }
  const std::size_t step = returns.points.size() / kPointsOfScan + 1;
  for (std::size_t i = 0; i < returns.points.size(); i += step) {
    const Vector3& p = returns.points[i];
    if (p.z() < lowest_m) continue;
    const Vector3 beam = (p - returns.viewpoint).normalized();
    Outside least{kNear, kNear};
    std::size_t nearest = shapes.size();
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (!around[s].contains(p)) continue;
      const double exact_m = std::visit(PointDistance{T_shapes_fixed[s] * p}, shapes[s].shape);
      if (exact_m >= least.exact_m) continue;
      least.exact_m = exact_m;
      nearest = s;
    }
    if (nearest == shapes.size()) continue;
    least.with_noise_m = nearestOnBeam(shapes[nearest].shape, T_shapes_fixed[nearest], p, beam);
    Histograms& histograms = histograms_[shapes[nearest].link];
    ++histograms.exact[binOf(least.exact_m)];
    ++histograms.with_noise[binOf(least.with_noise_m)];
    if (least.exact_m == 0.0 || points_.size() == kPointsDrawn) continue;
    points_.push_back({nearest, T_shapes_fixed[nearest] * p, least.exact_m});
  }
}

std::vector<OwnReturns::OfLink> OwnReturns::links() const {
  std::vector<OfLink> links;
  for (std::size_t i = 0; i < histograms_.size(); ++i) {
    auto judged = judge(histograms_[i]);
    if (!judged) continue;
    judged->link = model_->links()[i];
    links.push_back(*judged);
  }
  return links;
}

std::size_t OwnReturns::binOf(double outside_m) {
  return std::min(static_cast<std::size_t>(outside_m / kBin), kBins - 1);
}

std::optional<OwnReturns::OfLink> OwnReturns::judge(const Histograms& histograms) {
  const Histogram& exact = histograms.exact;
  const auto sumOf = [](const Histogram& histogram, std::size_t from, std::size_t to) {
    return std::accumulate(histogram.begin() + static_cast<std::ptrdiff_t>(from),
                           histogram.begin() + static_cast<std::ptrdiff_t>(std::min(to, kBins)),
                           std::size_t{0});
  };
  OfLink link;
  const auto sum = [&](std::size_t from, std::size_t to) { return sumOf(exact, from, to); };
  link.points = sum(0, kBins);
  if (link.points < kPointsMin) return std::nullopt;
  const auto all = static_cast<double>(link.points);
  constexpr auto kSurfaceBins = static_cast<std::size_t>(kSurface / kBin);
  std::size_t median = 0;
  while (2 * sum(0, median + 1) < link.points) ++median;
  link.median_m = (static_cast<double>(median) + 0.5) * kBin;
  if (static_cast<double>(sum(0, kSurfaceBins)) < kSurfaceShareMin * all) {
    const std::size_t from = median - std::min(median, kSurfaceBins);
    const std::size_t to = median + kSurfaceBins + 1;
    if (static_cast<double>(sum(from, to)) < kApartShareMin * all || to > kBins)
      return std::nullopt;
    link.is_apart = true;
    link.reach_m = static_cast<double>(to) * kBin;
    return link;
  }
  const Histogram& with_noise = histograms.with_noise;
  for (std::size_t end = 1; end < kBins; ++end) {
    const auto within = static_cast<double>(sumOf(with_noise, 0, end));
    if (static_cast<double>(with_noise[end]) > kGapShare * within) continue;
    link.reach_m = static_cast<double>(end) * kBin;
    return link;
  }
  return std::nullopt;
}

void drawOwnReturns(const RobotModel& model, const OwnReturns& own, const std::string& picture) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const OwnReturns::Point& point : own.points()) {
    const Vector3 p = own.shapePoses()[point.shape] * point.p_shape;  // arms may have moved since
    points.push_back({p.x(), p.y(), p.z(), point.outside_m});
  }
  drawPrimitives({{"robot", model.name()},
                  {"title", model.name() + ": what was measured near its model, and outside of it"},
                  {"meshes", nlohmann::ordered_json::array()},
                  {"primitives", primitivesJson(model, own.shapePoses())},
                  {"points", points}},
                 picture);
}

}  // namespace tccm
