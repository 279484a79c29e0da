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
