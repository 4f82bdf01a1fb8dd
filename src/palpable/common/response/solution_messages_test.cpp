#include "palpable/common/response/solution_messages.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <string>

namespace palpable {
namespace {

constexpr std::size_t kLargest = 4096;

// Reads the messages in these bytes, given to the reader in pieces of `at_a_time` bytes.
template <class Found>
bool read(const std::vector<std::byte>& bytes, std::size_t at_a_time, const Found& found) {
  ExactMessages messages(kLargest);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::span<std::byte> room = messages.room();
    const std::size_t count = std::min({at_a_time, bytes.size() - at, room.size()});
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), count, room.begin());
    messages.add(count);
    at += count;
    while (const auto message = messages.next()) found(*message);
    if (messages.broken()) return false;
  }
  return true;
}

std::vector<VertexForce> some_load() { return {{3, {1, 2, 3}}, {8, {-0.5f, 0, 1e-6f}}}; }

Eigen::Matrix3Xf some_field() {
  Eigen::Matrix3Xf field(3, 40);
  for (Eigen::Index i = 0; i < field.size(); ++i) field.data()[i] = 0.25f * static_cast<float>(i);
  return field;
}

TEST_CASE("messages come back as they were written, in pieces of any size", "[response]") {
  std::vector<std::byte> all, one;
  const auto add = [&] { all.insert(all.end(), one.begin(), one.end()); };
  write_ready(40, one), add();
  write_load(7, some_load(), one), add();
  write_solution(7, some_field(), one), add();
  write_solution(8, std::nullopt, one), add();
  write_sorry("no such file", one), add();
  for (const std::size_t at_a_time :
       {std::size_t{1}, std::size_t{31}, std::size_t{1000}, kLargest}) {
    INFO(at_a_time);
    std::vector<ExactMessage::Kind> kinds;
    REQUIRE(read(all, at_a_time, [&](const ExactMessage& m) {
      kinds.push_back(m.kind);
      if (m.kind == ExactMessage::Kind::kReady) CHECK(m.count == 40);
      if (m.kind == ExactMessage::Kind::kSorry) CHECK(m.text() == "no such file");
      if (m.kind == ExactMessage::Kind::kLoad) {
        std::vector<VertexForce> forces;
        m.read_load(forces);
        CHECK(m.number == 7);
        REQUIRE(forces.size() == 2);
        CHECK((forces[1].vertex == 8 && forces[1].force == some_load()[1].force));
      }
      if (m.kind == ExactMessage::Kind::kAnswer && m.number == 7) {
        Eigen::Matrix3Xf field;
        m.read_solution(field);
        CHECK(field == some_field());
      }
      if (m.kind == ExactMessage::Kind::kAnswer && m.number == 8) CHECK(m.count == 0);
    }));
    using Kind = ExactMessage::Kind;
    CHECK(kinds ==
          std::vector{Kind::kReady, Kind::kLoad, Kind::kAnswer, Kind::kAnswer, Kind::kSorry});
  }
}

TEST_CASE("a message with any byte changed is broken", "[response][fuzz]") {
  std::vector<std::byte> bytes;
  write_load(7, some_load(), bytes);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    // Any number is valid: the reader compares it with that of the load it sent.
    if (at >= 12 && at < 16) continue;
    for (const auto bit : {std::byte{1}, std::byte{0x80}}) {
      INFO(at);
      std::vector<std::byte> broken = bytes;
      broken[at] ^= bit;
      int found = 0;
      (void)read(broken, broken.size(), [&](const ExactMessage&) { ++found; });
      CHECK(found == 0);
    }
  }
  const std::string text = "palpable: no such body, and more words than a header has bytes\n";
  std::vector<std::byte> words(text.size());
  std::transform(text.begin(), text.end(), words.begin(), [](char c) { return std::byte(c); });
  CHECK_FALSE(read(words, words.size(), [](const ExactMessage&) {}));
}

TEST_CASE("a message longer than the limit is broken, not waited for", "[response]") {
  std::vector<std::byte> bytes;
  write_sorry(std::string(kLargest + 1, 'x'), bytes);
  CHECK_FALSE(read(bytes, 64, [](const ExactMessage&) {}));
}

TEST_CASE("messages are written and read without allocation", "[response]") {
  std::vector<std::byte> bytes;
  const std::vector<VertexForce> load = some_load();
  write_load(7, load, bytes);
  ExactMessages messages(kLargest);
  std::vector<VertexForce> forces;
  forces.reserve(load.size());
  CHECK(test::allocations_during([&] {
          write_load(8, load, bytes);
          std::copy(bytes.begin(), bytes.end(), messages.room().begin());
          messages.add(bytes.size());
          messages.next()->read_load(forces);
        }) == 0);
  CHECK(forces.size() == 2);
}

}  // namespace
}  // namespace palpable
