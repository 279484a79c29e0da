#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "check/checker_config.h"
#include "support/random.h"
#include "support/table_scene.h"

namespace tccm::test {

/// A number of any magnitude.
inline double wild(Random& random) {
  if (random.chance(0.025)) return std::numeric_limits<double>::quiet_NaN();
  if (random.chance(0.025)) {
    return random.chance(0.5) ? std::numeric_limits<double>::infinity() : 0.0;
  }
  return std::pow(10.0, random.uniform(-12.0, 12.0)) * (random.chance(0.5) ? 1.0 : -1.0);
}

/// A checker of any robot before the table, fed by hand.
struct WildChecker {
  explicit WildChecker(std::shared_ptr<const RobotModel> of_model)
      : model(std::move(of_model)), checker(model, Checker::Config()) {
    for (const JointVariable& variable : model->variables()) names.push_back(variable.name);
    *map = tableMap();
    checker.setRootPose(0, Time(), Pose::Identity(), true);
  }

  void feed(const std::vector<double>& positions, const std::vector<double>& velocities) {
    now += std::chrono::milliseconds(10);
    auto copy = std::make_shared<CuboidMap>(*map);
    copy->stamp = now;
    copy->serial = ++serial;
    checker.setMap(now, copy);
    checker.addJoints(now, now, names, positions, velocities);
  }
  /// From anywhere, or from the joints' zeros; now and then everything starts anew.
  void feedSomeWild(Random& random) {
    const std::vector<double> zeros(names.size(), 0.0);
    if (fed++ % 10 == 0) {
      checker.startAnew();
      checker.setRootPose(0, Time(), Pose::Identity(), true);
      feed(zeros, zeros);
    }
    feed(random.chance(0.5) ? zeros : someWild(random), someWild(random));
  }
  [[nodiscard]] std::vector<double> someWild(Random& random) const {
    std::vector<double> values;
    for (std::size_t v = 0; v < names.size(); ++v) {
      values.push_back(random.chance(0.5) ? random.uniform(-1.0, 1.0) : wild(random));
    }
    return values;
  }

  std::shared_ptr<const RobotModel> model;
  Checker checker;
  std::vector<std::string> names;
  std::shared_ptr<CuboidMap> map = std::make_shared<CuboidMap>();
  Time now{fromSeconds(100.0)};
  int fed = 0;
  std::uint32_t serial = 0;
};

}  // namespace tccm::test
