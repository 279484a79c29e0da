#include "fit/fit_cache.h"

#include <unistd.h>

#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/nil_generator.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <cerrno>
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
#include <vector>

#include "mesh/text.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

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

/// Volume and overhang, then a line a primitive: shape, sizes and the pose's matrix.
std::string textOf(const PrimitiveFit& fit) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);  // what is read is the same to the bit
  text << fit.hull_volume_m3 << ' ' << fit.overhang_m << '\n';
  for (const PlacedShape& placed : fit.primitives) {
    text << name(placed.shape);
    const Vector3 sizes = sizesOf(placed.shape);
    for (int i = 0; i < 3; ++i) text << ' ' << sizes[i];
    for (int i = 0; i < 16; ++i) text << ' ' << placed.pose.data()[i];
    text << '\n';
  }
  return text.str();
}

/// @param text of textOf()
PrimitiveFit fitOf(const std::string& text) {
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  PrimitiveFit fit;
  words >> fit.hull_volume_m3 >> fit.overhang_m;
  for (std::string name; words >> name;) {
    Vector3 sizes;
    Pose pose;
    for (int i = 0; i < 3; ++i) words >> sizes[i];
    for (int i = 0; i < 16; ++i) words >> pose.data()[i];
    fit.primitives.push_back({shapeOf(name, sizes), pose});
  }
  return fit;
}

/// What is written: a line that tells damaged and foreign files, then the fit.
std::string sealed(const std::string& text, const std::string& identity) {
  return digest({&identity, &text}) + "\n" + text;
}

/// Empty for what is no plain file, too large or unreadable.
std::string readSmallFile(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kFileMax) return {};
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
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

/// Nothing unless the file is whole, and of that fit.
std::optional<PrimitiveFit> savedFit(const fs::path& path, const std::string& identity) {
  const std::string saved = readSmallFile(path);
  const std::string text = saved.substr(saved.find('\n') + 1);
  if (saved != sealed(text, identity)) return std::nullopt;
  return fitOf(text);
}

}  // namespace

PrimitiveFit FitCache::fit(const std::string& mesh_content, const std::string& key,
                           const std::function<PrimitiveFit()>& compute) {
  const std::string version = "tccm_monitor primitive fit " + std::to_string(kFitCacheVersion);
  const std::string identity = digest({&version, &key, &mesh_content});
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = known_.find(identity);
  if (found != known_.end()) return found->second;
  const fs::path path = fs::path(folder_) / (identity + ".fit");
  const auto saved = folder_.empty() ? std::nullopt : savedFit(path, identity);
  const PrimitiveFit fit = saved ? *saved : compute();
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
