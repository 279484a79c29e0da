#include "scan/scan_stage.h"

#include <algorithm>

#include "tccm_monitor/config_error.h"

namespace tccm {

Seen seenBy(BeamKind kind) {
  if (kind == BeamKind::kReturn) return Seen::kSurface;
  if (kind == BeamKind::kNoReturn) return Seen::kNothing;
  // It measured nothing, or its end lies between two surfaces or in the robot's shadow.
  return kind == BeamKind::kSelf ? Seen::kRobot : Seen::kUnclear;
}

void takeReturns(const AssembledScan& scan, ScanReturns& returns) {
  returns.stamp = scan.stamp;
  returns.tilt = scan.beams.front().tilt;
  returns.viewpoint = scan.beams.back().viewpoint;
  returns.points.clear();
  returns.looks.clear();
  for (const Beam& beam : scan.beams) {
    if (beam.kind == BeamKind::kReturn) returns.points.push_back(beam.p_fixed);
    returns.looks.push_back({beam.viewpoint, beam.p_fixed, seenBy(beam.kind)});
  }
}

void ScanStage::Config::describe(ParameterTable& table) {
  table.add("self_filter", &self_filter,
            "false: the robot is not filtered out, and need not be known");
  body.describe(table);
  assembler.describe(table);
  table.add("future_max_s", &future_max_s, "s", {0.0, 10.0},
            "a scan or joint state stamped further ahead is dropped");
}

ScanStage::ScanStage(const Config& config, std::shared_ptr<const RobotModel> model)
    : config_(validated(config)), bare_model_(std::move(model)) {
  if (bare_model_ && config.self_filter) {
    body_ = std::make_unique<BodySampler>(bare_model_, config.body);
  }
}

bool ScanStage::addJoints(Time now, Time stamp, const std::vector<std::string>& names,
                          const std::vector<double>& positions,
                          const std::vector<double>& velocities) {
  if (stamp - now > fromSeconds(config_.future_max_s)) return false;
  if (body_) body_->joints().add(stamp, names, positions, velocities);
  return true;
}

std::vector<std::string> ScanStage::hold(const std::vector<AttachedObject>& objects) {
  std::vector<std::string> defects;
  if (!body_) return defects;
  std::vector<AttachedObject> held;
  for (const AttachedObject& object : objects) {
    held.push_back(object);
    try {
      static_cast<void>(bare_model_->holding(held));
    } catch (const ConfigError& error) {
      // The others are taken all the same: what was detached must not be filtered out any longer.
      held.pop_back();
      defects.emplace_back(error.what());
    }
  }
  body_->setModel(std::make_shared<const RobotModel>(bare_model_->holding(held)));
  return defects;
}

void ScanStage::reset() {
  if (body_) body_->joints().reset();
}

std::string ScanStage::assemble(const LaserScan& scan, const PosePath& T_fixed_sensor,
                                const std::vector<PosePath>& T_fixed_roots) {
  static const std::vector<BodySample> kNobody;
  if (body_) {
    std::string unknown = body_->sample(scan.stamp, scan.lastBeamTime(), T_fixed_roots);
    if (!unknown.empty()) return unknown;
  }
  std::string dropped =
      config_.assembler.assemble(scan, T_fixed_sensor, body_ ? body_->samples() : kNobody, scan_);
  if (dropped.empty() && body_) countSelf();
  return dropped;
}

void ScanStage::countSelf() {
  constexpr double kKept = 0.99;  // of a scan's counts at the next
  self_counts_.resize(bare_model_->links().size());
  for (double& count : self_counts_) count *= kKept;
  for (std::size_t i = 0; i < scan_.self_counts.size(); ++i) {
    self_counts_[body_->linkOf(i)] += static_cast<double>(scan_.self_counts[i]);
  }
  const auto most = std::max_element(self_counts_.begin(), self_counts_.end());
  const auto link = static_cast<std::size_t>(most - self_counts_.begin());
  if (*most > 0.0) self_link_ = bare_model_->links()[link];
}

}  // namespace tccm
