#include "ros/server_config.h"

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

}  // namespace

YAML::Node parametersOf(const ros::NodeHandle& node) {
  XmlRpc::XmlRpcValue value;
  return node.getParam(node.getNamespace(), value) ? toYaml(value) : YAML::Node();
}

}  // namespace tccm
