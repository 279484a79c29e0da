#pragma once

#include <ros/ros.h>
#include <tccm_monitor/CheckTrajectory.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "ros/service_line.h"

namespace tccm {

/// Asks `check_trajectory`, and reports goals, in a thread of its own: while a checker thinks, or
/// hangs, permissions are heard and setpoints go out.
class TrajectoryQuestions {
 public:
  struct Answer {
    bool is_free = false;
    bool moves_out = false;  ///< of a contact: the monitor permits it once it is commanded
    std::string why;         ///< it is not free, in one line
  };
  /// One question on its way.
  class Question {
   public:
    /// Nothing as long as there is none.
    [[nodiscard]] std::optional<Answer> answer() const {
      const std::lock_guard<std::mutex> lock(mutex_);
      return answer_;
    }

   private:
    friend class TrajectoryQuestions;
    mutable std::mutex mutex_;
    std::optional<Answer> answer_;
  };

  explicit TrajectoryQuestions(const ros::NodeHandle& node);
  TrajectoryQuestions(const TrajectoryQuestions&) = delete;
  TrajectoryQuestions& operator=(const TrajectoryQuestions&) = delete;
  ~TrajectoryQuestions();

  [[nodiscard]] std::shared_ptr<const Question> ask(const trajectory_msgs::JointTrajectory& way);
  /// A goal is under way, for what is asked after that, as long as what is returned is kept:
  /// exemptions begin and end with it. @param owner the node that sent it. @param goal its id.
  [[nodiscard]] std::shared_ptr<void> report(const std::string& owner, const std::string& goal);

 private:
  void run();
  void add(std::function<void()> task);
  [[nodiscard]] Answer call(const trajectory_msgs::JointTrajectory& way);
  void call(const std::string& owner, const std::string& goal, bool under_way);

  ServiceLine check_, report_;
  std::mutex mutex_;
  std::condition_variable news_;
  std::deque<std::function<void()>> waiting_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace tccm
