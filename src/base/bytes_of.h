#pragma once

#include <cstddef>
#include <vector>

namespace tccm {

/// What the elements of vectors occupy, the room for more included.
template <typename... T>
[[nodiscard]] std::size_t bytesOf(const std::vector<T>&... vectors) {
  return (... + (vectors.capacity() * sizeof(T)));
}

}  // namespace tccm
