#include "check/trajectory_check.h"

#include <algorithm>

#include "base/line_of.h"

namespace tccm {
namespace {

/// In the unit of CollisionCheck::work(): some 0.3 s. A trajectory of 100 points takes a
/// thousandth.
constexpr std::size_t kWorkMax = 60'000'000;
constexpr double kTravelMax = 1e4;         // [rad or m] of one joint; there is no need to begin
constexpr std::size_t kWorkOfPose = 30;    // for each joint and shape
constexpr double kLeavingPoses = 400.0;    // that are looked at for the end of a contact
constexpr double kSplineTolerance = 5e-4;  // [rad or m]

std::string atTime(const std::string& what, double time_s) {
  return lineOf("%.150s after %.3f s", what.c_str(), time_s);
}

}  // namespace

void TrajectoryCheck::Config::describe(ParameterTable& table) {
  table.add("trajectory_step_m", &step_m, "m", {1e-4, 0.1},
            "as `way_step_m`, for `check_trajectory`: a contact that is passed over is no deeper "
            "than half of it");
  table.add("trajectory_occlusion_poses", &occlusion_poses, "", {1, 1000},
            "so many waypoints, spread evenly, are looked at for occlusion");
}

TrajectoryCheck::TrajectoryCheck(const std::shared_ptr<const CheckedRobot>& robot,
                                 const Config& config, double clearance_radius_m,
                                 double old_periods)
    : robot_(robot),
      config_(validated(config)),
      pose_(robot, old_periods),
      way_(robot, config.step_m),
      moving_out_(robot),
      clearance_radius_m_(clearance_radius_m),
      path_(robot->model->variables().size()) {}

TrajectoryAnswer TrajectoryCheck::check(const Surroundings& around,
                                        const JointTrajectory& trajectory,
                                        const std::vector<double>& from,
                                        const std::vector<Pose>& T_fixed_roots) {
  TrajectoryAnswer answer;
  const std::string defect = defectOf(trajectory, *robot_->model, from);
  if (!defect.empty()) {
    answer.cause = {Reason::kBadQuestion, defect};
    return answer;
  }
  if (!makePath(trajectory, *robot_->model, from, kSplineTolerance, path_)) return tooLong();
  path_.travelUntil(path_.end(), positions_);
  if (*std::max_element(positions_.begin(), positions_.end()) > kTravelMax) return tooLong();
  const Way way{around.map, path_, T_fixed_roots};
  if (!findClearances(around, way, trajectory, answer)) return tooLong();
  findContact(around, way, trajectory, answer);
  if (around.keep_out) {
    findContact(around, {*around.keep_out, path_, T_fixed_roots}, trajectory, answer);
  }
  if (way_.isTooLong()) return tooLong();
  const bool is_free =
      answer.cause.reason == Reason::kClear || answer.cause.reason == Reason::kMovingOut;
  if (is_free && robot_->config.check_occlusion) {
    findOcclusion(around, way, trajectory, answer);
  }
  return answer;
}

TrajectoryAnswer TrajectoryCheck::tooLong() {
  TrajectoryAnswer answer;
  answer.cause = {Reason::kCheckLate,
                  "it is too long to judge within a second: ask for a part of it"};
  return answer;
}

bool TrajectoryCheck::findClearances(const Surroundings& around, const Way& way,
                                     const JointTrajectory& trajectory, TrajectoryAnswer& answer) {
  const RobotModel& model = *robot_->model;
  const std::size_t begun = robot_->collision.work();
  const std::size_t each = kWorkOfPose * (model.joints().size() + model.shapes().size());
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    place(way, trajectory.points[i].time_s);
    answer.clearances_m.push_back(pose_.leastClearance(around, clearance_radius_m_));
    const std::size_t done = robot_->collision.work() - begun + (i + 1) * each;
    if (done > kWorkMax) return false;
    way_.allow(kWorkMax - done);
  }
  return true;
}

void TrajectoryCheck::place(const Way& way, double time_s) {
  way.path.positionsAt(time_s, positions_);
  pose_.place(positions_, way.T_fixed_roots);
}

double TrajectoryCheck::findLeft(const Surroundings& around, const Way& way) {
  const bool are_regions = way.obstacles.keepOut() != nullptr;
  const double begin_s = way.path.begin(), end_s = way.path.end();
  way_.leave({});
  place(way, begin_s);
  pose_.findContacts(around, findings_);
  const std::vector<Contact>& contacts = are_regions ? findings_.keep_out : findings_.contacts;
  if (contacts.empty() || !moving_out_.opens(way, contacts, true)) return begin_s;
  const std::vector<Contact>& later = are_regions ? later_.keep_out : later_.contacts;
  const auto lasts = [&later](const Contact& contact) {
    return std::any_of(later.begin(), later.end(), [&](const Contact& found) {
      return found.shape == contact.shape && found.cuboid == contact.cuboid;
    });
  };
  for (double pose = 1.0; pose <= kLeavingPoses; ++pose) {
    const double time_s = begin_s + (end_s - begin_s) * pose / kLeavingPoses;
    place(way, time_s);
    pose_.findContacts(around, later_);
    if (std::any_of(contacts.begin(), contacts.end(), lasts)) continue;
    way_.leave(contacts);
    return time_s;
  }
  return begin_s;
}

bool TrajectoryCheck::isFree(const Way& way, double from_s, double to_s, std::size_t index,
                             TrajectoryAnswer& answer) {
  const auto found = way_.firstContact(way, from_s, to_s, from_s == way.path.begin());
  if (!found) return true;
  const double time_s = from_s + found->time_s;
  if (answer.index && time_s >= answer.time_s) return false;
  const KeepOut* keep_out = way.obstacles.keepOut();
  const Contact& contact = found->contact;
  const std::string& link = robot_->model->linkOf(contact.shape);
  const std::string what =
      link + (keep_out ? " enters keep-out region '" + keep_out->name(contact.cuboid) + "'"
                       : " touches the map");
  answer.index = index;
  answer.time_s = time_s;
  answer.contact.reset();
  if (!keep_out) answer.contact = contact;
  answer.cause = {keep_out ? Reason::kKeepOut : Reason::kCollision, atTime(what, time_s), link};
  return false;
}

void TrajectoryCheck::findContact(const Surroundings& around, const Way& way,
                                  const JointTrajectory& trajectory, TrajectoryAnswer& answer) {
  double from_s = way.path.begin();
  const double left_s = findLeft(around, way);
  if (left_s > from_s && answer.cause.reason == Reason::kClear) {
    const bool are_regions = way.obstacles.keepOut() != nullptr;
    const Contact& contact = (are_regions ? findings_.keep_out : findings_.contacts).front();
    const std::string& link = robot_->model->linkOf(contact.shape);
    answer.cause = {Reason::kMovingOut, link + " moves out of contact", link};
  }
  const std::size_t end = answer.index ? *answer.index + 1 : trajectory.points.size();
  for (std::size_t i = 0; i < end; ++i) {
    const double to_s = trajectory.points[i].time_s;
    if (from_s < left_s && left_s < to_s) {
      if (!isFree(way, from_s, left_s, i, answer)) return;
      from_s = left_s;
    }
    if (from_s >= left_s) way_.leave({});
    if (!isFree(way, from_s, to_s, i, answer)) return;
    from_s = to_s;
  }
}

void TrajectoryCheck::findOcclusion(const Surroundings& around, const Way& way,
                                    const JointTrajectory& trajectory, TrajectoryAnswer& answer) {
  const std::size_t points = trajectory.points.size();
  const auto poses = std::min(points, static_cast<std::size_t>(config_.occlusion_poses));
  for (std::size_t k = 1; k <= poses; ++k) {
    const std::size_t i = k * points / poses - 1;  // the last one is among them
    const double time_s = trajectory.points[i].time_s;
    place(way, time_s);
    pose_.findOcclusion(around, findings_);
    const std::string hidden = pose_.mostHiddenLink(findings_);
    if (hidden.empty()) continue;
    answer.index = i;
    answer.time_s = time_s;
    answer.cause = {Reason::kOcclusion, atTime(hidden + " is hidden from the sensor", time_s),
                    hidden};
    return;
  }
}

}  // namespace tccm
