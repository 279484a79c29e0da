/// The conversions between primitives, held objects and their messages.

#include <gtest/gtest.h>

#include <limits>

#include "ros/conversions.h"
#include "support/near.h"
#include "support/random.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A ball of 50 mm at its link's origin.
tccm_monitor::Primitive ball() {
  tccm_monitor::Primitive message;
  message.shape = "sphere";
  message.radius = 0.05;
  message.pose.orientation.w = 1.0;
  return message;
}

tccm_monitor::AttachedObject held() {
  tccm_monitor::AttachedObject message;
  message.name = "mug";
  message.link = "hand";
  message.primitive = ball();
  return message;
}

template <typename Message>
std::string refusalOf(const Message& message) {
  try {
    static_cast<void>(fromMessage(message, "the mug"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

std::string refusalOf(const tccm_monitor::AttachedObject& message) {
  try {
    static_cast<void>(fromMessage(message));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expectSame(const Shape& a, const Shape& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const auto* box = std::get_if<Box>(&a)) {
    EXPECT_TRUE(test::isNearly(box->half_extents, std::get<Box>(b).half_extents, 1e-15));
  } else if (const auto* cylinder = std::get_if<Cylinder>(&a)) {
    EXPECT_EQ(cylinder->radius, std::get<Cylinder>(b).radius);
    EXPECT_EQ(cylinder->half_length, std::get<Cylinder>(b).half_length);
  } else if (const auto* capsule = std::get_if<Capsule>(&a)) {
    EXPECT_EQ(capsule->radius, std::get<Capsule>(b).radius);
    EXPECT_EQ(capsule->half_length, std::get<Capsule>(b).half_length);
  } else {
    EXPECT_EQ(std::get<Sphere>(a).radius, std::get<Sphere>(b).radius);
  }
}

TEST(PrimitiveConversionsTest, EveryShapeComesBackAsItWas) {
  test::Random random(7);
  for (int i = 0; i < 100; ++i) {
    const double r = random.uniform(0.01, 0.3), l = random.uniform(0.0, 0.5);
    for (const Shape& shape : {Shape(Box{Vector3(r, l, 0.5 * r)}), Shape(Cylinder{r, l}),
                               Shape(Capsule{r, l}), Shape(Sphere{r})}) {
      PlacedShape placed{shape};
      placed.pose.translate(Vector3(random.uniform(-1, 1), l, -r));
      placed.pose.rotate(Eigen::AngleAxisd(random.uniform(-3, 3), Vector3(1, l, r).normalized()));
      const tccm_monitor::Primitive message = toMessage(placed);
      EXPECT_EQ(message.shape, name(shape));
      const PlacedShape back = fromMessage(message, "it");
      expectSame(back.shape, shape);
      EXPECT_TRUE(test::isNearly(back.pose, placed.pose, 1e-12));
    }
  }
}

TEST(PrimitiveConversionsTest, MessagesHaveFullEdgesAndLengths) {
  const auto box = toMessage(PlacedShape{Box{Vector3(0.1, 0.2, 0.3)}});
  EXPECT_EQ(box.size.x, 0.2);
  EXPECT_EQ(box.size.y, 0.4);
  EXPECT_EQ(box.size.z, 0.6);
  const auto capsule = toMessage(PlacedShape{Capsule{0.05, 0.2}});
  EXPECT_EQ(capsule.radius, 0.05);
  EXPECT_EQ(capsule.length, 0.4) << "of the straight part";
}

TEST(PrimitiveConversionsTest, AQuaternionThatIsNoneIsRefused) {
  auto message = ball();
  message.pose.orientation.w = 0.0;
  EXPECT_EQ(refusalOf(message), "the mug: its orientation is no unit quaternion");
  EXPECT_EQ(refusalOf(message.pose), "the mug: its orientation is no unit quaternion");
  for (const double w : {2.0, 0.99, 1.01, kNaN, kInfinity, -kInfinity}) {
    message.pose.orientation.w = w;
    EXPECT_NE(refusalOf(message).find("orientation"), std::string::npos) << w;
  }
}

TEST(PrimitiveConversionsTest, ARoundedQuaternionIsTakenAndMadeARotation) {
  auto message = ball();
  message.pose.orientation.z = 0.7071;
  message.pose.orientation.w = 0.7071;
  const PlacedShape placed = fromMessage(message, "it");
  EXPECT_TRUE(isRigid(placed.pose));
  EXPECT_TRUE(test::isNearly(Vector3(placed.pose.linear().col(0)), Vector3::UnitY(), 1e-9));
}

TEST(PrimitiveConversionsTest, APositionThatIsNoneIsRefused) {
  for (const double z : {kNaN, kInfinity, -kInfinity}) {
    auto message = ball();
    message.pose.position.z = z;
    EXPECT_EQ(refusalOf(message), "the mug: its position is not finite") << z;
  }
}

TEST(PrimitiveConversionsTest, AShapeThatIsNoneIsRefusedByName) {
  auto message = ball();
  for (const std::string shape : {"", "cone", "Sphere", "sphere ", "mesh"}) {
    message.shape = shape;
    EXPECT_EQ(refusalOf(message),
              "the mug: shape '" + shape + "' is none of box, cylinder, capsule, sphere");
  }
}

TEST(PrimitiveConversionsTest, SizesAreLeftToWhoeverTakesTheShape) {
  auto message = ball();
  message.radius = -1.0;
  EXPECT_EQ(std::get<Sphere>(fromMessage(message, "it").shape).radius, -1.0);
  message.radius = kNaN;
  EXPECT_THROW(validate(fromMessage(message, "it").shape, "it"), ConfigError);
}

TEST(PrimitiveConversionsTest, AHeldObjectIsNamedInItsRefusals) {
  const AttachedObject object = fromMessage(held());
  EXPECT_EQ(object.name, "mug");
  EXPECT_EQ(object.link, "hand");
  EXPECT_EQ(std::get<Sphere>(object.primitive.shape).radius, 0.05);
  auto message = held();
  message.primitive.shape = "cone";
  EXPECT_EQ(refusalOf(message).rfind("object 'mug': shape 'cone'", 0), 0U);
}

}  // namespace
}  // namespace tccm
