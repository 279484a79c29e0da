#include "nodelets/diagnosed_nodelet.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

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

}  // namespace
}  // namespace tccm
