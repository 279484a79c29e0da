#pragma once

#include <atomic>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <mutex>
#include <vector>

namespace tccm {

/// Messages that are used again once everybody has let go of them: after a while nothing is
/// allocated any more.
template <typename Message>
class MessagePool {
 public:
  /// A message that nobody else holds, with the content of an earlier use.
  boost::shared_ptr<Message> take() {
    for (const auto& message : messages_) {
      if (!message.unique()) continue;
      // Whoever let go of it last may have read it in another thread.
      std::atomic_thread_fence(std::memory_order_acquire);
      return message;
    }
    return grow();
  }

 private:
  /// More are under way at once than ever before. Never inlined: what counts allocations knows it
  /// by its name.
  [[gnu::noinline]] boost::shared_ptr<Message> grow() {
    messages_.push_back(boost::make_shared<Message>());
    return messages_.back();
  }

  std::vector<boost::shared_ptr<Message>> messages_;
};

/// The same for several threads.
template <typename Message>
class SharedMessagePool {
 public:
  boost::shared_ptr<Message> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return pool_.take();
  }

 private:
  std::mutex mutex_;
  MessagePool<Message> pool_;
};

}  // namespace tccm
