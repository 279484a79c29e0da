#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config_draft.h"
#include "floor.h"
#include "listener.h"
#include "monitor_config.h"
#include "survey.h"
#include "tccm_monitor/robot_model.h"

namespace tccm {

/// What a first run through the monitor shows of a robot and its surroundings.
struct Lessons {
  std::vector<std::optional<double>> tilt_periods_s;  ///< by sensor
  std::vector<Vector3> points;                        ///< in the fixed frame, the robot's left out
  double joint_age_s = 0.0;        ///< the largest of a check, but for those that are faults
  std::vector<double> map_ages_s;  ///< likewise, by sensor
  /// Mean visible fraction of links watched for occlusion, where they are large enough to tell.
  std::map<std::string, double> visible;
  /// By sensor: points inside the area or on the floor below it, the robot's left out.
  std::vector<std::size_t> points_in_area;
};

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
  /// Puts the TrajectoryGate before them.
  void setGate(const std::vector<ArmController>& controllers);

 private:
  void chooseFixedFrame();
  void chooseSensors();
  void configure(const Sensor& sensor);
  void configureCloud(const Sensor& sensor);
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
  std::vector<std::string> hands_;        ///< links far out on the arms
  std::vector<std::string> notes_, defects_;
};

}  // namespace tccm
