#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>
#include <tccm_monitor/AttachedObjects.h>
#include <tccm_monitor/GetCuboidMap.h>

#include <atomic>
#include <map>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <vector>

#include "base/line_of.h"
#include "map/place_ages.h"
#include "nodelets/diagnosed_nodelet.h"
#include "nodelets/markers.h"
#include "nodelets/scan_tracer.h"
#include "ros/cloud_scan.h"
#include "ros/conversions.h"
#include "ros/published_map.h"
#include "ros/server_config.h"
#include "tccm_monitor/config_error.h"

namespace tccm {

/// Nodelet: `scan_cloud` or `cloud_scan` in; `cuboid_map` with every scan and `cuboid_markers` for
/// whoever looks out.
class TccmMapper : public DiagnosedNodelet {
 public:
  TccmMapper() : DiagnosedNodelet("map") {}
  ~TccmMapper() override { end(); }

 private:
  static constexpr std::size_t kMapsAtStart = 4;  // ours, the checker's, and two on the way to it
  static constexpr const char* kLacksWindow =
      "a camera or lidar has no tilt to measure a window by: set window_s above 0";

  void setUp() override {
    config_ = configFrom<MapperConfig>(privateNode());
    tellDifferences(privateNode(), config_);
    mapper_ = std::make_unique<Mapper>(config_.mapper);
    ages_ = std::make_unique<PlaceAges>(mapper_->map());
    while (maps_.size() < kMapsAtStart) makeMap();
    trace_.begin(node());
    map_publisher_ = advertise<PublishedMap>(node(), "cuboid_map", 3);
    marker_publisher_ = advertise<visualization_msgs::Marker>(node(), "cuboid_markers", 4);
    services_ = {serve(node(), "clear_map", &TccmMapper::clearMap, this),
                 serve(node(), "get_cuboid_map", &TccmMapper::getCuboidMap, this)};
    marker_timer_ = timer(1.0 / config_.marker_rate_hz, [this] { publishMarkers(); });
    inputs_ = {hear("scan_cloud", 20, &TccmMapper::receiveCloud),
               hear("cloud_scan", 3, &TccmMapper::receiveCloudScan),
               hear("attached_objects", 5, &TccmMapper::receiveAttached)};
  }

  void receiveCloud(const sensor_msgs::PointCloud2::ConstPtr& message) {
    trace_.forget();
    trace_.note("the mapper has it");
    const std::string defect = fromMessage(*message, returns_);
    if (!defect.empty()) return drop("scan_cloud", defect);
    add("scan_cloud", message->header.frame_id);
  }

  void receiveCloudScan(const tccm_monitor::CloudScan::ConstPtr& message) {
    trace_.forget();
    trace_.note("the mapper has it");
    lacks_window_ = config_.mapper.window_s == 0.0 && config_.mapper.window_scans == 0;
    if (lacks_window_) return drop("cloud_scan", kLacksWindow);
    const std::string defect = fromMessage(*message, returns_);
    if (!defect.empty()) return drop("cloud_scan", defect);
    add("cloud_scan", message->header.frame_id);
  }

  /// What was read into returns_.
  void add(const char* topic, const std::string& frame) {
    if (!frame_.empty() && frame != frame_ && !is_cleared_) {
      return drop(topic, "its frame is '" + frame + "', the map's is '" + frame_ +
                             "' until clear_map is called");
    }
    trace_.note("unpacked");
    const Mapper::Outcome outcome = mapper_->add(returns_);
    if (!outcome.dropped.empty()) return drop(topic, outcome.dropped);
    frame_ = frame;
    is_cleared_ = false;
    ++mapped_;
    added_.mapped += outcome.added.mapped;
    added_.out_of_area += outcome.added.out_of_area;
    noteLeftOut(outcome.added);
    trace_.note("mapped");
    publish();
    trace_.note("cuboid_map is published");
    trace_.publish(toRos(returns_.stamp));
    ages_->follow(mapper_->map(), mapper_->looks());
  }

  /// What did not fit into the map, and what to do about it.
  void noteLeftOut(const IntegrationMap::Added& added) {
    const std::size_t points = returns_.points.size();
    const std::size_t left_out = points - added.mapped - added.out_of_area - added.forgotten;
    if (!mapper_->map().overflowed()) left_out_.clear();
    if (left_out == 0) return;
    const IntegrationMap& map = mapper_->map();
    const bool is_full = map.returns() == map.config().returns_max;
    left_out_ = lineOf("%zu of a scan's %zu points are left out of the map: ", left_out, points) +
                (is_full ? lineOf("the window's %zu scans have more than window_returns_max, %zu: "
                                  "raise it, or lower window_s",
                                  map.scans(), map.config().returns_max)
                         : lineOf("intervals_max, %zu, is too little: raise it",
                                  map.config().intervals_max));
    NODELET_WARN_THROTTLE(5.0, "%s.", left_out_.c_str());
  }

  void drop(const char* topic, const std::string& reason) {
    ++dropped_;
    NODELET_WARN_THROTTLE(5.0, "A %s was dropped: %s.", topic, reason.c_str());
  }

  void receiveAttached(const tccm_monitor::AttachedObjects::ConstPtr& message) {
    if (!frame_.empty() && message->header.frame_id != frame_) {
      NODELET_ERROR("attached_objects are in frame '%s', the map is in '%s': nothing is forgotten.",
                    message->header.frame_id.c_str(), frame_.c_str());
      return;
    }
    std::map<std::string, ros::Time> attached;
    for (const tccm_monitor::AttachedObject& object : message->objects) {
      attached[object.name] = object.forget_until;
      const auto known = attached_.find(object.name);
      if (known != attached_.end() && known->second == object.forget_until) continue;
      const std::string owner = "object '" + object.name + "'";
      try {
        const PlacedShape seen{fromMessage(object.primitive, owner).shape,
                               fromMessage(object.attached_at, owner)};
        forgotten_ += mapper_->forget({{seen, object.forget_padding}}, toTime(object.forget_until));
      } catch (const ConfigError& error) {
        NODELET_ERROR("Nothing is forgotten of an attached object: %s.", error.what());
      }
    }
    attached_ = std::move(attached);
    attached_stamp_ = message->header.stamp;
    if (newest_) publish();
  }

  /// One that nobody holds any more.
  std::shared_ptr<CuboidMap> takeMap() {
    for (const auto& map : maps_) {
      if (map.use_count() > 1) continue;
      std::atomic_thread_fence(std::memory_order_acquire);  // who let go of it may have read it
      return map;
    }
    return makeMap();
  }

  /// As MessagePool::grow().
  [[gnu::noinline]] std::shared_ptr<CuboidMap> makeMap() {
    maps_.push_back(std::make_shared<CuboidMap>());
    mapper_->reserve(*maps_.back());
    return maps_.back();
  }

  void publish() {
    const auto published = published_.take();
    published->map.reset();
    published->map = takeMap();
    mapper_->snapshot(*published->map);
    mapper_->apply(*ages_, *published->map);
    trace_.note("snapshot is taken");
    published->frame = frame_;
    published->attached_stamp = attached_stamp_;
    newest_ = published;
    map_publisher_.publish(newest_);
  }

  void publishMarkers() {
    if (!newest_ || marker_publisher_.getNumSubscribers() == 0) return;
    tccm_monitor::CuboidMap map;
    toMessage(*newest_, map);
    for (const CuboidLayer layer : {CuboidLayer::kLive, CuboidLayer::kHeld}) {
      marker_publisher_.publish(toMarker(map, layer, config_.static_windows));
    }
  }

  bool clearMap(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    mapper_->clear();
    is_cleared_ = true;
    response.success = true;
    response.message = "the map is empty until the next scan, and INIT for a whole window";
    if (newest_) publish();
    return true;
  }

  bool getCuboidMap(tccm_monitor::GetCuboidMap::Request& /*request*/,
                    tccm_monitor::GetCuboidMap::Response& response) {
    response.success = newest_ != nullptr;
    if (newest_) toMessage(*newest_, response.map);
    if (!newest_) response.message = "no scan was mapped yet";
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    using diagnostic_msgs::DiagnosticStatus;
    static const CuboidMap none;
    const CuboidMap& newest = newest_ ? *newest_->map : none;
    if (lacks_window_) {
      status.summary(DiagnosticStatus::ERROR, kLacksWindow);
    } else if (mapped_ == 0) {
      status.summary(DiagnosticStatus::ERROR, "no scan_cloud and no cloud_scan yet");
    } else if (newest.overflowed) {
      status.summary(DiagnosticStatus::ERROR,
                     left_out_.empty() ? "points are left out: raise held_max" : left_out_);
    } else if (!newest.complete && mapper_->map().scans() == config_.mapper.map.scans_max) {
      status.summary(DiagnosticStatus::ERROR, "window_scans_max is too small for the window");
    } else if (newest.tilt_stopped) {
      status.summary(DiagnosticStatus::ERROR, "the tilt stands still, or does not go as far");
    } else if (mapper_->tiltTooFast()) {
      status.summary(DiagnosticStatus::ERROR,
                     "the tilt seems to turn more often than tilt_period_min_s: see whether one "
                     "sensor alone publishes on the scans' topic");
    } else if (!newest.complete) {
      status.summary(DiagnosticStatus::WARN, "the map does not hold a whole window yet");
    } else {
      status.summary(DiagnosticStatus::OK, "the map holds the whole window");
    }
    status.add("scans mapped", mapped_);
    status.add("scans dropped", dropped_);
    status.add("points mapped", added_.mapped);
    status.add("points out of area", added_.out_of_area);
    status.add("points of attached objects forgotten", forgotten_);
    status.add("cuboids", newest.cuboids.size());
    status.add("window [scans]", mapper_->map().scans());
    const auto tilt = mapper_->tiltPeriod();
    if (newest.self_share) status.add("share taken for the robot", *newest.self_share);
    status.add("tilt period [s]", tilt ? std::to_string(toSeconds(*tilt)) : "not measured yet");
    status.add("held intervals", mapper_->held());
    status.add("memory [bytes]", mapper_->memoryBytes() + ages_->memoryBytes());
  }

  MapperConfig config_;
  std::unique_ptr<Mapper> mapper_;
  std::unique_ptr<PlaceAges> ages_;
  ScanReturns returns_;
  std::string frame_;
  bool is_cleared_ = false;                       ///< nothing was mapped since
  std::vector<std::shared_ptr<CuboidMap>> maps_;  ///< used again once nobody holds them
  MessagePool<PublishedMap> published_;
  PublishedMap::ConstPtr newest_;
  std::map<std::string, ros::Time> attached_;  ///< forget_until of those taken into account
  ros::Time attached_stamp_;
  std::size_t mapped_ = 0;
  std::size_t dropped_ = 0;
  bool lacks_window_ = false;
  std::string left_out_;  ///< lately, for people; empty where nothing was
  std::size_t forgotten_ = 0;
  IntegrationMap::Added added_;
  ScanTracer trace_;
  ros::Publisher map_publisher_, marker_publisher_;
  std::vector<ros::ServiceServer> services_;
  std::vector<ros::Subscriber> inputs_;
  ros::WallTimer marker_timer_;
};

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::TccmMapper, nodelet::Nodelet)
