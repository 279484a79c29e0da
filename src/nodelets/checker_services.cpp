// What arm controllers and operators ask the checker. An error is never answered with free.
#include "nodelets/collision_checker.h"
#include "nodelets/status_conversions.h"
#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr const char* kNoTimeYet = "simulated time has not begun";

std::uint8_t resultOf(Reason reason) {
  using Response = CheckState::Response;  // those of CheckTrajectory are the same
  switch (reason) {
    case Reason::kClear:
      return Response::FREE;
    case Reason::kCollision:
    case Reason::kCollisionAhead:
      return Response::COLLISION;
    case Reason::kOcclusion:
    case Reason::kOcclusionAhead:
      return Response::OCCLUDED;
    default:
      return levelOf(reason) == Level::kFault && reason != Reason::kBadQuestion ? Response::FAULT
                                                                                : Response::UNKNOWN;
  }
}

}  // namespace

template <typename Response, typename Ask>
bool CollisionChecker::respond(Response& response, Ask&& ask) {
  const ros::Time now = ros::Time::now();
  Cause cause{Reason::kInit, kNoTimeYet};
  if (!now.isZero()) {
    checker_->setOutsideCause(outsideCause());
    cause = ask(toTime(now));
    if (const CuboidMap* map = checker_->map()) {
      response.map_stamp = toRos(map->stamp);
      response.map_age = toRos(toTime(now) - map->stamp);
    }
  }
  response.result = resultOf(cause.reason);
  response.reason = cause.reason == Reason::kClear ? "FREE" : name(cause.reason);
  response.detail = cause.detail;
  response.link = cause.link;
  return true;
}

bool CollisionChecker::checkState(CheckState::Request& request, CheckState::Response& response) {
  return respond(response, [&](Time now) {
    return checker_->checkState(now, request.state.name, request.state.position).cause;
  });
}

bool CollisionChecker::checkTrajectory(CheckTrajectory::Request& request,
                                       CheckTrajectory::Response& response) {
  response.index = -1;
  return respond(response, [&](Time now) {
    const TrajectoryAnswer found = checker_->checkTrajectory(now, fromMessage(request.trajectory));
    if (found.index) response.index = static_cast<std::int32_t>(*found.index);
    response.time_from_start = found.time_s;
    if (found.contact) {
      response.cuboid =
          toFlag(*checker_->map(), found.contact->cuboid, tccm_monitor::Cuboid::COLLISION);
    }
    for (const double clearance_m : found.clearances_m) {
      response.clearance.push_back(static_cast<float>(clearance_m));
    }
    return found.cause;
  });
}

bool CollisionChecker::addExemption(AddExemption::Request& request,
                                    AddExemption::Response& response) {
  const ros::Time now = ros::Time::now();
  try {
    if (now.isZero()) throw ConfigError(kNoTimeYet);
    checker_->addExemption(toTime(now),
                           {request.owner, request.link, fromMessage(request.region, "region"), {}},
                           request.duration.toSec());
    response.success = true;
    response.until = now + request.duration;
    ROS_WARN("Exemption of '%s': '%s' may touch what lies in its region for %.1f s.",
             request.owner.c_str(), request.link.c_str(), request.duration.toSec());
  } catch (const std::exception& error) {  // a sum of times may be more than a ros::Time holds
    response.message = error.what();
  }
  return true;
}

bool CollisionChecker::reset(std_srvs::Trigger::Request& /*request*/,
                             std_srvs::Trigger::Response& response) {
  response.message = checker_->reset();
  response.success = response.message.empty();
  if (response.success) {
    ROS_INFO("Reset.");
  } else {
    ROS_WARN("Reset refused: %s.", response.message.c_str());
  }
  return true;
}

}  // namespace tccm
