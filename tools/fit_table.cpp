#include "fit_table.h"

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

namespace tccm {
namespace {

using Row = std::vector<std::string>;

constexpr std::size_t kLineWidth = 100;

template <typename... Values>
std::string text(const char* format, Values... values) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

struct SizeText {
  std::string operator()(const Box& box) const {
    const Vector3 mm = 2e3 * box.half_extents;
    return text("%.1f x %.1f x %.1f", mm.x(), mm.y(), mm.z());
  }
  std::string operator()(const Cylinder& c) const {
    return text("radius %.1f, length %.1f", 1e3 * c.radius, 2e3 * c.half_length);
  }
  std::string operator()(const Capsule& c) const {
    return (*this)(Cylinder{c.radius, c.half_length});
  }
  std::string operator()(const Sphere& s) const { return text("radius %.1f", 1e3 * s.radius); }
};

double volumeOf(const RobotModel& model, const LinkElement& element) {
  double sum = 0.0;
  for (std::size_t i = 0; i < element.shapes; ++i) {
    sum += volume(model.shapes()[element.first_shape + i].shape);
  }
  return sum;
}

std::string ratioText(double volume, double hull) {
  return hull > 0.0 ? text("%.2f", volume / hull) : std::string("flat");
}

std::string sourceText(const LinkElement& element) {
  if (element.source != "mesh") return element.source;
  const std::size_t slash = element.uri.find_last_of('/');
  return slash == std::string::npos ? element.uri : element.uri.substr(slash + 1);
}

std::vector<Row> rowsOf(const RobotModel& model) {
  std::vector<Row> rows{
      {"link", "shape", "primitive", "size [mm]", "volume / hull", "overhang [mm]"}};
  std::string last_link;
  for (const LinkElement& element : model.elements()) {
    for (std::size_t i = 0; i < element.shapes; ++i) {
      const Shape& shape = model.shapes()[element.first_shape + i].shape;
      const std::string& link = model.links()[element.link];
      Row row{link == last_link ? "" : link,
              i == 0 ? sourceText(element) : "",
              name(shape),
              std::visit(SizeText{}, shape),
              "",
              ""};
      if (i == 0 && element.source == "mesh") {
        row[4] = ratioText(volumeOf(model, element), element.hull_volume_m3);
        row[5] = text("%.1f", 1e3 * element.overhang_m);
      }
      rows.push_back(row);
      last_link = link;
    }
  }
  return rows;
}

void print(const std::vector<Row>& rows, std::ostream& out) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

}  // namespace

FitTotals totalsOf(const RobotModel& model) {
  FitTotals totals;
  for (const LinkElement& element : model.elements()) {
    if (element.source != "mesh") continue;
    ++totals.meshes;
    totals.primitives += element.shapes;
    totals.volume_m3 += volumeOf(model, element);
    totals.hull_volume_m3 += element.hull_volume_m3;
    totals.overhang_m = std::max(totals.overhang_m, element.overhang_m);
  }
  return totals;
}

void printTable(const RobotModel& model, std::ostream& out) {
  print(rowsOf(model), out);
  const FitTotals totals = totalsOf(model);
  std::set<std::size_t> links;
  for (const LinkShape& shape : model.shapes()) links.insert(shape.link);
  out << '\n'
      << model.name() << ": " << links.size() << " links with " << model.shapes().size()
      << " primitives";
  if (totals.meshes > 0) {
    out << "; " << totals.meshes << " meshes covered by " << totals.primitives << ", "
        << ratioText(totals.volume_m3, totals.hull_volume_m3)
        << " times the volume of their convex hulls, largest overhang "
        << text("%.1f mm", 1e3 * totals.overhang_m);
  }
  out << '\n';
  const auto& without = model.linksWithoutShape();
  if (without.empty()) return;
  out << without.size() << " links have no shape and are not watched:\n";
  std::string line;
  for (const std::string& link : without) {
    if (line.size() + link.size() > kLineWidth) {
      out << line << '\n';
      line.clear();
    }
    line += "  " + link;
  }
  out << line << '\n';
}

}  // namespace tccm
