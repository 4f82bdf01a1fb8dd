/// @file
/// What waits to be sent to one client of a running session. Bounded: a client that reads too
/// slowly loses pictures first, then skins, then whole lines.
///
///     lines     in their order, up to a number of bytes; further ones are lost and counted
///     skin      the newest alone
///     picture   the newest alone, and only when nothing else waits
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Bytes that several clients share.
using SharedBytes = std::shared_ptr<const std::string>;

/// One message of a WebSocket: `begin`, then `bytes` from `from` on.
struct QueuedMessage {
  bool is_text = true;
  std::string begin = {};
  SharedBytes bytes;
  std::size_t from = 0;

  [[nodiscard]] std::string_view rest() const { return std::string_view(*bytes).substr(from); }
};

/// Not for several threads.
class ClientQueue {
 public:
  /// @param most_line_bytes  of the lines that wait
  explicit ClientQueue(std::size_t most_line_bytes) : most_line_bytes_(most_line_bytes) {}

  /// A line that is sent as it is, before all others, and never lost: what greets a client that has
  /// just come, or says why it is sent away.
  void add_greeting(SharedBytes line) { greetings_.push_back(std::move(line)); }
  /// Begins another session: its greetings go after the lines that wait, as they are, and are never
  /// lost; skins and pictures of the session before are forgotten.
  void begin_anew(const std::vector<SharedBytes>& greetings);
  /// A line of JSON, without a line break. It is sent with a first key "dropped": the number of
  /// lines that this client lost before it. @param line  an object with at least one key
  void add_line(SharedBytes line);
  /// Counts lines that never came here.
  void lose_lines(std::int64_t count) {
    dropped_ += count;
    lost_lines_ += count;
  }
  /// The triangles of the skins, which go before the first skin.
  void set_mesh(SharedBytes mesh) { mesh_ = std::move(mesh); }
  void set_skin(SharedBytes skin);
  void set_picture(SharedBytes picture);
  /// Forgets skins and pictures that wait, because the client no longer wants them.
  void drop_skin() { mesh_ = skin_ = nullptr; }
  void drop_picture() { picture_ = nullptr; }
  /// Whether the triangles wait.
  [[nodiscard]] bool has_mesh() const { return mesh_ != nullptr; }

  /// Takes out what is to be sent next; nothing: all was sent.
  [[nodiscard]] std::optional<QueuedMessage> next();

  [[nodiscard]] std::int64_t lost_lines() const { return lost_lines_; }
  [[nodiscard]] std::int64_t lost_pictures() const { return lost_pictures_; }

 private:
  struct Line {
    SharedBytes bytes;
    std::int64_t dropped = 0;  // before it
    bool greets = false;       // sent as it is, not counted in line_bytes_
  };

  std::size_t most_line_bytes_;
  std::size_t line_bytes_ = 0;
  std::int64_t dropped_ = 0;  // since the last line that was kept
  std::int64_t lost_lines_ = 0, lost_pictures_ = 0;
  std::deque<SharedBytes> greetings_;
  std::deque<Line> lines_;
  SharedBytes mesh_, skin_, picture_;  // null: none
};

}  // namespace palpable
