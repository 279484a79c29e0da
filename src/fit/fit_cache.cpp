#include "fit/fit_cache.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFileMax = 1U << 20U;  // bytes; a fit has some hundreds
constexpr std::size_t kPrimitivesMax = 1000;
const char* const kFormat = "tccm_monitor primitive fit";

std::string hex(const unsigned char* bytes, std::size_t count) {
  static const char* const kDigits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += kDigits[bytes[i] >> 4U];
    text += kDigits[bytes[i] & 0xfU];
  }
  return text;
}

/// SHA-256 over parts; their lengths go in as well, so that no two lists of parts are alike.
std::string digest(const std::vector<const std::string*>& parts) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  bool done = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const std::string* part : parts) {
    const std::string length = std::to_string(part->size()) + ":";
    done = done && EVP_DigestUpdate(context.get(), length.data(), length.size()) == 1 &&
           EVP_DigestUpdate(context.get(), part->data(), part->size()) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned int count = 0;
  done = done && EVP_DigestFinal_ex(context.get(), bytes.data(), &count) == 1;
  if (!done) throw std::runtime_error("SHA-256 is not available");
  return hex(bytes.data(), count);
}

std::string identityOf(const std::string& content, const std::string& key) {
  const std::string version = kFormat + std::string(" ") + std::to_string(kFitCacheVersion);
  return digest({&version, &key, &content});
}

/// Numbers by their 64 bits: exact, and alike in every locale.
class NumberWriter {
 public:
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    text << ' ' << std::hex << bits;
  }
  void add(const Pose& pose) {
    for (int i = 0; i < 12; ++i) add(pose.matrix()(i / 4, i % 4));
  }
  void operator()(const Box& box) {
    for (int i = 0; i < 3; ++i) add(box.half_extents[i]);
  }
  void operator()(const Cylinder& c) { addLong(c.radius, c.half_length); }
  void operator()(const Capsule& c) { addLong(c.radius, c.half_length); }
  void operator()(const Sphere& s) { add(s.radius); }
  std::ostringstream text;

 private:
  void addLong(double radius, double half_length) {
    add(radius);
    add(half_length);
  }
};

/// The counterpart; throws where a number is missing.
class NumberReader {
 public:
  explicit NumberReader(std::istream& text) : text_(text) {}
  double number() {
    std::uint64_t bits = 0;
    if (!(text_ >> std::hex >> bits)) throw std::runtime_error("a number is missing");
    double number = 0.0;
    std::memcpy(&number, &bits, sizeof(number));
    if (!std::isfinite(number)) throw std::runtime_error("a number is not finite");
    return number;
  }
  Pose pose() {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = number();
    return pose;
  }
  Shape shape(const std::string& name) {
    if (name == "box") {
      Vector3 half_extents;
      for (int i = 0; i < 3; ++i) half_extents[i] = number();
      return Box{half_extents};
    }
    const double radius = number();
    if (name == "sphere") return Sphere{radius};
    const double half_length = number();
    if (name == "cylinder") return Cylinder{radius, half_length};
    if (name == "capsule") return Capsule{radius, half_length};
    throw std::runtime_error("an unknown shape");
  }

 private:
  std::istream& text_;
};

/// Format, identity, volume and overhang, then a line a primitive.
std::string bodyOf(const std::string& identity, const PrimitiveFit& fit) {
  NumberWriter writer;
  writer.text.imbue(std::locale::classic());
  writer.text << kFormat << '\n' << identity << '\n' << fit.primitives.size();
  writer.add(fit.hull_volume_m3);
  writer.add(fit.overhang_m);
  for (const PlacedShape& placed : fit.primitives) {
    writer.text << '\n' << name(placed.shape);
    std::visit(writer, placed.shape);
    writer.add(placed.pose);
  }
  writer.text << '\n';
  return writer.text.str();
}

std::string fileTextOf(const std::string& identity, const PrimitiveFit& fit) {
  const std::string body = bodyOf(identity, fit);
  return body + digest({&body}) + "\n";
}

/// Nothing unless the text is whole, and that fit's.
std::optional<PrimitiveFit> fitOf(const std::string& text, const std::string& identity) {
  const std::string header = std::string(kFormat) + "\n" + identity + "\n";
  if (text.rfind(header, 0) != 0) return std::nullopt;
  std::istringstream stream(text.substr(header.size()));
  stream.imbue(std::locale::classic());
  PrimitiveFit fit;
  try {
    std::size_t count = 0;
    stream >> count;
    if (!stream || count > kPrimitivesMax) return std::nullopt;
    NumberReader reader(stream);
    fit.hull_volume_m3 = reader.number();
    fit.overhang_m = reader.number();
    for (std::string shape; fit.primitives.size() < count;) {
      stream >> shape;
      PlacedShape placed{reader.shape(shape)};
      placed.pose = reader.pose();
      validate(placed.shape, "a fit");
      fit.primitives.push_back(placed);
    }
  } catch (const std::exception&) {
    return std::nullopt;
  }
  // Written once more, it has to be the same text: so also its checksum is right.
  if (fileTextOf(identity, fit) != text) return std::nullopt;
  return fit;
}

/// Closes on destruction.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() { close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] bool isOpen() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }
  bool close() {
    const bool closed = descriptor_ >= 0 && ::close(descriptor_) == 0;
    descriptor_ = -1;
    return closed;
  }

 private:
  int descriptor_;
};

/// Nothing for what is no plain file, too large or unreadable.
std::optional<std::string> readSmallFile(const std::string& path) {
  // Without waiting: a pipe of that name must not hold the start up.
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.isOpen() || ::fstat(file.descriptor(), &status) != 0) return std::nullopt;
  if (!S_ISREG(status.st_mode) || status.st_size > static_cast<off_t>(kFileMax)) {
    return std::nullopt;
  }
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  const ssize_t count = ::read(file.descriptor(), text.data(), text.size());
  if (count != static_cast<ssize_t>(text.size())) return std::nullopt;
  return text;
}

bool writeAll(int descriptor, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

/// Others see the whole file or none.
/// @throws std::system_error
void writeAtomically(const std::string& path, const std::string& text) {
  std::string temporary = path + ".XXXXXX";
  File file(::mkostemp(temporary.data(), O_CLOEXEC));
  if (!file.isOpen()) throw std::system_error(errno, std::generic_category());
  const bool written = writeAll(file.descriptor(), text) && file.close() &&
                       ::rename(temporary.c_str(), path.c_str()) == 0;
  if (written) return;
  const int why = errno;
  ::unlink(temporary.c_str());
  throw std::system_error(why, std::generic_category());
}

std::string pathOf(const std::string& folder, const std::string& identity) {
  return fs::path(folder) / (identity + ".fit");
}

}  // namespace

PrimitiveFit FitCache::fit(const std::string& mesh_content, const std::string& key,
                           const std::function<PrimitiveFit()>& compute) {
  const std::string identity = identityOf(mesh_content, key);
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = known_.find(identity);
  if (found != known_.end()) return found->second;
  if (!folder_.empty()) {
    if (const auto text = readSmallFile(pathOf(folder_, identity))) {
      if (const auto saved = fitOf(*text, identity)) {
        return known_.emplace(identity, *saved).first->second;
      }
    }
  }
  const PrimitiveFit computed = compute();
  known_.emplace(identity, computed);
  if (!folder_.empty()) save(identity, computed);
  return computed;
}

void FitCache::save(const std::string& identity, const PrimitiveFit& fit) {
  try {
    fs::create_directories(folder_);
    writeAtomically(pathOf(folder_, identity), fileTextOf(identity, fit));
  } catch (const std::exception& error) {
    save_problem_ = "fits cannot be saved in " + printable(folder_) + ": " + error.what();
  }
}

std::string FitCache::saveProblem() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return save_problem_;
}

}  // namespace tccm
