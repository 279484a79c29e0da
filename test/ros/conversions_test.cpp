#include "ros/conversions.h"

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "support/cuboid_scene.h"
#include "support/random.h"

namespace tccm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Time at(double seconds) { return Time(fromSeconds(seconds)); }

TEST(TimeConversionTest, StampsKeepTheirNanoseconds) {
  const Time time(Duration(1700000000123456789LL));
  EXPECT_EQ(toTime(toRos(time)), time);
  EXPECT_EQ(toRos(time).nsec, 123456789U);
  EXPECT_EQ(toRos(Duration(-1500000000)).toSec(), -1.5);
}

/// Passes of every kind in some neighbouring rows.
void lookAtRandom(test::Random& random, CuboidMap& map) {
  map.looks.begin(map.stamp - fromSeconds(60.0), random.point(2.0));
  const DirectionGrid& grid = map.looks.grid();
  const auto ticks = [&random] { return static_cast<LookImage::Ticks>(random.integer(0, 60000)); };
  const int first = random.integer(0, grid.rows() - 1);
  for (int row = first; row < std::min(grid.rows(), first + 12); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      for (LookImage::Pass& pass : map.looks.edit(row, column)) {
        pass = {ticks(), ticks(), static_cast<std::uint16_t>(random.integer(0, 65535)),
                static_cast<Seen>(random.integer(0, 4)), random.chance(0.3)};
      }
    }
  }
}

CuboidMap randomScene(test::Random& random) {
  Grid::Config grid;
  grid.origin_x_m = random.uniform(-2.0, 2.0);
  grid.origin_y_m = random.uniform(-2.0, 2.0);
  grid.size_x_m = grid.size_y_m = 0.6;
  grid.cell_size_m = random.uniform(0.01, 0.06);
  CuboidMap map = test::randomMap(random, grid, 0.3);
  map.stamp = at(random.uniform(1.0, 1e6));
  map.serial = static_cast<std::uint32_t>(random.integer(1, 100000));
  map.window_scans = 60;
  map.window = fromSeconds(1.7);
  map.viewpoint = random.point(2.0);
  for (Cuboid& cuboid : map.cuboids) {
    cuboid.age_scans = static_cast<std::uint32_t>(random.integer(0, 1000));
    cuboid.dyn = cuboid.age_scans / 60;
    cuboid.held = random.chance(0.2);
    cuboid.appeared = !cuboid.held && cuboid.age_scans % 3 == 0;
    map.appeared += cuboid.appeared ? 1 : 0;
  }
  map.tilt_stopped = random.chance(0.5);
  map.look_period = fromSeconds(random.uniform(0.0, 3.0));
  lookAtRandom(random, map);
  return map;
}

void expectSameLooks(const LookImage& a, const LookImage& b) {
  EXPECT_EQ(a.grid().columns(), b.grid().columns());
  EXPECT_EQ(a.viewpoint(), b.viewpoint());
  EXPECT_EQ(a.epoch(), b.epoch());
  ASSERT_EQ(a.grid().pixels(), b.grid().pixels());
  for (std::size_t pixel = 0; pixel < a.grid().pixels(); ++pixel) {
    for (std::size_t k = 0; k < LookImage::kPasses; ++k) {
      const LookImage::Pass &c = a.passes(pixel)[k], &d = b.passes(pixel)[k];
      ASSERT_EQ(std::tie(c.first, c.last, c.range_mm, c.end, c.moved),
                std::tie(d.first, d.last, d.range_mm, d.end, d.moved))
          << pixel;
    }
  }
}

void expectSame(const CuboidMap& a, const CuboidMap& b) {
  // The size may differ: a message counts whole cells.
  EXPECT_EQ(a.grid.cellsX(), b.grid.cellsX());
  EXPECT_EQ(a.grid.cellsY(), b.grid.cellsY());
  EXPECT_EQ(a.grid.box(0, 0, 1).min(), b.grid.box(0, 0, 1).min());
  EXPECT_EQ(a.grid.config().cell_size_m, b.grid.config().cell_size_m);
  EXPECT_EQ(a.grid.config().height_quantum_m, b.grid.config().height_quantum_m);
  EXPECT_EQ(a.grid.config().height_min_m, b.grid.config().height_min_m);
  EXPECT_EQ(a.grid.config().height_max_m, b.grid.config().height_max_m);
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.serial, b.serial);
  EXPECT_EQ(a.window_scans, b.window_scans);
  EXPECT_EQ(a.window, b.window);
  EXPECT_EQ(a.complete, b.complete);
  EXPECT_EQ(a.overflowed, b.overflowed);
  EXPECT_EQ(a.tilt_stopped, b.tilt_stopped);
  EXPECT_EQ(a.look_period, b.look_period);
  expectSameLooks(a.looks, b.looks);
  EXPECT_EQ(a.thickness, b.thickness);
  EXPECT_EQ(a.viewpoint, b.viewpoint);
  EXPECT_EQ(a.cell_begin, b.cell_begin);
  ASSERT_EQ(a.cuboids.size(), b.cuboids.size());
  for (std::size_t i = 0; i < a.cuboids.size(); ++i) {
    const Cuboid &c = a.cuboids[i], &d = b.cuboids[i];
    ASSERT_EQ(std::tie(c.cell, c.bottom, c.top, c.points, c.age_scans, c.dyn, c.held, c.appeared),
              std::tie(d.cell, d.bottom, d.top, d.points, d.age_scans, d.dyn, d.held, d.appeared));
  }
}

TEST(MapConversionTest, AMapComesBackAsItWas) {
  test::Random random(1);
  CuboidMap back;
  tccm_monitor::CuboidMap message;
  for (int i = 0; i < 200; ++i) {
    CuboidMap map = randomScene(random);
    map.complete = random.chance(0.5);
    map.overflowed = random.chance(0.5);
    toMessage(map, "base_link", message);
    EXPECT_EQ(message.header.frame_id, "base_link");
    ASSERT_EQ(fromMessage(message, back), "");
    expectSame(back, map);
  }
}

TEST(MapConversionTest, AMapWithoutCuboidsIsAMap) {
  tccm_monitor::CuboidMap message;
  toMessage(test::emptyMap(), "base_link", message);
  CuboidMap back;
  ASSERT_EQ(fromMessage(message, back), "");
  expectSame(back, test::emptyMap());
}

TEST(MapConversionTest, HeightsInMetresAreWhatTheQuantaMean) {
  CuboidMap map = test::emptyMap();
  test::addCuboid(map, 7, 0.7, 0.75);
  tccm_monitor::CuboidMap message;
  toMessage(map, "base_link", message);
  EXPECT_EQ(message.cuboids.at(0).cell, 7U);
  EXPECT_FLOAT_EQ(message.cuboids.at(0).top, 0.75F);
  EXPECT_FLOAT_EQ(message.cuboids.at(0).depth, 0.05F);
  EXPECT_DOUBLE_EQ(message.thickness, 0.02);
  EXPECT_EQ(message.cuboids.at(0).col, tccm_monitor::Cuboid::CLEAR);
}

class DefectiveMapTest : public ::testing::Test {
 protected:
  DefectiveMapTest() {
    CuboidMap map = test::emptyMap();
    test::addCuboid(map, 7, 0.7, 0.75);
    test::addCuboid(map, 9, 0.7, 0.75);
    toMessage(map, "base_link", message_);
  }
  std::string defect() {
    CuboidMap map;
    return fromMessage(message_, map);
  }
  tccm_monitor::CuboidMap message_;
};

TEST_F(DefectiveMapTest, TheWholeMessageIsAMap) { EXPECT_EQ(defect(), ""); }

TEST_F(DefectiveMapTest, ACuboidOutsideTheGridIsRefused) {
  message_.cuboids[1].cell = message_.cells_x * message_.cells_y;
  EXPECT_NE(defect(), "");
}

TEST_F(DefectiveMapTest, CuboidsThatAreNotOrderedByCellAreRefused) {
  std::swap(message_.cuboids[0], message_.cuboids[1]);
  EXPECT_NE(defect(), "");
}

TEST_F(DefectiveMapTest, CuboidsOfACellThatAreNotOrderedOrOverlapAreRefused) {
  message_.cuboids[1].cell = 7;
  EXPECT_NE(defect(), "");
  message_.cuboids[1].top = 0.5F;
  EXPECT_NE(defect(), "");
  message_.cuboids[1].top = 0.9F;
  EXPECT_EQ(defect(), "");
}

TEST_F(DefectiveMapTest, HeightsThatAreNoHeightsAreRefused) {
  for (const double height : {kNaN, kInf, -kInf, 1e9}) {
    message_.cuboids[1].top = static_cast<float>(height);
    EXPECT_NE(defect(), "") << height;
  }
  message_.cuboids[1].top = 0.75F;
  for (const double depth : {kNaN, kInf, 0.0, -0.1}) {
    message_.cuboids[1].depth = static_cast<float>(depth);
    EXPECT_NE(defect(), "") << depth;
  }
}

TEST_F(DefectiveMapTest, AGridThatIsNoneIsRefused) {
  const tccm_monitor::CuboidMap whole = message_;
  for (const double value : {kNaN, kInf, 0.0, -0.02}) {
    message_.cell_size = value;
    EXPECT_NE(defect(), "") << value;
    message_ = whole;
    message_.height_quantum = value;
    EXPECT_NE(defect(), "") << value;
    message_ = whole;
  }
  message_.origin_x = kNaN;
  EXPECT_NE(defect(), "");
  message_ = whole;
  message_.cells_x = 0;
  EXPECT_NE(defect(), "");
  message_ = whole;
  message_.cells_x = message_.cells_y = 4000000000U;
  EXPECT_NE(defect(), "");
  message_ = whole;
  message_.height_max = message_.height_min;
  EXPECT_NE(defect(), "");
}

TEST_F(DefectiveMapTest, AThicknessThatIsNoneIsRefused) {
  for (const double thickness : {kNaN, kInf, 0.0, -0.02, 1e9}) {
    message_.thickness = thickness;
    EXPECT_NE(defect(), "") << thickness;
  }
}

TEST_F(DefectiveMapTest, AViewpointThatIsNotFiniteIsRefused) {
  message_.viewpoint.z = kNaN;
  EXPECT_NE(defect(), "");
}

TEST_F(DefectiveMapTest, LooksThatAreNoneAreRefused) {
  const tccm_monitor::CuboidMap whole = message_;
  const auto columns = static_cast<std::size_t>(LookImage().grid().columns());
  const auto setPasses = [this](std::size_t passes) {
    message_.looks.first_ms.assign(passes, 0);
    message_.looks.last_ms.assign(passes, 0);
    message_.looks.range_mm.assign(passes, 0);
    message_.looks.end.assign(passes, 0);
    message_.looks.moved.assign(passes, 0);
  };
  setPasses(2 * columns);
  EXPECT_EQ(defect(), "") << "a whole row";
  message_.looks.end.back() = tccm_monitor::Looks::UNCLEAR + 1;
  EXPECT_NE(defect(), "");
  setPasses(2 * columns - 1);
  EXPECT_NE(defect(), "") << "no whole row";
  setPasses(2 * columns);
  message_.looks.last_ms.pop_back();
  EXPECT_NE(defect(), "") << "a list is shorter";
  message_ = whole;
  setPasses(2 * columns);
  message_.looks.row_begin = static_cast<std::uint32_t>(LookImage().grid().rows());
  EXPECT_NE(defect(), "") << "beyond the last row";
  message_ = whole;
  message_.looks.viewpoint.x = kNaN;
  EXPECT_NE(defect(), "");
  for (const double resolution : {kNaN, kInf, 0.0, -0.035, 1.0}) {
    message_ = whole;
    message_.looks.resolution = resolution;
    EXPECT_NE(defect(), "") << resolution;
  }
  message_ = whole;
  message_.look_period = ros::Duration(-1.0);
  EXPECT_NE(defect(), "");
}

TEST(OccupiedPointsTest, LieInTheCuboidsFromEndToEndNoFurtherApartThanACell) {
  test::Random random(5);
  CuboidMap map = test::emptyMap();
  std::set<CellIndex> cells;
  while (cells.size() < 300) cells.insert(static_cast<CellIndex>(random.integer(0, 7499)));
  for (const CellIndex cell : cells) {
    const double bottom = random.uniform(0.0, 1.0);
    test::addCuboid(map, cell, bottom, bottom + random.uniform(0.002, 0.5));
  }
  indexCells(map);
  sensor_msgs::PointCloud2 message;
  for (int again = 0; again < 2; ++again) toPoints(map, "base_link", message);
  EXPECT_EQ(message.header.frame_id, "base_link");
  sensor_msgs::PointCloud2ConstIterator<float> x(message, "x"), y(message, "y"), z(message, "z");
  std::map<CellIndex, std::vector<double>> heights;
  for (; x != x.end(); ++x, ++y, ++z) {
    const auto cell = map.grid.cellOf({*x, *y, 0.5});
    ASSERT_TRUE(cell);
    heights[*cell].push_back(*z);
  }
  ASSERT_EQ(heights.size(), map.cuboids.size());
  for (const Cuboid& cuboid : map.cuboids) {
    std::vector<double>& column = heights.at(cuboid.cell);
    std::sort(column.begin(), column.end());
    EXPECT_NEAR(column.front(), map.grid.metres(cuboid.bottom), 1e-6);
    EXPECT_NEAR(column.back(), map.grid.metres(cuboid.top), 1e-6);
    for (std::size_t i = 1; i < column.size(); ++i) {
      EXPECT_LE(column[i] - column[i - 1], map.grid.config().cell_size_m + 1e-6);
    }
  }
}

}  // namespace
}  // namespace tccm
