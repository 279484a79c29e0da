#pragma once

#include <ros/ros.h>

#include <mutex>
#include <string>
#include <utility>

namespace tccm {

/// A line to a service that is kept open. A call waits for its answer, but ends, without one, when
/// another thread ends the line: also where the server hangs.
class ServiceLine {
 public:
  /// @param name as the node resolves it.
  ServiceLine(const ros::NodeHandle& node, const std::string& name, std::string md5)
      : node_(node), name_(node.resolveName(name)), md5_(std::move(md5)) {}

  /// @return whether there is an answer.
  template <typename Request, typename Response>
  [[nodiscard]] bool call(const Request& request, Response& response) {
    // A server that began anew is found only now.
    for (int attempt = 0; attempt < 2; ++attempt) {
      ros::ServiceClient client = connected(attempt > 0);
      if (client && client.call(request, response, md5_)) return true;
    }
    return false;
  }
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
    client_.shutdown();
  }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  [[nodiscard]] ros::ServiceClient connected(bool anew) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_over_) return {};
    if (anew || !client_) {
      ros::ServiceClientOptions options(name_, md5_, true, {});
      client_ = node_.serviceClient(options);
    }
    return client_;
  }

  ros::NodeHandle node_;
  std::string name_;
  std::string md5_;
  std::mutex mutex_;
  ros::ServiceClient client_;
  bool is_over_ = false;
};

}  // namespace tccm
