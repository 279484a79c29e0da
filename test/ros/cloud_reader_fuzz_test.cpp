/// Whatever a header says, nothing beyond the data is read. Built with the sanitizers of address
/// and undefined behaviour.

#include <gtest/gtest.h>

#include "ros/cloud_reader.h"
#include "support/driver_clouds.h"
#include "support/random.h"

namespace tccm {
namespace {

using sensor_msgs::PointCloud2;
using test::Random;

std::uint32_t wild(Random& random, std::uint32_t near) {
  switch (random.integer(0, 4)) {
    case 0:
      return static_cast<std::uint32_t>(random.integer(0, 64));
    case 1:
      return 0xFFFFFFFFU - static_cast<std::uint32_t>(random.integer(0, 16));
    case 2:
      return near + static_cast<std::uint32_t>(random.integer(-8, 8));
    case 3:
      return near * static_cast<std::uint32_t>(random.integer(0, 3));
    default:
      return static_cast<std::uint32_t>(random.integer(0, 0x7FFFFFFF));
  }
}

void mutateField(sensor_msgs::PointField& field, Random& random) {
  const char* names[] = {"x", "y", "z", "t", "time", "timestamp", "offset_time", "", "rgb\n"};
  switch (random.integer(0, 3)) {
    case 0:
      field.name = names[random.integer(0, 8)];
      break;
    case 1:
      field.offset = wild(random, field.offset);
      break;
    case 2:
      field.datatype = static_cast<std::uint8_t>(random.integer(0, 255));
      break;
    default:
      field.count = wild(random, 1);
  }
}

void mutate(PointCloud2& message, Random& random) {
  const auto any = [&](std::size_t size) {
    return static_cast<std::size_t>(random.integer(0, static_cast<int>(size) - 1));
  };
  switch (random.integer(0, 7)) {
    case 0:
      message.width = wild(random, message.width);
      break;
    case 1:
      message.height = wild(random, message.height);
      break;
    case 2:
      message.point_step = wild(random, message.point_step);
      break;
    case 3:
      message.row_step = wild(random, message.row_step);
      break;
    case 4:
      message.data.resize(wild(random, 3000) % 6000);
      break;
    case 5:
      if (!message.data.empty())
        message.data[any(message.data.size())] = static_cast<std::uint8_t>(random.integer(0, 255));
      break;
    case 6:
      if (!message.fields.empty())
        message.fields.push_back(message.fields[any(message.fields.size())]);
      break;
    default:
      if (!message.fields.empty()) mutateField(message.fields[any(message.fields.size())], random);
  }
}

/// The first rows and columns alone: many of them in little time.
PointCloud2 excerptOf(const PointCloud2& message) {
  PointCloud2 excerpt = message;
  excerpt.width = 13;
  excerpt.height = message.height > 1 ? 7 : 1;
  excerpt.row_step = excerpt.width * excerpt.point_step;
  excerpt.data.resize(static_cast<std::size_t>(excerpt.row_step) * excerpt.height);
  return excerpt;
}

TEST(CloudReaderFuzzTest, NothingBeyondTheDataIsReadWhateverTheHeaderSays) {
  const CloudReader reader{CloudLimits{}};
  std::vector<PointCloud2> healthy;
  for (const test::DriverCloud& driver : test::driverClouds()) {
    healthy.push_back(excerptOf(driver.message));
  }
  std::size_t read = 0, refused = 0;
  Cloud cloud;
  for (unsigned seed = 0; seed < 40000; ++seed) {
    Random random(seed);
    PointCloud2 message = healthy[seed % healthy.size()];
    for (int i = random.integer(1, 4); i > 0; --i) mutate(message, random);
    message.data.shrink_to_fit();
    const std::string defect = reader.read(message, cloud);
    ++(defect.empty() ? read : refused);
    EXPECT_EQ(defect.find('\n'), std::string::npos) << defect;
    if (!defect.empty()) continue;
    EXPECT_EQ(cloud.points.size(), static_cast<std::size_t>(message.width) * message.height);
    EXPECT_LE(toSeconds(cloud.last() - cloud.first()), 0.2001) << seed;
  }
  EXPECT_GT(read, 1000U);
  EXPECT_GT(refused, 10000U);
}

}  // namespace
}  // namespace tccm
