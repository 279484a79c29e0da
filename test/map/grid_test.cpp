#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "support/near.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"
#include "tccm_monitor/cuboid_map.h"

namespace tccm {
namespace {

using test::Random;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The number as a dump prints it and a stranger reads it.
double printed(double x) {
  char text[64];
  std::snprintf(text, sizeof text, "%.6f", x);
  return std::strtod(text, nullptr);
}

Grid::Config area(double origin, double size, double cell_size) {
  Grid::Config config;
  config.origin_x_m = config.origin_y_m = origin;
  config.size_x_m = config.size_y_m = size;
  config.cell_size_m = cell_size;
  return config;
}

TEST(GridTest, ThePapersAreaHas75By100Cells) {
  const Grid grid;
  EXPECT_EQ(grid.cellsX(), 75U);
  EXPECT_EQ(grid.cellsY(), 100U);
  EXPECT_EQ(grid.cells(), 7500U);
}

TEST(GridTest, ALastCellMayReachBeyondTheArea) {
  EXPECT_EQ(Grid(area(0.0, 1.01, 0.1)).cellsX(), 11U);
  EXPECT_EQ(Grid(area(0.0, 0.3, 0.1)).cellsX(), 3U);  // 0.3 / 0.1 is a hair below 3
}

TEST(GridTest, CellsCountAlongXFirst) {
  const Grid grid(area(0.0, 1.0, 0.25));
  EXPECT_EQ(grid.cellOf({0.0, 0.0, 0.0}), 0U);
  EXPECT_EQ(grid.cellOf({0.26, 0.0, 0.0}), 1U);
  EXPECT_EQ(grid.cellOf({0.0, 0.26, 0.0}), 4U);
  EXPECT_EQ(grid.cellOf({0.999999, 0.999999, 0.0}), 15U);
}

TEST(GridTest, ABorderBelongsToTheCellAboveIt) {
  const Grid grid(area(-0.5, 1.0, 0.25));
  EXPECT_EQ(grid.cellOf({-0.25, -0.5, 0.0}), 1U);
  EXPECT_EQ(grid.cellOf({-0.250001, -0.5, 0.0}), 0U);
  EXPECT_FALSE(grid.cellOf({-0.500001, -0.5, 0.0}));
  EXPECT_FALSE(grid.cellOf({0.5, -0.5, 0.0}));
  EXPECT_FALSE(grid.cellOf({-0.5, 0.5, 0.0}));
}

TEST(GridTest, HeightLimitsIncludeTheLowerAndNotTheUpper) {
  Grid::Config config = area(0.0, 1.0, 0.25);
  config.height_min_m = -0.1;
  config.height_max_m = 1.5;
  const Grid grid(config);
  EXPECT_TRUE(grid.cellOf({0.1, 0.1, -0.1}));
  EXPECT_FALSE(grid.cellOf({0.1, 0.1, -0.100001}));
  EXPECT_TRUE(grid.cellOf({0.1, 0.1, 1.499999}));
  EXPECT_FALSE(grid.cellOf({0.1, 0.1, 1.5}));
}

TEST(GridTest, PointsThatAreNotFiniteAreInNoCell) {
  const Grid grid;
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(grid.cellOf({bad, 0.0, 0.5}));
    EXPECT_FALSE(grid.cellOf({0.5, bad, 0.5}));
    EXPECT_FALSE(grid.cellOf({0.5, 0.0, bad}));
  }
}

/// @param x where the number that a dump prints has to name the same cell.
void expectCellOfPrinted(const Grid& grid, double x) {
  const double rounded = Grid::toMicrometre(x);
  ASSERT_EQ(rounded, printed(rounded));
  const double column =
      std::floor((printed(rounded) - grid.config().origin_x_m) / grid.config().cell_size_m);
  const auto cell = grid.cellOf({rounded, grid.config().origin_y_m, grid.config().height_min_m});
  const bool inside = column >= 0.0 && column < grid.cellsX();
  ASSERT_EQ(cell.has_value(), inside) << x;
  ASSERT_EQ(cell.value_or(0), inside ? static_cast<CellIndex>(column) : 0U) << x;
}

TEST(GridTest, ThePrintedNumberNamesTheSameCellAnywhereAndOnBorders) {
  Random random(21);
  for (const double cell_size : {0.02, 0.01, 0.03, 0.05, 0.1, 0.07}) {
    for (const double origin : {0.0, -1.0, 0.3, -0.77, 12.34}) {
      const Grid grid(area(origin, 2.0, cell_size));
      for (int i = 0; i < 2000; ++i) {
        expectCellOfPrinted(grid, origin + random.uniform(-0.1, 2.1));
        const double border = origin + random.integer(-2, 110) * cell_size;
        expectCellOfPrinted(grid, border);
        expectCellOfPrinted(grid, border + 1e-6);
        expectCellOfPrinted(grid, border - 1e-6);
        expectCellOfPrinted(grid, border + random.uniform(-1e-6, 1e-6));
      }
    }
  }
}

TEST(GridTest, RoundingToTheMicrometreMovesByHalfOfOneAtMost) {
  Random random(22);
  for (int i = 0; i < 10000; ++i) {
    const double x = random.uniform(-20.0, 20.0);
    ASSERT_LE(std::abs(Grid::toMicrometre(x) - x), 0.5e-6 + 1e-12);
    ASSERT_EQ(Grid::toMicrometre(Grid::toMicrometre(x)), Grid::toMicrometre(x));
  }
  EXPECT_TRUE(std::isnan(Grid::toMicrometre(kNaN)));
  EXPECT_TRUE(std::isinf(Grid::toMicrometre(kInfinity)));
}

TEST(GridTest, HeightsRoundToTheNearestQuantumAndHalvesToEven) {
  const Grid grid;
  EXPECT_EQ(grid.heightOf(0.0), 0);
  EXPECT_EQ(grid.heightOf(0.7314), 731);
  EXPECT_EQ(grid.heightOf(0.7316), 732);
  EXPECT_EQ(grid.heightOf(-0.0014), -1);
  Grid::Config halves;
  halves.height_quantum_m = 0.0625;  // exact in binary, as its halves are
  EXPECT_EQ(Grid(halves).heightOf(0.5 * 0.0625), 0);
  EXPECT_EQ(Grid(halves).heightOf(1.5 * 0.0625), 2);
  EXPECT_EQ(Grid(halves).heightOf(2.5 * 0.0625), 2);
}

TEST(GridTest, HeightsComeBackWithinHalfAQuantum) {
  Random random(23);
  const Grid grid;
  for (int i = 0; i < 10000; ++i) {
    const double z = random.uniform(0.0, 2.0);
    ASSERT_LE(std::abs(grid.metres(grid.heightOf(z)) - z), 0.0005 + 1e-12);
    ASSERT_LE(grid.metres(grid.heightFloor(z)), z + 1e-12);
    ASSERT_GE(grid.metres(grid.heightCeil(z)), z - 1e-12);
    ASSERT_LE(grid.heightCeil(z) - grid.heightFloor(z), 1);
  }
}

TEST(GridTest, FloorAndCeilingAreClampedTo16Bits) {
  const Grid grid;
  EXPECT_EQ(grid.heightFloor(1e6), 32767);
  EXPECT_EQ(grid.heightCeil(-1e6), -32768);
  EXPECT_EQ(grid.heightFloor(-kInfinity), -32768);
}

TEST(GridTest, ACellsBoxHoldsItsPointsAndItsCentre) {
  Random random(24);
  const Grid grid;
  for (int i = 0; i < 10000; ++i) {
    Vector3 p(random.uniform(0.0, 1.5), random.uniform(-1.0, 1.0), random.uniform(0.0, 1.9));
    p = p.unaryExpr([](double x) { return Grid::toMicrometre(x); });
    const auto cell = grid.cellOf(p);
    if (!cell) continue;
    const UprightBox box = grid.box(*cell, 0, 2000);
    ASSERT_LT(box.exteriorDistance(p), 1e-9);
    ASSERT_NEAR(box.sizes().z(), 2.0, 1e-12);
    ASSERT_TRUE(
        test::isNearly(box.center(), {grid.centre(*cell).x(), grid.centre(*cell).y(), 1.0}, 1e-9));
  }
}

bool holds(const Grid::Footprint& footprint, CellIndex x, CellIndex y) {
  return x >= footprint.x_begin && x < footprint.x_end && y >= footprint.y_begin &&
         y < footprint.y_end;
}

/// How far a box and a cell's column are apart in the plane; negative where they overlap.
double gap(const Grid& grid, const UprightBox& box, CellIndex x, CellIndex y) {
  const UprightBox cell = grid.box(y * grid.cellsX() + x, 0, 1);
  return std::max({box.min().x() - cell.max().x(), cell.min().x() - box.max().x(),
                   box.min().y() - cell.max().y(), cell.min().y() - box.max().y()});
}

/// Cells of 62.5 mm: their borders are exact, so touching is exact too.
TEST(GridTest, AFootprintHasExactlyTheCellsThatTheBoxTouchesBordersIncluded) {
  Random random(25);
  const Grid grid(area(-0.5, 1.0, 0.0625));
  for (int i = 0; i < 3000; ++i) {
    const auto edge = [&] {
      return random.chance(0.5) ? 0.0625 * random.integer(-12, 12) : random.uniform(-0.75, 0.75);
    };
    const Vector3 a(edge(), edge(), 0.0), b(edge(), edge(), 0.1);
    const UprightBox box(a.cwiseMin(b), a.cwiseMax(b));
    const auto footprint = grid.footprint(box);
    for (CellIndex y = 0; y < grid.cellsY(); ++y) {
      for (CellIndex x = 0; x < grid.cellsX(); ++x) {
        ASSERT_EQ(holds(footprint, x, y), gap(grid, box, x, y) <= 0.0) << "box " << i;
      }
    }
  }
}

/// Borders of 20 mm cells are rounded numbers: what overlaps by more than a nanometre is there,
/// what is farther than that is not.
TEST(GridTest, AFootprintOf20MillimetreCellsMissesNothingThatOverlaps) {
  Random random(26);
  const Grid grid(area(-0.3, 0.6, 0.02));
  for (int i = 0; i < 2000; ++i) {
    const auto edge = [&] {
      return random.chance(0.5) ? -0.3 + 0.02 * random.integer(-3, 33) : random.uniform(-0.4, 0.4);
    };
    const Vector3 a(edge(), edge(), 0.0), b(edge(), edge(), 0.1);
    const UprightBox box(a.cwiseMin(b), a.cwiseMax(b));
    const auto footprint = grid.footprint(box);
    for (CellIndex y = 0; y < grid.cellsY(); ++y) {
      for (CellIndex x = 0; x < grid.cellsX(); ++x) {
        const double apart = gap(grid, box, x, y);
        if (std::abs(apart) < 1e-9) continue;
        ASSERT_EQ(holds(footprint, x, y), apart < 0.0) << "box " << i << " gap " << apart;
      }
    }
  }
}

TEST(GridTest, AFootprintOutsideTheAreaIsEmpty) {
  const Grid grid;
  const auto footprint = grid.footprint({Vector3(5.0, 5.0, 0.0), Vector3(6.0, 6.0, 1.0)});
  EXPECT_EQ(footprint.x_begin, footprint.x_end);
  const auto whole = grid.footprint({Vector3::Constant(-1e9), Vector3::Constant(1e9)});
  EXPECT_EQ(whole.x_begin, 0U);
  EXPECT_EQ(whole.x_end, grid.cellsX());
  EXPECT_EQ(whole.y_end, grid.cellsY());
}

TEST(GridTest, GridsAreEqualWhereEveryNumberIs) {
  EXPECT_TRUE(Grid() == Grid());
  for (double Grid::Config::*key :
       {&Grid::Config::origin_x_m, &Grid::Config::origin_y_m, &Grid::Config::size_x_m,
        &Grid::Config::size_y_m, &Grid::Config::height_min_m, &Grid::Config::height_max_m,
        &Grid::Config::cell_size_m, &Grid::Config::height_quantum_m}) {
    Grid::Config other;
    other.*key += 0.001;
    EXPECT_FALSE(Grid() == Grid(other));
  }
}

TEST(GridTest, NaNZeroAndTooLargeConfigurationsAreRefused) {
  for (const double bad : {kNaN, kInfinity}) {
    for (double Grid::Config::*key :
         {&Grid::Config::origin_x_m, &Grid::Config::origin_y_m, &Grid::Config::size_x_m,
          &Grid::Config::size_y_m, &Grid::Config::height_min_m, &Grid::Config::height_max_m,
          &Grid::Config::cell_size_m, &Grid::Config::height_quantum_m}) {
      Grid::Config config;
      config.*key = bad;
      EXPECT_THROW(Grid{config}, ConfigError);
    }
  }
  EXPECT_THROW(Grid(area(0.0, 0.0, 0.02)), ConfigError);
  EXPECT_THROW(Grid(area(0.0, 1.0, 0.0)), ConfigError);
  EXPECT_THROW(Grid(area(0.0, 1000.0, 0.001)), ConfigError);
}

TEST(GridTest, HeightsThatDoNotFitInto16BitsAreRefused) {
  Grid::Config config;
  config.height_max_m = 33.0;
  EXPECT_THROW(Grid{config}, ConfigError);
  config.height_quantum_m = 0.002;
  EXPECT_NO_THROW(Grid{config});
  config = {};
  config.height_max_m = config.height_min_m;
  EXPECT_THROW(Grid{config}, ConfigError);
}

TEST(Grid, PlacesAReturnWhereTheRoundedPositionNamesCellAndHeight) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> anywhere(-0.1, 2.1), hair(-3e-6, 3e-6);
  std::uniform_int_distribution<int> cell(-1, 101), quantum(-1, 2001), coin(0, 1);
  Grid::Config config;
  config.size_x_m = config.size_y_m = config.height_max_m = 2.0;
  config.origin_y_m = 0.0;
  const Grid grid(config);
  for (int i = 0; i < 200000; ++i) {
    // Every second coordinate lies within a hair of where a rounding changes.
    const auto along = [&](double size) {
      return coin(engine) ? anywhere(engine) : cell(engine) * size + hair(engine);
    };
    const Vector3 p(
        along(0.02), along(0.02),
        coin(engine) ? anywhere(engine) : (quantum(engine) + 0.5) * 1e-3 + hair(engine));
    const Vector3 rounded(Grid::toMicrometre(p.x()), Grid::toMicrometre(p.y()),
                          Grid::toMicrometre(p.z()));
    const auto expected = grid.cellOf(rounded);
    const auto place = grid.place(p);
    ASSERT_EQ(place.has_value(), expected.has_value()) << p.transpose();
    if (!place) continue;
    ASSERT_EQ(place->cell, *expected) << p.transpose();
    ASSERT_EQ(place->height, grid.heightOf(rounded.z())) << p.transpose();
  }
}

}  // namespace
}  // namespace tccm
