#include "ros/parameters.h"

#include <ros/node_handle.h>

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

YAML::Node toYaml(XmlRpc::XmlRpcValue& value) {
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      node = static_cast<bool>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeInt:
      node = static_cast<int>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      node = static_cast<double>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      node = static_cast<std::string>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);  // also where it is empty
      for (int i = 0; i < value.size(); ++i) node.push_back(toYaml(value[i]));
      break;
    case XmlRpc::XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& entry : value) node[entry.first] = toYaml(entry.second);
      break;
    default:
      break;
  }
  return node;
}

std::string flowText(const YAML::Node& node) {
  YAML::Emitter emitter;
  emitter << YAML::Flow << node;
  return emitter.c_str();
}

}  // namespace

Parameters::Parameters(YAML::Node node, std::string owner)
    : node_(std::move(node)), owner_(std::move(owner)) {
  if (node_ && !node_.IsNull() && !node_.IsMap()) {
    throw ConfigError(owner_ + ": its parameters are no map of keys and values");
  }
}

Parameters Parameters::fromServer(const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue value;
  const std::string& name = private_node.getNamespace();
  if (!private_node.getParam(name, value)) return {YAML::Node(), name};
  return {toYaml(value), name};
}

template <typename T>
void Parameters::readAs(const std::string& key, const char* type, T& value) {
  known_.insert(key);
  if (!node_ || !node_.IsMap()) return;
  const YAML::Node entry = static_cast<const YAML::Node&>(node_)[key];
  if (!entry) return;
  try {
    value = entry.as<T>();
  } catch (const YAML::Exception&) {
    throw ConfigError(owner_ + "/" + key + ": " + flowText(entry) + " is not " + type);
  }
}

void Parameters::read(const std::string& key, bool& value) { readAs(key, "true or false", value); }

void Parameters::read(const std::string& key, int& value) { readAs(key, "a whole number", value); }

void Parameters::read(const std::string& key, std::size_t& value) {
  readAs(key, "a whole number of at least 0", value);
}

void Parameters::read(const std::string& key, double& value) { readAs(key, "a number", value); }

void Parameters::read(const std::string& key, std::string& value) { readAs(key, "a text", value); }

void Parameters::read(const std::string& key, std::vector<std::string>& value) {
  readAs(key, "a list of texts", value);
}

void Parameters::read(const std::string& key, std::optional<double>& value) {
  double number = 0.0;
  readAs(key, "a number", number);
  if (isSet(key)) value = number;
}

void Parameters::read(const std::string& key, std::map<std::string, double>& value) {
  readAs(key, "a map of names and numbers", value);
}

void Parameters::read(const std::string& key,
                      std::map<std::string, std::vector<std::string>>& value) {
  readAs(key, "a map of names and lists of texts", value);
}

std::vector<Parameters> Parameters::readList(const std::string& key) {
  std::vector<YAML::Node> nodes;
  readAs(key, "a list of maps", nodes);
  std::vector<Parameters> entries;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    entries.emplace_back(nodes[i], owner_ + "/" + key + "[" + std::to_string(i) + "]");
  }
  return entries;
}

bool Parameters::isSet(const std::string& key) const {
  return node_ && node_.IsMap() && static_cast<bool>(node_[key]);
}

std::vector<std::string> Parameters::unknownKeys() const {
  std::vector<std::string> unknown;
  if (!node_ || !node_.IsMap()) return unknown;
  for (const auto& entry : node_) {
    const auto key = entry.first.as<std::string>();
    if (known_.count(key) == 0) unknown.push_back(key);
  }
  return unknown;
}

}  // namespace tccm
