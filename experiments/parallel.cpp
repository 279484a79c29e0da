#include "experiments/parallel.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tccm::simulation {
namespace {

/// What threads take their work from.
class Queue {
 public:
  Queue(std::size_t count, const std::function<void(std::size_t)>& work)
      : count_(count), work_(work) {}

  void drain() {
    for (std::unique_lock lock(mutex_); next_ < count_;) {
      const std::size_t i = next_++;
      lock.unlock();
      const std::exception_ptr failure = tried(i);
      lock.lock();
      if (failure && !failure_) failure_ = failure;
      if (failure) next_ = count_;
      ++done_;
      changed_.notify_one();
    }
  }

  /// Until nothing is left to be done. What was done before anybody watched is told too.
  void watch(const std::function<void(double)>& progress) {
    std::size_t told = 0;
    for (std::unique_lock lock(mutex_); told < count_;) {
      changed_.wait(lock, [&] { return done_ != told || failure_; });
      if (failure_) return;
      told = done_;
      lock.unlock();
      if (progress) progress(static_cast<double>(told) / static_cast<double>(count_));
      lock.lock();
    }
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  [[nodiscard]] std::exception_ptr tried(std::size_t i) const {
    try {
      work_(i);
    } catch (...) {
      return std::current_exception();
    }
    return nullptr;
  }

  std::size_t count_;
  const std::function<void(std::size_t)>& work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

void inParallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                const std::function<void(double)>& progress) {
  Queue queue(count, work);
  std::vector<std::thread> workers;
  workers.reserve(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) workers.emplace_back([&queue] { queue.drain(); });
  queue.watch(progress);
  for (std::thread& worker : workers) worker.join();
  queue.rethrow();
}

}  // namespace tccm::simulation
