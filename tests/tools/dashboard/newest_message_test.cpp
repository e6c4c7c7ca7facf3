#include "tools/dashboard/newest_message.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace flexarm {
namespace {

/// A browser: counts how often it was put to sleep and woken.
struct Browser {
  explicit Browser(NewestMessage& messages) : reader(messages) {}

  // The next piece, "" if it sleeps or the stream has ended.
  std::string Read(std::size_t most) {
    std::string text(most, '\0');
    last =
        reader.Read(text.data(), most, {.begin = [this] { ++slept; }, .end = [this] { ++woken; }});
    text.resize(last > 0 ? static_cast<std::size_t>(last) : 0);
    return text;
  }

  MessageReader reader;
  std::int64_t last = 0;
  int slept = 0, woken = 0;
};

TEST(NewestMessage, AReaderSleepsUntilThereIsANewOneAndGetsItOnce) {
  NewestMessage messages;
  Browser browser(messages);
  EXPECT_EQ(browser.Read(100), "");
  EXPECT_EQ(browser.slept, 1);
  messages.Publish("one");
  EXPECT_EQ(browser.woken, 1);
  EXPECT_EQ(browser.Read(100), "one");
  EXPECT_EQ(browser.Read(100), "");
  EXPECT_EQ(browser.slept, 2);
}

TEST(NewestMessage, AReaderThatComesLaterGetsTheNewestAtOnce) {
  NewestMessage messages;
  messages.Publish("old");
  messages.Publish("new");
  Browser browser(messages);
  EXPECT_EQ(browser.Read(100), "new");
}

TEST(NewestMessage, ASlowReaderGetsWholeMessagesAndSkipsThoseBetween) {
  NewestMessage messages;
  messages.Publish("first message");
  Browser browser(messages);
  EXPECT_EQ(browser.Read(5), "first");
  for (int i = 0; i < 1000; ++i) messages.Publish("message " + std::to_string(i));
  EXPECT_EQ(browser.Read(100), " message");
  EXPECT_EQ(browser.Read(100), "message 999");
  EXPECT_EQ(browser.Read(100), "");
}

// 300 readers, each in the middle of the same message, while 1000 others pass: two are kept.
TEST(NewestMessage, NothingGrowsHoweverSlowTheReadersAre) {
  NewestMessage messages;
  messages.Publish("first message");
  const std::weak_ptr<const std::string> first = messages.Newest().text;
  std::vector<std::unique_ptr<Browser>> browsers;
  for (int i = 0; i < 300; ++i) {
    browsers.push_back(std::make_unique<Browser>(messages));
    browsers.back()->Read(1);
  }
  std::vector<std::weak_ptr<const std::string>> passed;
  for (int i = 0; i < 1000; ++i) {
    messages.Publish(std::string(100, 'x'));
    passed.emplace_back(messages.Newest().text);
  }
  EXPECT_FALSE(first.expired());
  int kept = 0;
  for (const auto& message : passed) kept += message.expired() ? 0 : 1;
  EXPECT_EQ(kept, 1);
  for (const auto& browser : browsers) browser->Read(100);
  EXPECT_TRUE(first.expired());
}

TEST(NewestMessage, AReaderThatSleepsKeepsNoMessage) {
  NewestMessage messages;
  messages.Publish("one");
  const std::weak_ptr<const std::string> one = messages.Newest().text;
  Browser browser(messages);
  EXPECT_EQ(browser.Read(100), "one");
  messages.Publish("two");
  EXPECT_TRUE(one.expired());
}

TEST(NewestMessage, TheEndWakesSleepersAndEndsStreams) {
  NewestMessage messages;
  Browser browser(messages);
  browser.Read(1);
  messages.Close();
  EXPECT_EQ(browser.woken, 1);
  browser.Read(1);
  EXPECT_EQ(browser.last, MessageReader::kEnded);
  EXPECT_EQ(browser.slept, 1);
}

// Every sleep is ended by the message after it, whatever the threads do: no wake-up is lost.
TEST(NewestMessage, NoMessageComesBetweenTheLookAndTheSleep) {
  constexpr int kMessages = 20'000;
  NewestMessage messages;
  std::atomic<bool> sleeps = false;
  std::atomic<int> slept = 0;
  std::jthread reader([&] {
    MessageReader stream(messages);
    std::array<char, 64> piece{};
    for (;;) {
      const std::int64_t count =
          stream.Read(piece.data(), piece.size(),
                      {.begin = [&] { sleeps = true, ++slept; }, .end = [&] { sleeps = false; }});
      if (count == MessageReader::kEnded) return;
      while (sleeps) std::this_thread::yield();  // for ever, if a wake-up were lost
    }
  });
  while (slept == 0) std::this_thread::yield();  // there is no message yet: it sleeps
  for (int i = 0; i < kMessages; ++i) messages.Publish("message");
  messages.Close();
  reader.join();
}

}  // namespace
}  // namespace flexarm
