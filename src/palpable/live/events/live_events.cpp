#include "palpable/live/events/live_events.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

namespace palpable {

LiveEvents::LiveEvents(const std::string& events, bool takes_things) {
  if (events == kNoEvents) return;
  try {
    server_.emplace(
        value_or_throw(event_address(events)),
        EventServerSettings{.takes_lines = takes_things, .longest_line = kLongestThingsLine});
  } catch (const Error& error) { throw Error(fmt::format("--events: {}", error.what())); }
}

void LiveEvents::begin(const Session& session) {
  if (!server_) return;
  begin(event_bodies(session), EventWorld::kFirstCamera);
}

void LiveEvents::begin(const std::vector<EventBody>& bodies, EventWorld world) {
  if (!server_) return;
  const std::lock_guard lock(mutex_);
  lines_.emplace(bodies);
  lines_of_presser_.emplace(bodies);
  server_->greet_with(hello_line(bodies, world));
}

void LiveEvents::send(const Scene& scene) {
  const std::lock_guard lock(mutex_);
  if (!lines_) return;
  const std::optional<EventExtras> extras = std::exchange(extras_, std::nullopt);
  if (!presser_ || !extras) return server_->send(lines_->line_of(scene));
  server_->send(lines_->line_of(scene), *presser_, lines_of_presser_->line_of(scene, *extras));
}

LiveEvents::News LiveEvents::next_things(ThingsLine& line, double longest) {
  const std::lock_guard lock(mutex_);
  if (!lines_) return News::kNone;
  server_->serve();
  std::optional<SentLine> sent = server_->next_line();
  if (!sent) {
    server_->wait(std::chrono::milliseconds(std::lround(1e3 * longest)));
    server_->serve();
    sent = server_->next_line();
  }
  if (sent) return answer(*sent, line);
  if (!presser_ || server_->may_send(*presser_)) return News::kNone;
  presser_.reset();
  return News::kReleased;
}

LiveEvents::News LiveEvents::answer(const SentLine& sent, ThingsLine& line) {
  const bool presses = presser_ == sent.client;
  if (presser_ && !presses && server_->may_send(*presser_)) {
    server_->refuse(sent.client, "another client presses already; only one can at a time");
    return News::kNone;
  }
  Result<ThingsLine> read =
      read_things_line(sent.text, presses ? presser_time_ : std::optional<double>());
  if (!read.ok()) {
    server_->refuse(sent.client, read.problem().message);
    if (!presses) return News::kNone;
    presser_.reset();
    return News::kReleased;
  }
  line = std::move(read).value();
  presser_ = sent.client;
  presser_time_ = line.time;
  extras_ = EventExtras{.skipped = sent.skipped, .vertices = line.wants_vertices};
  return News::kThings;
}

void LiveEvents::send(int frame, int tick, double time, std::span<const Touch> touches) {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->send(lines_->tick_line(frame, tick, time, touches));
}

void LiveEvents::serve() {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->serve();
}

std::string LiveEvents::text() const {
  if (!server_) return {};
  const EventCounts& counts = server_->counts();
  return fmt::format(
      "events: {} clients, {} refused, {} closed because they did not read, {} lines dropped{}\n",
      counts.clients, counts.refused, counts.closed_behind, counts.dropped_lines,
      counts.sent_away > 0 ? fmt::format(", {} sent away for what they sent", counts.sent_away)
                           : "");
}

}  // namespace palpable
