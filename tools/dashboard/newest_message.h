#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace flexarm {

/// The newest message for any number of readers, each at its own speed. A reader that is slow skips
/// messages; besides the newest one only those exist that a reader is in the middle of. So however
/// many readers there are and however slow, nothing grows but with their number.
class NewestMessage {
 public:
  struct Numbered {
    std::shared_ptr<const std::string> text;  ///< null: there was none yet
    std::uint64_t number = 0;                 ///< 1 for the first one
  };
  /// How a reader sleeps, and how it is woken; both are called with the lock held, so that no
  /// message comes in between.
  struct Sleep {
    std::function<void()> begin, end;
  };

  /// Replaces the newest one and wakes all who sleep.
  void Publish(std::string text);
  /// The end: wakes all who sleep; there are no more messages.
  void Close();

  Numbered Newest() const;
  bool closed() const;

  /// The newest one if it is newer than `number`; otherwise, unless it is closed, an empty one, and
  /// the reader sleeps.
  Numbered NewerThan(std::uint64_t number, const Sleep& sleep);

 private:
  void WakeAll();  // with the lock held

  mutable std::mutex mutex_;  // of what follows
  Numbered newest_;
  bool closed_ = false;
  std::vector<std::function<void()>> sleepers_;
};

/// One reader of a NewestMessage: whole messages, in pieces as large as the reader can take.
class MessageReader {
 public:
  explicit MessageReader(NewestMessage& messages) : messages_(&messages) {}

  static constexpr int kSleeps = 0, kEnded = -1;

  /// Copies the next piece. @returns its bytes; kSleeps: there is nothing yet; kEnded
  std::int64_t Read(char* out, std::size_t most, const NewestMessage::Sleep& sleep);

 private:
  NewestMessage* messages_;
  NewestMessage::Numbered current_;
  std::size_t at_ = 0;  // of the text of current_
};

}  // namespace flexarm
