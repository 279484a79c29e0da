#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "config/parameter_table.h"
#include "robot/frame_chain.h"
#include "robot/joint_track.h"
#include "tccm_monitor/robot_model.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

/// Compares where transforms put the monitored links and the sensors with where the URDF and joint
/// states put them, at equal stamps. Off the way from scan to verdict, ten times a second at most.
///
/// Every frame is compared against the next one above that transforms place anyhow: the robot's
/// root, a trusted frame, or one under a floating or planar joint.
class ModelAgreement {
 public:
  struct Config {
    double tolerance_m = 0.03;  ///< at the link's far end

    void describe(ParameterTable& table);
  };

  /// Where transforms have one frame in another.
  struct Transforms {
    struct Newest {
      Time stamp;
      Pose pose;
      bool is_static;
    };
    std::function<std::optional<Newest>(const std::string& reference, const std::string& frame)>
        newest;
    /// Nothing where the transforms around the stamp are missing, or too far apart.
    std::function<std::optional<Pose>(const std::string& reference, const std::string& frame,
                                      Time stamp)>
        at;
  };

  /// What came of one frame.
  struct Compared {
    enum class State : std::uint8_t { kNoTransform, kNoJoints, kCompared };

    std::string link;
    std::string reference;  ///< the link that it is compared against
    bool is_sensor = false;
    State state = State::kNoTransform;  ///< at the last attempt
    std::size_t comparisons = 0;
    std::size_t beyond = 0;     ///< of them beyond the tolerance
    double worst_m = 0.0;       ///< at equal stamps, whatever explains it
    bool disagrees = false;     ///< lately, and not once only
    bool did_disagree = false;  ///< it disagreed at any time
  };

  /// @throws ConfigError
  ModelAgreement(std::shared_ptr<const RobotModel> model, const Config& config);

  /// Another tolerance from now on.
  void reconfigure(const Config& config);
  void addJoints(Time stamp, const std::vector<std::string>& names,
                 const std::vector<double>& positions);
  /// A sensor that scans come from. @param frame as tf calls it, without a slash in front.
  void watchSensor(const std::string& frame);
  /// Does nothing where it did something less than a tenth of a second ago. @return whether it did.
  bool compare(Time now, const Transforms& transforms);
  void reset();

  /// MODEL_DISAGREES where a frame does; else kClear.
  [[nodiscard]] const Cause& cause() const { return cause_; }
  /// What the first such cause said; empty where there was none.
  [[nodiscard]] const std::string& firstDisagreement() const { return first_disagreement_; }
  /// Monitored links from the root on, then sensors; without those that transforms place anyhow.
  [[nodiscard]] std::vector<Compared> compared() const;
  /// What is not compared, and why, for people: "laser: the URDF does not know it". Links are told
  /// once there was time to hear of them.
  [[nodiscard]] std::vector<std::string> notCompared() const;

 private:
  struct Frame {
    Compared result;
    std::string tf_reference, tf_frame;
    FrameChain chain;
    std::vector<Vector3> points;  ///< at which displacements are measured, in the link's frame
    std::vector<Time> awaited;    ///< instants of transforms that joint states have to reach
    std::optional<Time> stamp;    ///< compared last
    std::optional<Time> when;     ///< and by the clock
    std::uint32_t history = 0;    ///< a bit for each of the last comparisons: beyond the tolerance
    Displacement last;
  };

  void addFrame(const std::string& link, std::vector<Vector3> points, bool is_sensor);
  void compareFrame(Frame& frame, Time now, const Transforms& transforms);
  /// The instant to compare at; nothing where there is none yet.
  [[nodiscard]] std::optional<Time> instantOf(Frame& frame, const Transforms::Newest& newest) const;
  /// Fills positions_. @return false where joint states around the instant are missing.
  [[nodiscard]] bool findPositions(const Frame& frame, Time stamp);
  /// Of tf from where positions_ put the frame.
  [[nodiscard]] Displacement displacementOf(const Frame& frame, const Pose& by_tf) const;
  /// Whether joint states of a moment before or after put the frame where tf has it.
  [[nodiscard]] bool isExplainedByStamps(const Frame& frame, Time stamp, const Pose& by_tf);
  void note(Frame& frame, Time now, Time stamp, const Displacement& displacement, bool is_beyond);
  void renewCause();
  /// It was never compared: the cause, for people.
  [[nodiscard]] std::string whyNot(const Frame& frame) const;

  std::shared_ptr<const RobotModel> model_;
  Config config_;
  std::unordered_map<std::string, std::size_t> variables_;  ///< by joint
  std::vector<JointTrack> tracks_;                          ///< by variable of model_->frames()
  std::vector<double> positions_;                           ///< reused
  std::vector<Frame> frames_;
  std::vector<std::string> sensors_;          ///< that were heard of, as tf calls them
  std::vector<std::string> unknown_sensors_;  ///< of them those that the URDF does not know
  std::optional<Time> first_, last_;          ///< attempts
  Cause cause_;
  std::string first_disagreement_;
};

}  // namespace tccm
