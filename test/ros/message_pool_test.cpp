#include "ros/message_pool.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tccm {
namespace {

TEST(MessagePoolTest, AMessageThatSomebodyHoldsIsNeverHandedOutAgain) {
  MessagePool<std::string> pool;
  const auto first = pool.take();
  *first = "held";
  const auto second = pool.take();
  EXPECT_NE(first, second);
  *second = "another";
  EXPECT_EQ(*first, "held");
  EXPECT_NE(pool.take(), first);
}

TEST(MessagePoolTest, AMessageThatWasLetGoOfIsUsedAgainWithItsMemory) {
  MessagePool<std::string> pool;
  auto message = pool.take();
  message->assign(1000, 'x');
  const std::string* const where = message.get();
  message.reset();
  message = pool.take();
  EXPECT_EQ(message.get(), where);
  EXPECT_GE(message->capacity(), 1000U);
}

TEST(MessagePoolTest, ASubscribersConstPointerHoldsAMessageToo) {
  MessagePool<std::string> pool;
  boost::shared_ptr<const std::string> subscriber = pool.take();
  const auto other = pool.take();
  EXPECT_NE(subscriber.get(), other.get());
  const std::string* const where = subscriber.get();
  subscriber.reset();
  EXPECT_EQ(pool.take().get(), where);
}

TEST(MessagePoolTest, NoMoreMessagesAreMadeThanAreHeldAtOnce) {
  MessagePool<std::string> pool;
  std::set<const std::string*> made;
  auto held = pool.take();
  for (int i = 0; i < 100; ++i) {
    const auto next = pool.take();
    made.insert(next.get());
    made.insert(held.get());
    held = next;
  }
  EXPECT_LE(made.size(), 3U);
}

TEST(SharedMessagePoolTest, NoTwoThreadsAreEverHandedTheSameMessage) {
  SharedMessagePool<std::string> pool;
  constexpr std::size_t kThreads = 4, kMessages = 500;
  std::vector<std::vector<boost::shared_ptr<std::string>>> held(kThreads);
  std::vector<std::thread> threads;
  for (auto& mine : held) {
    threads.emplace_back([&pool, &mine] {
      for (std::size_t i = 0; i < kMessages; ++i) mine.push_back(pool.take());
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<const std::string*> different;
  for (const auto& mine : held) {
    for (const auto& message : mine) different.insert(message.get());
  }
  EXPECT_EQ(different.size(), kThreads * kMessages);
}

}  // namespace
}  // namespace tccm
