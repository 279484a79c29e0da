#include "ros/published_map.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "ros/conversions.h"
#include "support/cuboid_scene.h"
#include "support/random.h"

namespace tccm {
namespace {

Grid::Config smallGrid() {
  Grid::Config grid;
  grid.size_x_m = grid.size_y_m = 0.6;
  return grid;
}

PublishedMap randomMap(test::Random& random) {
  PublishedMap published;
  published.map = std::make_shared<CuboidMap>(test::randomMap(random, smallGrid(), 0.3));
  CuboidMap& map = *published.map;
  map.stamp = Time(fromSeconds(random.uniform(1.0, 1e6)));
  map.looks.begin(map.stamp, random.point(2.0));
  for (int row = 10; row < 10 + random.integer(0, 12); ++row) {
    map.looks.edit(row, random.integer(0, 100))[0] = {1, 2, 300, Seen::kSurface, false};
  }
  published.frame = random.chance(0.5) ? "base_link" : "map";
  published.attached_stamp = ros::Time(random.uniform(0.0, 100.0));
  return published;
}

std::vector<std::uint8_t> bytesOf(const ros::SerializedMessage& serialized) {
  return {serialized.buf.get(), serialized.buf.get() + serialized.num_bytes};
}

TEST(PublishedMapTest, OthersHearTheMessageThatItStandsFor) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const PublishedMap published = randomMap(random);
    tccm_monitor::CuboidMap message;
    toMessage(published, message);
    EXPECT_EQ(message.header.frame_id, published.frame);
    EXPECT_EQ(message.attached_stamp, published.attached_stamp);
    ASSERT_EQ(bytesOf(ros::serialization::serializeMessage(published)),
              bytesOf(ros::serialization::serializeMessage(message)));
  }
}

TEST(PublishedMapTest, ItIsOfTheMessagesType) {
  using Message = tccm_monitor::CuboidMap;
  using Published = PublishedMap;
  namespace traits = ros::message_traits;
  EXPECT_STREQ(traits::md5sum<Published>(), traits::md5sum<Message>());
  EXPECT_STREQ(traits::datatype<Published>(), traits::datatype<Message>());
  EXPECT_STREQ(traits::definition<Published>(), traits::definition<Message>());
}

TEST(PublishedMapTest, FromAnotherProcessItComesAsItWas) {
  test::Random random(2);
  PublishedMap back;
  for (int i = 0; i < 100; ++i) {
    const PublishedMap published = randomMap(random);
    ros::SerializedMessage serialized = ros::serialization::serializeMessage(published);
    ros::serialization::IStream stream(serialized.message_start,
                                       static_cast<std::uint32_t>(serialized.num_bytes - 4));
    ros::serialization::deserialize(stream, back);
    EXPECT_EQ(back.defect, "");
    EXPECT_EQ(back.frame, published.frame);
    EXPECT_EQ(back.attached_stamp, published.attached_stamp);
    EXPECT_EQ(bytesOf(ros::serialization::serializeMessage(back)), bytesOf(serialized));
  }
}

TEST(PublishedMapTest, WhatIsNoMapHasADefect) {
  test::Random random(3);
  PublishedMap back;
  tccm_monitor::CuboidMap message;
  toMessage(randomMap(random), message);
  message.cell_size = -1.0;
  fromMessage(message, back);
  EXPECT_NE(back.defect, "");
  message.cell_size = smallGrid().cell_size_m;
  fromMessage(message, back);
  EXPECT_EQ(back.defect, "");
}

TEST(PublishedMapTest, AMapThatSomebodyHoldsIsNotWrittenOver) {
  test::Random random(4);
  tccm_monitor::CuboidMap message;
  PublishedMap back;
  toMessage(randomMap(random), message);
  fromMessage(message, back);
  const CuboidMap* const first = back.map.get();
  fromMessage(message, back);
  EXPECT_EQ(back.map.get(), first);
  const std::shared_ptr<const CuboidMap> held = back.map;
  const Time stamp = held->stamp;
  message.header.stamp += ros::Duration(1.0);
  fromMessage(message, back);
  EXPECT_NE(back.map.get(), held.get());
  EXPECT_EQ(held->stamp, stamp);
}

}  // namespace
}  // namespace tccm
