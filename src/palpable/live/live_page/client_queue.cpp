#include "palpable/live/live_page/client_queue.h"

#include "palpable/common/base/contract.h"

#include <fmt/format.h>

#include <utility>

namespace palpable {

void ClientQueue::begin_anew(const std::vector<SharedBytes>& greetings) {
  for (const SharedBytes& line : greetings) lines_.push_back({.bytes = line, .greets = true});
  drop_skin();
  drop_picture();
}

void ClientQueue::add_line(SharedBytes line) {
  PALPABLE_EXPECT(line && line->size() > 2 && line->front() == '{', "an object with a key");
  if (line_bytes_ + line->size() > most_line_bytes_) { return lose_lines(1); }
  line_bytes_ += line->size();
  lines_.push_back({.bytes = std::move(line), .dropped = std::exchange(dropped_, 0)});
}

void ClientQueue::set_skin(SharedBytes skin) { skin_ = std::move(skin); }

void ClientQueue::set_picture(SharedBytes picture) {
  if (picture_) ++lost_pictures_;
  picture_ = std::move(picture);
}

std::optional<QueuedMessage> ClientQueue::next() {
  if (!greetings_.empty()) {
    QueuedMessage message{.bytes = std::move(greetings_.front())};
    greetings_.pop_front();
    return message;
  }
  if (!lines_.empty()) {
    Line line = std::move(lines_.front());
    lines_.pop_front();
    if (line.greets) return QueuedMessage{.bytes = std::move(line.bytes)};
    line_bytes_ -= line.bytes->size();
    return QueuedMessage{.begin = fmt::format("{{\"dropped\":{},", line.dropped),
                         .bytes = std::move(line.bytes),
                         .from = 1};
  }
  for (SharedBytes* slot : {&mesh_, &skin_, &picture_}) {
    if (*slot) return QueuedMessage{.is_text = false, .bytes = std::exchange(*slot, nullptr)};
  }
  return std::nullopt;
}

}  // namespace palpable
