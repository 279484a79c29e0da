#include "check/obeyed_scale.h"

#include <algorithm>

namespace tccm {

void ObeyedScale::Range::widenBy(double scale) {
  least = std::min(least, scale);
  most = std::max(most, scale);
}

void ObeyedScale::add(Time now, double scale, double braking, Duration lag) {
  const double braked = last_ ? most_ - braking * toSeconds(now - *last_) : 1.0;
  if (!last_ || now - begun_ > lag) {
    before_ = present_;
    present_ = {scale, scale};
    begun_ = now;
  }
  last_ = now;
  present_.widenBy(scale);
  least_ = std::min(before_.least, present_.least);
  most_ = std::max({before_.most, present_.most, braked});
}

}  // namespace tccm
