#include "simulation/named.h"

#include <gtest/gtest.h>

#include "support/error_of.h"

namespace tccm::simulation {
namespace {

enum class Colour { kRed, kGreen, kBlue };

Colour colour(const std::string& name) {
  return named<Colour>("colour", name, {"red", "green", "blue"});
}

TEST(NamedTest, AnEnumeratorIsFoundByItsName) {
  EXPECT_EQ(colour("red"), Colour::kRed);
  EXPECT_EQ(colour("blue"), Colour::kBlue);
}

TEST(NamedTest, AnotherNameIsRefusedWithTheKeyAndAllThereAre) {
  EXPECT_EQ(test::errorOf([] { (void)colour("Red"); }), "colour: Red is none of red, green, blue");
}

}  // namespace
}  // namespace tccm::simulation
