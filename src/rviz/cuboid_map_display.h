#pragma once

#include <ros/time.h>
#include <rviz/message_filter_display.h>
#include <tccm_monitor/CuboidMap.h>
#include <tccm_monitor/MonitorStatus.h>

#include <memory>
#include <vector>

#include "rviz/cuboid_geometry.h"

namespace rviz {
class ColorProperty;
class EnumProperty;
class FloatProperty;
class IntProperty;
class RosTopicProperty;
}  // namespace rviz

namespace tccm {

class CuboidMesh;

/// Draws a CuboidMap. What is wrong with a map is told, and nothing of it drawn. At most one map is
/// made into a picture for each frame, the newest.
class CuboidMapDisplay : public rviz::MessageFilterDisplay<tccm_monitor::CuboidMap> {
  Q_OBJECT

 public:
  CuboidMapDisplay();
  ~CuboidMapDisplay() override;

  void onInitialize() override;
  void reset() override;
  void update(float wall_dt, float ros_dt) override;

 protected:
  void subscribe() override;
  void unsubscribe() override;

 private:
  void changeLook();
  void changeStatusTopic();
  void processMessage(const tccm_monitor::CuboidMap::ConstPtr& message) override;
  void takeStatus(const tccm_monitor::MonitorStatus& status);
  void setFlagged(std::vector<FlaggedPlace> flagged);
  /// @return whether there is a map to draw, and where.
  bool takeMap(const tccm_monitor::CuboidMap& message);
  bool place(const std_msgs::Header& header);
  void hide();
  void draw();
  void tellSilence();
  void countFrame(float wall_dt);

  rviz::EnumProperty* coloring_;
  rviz::FloatProperty* alpha_;
  rviz::ColorProperty* sensor_color_;
  rviz::IntProperty* static_windows_;
  rviz::RosTopicProperty* status_topic_;

  CuboidLook look_;
  CuboidMap map_;
  CuboidGeometry geometry_;
  std::unique_ptr<CuboidMesh> live_, held_;
  tccm_monitor::CuboidMap::ConstPtr newest_;  ///< not drawn yet
  bool shown_ = false;                        ///< map_ is sound, and where it is is known
  bool changed_ = false;                      ///< the picture is not that of map_ any more
  bool silent_ = false;
  ros::WallTime heard_;  ///< the newest map
  ros::Subscriber status_subscriber_;
  std::vector<FlaggedPlace> flagged_;
  ros::WallTime flagged_heard_;
  struct Counted {
    double wall_s = 0.0, longest_s = 0.0, drawing_s = 0.0;
    int frames = 0, drawn = 0;
  } counted_;
};

}  // namespace tccm
