#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tccm::test {

/// What LZF packed. @throws std::runtime_error
inline std::vector<std::uint8_t> unpackedLzf(const std::uint8_t* in, std::size_t size,
                                             std::size_t unpacked_size) {
  std::vector<std::uint8_t> out;
  out.reserve(unpacked_size);
  std::size_t read = 0;
  const auto next = [&] {
    if (read == size) throw std::runtime_error("LZF: it ends too early");
    return in[read++];
  };
  while (out.size() < unpacked_size) {
    const std::size_t control = next();
    if (control < 32) {
      for (std::size_t i = 0; i <= control; ++i) out.push_back(next());
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) length += next();
    const std::size_t back = ((control & 31) << 8 | std::size_t{next()}) + 1;
    if (back > out.size()) throw std::runtime_error("LZF: it refers to before its begin");
    for (std::size_t i = 0; i < length + 2; ++i) out.push_back(out[out.size() - back]);
  }
  return out;
}

/// A PCD file of version 0.7, binary or binary_compressed, as the message that a driver would have
/// published. Nothing where there is no such file. @throws std::runtime_error
inline std::optional<sensor_msgs::PointCloud2> readPcd(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  sensor_msgs::PointCloud2 message;
  std::vector<std::uint32_t> sizes;
  std::string line, key, word, how;
  while (how.empty() && std::getline(file, line)) {
    std::istringstream words(line);
    words >> key;
    for (std::size_t i = 0; words >> word; ++i) {
      if (key == "FIELDS") {
        message.fields.emplace_back();
        message.fields.back().name = word;
        message.fields.back().count = 1;
      }
      if (key == "SIZE") sizes.push_back(static_cast<std::uint32_t>(std::stoul(word)));
      if (key == "TYPE") {
        message.fields.at(i).datatype = word == "F" && sizes.at(i) == 8
                                            ? sensor_msgs::PointField::FLOAT64
                                        : word == "F" ? sensor_msgs::PointField::FLOAT32
                                                      : sensor_msgs::PointField::UINT32;
      }
      if (key == "WIDTH") message.width = static_cast<std::uint32_t>(std::stoul(word));
      if (key == "HEIGHT") message.height = static_cast<std::uint32_t>(std::stoul(word));
      if (key == "DATA") how = word;
    }
  }
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    message.fields.at(i).offset = message.point_step;
    message.point_step += sizes[i];
  }
  message.row_step = message.width * message.point_step;
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  const std::size_t points = static_cast<std::size_t>(message.width) * message.height;
  if (how == "binary") {
    message.data.assign(bytes.begin(),
                        bytes.begin() + static_cast<std::ptrdiff_t>(points * message.point_step));
    return message;
  }
  if (how != "binary_compressed" || bytes.size() < 8)
    throw std::runtime_error(path + ": DATA " + how);
  std::uint32_t lengths[2];
  std::memcpy(lengths, bytes.data(), 8);
  const auto columns = unpackedLzf(bytes.data() + 8, lengths[0], lengths[1]);
  message.data.resize(points * message.point_step);
  std::size_t at = 0;  // field after field
  for (std::size_t f = 0; f < sizes.size(); ++f) {
    for (std::size_t i = 0; i < points; ++i, at += sizes[f]) {
      std::memcpy(&message.data[i * message.point_step + message.fields[f].offset], &columns.at(at),
                  sizes[f]);
    }
  }
  return message;
}

}  // namespace tccm::test
