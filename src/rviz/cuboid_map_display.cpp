#include "rviz/cuboid_map_display.h"

#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/color_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/int_property.h>
#include <rviz/properties/ros_topic_property.h>

#include <algorithm>
#include <initializer_list>
#include <pluginlib/class_list_macros.hpp>
#include <string>
#include <utility>

#include "ros/conversions.h"
#include "rviz/cuboid_mesh.h"

namespace tccm {
namespace {

using rviz::StatusProperty;

constexpr std::size_t kCuboidsMax = 200000;  ///< ten times what a large map has
constexpr double kSilence = 2.0;             ///< [s] without a map
constexpr double kCounted = 2.0;             ///< [s] until frames are told of
constexpr double kFlaggedFor = 1.0;          ///< [s] without a status

Rgba toRgba(const QColor& color) {
  return {static_cast<std::uint8_t>(color.red()), static_cast<std::uint8_t>(color.green()),
          static_cast<std::uint8_t>(color.blue()), 255};
}

std::vector<FlaggedPlace> flaggedOf(const tccm_monitor::MonitorStatus& status) {
  std::vector<FlaggedPlace> flagged;
  flagged.reserve(status.flagged.size());
  for (const tccm_monitor::CuboidFlag& flag : status.flagged) {
    flagged.push_back({flag.cell, static_cast<double>(flag.bottom), static_cast<double>(flag.top),
                       flag.col == tccm_monitor::Cuboid::COLLISION});
  }
  return flagged;
}

}  // namespace

CuboidMapDisplay::CuboidMapDisplay() {
  coloring_ = new rviz::EnumProperty("Colour by", "Verdict",
                                     "Verdict: as Dynamic, and what the last check flagged: "
                                     "magenta where a link touches it, blue where it hides "
                                     "one. Dynamic: static green, dynamic red, held violet. Age: "
                                     "from blue to red, for how many windows something "
                                     "has been there. Height: of its top, from blue to red. "
                                     "Sensor: all in one colour. Held: held ones violet.",
                                     this);
  for (const auto& [name, coloring] :
       {std::pair("Verdict", CuboidColoring::kVerdict),
        std::pair("Dynamic", CuboidColoring::kDynamic), std::pair("Age", CuboidColoring::kAge),
        std::pair("Height", CuboidColoring::kHeight), std::pair("Sensor", CuboidColoring::kSensor),
        std::pair("Held", CuboidColoring::kHeld)}) {
    coloring_->addOption(name, static_cast<int>(coloring));
  }
  alpha_ = new rviz::FloatProperty("Alpha", 1.0F, "Opacity of all, 0 to 1", this);
  alpha_->setMin(0.0F);
  alpha_->setMax(1.0F);
  sensor_color_ =
      new rviz::ColorProperty("Sensor colour", QColor(64, 191, 77),
                              "Of all cuboids, where the colour tells the sensor", this);
  static_windows_ = new rviz::IntProperty(
      "Static windows", 3,
      "For so many windows what is static has been there; the mapper's static_windows", this);
  static_windows_->setMin(1);
  status_topic_ = new rviz::RosTopicProperty(
      "Status topic", "monitor_status",
      QString::fromStdString(ros::message_traits::datatype<tccm_monitor::MonitorStatus>()),
      "Whose flagged cuboids are shown, where the colour tells the verdict", this);
  for (const rviz::Property* property : std::initializer_list<const rviz::Property*>{
           coloring_, alpha_, sensor_color_, static_windows_}) {
    connect(property, &rviz::Property::changed, this, &CuboidMapDisplay::changeLook);
  }
  connect(status_topic_, &rviz::Property::changed, this, &CuboidMapDisplay::changeStatusTopic);
}

CuboidMapDisplay::~CuboidMapDisplay() {
  CuboidMapDisplay::unsubscribe();
  for (const auto* mesh : {&live_, &held_}) {
    if (*mesh) scene_node_->detachObject(mesh->get());
  }
}

void CuboidMapDisplay::onInitialize() {
  MFDClass::onInitialize();
  for (auto* mesh : {&live_, &held_}) {
    *mesh = std::make_unique<CuboidMesh>();
    scene_node_->attachObject(mesh->get());
  }
  changeLook();
}

void CuboidMapDisplay::reset() {
  MFDClass::reset();
  newest_.reset();
  shown_ = false;
  silent_ = false;
  heard_ = ros::WallTime();
  setFlagged({});
  hide();
}

void CuboidMapDisplay::hide() {
  for (const auto* mesh : {&live_, &held_}) {
    if (*mesh) (*mesh)->clear();
  }
}

void CuboidMapDisplay::subscribe() {
  MFDClass::subscribe();
  changeStatusTopic();
}

void CuboidMapDisplay::unsubscribe() {
  MFDClass::unsubscribe();
  status_subscriber_.shutdown();
}

void CuboidMapDisplay::changeLook() {
  look_.coloring = static_cast<CuboidColoring>(coloring_->getOptionInt());
  look_.opacity = static_cast<double>(alpha_->getFloat());
  look_.sensor = toRgba(sensor_color_->getColor());
  look_.static_windows = static_cast<std::uint32_t>(std::max(1, static_windows_->getInt()));
  const bool one_color = look_.coloring == CuboidColoring::kSensor;
  sensor_color_->setHidden(!one_color);
  const bool dated = look_.coloring == CuboidColoring::kVerdict ||
                     look_.coloring == CuboidColoring::kDynamic ||
                     look_.coloring == CuboidColoring::kAge;
  static_windows_->setHidden(!dated);
  status_topic_->setHidden(look_.coloring != CuboidColoring::kVerdict);
  changed_ = true;
  if (initialized()) changeStatusTopic();
}

void CuboidMapDisplay::changeStatusTopic() {
  status_subscriber_.shutdown();
  setFlagged({});
  const std::string topic = status_topic_->getTopicStd();
  if (!isEnabled() || look_.coloring != CuboidColoring::kVerdict || topic.empty()) return;
  try {
    status_subscriber_ = update_nh_.subscribe<tccm_monitor::MonitorStatus>(
        topic, 1,
        [this](const tccm_monitor::MonitorStatus::ConstPtr& status) { takeStatus(*status); });
  } catch (const ros::Exception& error) {
    setStatusStd(StatusProperty::Error, "Status", error.what());
  }
}

void CuboidMapDisplay::takeStatus(const tccm_monitor::MonitorStatus& status) {
  flagged_heard_ = ros::WallTime::now();
  setFlagged(flaggedOf(status));
}

void CuboidMapDisplay::setFlagged(std::vector<FlaggedPlace> flagged) {
  if (flagged == flagged_) return;
  flagged_ = std::move(flagged);
  changed_ = true;
}

void CuboidMapDisplay::processMessage(const tccm_monitor::CuboidMap::ConstPtr& message) {
  newest_ = message;
}

void CuboidMapDisplay::update(float wall_dt, float /*ros_dt*/) {
  countFrame(wall_dt);
  if (newest_) {
    shown_ = takeMap(*newest_);
    newest_.reset();
    changed_ = true;
    heard_ = ros::WallTime::now();
    if (!shown_) hide();
  }
  // What an old check found may be gone.
  if (!flagged_.empty() && (ros::WallTime::now() - flagged_heard_).toSec() > kFlaggedFor) {
    setFlagged({});
  }
  if (shown_ && changed_) draw();
  tellSilence();
}

bool CuboidMapDisplay::takeMap(const tccm_monitor::CuboidMap& message) {
  std::string defect;
  if (message.cuboids.size() > kCuboidsMax) {
    defect = "it has more than " + std::to_string(kCuboidsMax) + " cuboids";
  } else {
    defect = fromMessage(message, map_);
  }
  if (!defect.empty()) {
    setStatusStd(StatusProperty::Error, "Map", "not drawn: " + defect);
    return false;
  }
  return place(message.header);
}

bool CuboidMapDisplay::place(const std_msgs::Header& header) {
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  if (!context_->getFrameManager()->getTransform(header, position, orientation)) {
    setStatusStd(
        StatusProperty::Error, "Transform",
        "from '" + header.frame_id + "' to '" + fixed_frame_.toStdString() + "' is missing");
    return false;
  }
  setStatusStd(StatusProperty::Ok, "Transform", "OK");
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  return true;
}

void CuboidMapDisplay::draw() {
  const ros::WallTime begin = ros::WallTime::now();
  geometry_.build(map_, look_, flagged_);
  live_->show(geometry_.live());
  held_->show(geometry_.held());
  changed_ = false;
  context_->queueRender();
  counted_.drawing_s += (ros::WallTime::now() - begin).toSec();
  ++counted_.drawn;
  const std::string text = std::to_string(map_.cuboids.size()) + " cuboids, " +
                           std::to_string(geometry_.faces()) + " faces";
  if (map_.overflowed) {
    setStatusStd(StatusProperty::Warn, "Map", text + "; points are missing");
  } else {
    setStatusStd(StatusProperty::Ok, "Map", text);
  }
}

void CuboidMapDisplay::tellSilence() {
  if (heard_.isZero()) return;
  const double silence = (ros::WallTime::now() - heard_).toSec();
  const bool silent = silence > kSilence;
  if (silent) {
    setStatus(StatusProperty::Warn, "Age", QString("silent for %1 s").arg(silence, 0, 'f', 0));
  } else if (silent_) {
    deleteStatus("Age");
  }
  silent_ = silent;
}

void CuboidMapDisplay::countFrame(float wall_dt) {
  Counted& c = counted_;
  c.wall_s += static_cast<double>(wall_dt);
  c.longest_s = std::max(c.longest_s, static_cast<double>(wall_dt));
  ++c.frames;
  if (c.wall_s < kCounted) return;
  if (c.drawn > 0) {
    ROS_DEBUG_NAMED(
        "cuboid_map_display",
        "%zu cuboids, %zu faces: %.1f frames a second, the longest %.0f ms; drawn anew %.1f times "
        "a second, in %.1f ms",
        map_.cuboids.size(), geometry_.faces(), c.frames / c.wall_s, 1e3 * c.longest_s,
        c.drawn / c.wall_s, 1e3 * c.drawing_s / c.drawn);
  }
  c = {};
}

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::CuboidMapDisplay, rviz::Display)
