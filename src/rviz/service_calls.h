#pragma once

#include <ros/master.h>
#include <ros/names.h>
#include <ros/service.h>
#include <ros/this_node.h>
#include <std_srvs/Trigger.h>

#include <string>
#include <vector>

namespace tccm {

/// Calls a service whose answer has success and message. @return what became of it, for people.
template <typename Service>
std::string callService(const std::string& name, const typename Service::Request& request) {
  Service service;
  service.request = request;
  if (!ros::service::exists(name, false)) return "there is no " + name;
  if (!ros::service::call(name, service)) return name + " did not answer";
  const std::string& message = service.response.message;
  if (service.response.success) return message.empty() ? "done" : "done, " + message;
  return "refused: " + message;
}

/// The services of a name in a namespace: its own, and those of its sensors, one level below.
/// @param name_space absolute.
inline std::vector<std::string> servicesNamed(const std::string& name,
                                              const std::string& name_space) {
  XmlRpc::XmlRpcValue arguments, result, state;
  arguments[0] = ros::this_node::getName();
  std::vector<std::string> found;
  if (!ros::master::execute("getSystemState", arguments, result, state, false)) return found;
  const std::string prefix = name_space == "/" ? name_space : name_space + "/";
  XmlRpc::XmlRpcValue& services = state[2];
  for (int i = 0; i < services.size(); ++i) {
    const std::string service = services[i][0];
    if (service.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string below = service.substr(prefix.size());
    const auto slash = below.find('/');
    if (below == name || (slash != std::string::npos && below.substr(slash + 1) == name)) {
      found.push_back(service);
    }
  }
  return found;
}

/// Clears the maps of all sensors in a namespace. @return what became of it, for people.
inline std::string clearMaps(const std::string& name_space) {
  const std::vector<std::string> services = servicesNamed("clear_map", name_space);
  if (services.empty()) return "there is no clear_map in " + name_space;
  std::string text;
  for (const std::string& service : services) {
    text +=
        (text.empty() ? "" : "; ") + service + ": " + callService<std_srvs::Trigger>(service, {});
  }
  return text;
}

}  // namespace tccm
