#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config_draft.h"
#include "floor.h"
#include "lessons.h"
#include "listener.h"
#include "monitor_config.h"
#include "own_returns.h"
#include "survey.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

constexpr double kHeadroom = 1.3;  ///< limits are so much above what was heard

/// Upwards.
inline double roundedTo(double value, double step) { return step * std::ceil(value / step - 1e-9); }

/// A configuration for a robot of which a survey is known.
class SetupDraft {
 public:
  /// A sensor that the monitor is to use.
  struct Sensor {
    std::string name;  ///< empty: the only one
    const Survey::Sensor* heard;
  };

  /// @param survey outlives it. @param model nothing: the surroundings are mapped alone.
  SetupDraft(const Survey& survey, std::shared_ptr<const RobotModel> model);

  static constexpr double kGapMax = 0.5;      ///< [s] of joint states; more is a fault
  static constexpr double kPeriodsMax = 8.0;  ///< that scans may be silent for; likewise

  [[nodiscard]] const std::vector<Sensor>& sensors() const { return sensors_; }
  [[nodiscard]] const std::string& jointTopic() const { return joint_topic_; }
  /// What people should know of it, and what is wrong with what the sensors see; a line each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  [[nodiscard]] const std::vector<std::string>& defects() const { return defects_; }
  [[nodiscard]] std::string yaml() const { return text_.yaml(); }
  /// As programs read it. @throws ConfigError
  [[nodiscard]] MonitorConfig settings() const;
  /// The same for a run that is to teach something: all heights, and room for a long tilt.
  [[nodiscard]] MonitorConfig trialSettings() const;
  /// @param is_patient limits of time are no shorter than suit a computer that pauses now and then.
  void learn(const Lessons& lessons, bool is_patient);
  /// The self filter's padding. @return false where the model is not what was seen: then a defect.
  bool learnModel(const OwnReturns& own);
  /// Puts the TrajectoryGate before them. @pre it has learned.
  void setGate(const std::vector<ArmController>& controllers);

 private:
  void chooseFixedFrame();
  void chooseSensors();
  void configure(const Sensor& sensor);
  /// What of a sensor was heard, for people.
  [[nodiscard]] static std::string whatOf(const Survey::Sensor& heard);
  void configureCloud(const Sensor& sensor);
  void setTopic(const Sensor& sensor, const std::string& why);
  void setNoise(const Sensor& sensor);
  void chooseArea();
  void chooseLinks();
  void chooseTimes();
  void setTimes(const Lessons& lessons, bool is_patient);
  void setFloor(const std::optional<Floor>& floor);
  [[nodiscard]] std::string sectionOf(const Sensor& sensor, const std::string& stage) const;
  [[nodiscard]] bool tilts(const Survey::Sensor& sensor) const;

  const Survey& survey_;
  std::shared_ptr<const RobotModel> model_;
  ConfigDraft text_;
  std::vector<Sensor> sensors_;
  std::string base_frame_;  ///< the robot's root, or what stands for it
  std::string fixed_frame_;
  std::string joint_topic_;
  Pose T_fixed_base_ = Pose::Identity();  ///< at the beginning
  double bottom_m_ = 0.0;                 ///< height of the robot's lowest part in the fixed frame
  /// The joint states' timeout [s] and its remark, where the default is too short.
  std::optional<std::pair<double, std::string>> joints_late_;
  std::vector<std::string> hands_;  ///< links far out on the arms
  std::vector<std::string> notes_, defects_;
};

}  // namespace tccm
