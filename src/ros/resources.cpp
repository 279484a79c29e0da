#include "ros/resources.h"

#include <ros/package.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

#include "mesh/mesh_file.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

bool startsWith(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

/// For an error's one line.
std::string oneLine(std::string uri) {
  constexpr std::size_t kLength = 300;
  if (uri.size() > kLength) uri = uri.substr(0, kLength) + "...";
  std::replace_if(
      uri.begin(), uri.end(), [](unsigned char c) { return c < 0x20U || c == 0x7fU; }, ' ');
  return uri;
}

std::optional<char> hexByte(const std::string& text, std::size_t position) {
  const auto digit = [](char c) {
    const std::size_t place = std::string("0123456789abcdef").find(static_cast<char>(c | 0x20));
    return place == std::string::npos ? -1 : static_cast<int>(place);
  };
  if (position + 2 > text.size()) return std::nullopt;
  const int high = digit(text[position]);
  const int low = digit(text[position + 1]);
  if (high < 0 || low < 0) return std::nullopt;
  return static_cast<char>(16 * high + low);
}

/// A percent sign that no two digits follow stays.
std::string percentDecoded(const std::string& text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = text[i] == '%' ? hexByte(text, i + 1) : std::nullopt;
    decoded += byte ? *byte : text[i];
    if (byte) i += 2;
  }
  return decoded;
}

/// The path that text stands for: percent-decoded, or as it stands where only that is there.
fs::path existing(const fs::path& base, const std::string& text) {
  const std::string decoded_text = percentDecoded(text);
  if (decoded_text.find('\0') != std::string::npos) throw ConfigError("it holds a NUL byte");
  if (startsWith(decoded_text, "/")) throw ConfigError("it has an encoded slash in front");
  const fs::path decoded = base / decoded_text;
  std::error_code ignored;
  if (!fs::exists(decoded, ignored) && fs::exists(base / text, ignored)) return base / text;
  return decoded;
}

std::string readFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const std::string name = oneLine(path);
  if (!fs::exists(status)) throw ConfigError("there is no file " + name);
  if (fs::is_directory(status)) throw ConfigError("it is a folder");
  if (!fs::is_regular_file(status)) throw ConfigError("it is no file");
  if (fs::file_size(path, error) > kMeshBytesMax) throw ConfigError("it is larger than 256 MB");
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file || file.bad()) {
    throw ConfigError("the file " + name +
                      " cannot be read: " + std::generic_category().message(errno));
  }
  return content;
}

/// ROS packages' folders, looked up when first needed: searching all of them takes tens of
/// milliseconds. Asked for a list, rospack complains of nothing on the terminal.
class RosPackages {
 public:
  std::optional<std::string> folder(const std::string& package) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!listed_) list();
    const auto found = folders_.find(package);
    return found == folders_.end() ? std::nullopt : std::optional<std::string>(found->second);
  }

 private:
  void list() {
    std::vector<std::string> lines;
    ros::package::command("list", lines);
    for (const std::string& line : lines) {
      const std::size_t space = line.find(' ');
      if (space != std::string::npos) folders_[line.substr(0, space)] = line.substr(space + 1);
    }
    listed_ = true;
  }

  std::mutex mutex_;
  bool listed_ = false;
  std::map<std::string, std::string> folders_;
};

class ResourceReader {
 public:
  explicit ResourceReader(fs::path package_path) : package_path_(std::move(package_path)) {}

  std::string read(const std::string& uri) {
    if (uri.find('\0') != std::string::npos) throw ConfigError("it holds a NUL byte");
    if (startsWith(uri, "package://")) return readFromPackage(uri.substr(10));
    if (startsWith(uri, "file://")) return readFromUri(uri.substr(7));
    if (startsWith(uri, "http://") || startsWith(uri, "https://") || startsWith(uri, "ftp://")) {
      throw ConfigError("not fetched: a robot must not depend on a network at its start");
    }
    if (startsWith(uri, "/")) return readFile(uri);
    throw ConfigError("it has to begin with package://, file:/// or /");
  }

 private:
  static std::string readFromUri(std::string rest) {
    if (startsWith(rest, "localhost/")) rest.erase(0, 9);
    if (!startsWith(rest, "/")) throw ConfigError("file:// has to be followed by an absolute path");
    rest.erase(0, rest.find_first_not_of('/'));
    return readFile(existing("/", rest));
  }

  std::string readFromPackage(const std::string& rest) {
    const std::size_t slash = rest.find('/');
    const std::string package = rest.substr(0, slash);
    const std::size_t begin = rest.find_first_not_of('/', package.size());
    if (package.empty() || begin == std::string::npos) {
      throw ConfigError("package:// has to be followed by a package and a file in it");
    }
    const std::string inside = rest.substr(begin);
    const fs::path decoded = fs::path(percentDecoded(inside)).lexically_normal();
    if (package == "." || package == ".." || decoded.is_absolute() || *decoded.begin() == ".." ||
        *fs::path(inside).lexically_normal().begin() == "..") {
      throw ConfigError("it leaves its package");
    }
    return readFile(existing(folderOf(package), inside));
  }

  fs::path folderOf(const std::string& package) {
    std::error_code ignored;
    if (!package_path_.empty() && fs::is_directory(package_path_ / package, ignored)) {
      return package_path_ / package;
    }
    if (const auto folder = ros_packages_.folder(package)) return *folder;
    const std::string where = package_path_.empty() ? "" : " in " + oneLine(package_path_) + " and";
    throw ConfigError("there is no package '" + oneLine(package) + "'" + where + " among ROS's");
  }

  const fs::path package_path_;
  RosPackages ros_packages_;
};

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

ReadResource resourceReader(const std::string& package_path) {
  const auto reader = std::make_shared<ResourceReader>(package_path);
  return [reader](const std::string& uri) {
    try {
      return reader->read(uri);
    } catch (const std::exception& error) {
      throw ConfigError(oneLine(uri) + ": " + error.what());
    }
  };
}

std::string fitCacheFolder() {
  const std::string ros_home = environment("ROS_HOME");
  const std::string home = environment("HOME");
  if (ros_home.empty() && home.empty()) return {};
  const fs::path base = ros_home.empty() ? fs::path(home) / ".ros" : fs::path(ros_home);
  return base / "tccm_monitor" / "fits";
}

}  // namespace tccm
