#include "tools/dashboard/newest_message.h"

#include <algorithm>
#include <utility>

namespace flexarm {

void NewestMessage::WakeAll() {
  for (const auto& wake : sleepers_) wake();
  sleepers_.clear();
}

void NewestMessage::Publish(std::string text) {
  auto shared = std::make_shared<const std::string>(std::move(text));
  const std::scoped_lock lock(mutex_);
  newest_ = {.text = std::move(shared), .number = newest_.number + 1};
  WakeAll();
}

void NewestMessage::Close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  WakeAll();
}

NewestMessage::Numbered NewestMessage::Newest() const {
  const std::scoped_lock lock(mutex_);
  return newest_;
}

bool NewestMessage::closed() const {
  const std::scoped_lock lock(mutex_);
  return closed_;
}

NewestMessage::Numbered NewestMessage::NewerThan(std::uint64_t number, const Sleep& sleep) {
  const std::scoped_lock lock(mutex_);
  if (newest_.number > number) return newest_;
  if (!closed_) {
    sleep.begin();
    sleepers_.push_back(sleep.end);
  }
  return {};
}

std::int64_t MessageReader::Read(char* out, std::size_t most, const NewestMessage::Sleep& sleep) {
  if (messages_->closed()) return kEnded;
  if (current_.text == nullptr || at_ == current_.text->size()) {
    NewestMessage::Numbered newer = messages_->NewerThan(current_.number, sleep);
    if (newer.text == nullptr) return kSleeps;
    current_ = std::move(newer);
    at_ = 0;
  }
  const std::size_t count = std::min(most, current_.text->size() - at_);
  std::copy_n(current_.text->data() + at_, count, out);
  at_ += count;
  const bool whole = at_ == current_.text->size();
  if (whole) {  // a reader that sleeps keeps no message
    current_.text = nullptr;
  }
  return static_cast<std::int64_t>(count);
}

}  // namespace flexarm
