#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <string>

#include "tccm_monitor/pose.h"
#include "tccm_monitor/time.h"

/// What fuzz targets make structures from.
namespace tccm::test {

/// Takes numbers out of a fuzzer's bytes, from the front; where none are left all are 0. Of each
/// the first values are the usual ones, so that an input that is cut short is a plain one.
class ByteReader {
 public:
  /// @param bytes have to outlive it.
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool isEmpty() const { return next_ >= bytes_.size(); }
  std::uint8_t byte() {
    return isEmpty() ? std::uint8_t{0} : static_cast<std::uint8_t>(bytes_[next_++]);
  }
  bool flag() { return (byte() & 1U) != 0; }
  /// One of 16.
  bool seldom() { return byte() >= 0xf0U; }
  /// From 0 to most, both included.
  std::size_t count(std::size_t most) {
    std::size_t value = byte();
    if (most > 0xffU) value = value << 8U | byte();
    return value % (most + 1);
  }
  /// The last `size` bytes of 8, as the machine stores them.
  std::uint64_t bits(std::size_t size = 8) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) bits = bits << 8U | byte();
    return bits;
  }
  template <typename T>
  T oneOf(std::initializer_list<T> values) {
    return values.begin()[count(values.size() - 1)];
  }
  /// In steps of a 65,535th, both ends included.
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits(2)) / 65535.0;
  }
  /// Mostly within; of 16 one is at an end or just beyond, or has nothing to do with it, or is
  /// none.
  double number(double low, double high) {
    const std::uint8_t kind = byte();
    if (kind < 0xf0U) return low + (high - low) * (kind + byte() / 256.0) / 240.0;
    constexpr double kMax = std::numeric_limits<double>::max();
    const std::array<double, 15> odd{
        std::nan(""), INFINITY, -INFINITY, 0.0,   -0.0,
        low,          high,     1e-200,    1e6,   std::nextafter(low, -kMax),
        kMax,         -kMax,    1e-12,     -1e17, std::nextafter(high, kMax)};
    if (kind - 0xf0U < odd.size()) return odd[kind - 0xf0U];
    const std::uint64_t any = bits();
    double value = 0.0;
    std::memcpy(&value, &any, sizeof value);
    return value;
  }
  /// A step of a clock [ms], mostly between these; else to the same instant, back, or far on.
  Duration step(int low_ms, int high_ms) {
    const std::uint8_t kind = byte();
    const auto milliseconds = [](auto ms) { return Duration(std::chrono::milliseconds(ms)); };
    if (kind < 0xe0U) return milliseconds(low_ms + kind % (high_ms - low_ms + 1));
    if (kind < 0xf0U) return milliseconds(16 * (kind - 0xe8));
    return milliseconds(oneOf({0, -1, -50, -99, -100, -101, -1000, 400, 1500, 3000, -5000, 60000}));
  }
  /// Mostly one whose parts are numbers within reach, seldom one that is none.
  Pose pose(double reach) {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 3; ++i) pose.translation()[i] = number(-reach, reach);
    const double angle = number(-3.2, 3.2);
    const Vector3 axis = oneOf<Vector3>({Vector3::UnitZ(), Vector3::UnitY(), Vector3::UnitX(),
                                         Vector3(0.6, 0.0, 0.8), Vector3(0.0, -0.8, 0.6)});
    pose.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    if (seldom()) pose.linear() *= number(0.9, 1.1);
    return pose;
  }
  /// As many of the bytes that are left.
  std::string text(std::size_t most) {
    const std::size_t size = std::min(most, bytes_.size() - std::min(next_, bytes_.size()));
    std::string taken = bytes_.substr(std::min(next_, bytes_.size()), size);
    next_ += size;
    return taken;
  }
  std::string rest() { return text(bytes_.size()); }

 private:
  const std::string& bytes_;
  std::size_t next_ = 0;
};

}  // namespace tccm::test
