#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "tccm_monitor/pose.h"
#include "tools/program.h"

namespace tccm::simulation {

/// What trials found, as bytes and back, bit for bit: for programs of one build.
/// Of a structure membersOf(structure), found by its namespace, returns all members as a std::tie.
class Archive {
 public:
  /// To be written.
  Archive() = default;
  /// To be read.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), reads_(true) {}

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] bool atEnd() const { return next_ == bytes_.size(); }

  /// Each is written, or read. @throws InputError where there is no more to read.
  template <typename... Values>
  void operator()(Values&... values) {
    (one(values), ...);
  }

 private:
  template <typename Value>
  void one(Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      raw(&value, sizeof value);
    } else {
      std::apply([this](auto&... members) { (*this)(members...); }, membersOf(value));
    }
  }
  void one(Vector3& value) { (*this)(value.x(), value.y(), value.z()); }
  template <typename Clock, typename Duration>
  void one(std::chrono::time_point<Clock, Duration>& value) {
    auto count = value.time_since_epoch().count();
    (*this)(count);
    value = std::chrono::time_point<Clock, Duration>(Duration(count));
  }
  void one(std::string& value) {
    value.resize(size(value.size()));
    raw(value.data(), value.size());
  }
  template <typename Value>
  void one(std::vector<Value>& values) {
    values.resize(size(values.size()));
    for (Value& value : values) one(value);
  }
  template <typename Value, std::size_t kSize>
  void one(std::array<Value, kSize>& values) {
    for (Value& value : values) one(value);
  }
  template <typename Value>
  void one(std::optional<Value>& value) {
    bool is_there = value.has_value();
    (*this)(is_there);
    if (!is_there) value.reset();
    if (is_there && !value) value.emplace();
    if (value) one(*value);
  }

  /// @return the size that is read, or else the one that is written.
  [[nodiscard]] std::size_t size(std::size_t is) {
    auto wide = static_cast<std::uint64_t>(is);
    raw(&wide, sizeof wide);
    // An element has a byte at least.
    if (reads_ && wide > bytes_.size() - next_) throw InputError("results of trials are cut short");
    return static_cast<std::size_t>(wide);
  }
  void raw(void* data, std::size_t length) {
    if (!reads_) {
      bytes_.append(static_cast<const char*>(data), length);
      return;
    }
    if (length > bytes_.size() - next_) throw InputError("results of trials are cut short");
    std::memcpy(data, bytes_.data() + next_, length);
    next_ += length;
  }

  std::string bytes_;
  std::size_t next_ = 0;
  bool reads_ = false;
};

}  // namespace tccm::simulation
