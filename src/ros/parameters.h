#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace ros {
class NodeHandle;
}

namespace tccm {

/// One nodelet's parameters, from the parameter server or from a YAML file alike. What is not set
/// keeps its default; what is set must have the right type.
class Parameters {
 public:
  /// @param owner names the nodelet in messages.
  Parameters(YAML::Node node, std::string owner);
  /// Everything under the node's private namespace. @throws ConfigError
  [[nodiscard]] static Parameters fromServer(const ros::NodeHandle& private_node);

  /// Each leaves value as it is where key is not set. @throws ConfigError naming key and value.
  void read(const std::string& key, bool& value);
  void read(const std::string& key, int& value);
  void read(const std::string& key, std::size_t& value);
  void read(const std::string& key, double& value);
  void read(const std::string& key, std::string& value);
  void read(const std::string& key, std::vector<std::string>& value);
  void read(const std::string& key, std::optional<double>& value);
  void read(const std::string& key, std::map<std::string, double>& value);
  void read(const std::string& key, std::map<std::string, std::vector<std::string>>& value);
  /// The entries of a list of maps, to be read one by one; none where key is not set.
  [[nodiscard]] std::vector<Parameters> readList(const std::string& key);

  /// The keys that are set and were never read: slips, most likely.
  [[nodiscard]] std::vector<std::string> unknownKeys() const;
  [[nodiscard]] const std::string& owner() const { return owner_; }

 private:
  [[nodiscard]] bool isSet(const std::string& key) const;
  template <typename T>
  void readAs(const std::string& key, const char* type, T& value);

  YAML::Node node_;
  std::string owner_;
  std::set<std::string> known_;
};

}  // namespace tccm
