#include "fit/primitive_fit.h"

#include <unistd.h>

#include <algorithm>
#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/nil_generator.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <system_error>

#include "base/printable.h"
#include "config/parameter_table.h"
#include "fit/enclosing.h"
#include "fit/mesh_partition.h"
#include "fit/overhang.h"
#include "fit/points.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

void requireSound(const Mesh& mesh, const std::string& owner) {
  constexpr double kFarthest = 1e3;  // [m]; beyond it is a slip of units
  if (mesh.triangles.empty() && !mesh.vertices.empty()) {
    throw ConfigError(owner + ": the mesh has vertices and no triangle");
  }
  for (const Vector3& p : mesh.vertices) {
    if (!p.allFinite()) throw ConfigError(owner + ": the mesh has a vertex that is not finite");
    if (p.cwiseAbs().maxCoeff() > kFarthest) {
      throw ConfigError(owner + ": the mesh has a vertex beyond 1000 m");
    }
  }
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) < mesh.vertices.size()) continue;
    throw ConfigError(owner + ": the mesh has a triangle of a vertex that it has not");
  }
}

PrimitiveFit fitted(const std::vector<MeshPart>& parts, double margin_m) {
  PrimitiveFit fit;
  for (const MeshPart& part : parts) {
    PlacedShape primitive = smallestEnclosing(part.vertices());
    primitive.shape = expanded(primitive.shape, {1.0, margin_m});
    fit.overhang_m = std::max(fit.overhang_m, overhang(primitive, part.vertices()));
    fit.primitives.push_back(primitive);
  }
  return fit;
}

Vector3 extentsOf(const Mesh& mesh) {
  UprightBox box;
  for (const Vector3& p : mesh.vertices) box.extend(p);
  return box.sizes();
}

double totalVolume(const PrimitiveFit& fit) {
  double sum = 0.0;
  for (const PlacedShape& primitive : fit.primitives) sum += volume(primitive.shape);
  return sum;
}

namespace fs = std::filesystem;

/// Part of every fit's identity. To be raised whenever the fitting, the reading of meshes or the
/// form of the cache's files changes.
constexpr int kFitCacheVersion = 4;

constexpr std::size_t kFileMax = 1U << 20U;  // bytes; a fit has some hundreds

/// 122 bits of SHA-1 over one part after the other, so that no two lists of parts are alike.
std::string digest(const std::vector<const std::string*>& parts) {
  boost::uuids::uuid before = boost::uuids::nil_uuid();
  for (const std::string* part : parts) {
    before = boost::uuids::name_generator_sha1(before)(part->data(), part->size());
  }
  return to_string(before);
}

/// A box's half extents; else the radius, and half the length where there is one.
Vector3 sizesOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return box->half_extents;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return {c->radius, c->half_length, 0.0};
  if (const auto* c = std::get_if<Capsule>(&shape)) return {c->radius, c->half_length, 0.0};
  return {std::get<Sphere>(shape).radius, 0.0, 0.0};
}

Shape shapeOf(const std::string& name, const Vector3& sizes) {
  if (name == "box") return Box{sizes};
  if (name == "cylinder") return Cylinder{sizes[0], sizes[1]};
  if (name == "capsule") return Capsule{sizes[0], sizes[1]};
  return Sphere{sizes[0]};
}

/// Volume, overhang and extents, a line a primitive: shape, sizes and the pose's matrix; then a
/// line a warning.
std::string textOf(const PrimitiveFit& fit) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);  // what is read is the same to the bit
  const Vector3& extents = fit.mesh_extents_m;
  text << fit.hull_volume_m3 << ' ' << fit.overhang_m << ' ' << extents.x() << ' ' << extents.y()
       << ' ' << extents.z() << ' ' << fit.primitives.size() << '\n';
  for (const PlacedShape& placed : fit.primitives) {
    text << name(placed.shape);
    const Vector3 sizes = sizesOf(placed.shape);
    for (int i = 0; i < 3; ++i) text << ' ' << sizes[i];
    for (int i = 0; i < 16; ++i) text << ' ' << placed.pose.data()[i];
    text << '\n';
  }
  for (const std::string& warning : fit.warnings) text << warning << '\n';
  return text.str();
}

/// @param text of textOf()
PrimitiveFit fitOf(const std::string& text) {
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  PrimitiveFit fit;
  std::size_t primitives = 0;
  words >> fit.hull_volume_m3 >> fit.overhang_m;
  for (int i = 0; i < 3; ++i) words >> fit.mesh_extents_m[i];
  words >> primitives;
  while (fit.primitives.size() < primitives) {
    std::string name;
    words >> name;
    Vector3 sizes;
    Pose pose;
    for (int i = 0; i < 3; ++i) words >> sizes[i];
    for (int i = 0; i < 16; ++i) words >> pose.data()[i];
    fit.primitives.push_back({shapeOf(name, sizes), pose});
  }
  words.ignore(1);  // the end of the last primitive's line
  for (std::string warning; std::getline(words, warning);) fit.warnings.push_back(warning);
  return fit;
}

/// What is written: a line that tells damaged and foreign files, then the fit.
std::string sealed(const std::string& text, const std::string& identity) {
  return digest({&identity, &text}) + "\n" + text;
}

/// Others see the whole file or none.
/// @throws std::system_error
void writeAtomically(const fs::path& path, const std::string& text) {
  std::string temporary = path.string() + ".XXXXXX";
  const int descriptor = ::mkstemp(temporary.data());
  if (descriptor < 0) throw std::system_error(errno, std::generic_category());
  ::close(descriptor);
  std::ofstream file(temporary, std::ios::binary);
  file << text;
  file.close();
  if (file && std::rename(temporary.c_str(), path.c_str()) == 0) return;
  const int why = errno;
  ::unlink(temporary.c_str());
  throw std::system_error(why, std::generic_category());
}

/// Nothing unless a plain file is there, whole, and of that fit.
std::optional<PrimitiveFit> savedFit(const fs::path& path, const std::string& identity) {
  std::error_code error;
  const bool plain = fs::is_regular_file(path, error) && fs::file_size(path, error) <= kFileMax;
  if (!plain) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  const std::string saved{std::istreambuf_iterator<char>(file), {}};
  const std::string text = saved.substr(saved.find('\n') + 1);
  if (saved != sealed(text, identity)) return std::nullopt;
  return fitOf(text);
}

}  // namespace

void PrimitiveFitConfig::describe(ParameterTable& table) {
  table.add("fit_primitives_max", &primitives_max, "", {1, 16}, "primitives for one mesh");
  table.add("fit_split_gain", &split_gain, "", {0.0, 0.9},
            "a further primitive has to better the fit by this share");
}

void PrimitiveFitConfig::validate() const { requireInRange("fit_margin_m", margin_m, 0.0, 0.1); }

PrimitiveFit fitPrimitives(const Mesh& mesh, const PrimitiveFitConfig& config,
                           const std::string& owner) {
  static_cast<void>(validated(config));
  requireSound(mesh, owner);
  PrimitiveFit best;
  if (mesh.triangles.empty()) {
    best.warnings = mesh.warnings;
    return best;
  }
  double least = std::numeric_limits<double>::infinity();
  double extent = 0.0;
  for (const std::vector<MeshPart>& parts :
       partitions(mesh, static_cast<std::size_t>(config.primitives_max))) {
    const PrimitiveFit fit = fitted(parts, config.margin_m);
    if (extent == 0.0) extent = boundingRadius(fit.primitives.front().shape);
    const auto further = static_cast<double>(fit.primitives.size() - 1);
    const double handicap = std::pow(1.0 - config.split_gain, -further);
    // A little for what even the best primitive reaches beyond, lest it decides alone.
    const double overhang_share = fit.overhang_m / extent + 0.01;
    const double score = totalVolume(fit) * std::cbrt(overhang_share) * handicap;
    if (score >= least) continue;
    least = score;
    best = fit;
  }
  best.warnings = mesh.warnings;
  best.mesh_extents_m = extentsOf(mesh);
  for (const PlacedShape& primitive : best.primitives) tccm::validate(primitive.shape, owner);
  best.hull_volume_m3 = convexHull(mesh.vertices).volume_m3;
  return best;
}

PrimitiveFit FitCache::fit(const std::string& mesh_content, const std::string& key,
                           const std::function<PrimitiveFit()>& compute) {
  const std::string version = "tccm_monitor primitive fit " + std::to_string(kFitCacheVersion);
  const std::string identity = digest({&version, &key, &mesh_content});
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = known_.find(identity);
  if (found != known_.end()) return found->second;
  const fs::path path = fs::path(folder_) / (identity + ".fit");
  const auto saved = folder_.empty() ? std::nullopt : savedFit(path, identity);
  PrimitiveFit fit = saved ? *saved : compute();
  known_.emplace(identity, fit);
  if (saved || folder_.empty()) return fit;
  try {
    fs::create_directories(folder_);
    writeAtomically(path, sealed(textOf(fit), identity));
  } catch (const std::exception& error) {
    save_problem_ = "fits cannot be saved in " + printable(folder_) + ": " + error.what();
  }
  return fit;
}

std::string FitCache::saveProblem() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return save_problem_;
}

}  // namespace tccm
