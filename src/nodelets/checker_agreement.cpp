/// What a CollisionChecker has to do with the comparison of tf and URDF.

#include <algorithm>

#include "check/model_agreement.h"
#include "nodelets/collision_checker.h"
#include "ros/agreement_transforms.h"
#include "ros/conversions.h"

namespace tccm {

void CollisionChecker::compareWithModel() {
  const ros::Time now = ros::Time::now();
  if (now.isZero()) return;
  const bool compared = checker_->agreement().compare(toTime(now), transformsOf(*transforms_));
  if (recorder_ && compared) recorder_->compared(toTime(now));
}

void CollisionChecker::nowAndThen() {
  if (recorder_) tellStopDefect();
  const std::vector<std::string> texts = checker_->agreement().notCompared();
  if (texts.size() <= told_not_compared_) return;
  told_not_compared_ = texts.size();
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
  NODELET_INFO("Where tf and the URDF put these is not compared: %s.", all.c_str());
}

void CollisionChecker::diagnoseAgreement(
    diagnostic_updater::DiagnosticStatusWrapper& status) const {
  double worst_m = 0.0;
  std::size_t compared = 0;
  for (const auto& frame : checker_->agreement().compared()) {
    compared += frame.comparisons > 0 ? 1 : 0;
    worst_m = std::max(worst_m, frame.worst_m);
  }
  status.add("links compared with tf", compared);
  status.addf("furthest that tf and URDF were apart [m]", "%.4f", worst_m);
  for (const std::string& text : checker_->agreement().notCompared()) {
    status.add("not compared with tf", text);
  }
}

}  // namespace tccm
