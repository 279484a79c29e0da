#include "permission_gate.h"

#include <cstdint>

namespace tccm::example {
namespace {

/// Sequences wrap around.
bool rises(std::uint32_t before, std::uint32_t after) {
  return static_cast<std::int32_t>(after - before) > 0;
}

}  // namespace

void PermissionGate::hear(const tccm_monitor::MotionPermission& permission, const Instant& now) {
  defect_.clear();
  if (last_ && !rises(last_->sequence, permission.sequence)) {
    defect_ = "the permission's sequence does not rise";
  } else if (last_ && permission.header.stamp < last_->header.stamp) {
    defect_ = "the permission's stamp goes back";
  }
  if (!last_ || permission.header.stamp != last_->header.stamp) news_ = now.steady;
  last_ = permission;
}

std::string PermissionGate::objection(const Instant& now) const {
  using Permission = tccm_monitor::MotionPermission;
  if (!last_) return "no permission was ever heard";
  if (!defect_.empty()) return defect_;
  if (!last_->permitted || last_->level > Permission::SLOW) {
    const std::string reason = last_->reasons.empty() ? "" : " " + last_->reasons.front();
    return "not permitted:" + reason + (last_->detail.empty() ? "" : ", " + last_->detail);
  }
  if (!(last_->speed_scale > 0.0 && last_->speed_scale <= 1.0)) {
    return "the permission's speed_scale is " + std::to_string(last_->speed_scale);
  }
  const double validity_s = last_->valid_until.toSec() - last_->header.stamp.toSec();
  if ((now.steady - news_).toSec() > validity_s) return "no new permission is heard";
  if (now.stamp > last_->valid_until) return "the permission has expired";
  if (last_->header.stamp.toSec() > now.stamp.toSec() + future_max_s_) {
    return "the permission's stamp lies in the future";
  }
  return {};
}

}  // namespace tccm::example
