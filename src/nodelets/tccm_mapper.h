#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/GetCuboidMap.h>
#include <visualization_msgs/Marker.h>

#include <map>
#include <memory>
#include <string>

#include "map/place_ages.h"
#include "monitor_config.h"
#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/message_pool.h"

namespace tccm {

/// Nodelet: `scan_cloud` in; `cuboid_map` with every scan and `cuboid_markers` for whoever looks
/// out.
class TccmMapper : public DiagnosedNodelet {
 public:
  TccmMapper() : DiagnosedNodelet("map") {}

 private:
  void setUp() override;
  void receiveCloud(const sensor_msgs::PointCloud2::ConstPtr& message);
  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message);
  void drop(const std::string& reason);
  void publish();
  void publishMarkers();
  bool clearMap(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool getCuboidMap(tccm_monitor::GetCuboidMap::Request& request,
                    tccm_monitor::GetCuboidMap::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  MapperConfig config_;
  std::unique_ptr<Mapper> mapper_;
  std::unique_ptr<PlaceAges> ages_;
  ScanReturns returns_;
  CuboidMap snapshot_;
  std::string frame_;
  MessagePool<tccm_monitor::CuboidMap> messages_;
  tccm_monitor::CuboidMap::ConstPtr newest_;
  visualization_msgs::Marker marker_;
  std::map<std::string, ros::Time> attached_;  ///< forget_until of those taken into account
  ros::Time attached_stamp_;
  ros::Publisher map_publisher_, marker_publisher_;
  ros::Subscriber cloud_subscriber_, attached_subscriber_;
  ros::ServiceServer clear_service_, get_service_;
  ros::WallTimer marker_timer_;
  std::size_t mapped_ = 0;
  std::size_t dropped_ = 0;
  std::size_t forgotten_ = 0;
  IntegrationMap::Added added_;
};

}  // namespace tccm
