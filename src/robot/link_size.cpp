#include "robot/link_size.h"

#include <algorithm>
#include <cstdio>

namespace tccm {
namespace {

constexpr double kUnits = 1000.0;      // millimetres taken for metres, or metres scaled twice
constexpr double kSuspicious = 200.0;  // between a robot's own proportions and such a slip
constexpr double kTelling = 5e-4;      // [m]; what is shorter says nothing of a link's size
constexpr double kSmallest = 1e-3;     // [m]; a mesh that is larger by kUnits may be a slip

std::string lengthText(double metres) {
  char text[40];
  if (metres < 0.1) {
    std::snprintf(text, sizeof text, "%.3g mm", 1e3 * metres);
  } else {
    std::snprintf(text, sizeof text, "%.3g m", metres);
  }
  return text;
}

double longestOther(const MeshSize& mesh) {
  double longest_m = 0.0;
  for (const double length_m : mesh.others_m) longest_m = std::max(longest_m, length_m);
  return longest_m;
}

}  // namespace

double longestSide(const Shape& shape) {
  return bounds(shape, Pose::Identity()).sizes().maxCoeff();
}

std::string sizeDefect(double longest_m, double size_max_m, const std::string& what, bool is_mesh) {
  if (longest_m <= size_max_m) return {};
  return what + " is " + lengthText(longest_m) + " long, and link_size_max_m is " +
         lengthText(size_max_m) +
         (is_mesh ? " (millimetres? scale 0.001 is missing)"
                  : " (millimetres? it has to be in metres)");
}

bool isOfDoubtfulSize(double longest_m, double size_max_m) {
  return longest_m >= kUnits * kSmallest || kUnits * longest_m <= size_max_m;
}

bool saysEnough(const MeshSize& mesh) { return longestOther(mesh) >= kTelling; }

std::string unitDefect(const MeshSize& mesh, double size_max_m, const std::string& what) {
  const double other_m = longestOther(mesh);
  if (!saysEnough(mesh) || !isOfDoubtfulSize(mesh.longest_m, size_max_m)) return {};
  const std::string beside = what + " is " + lengthText(mesh.longest_m) +
                             " long, and its link's other geometry and joints reach " +
                             lengthText(other_m);
  if (mesh.longest_m > kSuspicious * other_m) {
    return beside + " (millimetres? scale 0.001 is missing)";
  }
  if (other_m > kSuspicious * mesh.longest_m) {
    return beside + " (metres already? scale 0.001 is one too many)";
  }
  return {};
}

}  // namespace tccm
