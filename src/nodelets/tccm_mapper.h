#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/GetCuboidMap.h>
#include <tccm_monitor/MonitorStatus.h>
#include <visualization_msgs/Marker.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "map/mapper.h"
#include "nodelets/message_pool.h"
#include "ros/settings.h"

namespace tccm {

/// Nodelet: `scan_cloud` in; `cuboid_map` with every scan and `cuboid_markers` for whoever looks
/// out. All its callbacks run one after the other.
class TccmMapper : public nodelet::Nodelet {
 private:
  void onInit() override;
  void setUp();
  void receiveCloud(const sensor_msgs::PointCloud2::ConstPtr& message);
  void receiveStatus(const tccm_monitor::MonitorStatus::ConstPtr& message);
  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message);
  void drop(const std::string& reason);
  void publish();
  void publishMarkers();
  /// Writes what the checker last said of each place into the cuboids' col.
  void label(tccm_monitor::CuboidMap& message) const;
  bool clearMap(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool getCuboidMap(tccm_monitor::GetCuboidMap::Request& request,
                    tccm_monitor::GetCuboidMap::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  MapperSettings settings_;
  std::unique_ptr<Mapper> mapper_;
  ScanReturns returns_;
  CuboidMap snapshot_;
  std::string frame_;
  MessagePool<tccm_monitor::CuboidMap> messages_;
  tccm_monitor::CuboidMap::ConstPtr newest_;
  visualization_msgs::Marker marker_;
  std::vector<tccm_monitor::CuboidFlag> flags_;  ///< by cell
  std::map<std::string, ros::Time> attached_;    ///< forget_until of those taken into account
  ros::Time attached_stamp_;
  ros::Publisher map_publisher_;
  ros::Publisher marker_publisher_;
  ros::Subscriber cloud_subscriber_;
  ros::Subscriber status_subscriber_;
  ros::Subscriber attached_subscriber_;
  ros::ServiceServer clear_service_;
  ros::ServiceServer get_service_;
  ros::WallTimer marker_timer_;
  ros::WallTimer diagnostics_timer_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::size_t mapped_ = 0;
  std::size_t dropped_ = 0;
  std::size_t forgotten_ = 0;
  IntegrationMap::Added added_;
};

}  // namespace tccm
