#pragma once

#include <ros/ros.h>
#include <tccm_monitor/ScanTrace.h>

#include <string>

#include "ros/conversions.h"
#include "ros/handles.h"

namespace tccm {

/// Tells when a scan passed the stations of a nodelet, on `scan_trace`. Costs next to nothing while
/// nobody listens.
class ScanTracer {
 public:
  void begin(const ros::NodeHandle& node) {
    publisher_ = advertiseCounting<tccm_monitor::ScanTrace>(node, "scan_trace", 100, listeners_);
  }
  void note(const char* station) {
    if (listeners_ == 0) return;
    const ros::WallTime now = ros::WallTime::now();
    trace_.stations.emplace_back(station);
    trace_.walls.emplace_back(now.sec, now.nsec);
  }
  /// All that was noted since the last.
  void publish(const ros::Time& scan) {
    if (trace_.stations.empty()) return;
    trace_.stamp = scan;
    publisher_.publish(trace_);
    forget();
  }
  void forget() {
    trace_.stations.clear();
    trace_.walls.clear();
  }

 private:
  int listeners_ = 0;
  ros::Publisher publisher_;
  tccm_monitor::ScanTrace trace_;
};

}  // namespace tccm
