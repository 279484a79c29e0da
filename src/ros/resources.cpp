#include "ros/resources.h"

#include <ros/package.h>

#include <boost/algorithm/string/predicate.hpp>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <system_error>
#include <vector>

#include "base/printable.h"
#include "mesh/mesh.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;
using boost::algorithm::starts_with;

/// A percent sign that no two digits follow stays.
std::string percentDecoded(const std::string& text) {
  const auto isDigit = [&text](std::size_t i) {
    return i < text.size() && std::isxdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && isDigit(i + 1) && isDigit(i + 2)) {
      decoded += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

/// The path that text stands for: percent-decoded, or as it stands where only that is there.
fs::path existing(const fs::path& base, const std::string& text) {
  const std::string decoded_text = percentDecoded(text);
  if (decoded_text.find('\0') != std::string::npos) throw ConfigError("it holds a NUL byte");
  if (starts_with(decoded_text, "/")) throw ConfigError("it has an encoded slash in front");
  const fs::path decoded = base / decoded_text;
  std::error_code ignored;
  if (!fs::exists(decoded, ignored) && fs::exists(base / text, ignored)) return base / text;
  return decoded;
}

std::string readFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const std::string name = printable(path.string());
  if (!fs::exists(status)) throw ConfigError("there is no file " + name);
  if (fs::is_directory(status)) throw ConfigError("it is a folder");
  if (!fs::is_regular_file(status)) throw ConfigError("it is no file");
  if (fs::file_size(path, error) > kMeshBytesMax) throw ConfigError("it is larger than 256 MB");
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) {
    throw ConfigError("the file " + name +
                      " cannot be read: " + std::generic_category().message(errno));
  }
  return content;
}

class ResourceReader {
 public:
  explicit ResourceReader(fs::path package_path) : package_path_(std::move(package_path)) {}

  std::string read(const std::string& uri) {
    if (uri.find('\0') != std::string::npos) throw ConfigError("it holds a NUL byte");
    if (starts_with(uri, "package://")) return readFromPackage(uri.substr(10));
    if (starts_with(uri, "file://")) return readFromUri(uri.substr(7));
    if (starts_with(uri, "http://") || starts_with(uri, "https://") || starts_with(uri, "ftp://")) {
      throw ConfigError("not fetched: a robot must not depend on a network at its start");
    }
    if (starts_with(uri, "/")) return readFile(uri);
    throw ConfigError("it has to begin with package://, file:/// or /");
  }

 private:
  static std::string readFromUri(std::string rest) {
    if (starts_with(rest, "localhost/")) rest.erase(0, 9);
    if (!starts_with(rest, "/"))
      throw ConfigError("file:// has to be followed by an absolute path");
    rest.erase(0, rest.find_first_not_of('/'));
    return readFile(existing("/", rest));
  }

  std::string readFromPackage(const std::string& rest) {
    const std::string package = rest.substr(0, rest.find('/'));
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
    // Looked up when first needed: searching all of them takes tens of milliseconds. Asked for a
    // list, rospack complains of nothing on the terminal.
    std::call_once(listed_, [this] {
      std::vector<std::string> lines;
      ros::package::command("list", lines);
      for (const std::string& line : lines) {
        const std::size_t space = line.find(' ');
        if (space == std::string::npos) continue;
        ros_packages_[line.substr(0, space)] = line.substr(space + 1);
      }
    });
    const auto folder = ros_packages_.find(package);
    if (folder != ros_packages_.end()) return folder->second;
    const std::string where =
        package_path_.empty() ? "" : " in " + printable(package_path_.string()) + " and";
    throw ConfigError("there is no package '" + printable(package) + "'" + where + " among ROS's");
  }

  const fs::path package_path_;
  std::once_flag listed_;
  std::map<std::string, std::string> ros_packages_;  ///< their folders
};

}  // namespace

ReadResource resourceReader(const std::string& package_path) {
  const auto reader = std::make_shared<ResourceReader>(package_path);
  return [reader](const std::string& uri) {
    try {
      return reader->read(uri);
    } catch (const std::exception& error) {
      throw ConfigError(printable(uri) + ": " + error.what());
    }
  };
}

std::string fitCacheFolder() {
  const char* const ros_home = std::getenv("ROS_HOME");
  const char* const home = std::getenv("HOME");
  if (ros_home && *ros_home) return fs::path(ros_home) / "tccm_monitor" / "fits";
  if (home && *home) return fs::path(home) / ".ros" / "tccm_monitor" / "fits";
  return {};
}

}  // namespace tccm
