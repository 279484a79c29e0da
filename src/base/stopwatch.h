#pragma once

#include <chrono>

namespace tccm {

/// Wall time for reports on speed; nothing that is decided depends on it.
class Stopwatch {
 public:
  /// Since construction or the last call [us].
  double lapMicroseconds() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::micro> lap = now - last_;
    last_ = now;
    return lap.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace tccm
