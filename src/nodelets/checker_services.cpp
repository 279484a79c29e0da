// What arm controllers and operators ask the checker. An error is never answered with free.
#include "nodelets/collision_checker.h"
#include "nodelets/status_conversions.h"
#include "ros/checker_frames.h"
#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr const char* kNoTimeYet = "simulated time has not begun";

std::uint8_t resultOf(Reason reason) {
  using Response = CheckState::Response;  // those of CheckTrajectory are the same
  switch (reason) {
    case Reason::kClear:
    case Reason::kMovingOut:
      return Response::FREE;
    case Reason::kCollision:
    case Reason::kCollisionAhead:
      return Response::COLLISION;
    case Reason::kKeepOut:
    case Reason::kKeepOutAhead:
      return Response::KEEP_OUT;
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
    Exemption exemption{request.owner, request.link, fromMessage(request.region, "region"), {}};
    exemption.frame = withoutSlash(request.frame);
    exemption.with_goal = request.with_goal;
    checker_->addExemption(toTime(now), exemption, request.duration.toSec());
    placeExemptFrames(*transforms_, config_.fixed_frame, *checker_);
    checker_->updateExemptions(toTime(now));
    response.success = true;
    response.until = now;
    for (const Exemption& added : checker_->exemptions()) {
      if (added.owner != request.owner || added.link != request.link) continue;
      response.until = toRos(added.until);
      response.message = checker_->whyNotInForce(added);
    }
    ROS_WARN("Exemption of '%s': '%s' may touch what lies in its region for %.1f s%s.",
             request.owner.c_str(), request.link.c_str(), request.duration.toSec(),
             request.with_goal ? ", with a goal" : "");
  } catch (const std::exception& error) {  // a sum of times may be more than a ros::Time holds
    response.message = error.what();
  }
  return true;
}

bool CollisionChecker::setKeepOut(SetKeepOut::Request& request, SetKeepOut::Response& response) {
  try {
    const Vector3 size(request.size.x, request.size.y, request.size.z);
    if (request.remove != 0) {
      checker_->removeKeepOut(request.name);
      ROS_INFO("Keep-out region '%s' is removed.", request.name.c_str());
    } else {
      checker_->setKeepOut(
          {request.name, request.frame, Box{0.5 * size}, fromMessage(request.pose, "pose")});
      ROS_INFO("No link may enter keep-out region '%s'.", request.name.c_str());
    }
    response.success = true;
  } catch (const ConfigError& error) {
    response.message = error.what();
  }
  return true;
}

bool CollisionChecker::liftExemption(LiftExemption::Request& request,
                                     LiftExemption::Response& response) {
  const std::size_t lifted = checker_->liftExemptions(request.owner, request.link);
  response.lifted = static_cast<std::uint32_t>(lifted);
  response.success = lifted > 0;
  if (lifted == 0) {
    response.message = "'" + request.owner + "' has no exemption" +
                       (request.link.empty() ? "" : " for '" + request.link + "'") +
                       ": see list_exemptions";
  }
  return true;
}

bool CollisionChecker::listExemptions(ListExemptions::Request& /*request*/,
                                      ListExemptions::Response& response) {
  const ros::Time now = ros::Time::now();
  if (!now.isZero()) checker_->updateExemptions(toTime(now));
  response.exemptions = exemptionsOf(*checker_);
  return true;
}

bool CollisionChecker::reportGoal(ReportGoal::Request& request, ReportGoal::Response& response) {
  const ros::Time now = ros::Time::now();
  try {
    if (now.isZero()) throw ConfigError(kNoTimeYet);
    checker_->reportGoal(toTime(now), request.owner, request.goal, request.under_way);
    response.success = true;
  } catch (const std::exception& error) {
    response.message = error.what();
  }
  return true;
}

bool CollisionChecker::reset(std_srvs::Trigger::Request& /*request*/,
                             std_srvs::Trigger::Response& response) {
  response.message = checker_->reset();
  if (recorder_) recorder_->reset(toTime(ros::Time::now()));
  response.success = response.message.empty();
  if (response.success) {
    ROS_INFO("Reset.");
  } else {
    ROS_WARN("Reset refused: %s.", response.message.c_str());
  }
  return true;
}

}  // namespace tccm
