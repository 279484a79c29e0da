#pragma once

namespace tccm::simulation {

/// What becomes of the beams or pixels that straddle two surfaces. A chain of them keeps to what it
/// does, so that false points come in runs.
struct Mixing {
  bool on = false;
  double share = 0.5;  ///< of the far surface in the measured range

  /// For the next one. @param mixed_share of them that mix. @param persistence chance that it does
  /// as this one did. @param uniform() from 0 to 1.
  template <typename Uniform>
  void advance(double mixed_share, double persistence, Uniform&& uniform) {
    const bool changes = uniform() >= persistence;
    const bool mixes = uniform() < mixed_share;
    const double far_share = 0.05 + 0.9 * uniform();
    if (changes) *this = {mixes, far_share};
  }
};

}  // namespace tccm::simulation
