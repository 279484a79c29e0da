#include "nodelets/trajectory_questions.h"

#include <tccm_monitor/ReportGoal.h>

#include <utility>

#include "base/line_of.h"
#include "tccm_monitor/verdict.h"

namespace tccm {

using tccm_monitor::CheckTrajectory;
using tccm_monitor::ReportGoal;

TrajectoryQuestions::TrajectoryQuestions(const ros::NodeHandle& node)
    : check_(node, "check_trajectory", ros::service_traits::MD5Sum<CheckTrajectory>::value()),
      report_(node, "report_goal", ros::service_traits::MD5Sum<ReportGoal>::value()),
      thread_([this] { run(); }) {}

TrajectoryQuestions::~TrajectoryQuestions() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  news_.notify_one();
  check_.end();
  report_.end();
  thread_.join();
}

void TrajectoryQuestions::add(std::function<void()> task) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back(std::move(task));
  }
  news_.notify_one();
}

std::shared_ptr<const TrajectoryQuestions::Question> TrajectoryQuestions::ask(
    const trajectory_msgs::JointTrajectory& way) {
  auto question = std::make_shared<Question>();
  add([this, way, question] {
    if (question.use_count() == 1) return;  // nobody waits for the answer any more
    const Answer answer = call(way);
    const std::lock_guard<std::mutex> lock(question->mutex_);
    question->answer_ = answer;
  });
  return question;
}

std::shared_ptr<void> TrajectoryQuestions::report(const std::string& owner,
                                                  const std::string& goal) {
  add([this, owner, goal] { call(owner, goal, true); });
  return {nullptr, [this, owner, goal](void* /*nothing*/) {
            add([this, owner, goal] { call(owner, goal, false); });
          }};
}

void TrajectoryQuestions::run() {
  while (true) {
    std::function<void()> task;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      news_.wait(lock, [this] { return is_over_ || !waiting_.empty(); });
      if (is_over_) return;
      task = std::move(waiting_.front());
      waiting_.pop_front();
    }
    task();
  }
}

TrajectoryQuestions::Answer TrajectoryQuestions::call(const trajectory_msgs::JointTrajectory& way) {
  CheckTrajectory::Request request;
  request.trajectory = way;
  CheckTrajectory::Response response;
  if (!check_.call(request, response)) return {false, false, "check_trajectory does not answer"};
  if (response.result == CheckTrajectory::Response::FREE) {
    return {true, response.reason == name(Reason::kMovingOut), {}};
  }
  std::string why = "not free: " + response.reason + ", " + response.detail;
  if (response.detail.find(response.link) == std::string::npos) why += ", " + response.link;
  if (response.time_from_start > 0.0) {
    why += lineOf(", %.2f s from its start", response.time_from_start);
  }
  return {false, false, why};
}

/// A checker that does not take it has no exemption that begins with the goal.
void TrajectoryQuestions::call(const std::string& owner, const std::string& goal, bool under_way) {
  ReportGoal::Request request;
  request.owner = owner;
  request.goal = goal;
  request.under_way = static_cast<std::uint8_t>(under_way);
  ReportGoal::Response response;
  if (!report_.call(request, response)) return;
  if (response.success == 0) ROS_WARN("report_goal: %s", response.message.c_str());
}

}  // namespace tccm
