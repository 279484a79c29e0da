#pragma once

#include <atomic>

namespace tccm::test {

// What a test takes from the heap. counted_allocations.cpp, which replaces operator new, has to be
// a source of its program.

inline std::atomic<bool> is_counting{false};
inline std::atomic<int> allocations{0};  ///< while it is

}  // namespace tccm::test
