#include "nodelets/checker_services.h"

#include <string>
#include <utility>

#include "nodelets/status_conversions.h"
#include "ros/conversions.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr const char* kNoTimeYet = "simulated time has not begun";

template <typename Response>
std::uint8_t resultOf(Reason reason) {
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

/// What both questions are answered with.
template <typename Response>
void answer(Reason reason, const std::string& detail, const std::string& link, Response& response) {
  response.result = resultOf<Response>(reason);
  response.reason = reason == Reason::kClear ? "FREE" : name(reason);
  response.detail = detail;
  response.link = link;
}

template <typename Response>
void stampMap(const Checker& checker, Time now, Response& response) {
  const CuboidMap* map = checker.map();
  if (!map) return;
  response.map_stamp = toRos(map->stamp);
  response.map_age = toRos(now - map->stamp);
}

}  // namespace

CheckerServices::CheckerServices(ros::NodeHandle node, Checker& checker,
                                 std::function<void()> prepare)
    : checker_(checker), prepare_(std::move(prepare)) {
  state_ = node.advertiseService("check_state", &CheckerServices::checkState, this);
  trajectory_ = node.advertiseService("check_trajectory", &CheckerServices::checkTrajectory, this);
  exemption_ = node.advertiseService("add_exemption", &CheckerServices::addExemption, this);
  reset_ = node.advertiseService("reset", &CheckerServices::reset, this);
}

bool CheckerServices::checkState(tccm_monitor::CheckState::Request& request,
                                 tccm_monitor::CheckState::Response& response) {
  if (ros::Time::now().isZero()) {
    answer(Reason::kInit, kNoTimeYet, {}, response);
    return true;
  }
  const Time now = toTime(ros::Time::now());
  prepare_();
  const Checker::StateAnswer found =
      checker_.checkState(now, request.state.name, request.state.position);
  answer(found.reason, found.detail, found.link, response);
  stampMap(checker_, now, response);
  return true;
}

bool CheckerServices::checkTrajectory(tccm_monitor::CheckTrajectory::Request& request,
                                      tccm_monitor::CheckTrajectory::Response& response) {
  response.index = -1;
  if (ros::Time::now().isZero()) {
    answer(Reason::kInit, kNoTimeYet, {}, response);
    return true;
  }
  const Time now = toTime(ros::Time::now());
  prepare_();
  const TrajectoryCheck::Answer found =
      checker_.checkTrajectory(now, fromMessage(request.trajectory));
  answer(found.cause.reason, found.cause.detail, found.cause.link, response);
  if (found.index) response.index = static_cast<std::int32_t>(*found.index);
  response.time_from_start = found.time_s;
  if (found.contact) {
    response.cuboid =
        toFlag(*checker_.map(), found.contact->cuboid, tccm_monitor::Cuboid::COLLISION);
  }
  for (const double clearance_m : found.clearances_m) {
    response.clearance.push_back(static_cast<float>(clearance_m));
  }
  stampMap(checker_, now, response);
  return true;
}

bool CheckerServices::addExemption(tccm_monitor::AddExemption::Request& request,
                                   tccm_monitor::AddExemption::Response& response) {
  const ros::Time now = ros::Time::now();
  try {
    if (now.isZero()) throw ConfigError(kNoTimeYet);
    const PlacedShape region = fromMessage(request.region, "region");
    checker_.addExemption(toTime(now), {request.owner, request.link, region, {}},
                          request.duration.toSec());
    response.success = true;
    response.until = now + request.duration;
    ROS_WARN("Exemption of '%s': '%s' may touch what lies in its region for %.1f s.",
             request.owner.c_str(), request.link.c_str(), request.duration.toSec());
  } catch (const std::exception& error) {  // a sum of times may be more than a ros::Time holds
    response.success = false;
    response.message = error.what();
  }
  return true;
}

bool CheckerServices::reset(std_srvs::Trigger::Request& /*request*/,
                            std_srvs::Trigger::Response& response) {
  response.message = checker_.reset();
  response.success = response.message.empty();
  if (response.success) {
    ROS_INFO("Reset.");
  } else {
    ROS_WARN("Reset refused: %s.", response.message.c_str());
  }
  return true;
}

}  // namespace tccm
