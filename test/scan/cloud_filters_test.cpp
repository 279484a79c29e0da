#include "scan/cloud_filters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "support/random.h"

namespace tccm {
namespace {

using test::Random;
constexpr double kPixel = 1.0 / 550.0;  // [rad], of a camera of 640 x 480

struct Filtered {
  Cloud cloud;
  CloudState state;
  [[nodiscard]] BeamKind at(std::size_t row, std::size_t column) const {
    return state.kinds[row * cloud.width + column];
  }
  [[nodiscard]] std::size_t removed() const {
    return static_cast<std::size_t>(
        std::count(state.kinds.begin(), state.kinds.end(), BeamKind::kMixedPixel));
  }
};

/// A camera's cloud of that depth along z at each pixel; 0: none.
Filtered imageOf(std::size_t width, std::size_t height,
                 const std::function<double(std::size_t, std::size_t)>& depth,
                 double pixel = kPixel) {
  Filtered image;
  image.cloud.width = width;
  image.cloud.height = height;
  for (std::size_t row = 0; row < height; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      const double z = depth(row, column);
      const Vector3 p =
          z * Vector3(pixel * (static_cast<double>(column) - 0.5 * static_cast<double>(width)),
                      pixel * (static_cast<double>(row) - 0.5 * static_cast<double>(height)), 1.0);
      image.cloud.points.push_back(p.cast<float>());
      image.state.ranges.push_back(static_cast<float>(p.norm()));
      image.state.kinds.push_back(z > 0.0 ? BeamKind::kReturn : BeamKind::kUnknown);
    }
  }
  return image;
}

Filtered flyingOf(Filtered image, const RangeNoise& noise = {},
                  const FlyingPixelFilter& filter = {}) {
  filter.apply(image.cloud, noise, image.state);
  return image;
}

TEST(FlyingPixelFilterTest, APointBetweenTwoSurfacesAlongARowOrAColumnIsRemoved) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const double near = random.uniform(0.5, 1.5), far = near + random.uniform(0.5, 2.0);
    const double between = near + random.uniform(0.4, 0.6) * (far - near);
    const bool along_rows = random.chance(0.5);
    const auto edge = static_cast<std::size_t>(random.integer(2, 17));
    const auto depth = [&](std::size_t row, std::size_t column) {
      const std::size_t i = along_rows ? column : row;
      return i < edge ? near : i == edge ? between : far;
    };
    const Filtered image = flyingOf(imageOf(20, 20, depth));
    for (std::size_t k = 0; k < 20; ++k) {
      EXPECT_EQ(along_rows ? image.at(k, edge) : image.at(edge, k), BeamKind::kMixedPixel) << seed;
    }
    EXPECT_EQ(image.removed(), 20U) << seed;
  }
}

TEST(FlyingPixelFilterTest, APointAloneInTheAirIsRemoved) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const auto r = static_cast<std::size_t>(random.integer(0, 9));
    const auto c = static_cast<std::size_t>(random.integer(0, 9));
    const bool before_nothing = random.chance(0.5);
    const Filtered image = flyingOf(imageOf(10, 10, [&](std::size_t row, std::size_t column) {
      return row == r && column == c ? 1.0 : before_nothing ? 0.0 : 2.5;
    }));
    EXPECT_EQ(image.at(r, c), BeamKind::kMixedPixel) << seed;
    EXPECT_EQ(image.removed(), 1U) << seed;
  }
}

TEST(FlyingPixelFilterTest, TwoPointsAloneInTheAirAreRemovedAndThreeStay) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const auto r = static_cast<std::size_t>(random.integer(0, 7));
    const auto c = static_cast<std::size_t>(random.integer(0, 7));
    const bool before_nothing = random.chance(0.5), along_row = random.chance(0.5);
    for (const std::size_t length : {2U, 3U}) {
      const Filtered image = flyingOf(imageOf(10, 10, [&](std::size_t row, std::size_t column) {
        const std::size_t along = along_row ? column - c : row - r;
        const bool is_on_line = along_row ? row == r : column == c;
        return is_on_line && along < length ? 1.0 : before_nothing ? 0.0 : 2.5;
      }));
      EXPECT_EQ(image.removed(), length == 2 ? 2U : 0U) << seed;
      EXPECT_EQ(image.at(r, c), length == 2 ? BeamKind::kMixedPixel : BeamKind::kReturn) << seed;
    }
  }
}

TEST(FlyingPixelFilterTest, APointThatLiesNearFlyingPixelsAloneIsRemoved) {
  // Along the edge each pixel lies in between; beside the last no pixel before it is measured.
  const Filtered image = flyingOf(imageOf(9, 9, [](std::size_t row, std::size_t column) {
    if (column == 4) return row == 5 ? 1.51 : row < 5 ? 1.5 : 1.0;
    if (column < 4) return row == 5 && column == 3 ? 0.0 : 1.0;
    return 2.0;
  }));
  for (std::size_t row = 0; row <= 5; ++row) {
    EXPECT_EQ(image.at(row, 4), BeamKind::kMixedPixel) << row;
  }
  EXPECT_EQ(image.removed(), 6U);
}

TEST(FlyingPixelFilterTest, AThinWireBeforeAWallStays) {
  const RangeNoise noise;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    std::normal_distribution<double> normal;
    std::mt19937 engine(seed);
    // One or two pixels wide: 3 mm at 1 m.
    const double slope = random.uniform(-1.0, 1.0), away = random.uniform(0.6, 1.2);
    const double half = 0.5 * (1.0 + std::abs(slope)), middle = random.uniform(25.0, 35.0);
    const bool is_upright = random.chance(0.5);
    const auto is_wire = [&](std::size_t row, std::size_t column) {
      const double along = static_cast<double>(is_upright ? row : column) - 30.0;
      const double across = static_cast<double>(is_upright ? column : row);
      return std::abs(across - middle - slope * along) <= half;
    };
    const Filtered image = flyingOf(imageOf(60, 60, [&](std::size_t row, std::size_t column) {
      const double z = is_wire(row, column) ? away : 2.0;
      return z + static_cast<double>(noise.at(static_cast<float>(z))) * normal(engine);
    }));
    for (std::size_t row = 2; row < 58; ++row) {
      for (std::size_t column = 2; column < 58; ++column) {
        if (!is_wire(row, column)) continue;
        EXPECT_EQ(image.at(row, column), BeamKind::kReturn) << seed;
      }
    }
  }
}

/// The filter as its header says it, by the groups that points near each other make.
class Groups {
 public:
  explicit Groups(const Filtered& image) : image_(image) {}

  [[nodiscard]] bool isFlying(std::size_t i) const {
    std::vector<std::size_t> near;
    for (const std::size_t k : around(i)) {
      if (isNear(i, k)) near.push_back(k);
    }
    return isBetween(i) || groupOf(i).size() < 3 || (near.size() == 1 && isBetween(near.front()));
  }

 private:
  [[nodiscard]] double range(std::size_t i) const {
    return static_cast<double>(image_.state.ranges[i]);
  }
  [[nodiscard]] bool isNear(std::size_t i, std::size_t k) const {
    return range(k) > 0.0 && std::abs(range(i) - range(k)) < 0.1;
  }
  /// Whether one of two that are opposite lies before it and the other behind.
  [[nodiscard]] bool isBetween(std::size_t i) const {
    for (const std::size_t a : around(i)) {
      for (const std::size_t b : around(i)) {
        const bool are_opposite = a < b && a + b == 2 * i;
        const bool before = range(a) > 0.0 && range(a) < range(i) && !isNear(i, a);
        const bool behind = range(b) > range(i) && !isNear(i, b);
        const bool b_before = range(b) > 0.0 && range(b) < range(i) && !isNear(i, b);
        const bool a_behind = range(a) > range(i) && !isNear(i, a);
        if (are_opposite && ((before && behind) || (b_before && a_behind))) return true;
      }
    }
    return false;
  }
  [[nodiscard]] std::vector<std::size_t> around(std::size_t i) const {
    const std::size_t width = image_.cloud.width, row = i / width, column = i % width;
    std::vector<std::size_t> found;
    if (column > 0) found.push_back(i - 1);
    if (column + 1 < width) found.push_back(i + 1);
    if (row > 0) found.push_back(i - width);
    if (row + 1 < image_.cloud.height) found.push_back(i + width);
    return found;
  }
  [[nodiscard]] std::vector<std::size_t> groupOf(std::size_t i) const {
    std::vector<std::size_t> group{i};
    for (std::size_t next = 0; next < group.size(); ++next) {
      for (const std::size_t k : around(group[next])) {
        const bool is_new = std::find(group.begin(), group.end(), k) == group.end();
        if (is_new && isNear(group[next], k)) group.push_back(k);
      }
    }
    return group;
  }

  const Filtered& image_;
};

TEST(FlyingPixelFilterTest, RandomPicturesAreFilteredAsTheGroupsOfTheirPointsSay) {
  const std::vector<double> depths = {0.0, 1.0, 1.01, 1.5, 2.0};
  std::size_t flying = 0, staying = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Random random(seed);
    const auto width = static_cast<std::size_t>(seed % 8 == 0 ? 150 : random.integer(2, 12));
    const auto height = static_cast<std::size_t>(random.integer(2, 12));
    const double spread = random.uniform(0.1, 1.0);
    const Filtered before = imageOf(width, height, [&](std::size_t, std::size_t) {
      return random.chance(spread) ? depths[static_cast<std::size_t>(random.integer(0, 4))] : 1.0;
    });
    const Filtered after = flyingOf(before);
    const Groups groups(before);
    for (std::size_t i = 0; i < width * height; ++i) {
      if (before.state.kinds[i] != BeamKind::kReturn) continue;
      const bool is_flying = groups.isFlying(i);
      ASSERT_EQ(after.state.kinds[i] == BeamKind::kMixedPixel, is_flying) << seed << ", " << i;
      ++(is_flying ? flying : staying);
    }
  }
  EXPECT_GT(flying, 1000U);
  EXPECT_GT(staying, 10000U);
}

TEST(FlyingPixelFilterTest, NoisySurfacesStayHoweverTheyLie) {
  const RangeNoise noise;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    // A plane through (0, 0, away), at up to 80 degrees to the sight.
    const double away = random.uniform(0.5, 4.0), slope = std::tan(random.uniform(-1.4, 1.4));
    std::normal_distribution<double> normal;
    std::mt19937 engine(seed);
    const Filtered image = flyingOf(imageOf(60, 60, [&](std::size_t row, std::size_t) {
      const double y = kPixel * (static_cast<double>(row) - 30.0);
      const double z = away / (1.0 - slope * y);
      return z + static_cast<double>(noise.at(static_cast<float>(z))) * normal(engine);
    }));
    EXPECT_LE(image.removed(), 7U) << seed;  // 2 in 1000
  }
}

TEST(FlyingPixelFilterTest, ALidarsFloorStaysAlthoughItsRowsLieFarApart) {
  constexpr double kRow = 0.012;  // [rad], of 64 rows in 45 degrees
  const RangeNoise noise{0.01, 0.0};
  const Filtered image =
      flyingOf(imageOf(
                   100, 20,
                   [&](std::size_t row, std::size_t) {
                     return 1.0 / std::tan(0.25 + kRow * static_cast<double>(row));
                   },
                   kRow),
               noise);
  EXPECT_EQ(image.removed(), 0U);
}

TEST(FlyingPixelFilterTest, AnEdgeOfAnObjectStays) {
  const Filtered image = flyingOf(imageOf(20, 20, [](std::size_t, std::size_t column) {
    return column < 8 || column > 12 ? 2.0 : 1.0;
  }));
  EXPECT_EQ(image.removed(), 0U);
}

TEST(FlyingPixelFilterTest, ZeroIsNoFilter) {
  FlyingPixelFilter off;
  off.separation_m = 0.0;
  const auto depth = [](std::size_t, std::size_t column) {
    return column == 5 ? 1.5 : column < 5 ? 1.0 : 2.0;
  };
  EXPECT_EQ(flyingOf(imageOf(10, 10, depth), {}, off).removed(), 0U);
}

TEST(ThinningTest, OfADenseCloudEveryOtherRowAndColumnIsTaken) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const double depth = random.uniform(0.5, 4.0);
    Thinning thinning;
    thinning.spacing_m = random.uniform(0.005, 0.02);
    Filtered image = imageOf(24, 18, [depth](std::size_t, std::size_t) { return depth; });
    image.state.kinds[7] = BeamKind::kUnknown;
    for (std::size_t row = 0; row < 18; ++row) {
      thinning.applyToRow(image.cloud, static_cast<float>(kPixel), row, image.state);
    }
    EXPECT_EQ(image.at(0, 7), BeamKind::kUnknown) << seed;
    // A picture of 24 pixels is so narrow that ranges are depths.
    const double apart = 2.0 * kPixel * depth;
    if (std::abs(apart - thinning.spacing_m) < 1e-4) continue;
    const bool is_dense = apart < thinning.spacing_m;
    for (std::size_t row = 0; row < 18; ++row) {
      for (std::size_t column = 0; column < 24; ++column) {
        const bool is_row = row % 2 == 0 || row == 17, is_column = column % 2 == 0 || column == 23;
        const bool is_taken = !is_dense || (is_row && is_column);
        if (row == 0 && column == 7) continue;
        const BeamKind expected = is_taken ? BeamKind::kReturn : BeamKind::kThinned;
        EXPECT_EQ(image.at(row, column), expected) << seed;
      }
    }
  }
}

TEST(ThinningTest, NothingIsThinnedWhereNeighboursAreNotKnownOrNobodyWantsIt) {
  const auto near = [](std::size_t, std::size_t) { return 0.4; };
  const auto thinnedOf = [](Filtered image, double spacing_m, float step_rad) {
    Thinning thinning;
    thinning.spacing_m = spacing_m;
    for (std::size_t row = 0; row < image.cloud.height; ++row) {
      thinning.applyToRow(image.cloud, step_rad, row, image.state);
    }
    return std::count(image.state.kinds.begin(), image.state.kinds.end(), BeamKind::kThinned);
  };
  constexpr auto kStep = static_cast<float>(kPixel);
  EXPECT_EQ(thinnedOf(imageOf(20, 20, near), 0.01, kStep), 400 - 11 * 11);
  EXPECT_EQ(thinnedOf(imageOf(20, 20, near), 0.0, kStep), 0);
  EXPECT_EQ(thinnedOf(imageOf(20, 20, near), 0.01, 0.0F), 0);
  EXPECT_EQ(thinnedOf(imageOf(400, 1, near), 0.01, kStep), 0);
}

Filtered looseCloud(const std::vector<Vector3>& points) {
  Filtered loose;
  loose.cloud.width = points.size();
  loose.cloud.height = 1;
  for (const Vector3& p : points) {
    loose.cloud.points.push_back(p.cast<float>());
    loose.state.ranges.push_back(static_cast<float>(p.norm()));
    loose.state.kinds.push_back(BeamKind::kReturn);
  }
  return loose;
}

TEST(SupportFilterTest, VoxelsTellWhatCountingNeighboursTells) {
  SupportFilter::Config config;
  SupportFilter filter(config);
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    std::vector<Vector3> points;
    for (int i = random.integer(1, 400); i > 0; --i) points.push_back(random.point(1.0));
    Filtered loose = looseCloud(points);
    filter.apply(loose.cloud, loose.state);
    const auto voxel = [&](const Eigen::Vector3f& p, int k) {
      return static_cast<int>(std::floor(p[k] * (1.0F / static_cast<float>(config.voxel_m))));
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::size_t near = 0;
      for (const Eigen::Vector3f& other : loose.cloud.points) {
        bool beside = true;
        for (int k = 0; k < 3; ++k) {
          beside = beside && std::abs(voxel(other, k) - voxel(loose.cloud.points[i], k)) <= 1;
        }
        near += beside ? 1 : 0;
      }
      EXPECT_EQ(loose.state.kinds[i] == BeamKind::kReturn, near >= config.points_min) << seed;
    }
  }
}

TEST(SupportFilterTest, FarAwayPointsAreCountedAsWell) {
  SupportFilter filter({});
  Filtered loose = looseCloud({{1e30, 0.0, 0.0}, {-1e30, 1.0, 1.0}, {0.0, 0.0, 0.0}});
  filter.apply(loose.cloud, loose.state);
  EXPECT_EQ(loose.removed(), 3U);
}

}  // namespace
}  // namespace tccm
