#include "gate/permission_gate.h"

#include "base/line_of.h"

namespace tccm {
namespace {

/// Sequences wrap around.
bool rises(std::uint32_t before, std::uint32_t after) {
  return static_cast<std::int32_t>(after - before) > 0;
}

}  // namespace

void PermissionGate::hear(const HeardPermission& permission, const Instant& now) {
  defect_ = nullptr;
  if (last_ && !rises(last_->sequence, permission.sequence)) {
    defect_ = "the permission's sequence does not rise";
  } else if (last_ && permission.stamp < last_->stamp) {
    defect_ = "the permission's stamp goes back";
  }
  if (!last_ || permission.stamp != last_->stamp) news_ = now.steady;
  last_ = permission;
}

std::string PermissionGate::objection(const Instant& now) const {
  if (!last_) return "no permission was ever heard";
  if (defect_ != nullptr) return defect_;
  if (!last_->permitted) return "not permitted: " + last_->why;
  if (!(last_->speed_scale > 0.0 && last_->speed_scale <= 1.0)) {
    return lineOf("the permission's speed_scale is %g", last_->speed_scale);
  }
  if (now.steady - news_ > last_->valid_until - last_->stamp) return "no new permission is heard";
  if (now.stamp > last_->valid_until) return "the permission has expired";
  if (last_->stamp > now.stamp + future_max_) return "the permission's stamp lies in the future";
  return {};
}

}  // namespace tccm
