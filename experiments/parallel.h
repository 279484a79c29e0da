#pragma once

#include <cstddef>
#include <functional>

namespace tccm::simulation {

/// Calls work(i) for each i below count, on so many threads, each i once, in no order. What work
/// does must not depend on others. @param progress called by the caller's thread with the share
/// that is done; may be empty. @throws what work throws; the rest is left undone then.
void inParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                const std::function<void(double)>& progress);

}  // namespace tccm::simulation
