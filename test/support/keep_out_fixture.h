#pragma once

#include "check/keep_out.h"
#include "support/checker_fixture.h"
#include "support/error_of.h"

namespace tccm::test {

using Regions = KeepOut::Config;

inline KeepOutRegion keepOutBox(const std::string& name, const Vector3& center, const Vector3& size,
                                const std::string& frame = "") {
  return {name, frame, Box{0.5 * size}, placedAt(center.x(), center.y(), center.z())};
}

/// The padded hand, 90 mm around (slide, 0, 0.5), touches it from 0.71 m on.
inline KeepOutRegion wall() { return keepOutBox("wall", {0.9, 0.0, 0.5}, {0.2, 0.4, 1.0}); }

inline Regions::Region wallRow() {
  Regions::Region row;
  row.name = "wall";
  row.center_x_m = 0.9;
  row.center_z_m = 0.5;
  row.size_x_m = 0.2;
  row.size_y_m = 0.4;
  row.size_z_m = 1.0;
  return row;
}

class KeepOutFixture : public CheckerFixture {
 protected:
  /// As the braking parameters are by default.
  void stopLate() {
    config_.way.stop_time_s = 0.1;
    config_.permission.speed_scale_rise_per_s = 1000.0;
    remake();
  }
  [[nodiscard]] std::string refusalOf(const Regions& regions) {
    config_.keep_out = regions;
    const std::string error = errorOf([this] { Checker(model_, config_); });
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }
  [[nodiscard]] std::string refusalOf(const KeepOutRegion& region) {
    const std::size_t before = checker_->keepOut().size();
    const std::string error = errorOf([&] { checker_->setKeepOut(region); });
    EXPECT_TRUE(error.empty() || checker_->keepOut().size() == before) << error;
    return error;
  }
};

}  // namespace tccm::test
