#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tccm_monitor/direction_grid.h"
#include "tccm_monitor/time.h"

namespace tccm {

/// What a look along a direction ended at: up to there nothing stood.
enum class Seen : std::uint8_t {
  kNever = 0,    ///< nobody looked
  kSurface = 1,  ///< of the surroundings
  kNothing = 2,  ///< as far as the sensor can see
  kRobot = 3,    ///< the robot itself: what lies behind it is not known
  kUnclear = 4,  ///< no range, or none that is to be trusted: the direction alone is known
};

/// Which directions the sensor looked in lately, and how far it saw: for each direction its last
/// passes. A pass is one time that scans went over a direction, be it in one scan or, near a
/// turning point of the tilt, in several. This is what tells free from never seen.
class LookImage {
 public:
  /// Milliseconds since the epoch.
  using Ticks = std::uint32_t;
  struct Pass {
    Ticks first = 0;  ///< stamp of the first scan of the pass
    Ticks last = 0;   ///< and of the last so far
    std::uint16_t range_mm = 0;
    Seen end = Seen::kNever;
    /// Found from where the sensor is now, it was looked at from elsewhere, further away than a
    /// head that turns moves it: this direction may not be one that the sensor looks in.
    bool moved = false;

    /// [m]
    [[nodiscard]] double range() const { return 1e-3 * range_mm; }
  };
  static constexpr std::size_t kPasses = 2;
  /// Newest first.
  using Passes = std::array<Pass, kPasses>;

  /// Nobody has looked anywhere. @param resolution_rad edge of a pixel, 0.01 to 0.2.
  /// @throws ConfigError
  explicit LookImage(double resolution_rad = 0.035);

  /// What was seen of a place.
  struct Sight {
    enum class Kind {
      kSeen,     ///< free, or a surface
      kBehind,   ///< a surface stood before it
      kUnclear,  ///< the robot itself stood before it, or no look gave a range
      kNeverLooked,
    };
    Kind kind = Kind::kNeverLooked;
    Time stamp = {};  ///< the newest look that the kind rests on; the epoch where there was none
    /// The newest look in that direction, however far it saw; nothing where the sensor, as it
    /// stands, has not looked more than once.
    std::optional<Time> looked = std::nullopt;
  };
  /// @param margin_m a look that ended this much before the place saw it all the same.
  [[nodiscard]] Sight at(const Vector3& p_fixed, double margin_m) const;
  /// The same in the middle of a pixel, at a distance from the viewpoint.
  [[nodiscard]] Sight at(std::size_t pixel, double range_m, double margin_m) const;

  /// Whether in the place's direction and in those beside, above and below it passes that began
  /// after `since` reached as far as the place: then it is in view.
  [[nodiscard]] bool inViewSince(Time since, const Vector3& p_fixed, double margin_m) const;
  /// The newest look in a direction within an angle [rad] of the place's; the epoch where there was
  /// none.
  [[nodiscard]] Time lookedAround(const Vector3& p_fixed, double angle) const;
  /// Whether a pass that began after `since` saw the place, or a surface not more than margin_m
  /// before it; the robot's own is none.
  [[nodiscard]] bool passedSince(Time since, const Vector3& p_fixed, double margin_m) const;
  /// When the place is looked at next: a period after it was seen last in the same direction of the
  /// tilt, or as long after the newest frame as that came after the one before. Nothing where it
  /// was not seen lately, or the look is overdue by more than late_max: then none is due. @param
  /// period of the tilt.
  [[nodiscard]] std::optional<Time> nextLook(const Vector3& p_fixed, double margin_m, Time now,
                                             Duration period, Duration late_max) const;

  [[nodiscard]] const DirectionGrid& grid() const { return grid_; }
  /// From which the directions are taken [m, fixed frame].
  [[nodiscard]] const Vector3& viewpoint() const { return viewpoint_; }
  [[nodiscard]] const Passes& passes(std::size_t pixel) const { return passes_[pixel]; }
  [[nodiscard]] Time epoch() const { return epoch_; }
  [[nodiscard]] Time timeOf(Ticks ticks) const { return epoch_ + std::chrono::milliseconds(ticks); }
  /// The first tick not before an instant; 0 before the epoch.
  [[nodiscard]] Ticks ticksAt(Time stamp) const {
    constexpr Duration kTick = std::chrono::milliseconds(1);
    return stamp > epoch_ ? static_cast<Ticks>((stamp - epoch_ + kTick - Duration(1)) / kTick) : 0;
  }
  /// In rows outside of [rowBegin(), rowEnd()) nobody ever looked.
  [[nodiscard]] int rowBegin() const { return row_begin_; }
  [[nodiscard]] int rowEnd() const { return row_end_; }
  [[nodiscard]] bool empty() const { return row_begin_ >= row_end_; }

  /// As at the start.
  void clear();
  /// Begins anew from another viewpoint.
  void begin(Time epoch, const Vector3& viewpoint);
  [[nodiscard]] Passes& edit(int row, int column) {
    if (row < row_begin_) row_begin_ = row;
    if (row >= row_end_) row_end_ = row + 1;
    const std::size_t pixel = grid_.index(row, column);
    edits_[pixel / kBlock] = numbers_.next();
    return passes_[pixel];
  }
  /// Becomes like another. Copies what differs: little, where it was like the other lately.
  /// Allocates nothing where the resolution is the same.
  void copyFrom(const LookImage& other);
  [[nodiscard]] std::size_t memoryBytes() const {
    return passes_.capacity() * sizeof(Passes) + edits_.capacity() * sizeof(std::uint64_t);
  }

 private:
  /// Numbers for edits, that no edit of any image has twice; none is 0.
  class EditNumbers {
   public:
    EditNumbers() : next_(fresh()) {}
    EditNumbers(const EditNumbers& /*other*/) : EditNumbers() {}  // a copy is edited by itself
    EditNumbers& operator=(const EditNumbers& /*other*/) { return *this; }
    ~EditNumbers() = default;
    [[nodiscard]] std::uint64_t next() {
      if ((++next_ & kLeft) == 0) next_ = fresh();
      return next_;
    }

   private:
    static constexpr std::uint64_t kLeft = 0xFFFFFFFFU;  ///< before the next fresh one
    [[nodiscard]] static std::uint64_t fresh();
    std::uint64_t next_;
  };
  static constexpr std::size_t kBlock = 16;  ///< pixels that are copied together

  /// How long after the look before the newest one came in the place's direction, where that is so
  /// short that no tilt can do it: the sensor looks everywhere at once, as a camera does.
  [[nodiscard]] std::optional<Duration> betweenFrames(const Vector3& p_fixed) const;
  /// Hands on the passes in the place's direction in whose stroke of the tilt the place was
  /// reached, in that direction or in one beside, above or below.
  template <typename Visit>
  void visitSeen(const Vector3& p_fixed, double margin_m, Visit&& visit) const;
  [[nodiscard]] bool reachedSince(Time since, std::size_t pixel, double range_m) const;

  DirectionGrid grid_;
  std::vector<Passes> passes_;
  /// By block: the number of its last edit; 0: nobody looked there. Blocks with one number are
  /// alike, also those of two images.
  std::vector<std::uint64_t> edits_;
  EditNumbers numbers_;
  Time epoch_;
  Vector3 viewpoint_ = Vector3::Zero();
  int row_begin_;
  int row_end_ = 0;
};

}  // namespace tccm
