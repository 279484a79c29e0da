/// Inputs that fuzzing found, replayed: of what reads messages. See corpus_test.cpp.

#include <gtest/gtest.h>

#include "fuzz/corpus_replay.h"
#include "fuzz/messages_input.h"
#include "fuzz/transforms_input.h"

namespace tccm {
namespace {

TEST(RosCorpusTest, MessagesAreTakenAsTheyAreOrRefused) {
  EXPECT_GT(test::replay("messages", test::messagesDefect), 50U);
}

TEST(RosCorpusTest, APoseIsFoundWhereItWasHeardOf) {
  EXPECT_GT(test::replay("transforms", test::transformsDefect), 50U);
}

}  // namespace
}  // namespace tccm
