#include "palpable/common/response/solution_messages.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace palpable {
namespace {

struct Header {
  std::array<char, 8> magic{'p', 'a', 'l', 'e', 'x', 'a', 'c', '1'};
  ExactMessage::Kind kind{};
  std::uint32_t number = 0, count = 0, payload = 0;
  std::uint64_t hash = 0;  // of the payload
};
static_assert(sizeof(Header) == 32);

// A force in a message.
struct LoadEntry {
  std::int32_t vertex = 0;
  std::array<float, 3> force{};
};
static_assert(sizeof(LoadEntry) == 16);

std::uint64_t hash_of(std::span<const std::byte> payload) {
  return fnv1a({reinterpret_cast<const char*>(payload.data()), payload.size()});
}

// Whether a payload has the length that its kind and count require.
bool fits(const Header& h) {
  const std::uint64_t count = h.count;
  switch (h.kind) {
    case ExactMessage::Kind::kReady:
      return h.payload == 0;
    case ExactMessage::Kind::kLoad:
      return h.payload == count * sizeof(LoadEntry);
    case ExactMessage::Kind::kAnswer:
      return h.payload == count * 3 * sizeof(float);
    case ExactMessage::Kind::kSorry:
      return h.payload == count;
  }
  return false;
}

// Completes and writes the header. @pre the payload is in `bytes` behind it
void finish(Header header, std::vector<std::byte>& bytes) {
  const auto payload = std::span(bytes).subspan(sizeof(Header));
  PALPABLE_EXPECT(payload.size() <= std::numeric_limits<std::uint32_t>::max(),
                  "a message is below 4 GiB");
  header.payload = static_cast<std::uint32_t>(payload.size());
  header.hash = hash_of(payload);
  std::memcpy(bytes.data(), &header, sizeof(Header));
}

}  // namespace

void ExactMessage::read_load(std::vector<VertexForce>& forces) const {
  PALPABLE_EXPECT(kind == Kind::kLoad, "only a load has forces");
  forces.clear();
  for (std::size_t k = 0; k < count; ++k) {
    LoadEntry entry;
    std::memcpy(&entry, payload.data() + k * sizeof(entry), sizeof(entry));
    forces.push_back({entry.vertex, {entry.force[0], entry.force[1], entry.force[2]}});
  }
}

void ExactMessage::read_solution(Eigen::Matrix3Xf& field) const {
  PALPABLE_EXPECT(kind == Kind::kAnswer && count > 0, "only an answer has a field");
  field.resize(3, static_cast<Eigen::Index>(count));
  std::memcpy(field.data(), payload.data(), payload.size());
}

std::string_view ExactMessage::text() const {
  PALPABLE_EXPECT(kind == Kind::kSorry, "only an excuse has a text");
  return {reinterpret_cast<const char*>(payload.data()), payload.size()};
}

void write_ready(int nodes, std::vector<std::byte>& bytes) {
  bytes.resize(sizeof(Header));
  finish({.kind = ExactMessage::Kind::kReady, .count = static_cast<std::uint32_t>(nodes)}, bytes);
}

void write_load(std::uint32_t number, std::span<const VertexForce> forces,
                std::vector<std::byte>& bytes) {
  bytes.resize(sizeof(Header) + forces.size() * sizeof(LoadEntry));
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const Eigen::Vector3f& f = forces[k].force;
    const LoadEntry entry{forces[k].vertex, {f[0], f[1], f[2]}};
    std::memcpy(bytes.data() + sizeof(Header) + k * sizeof(entry), &entry, sizeof(entry));
  }
  finish({.kind = ExactMessage::Kind::kLoad,
          .number = number,
          .count = static_cast<std::uint32_t>(forces.size())},
         bytes);
}

void write_solution(std::uint32_t number, const std::optional<Eigen::Matrix3Xf>& field,
                    std::vector<std::byte>& bytes) {
  const std::size_t nodes = field ? static_cast<std::size_t>(field->cols()) : 0;
  bytes.resize(sizeof(Header) + nodes * 3 * sizeof(float));
  if (nodes > 0)
    std::memcpy(bytes.data() + sizeof(Header), field->data(), nodes * 3 * sizeof(float));
  finish({.kind = ExactMessage::Kind::kAnswer,
          .number = number,
          .count = static_cast<std::uint32_t>(nodes)},
         bytes);
}

void write_sorry(std::string_view why, std::vector<std::byte>& bytes) {
  bytes.resize(sizeof(Header) + why.size());
  std::memcpy(bytes.data() + sizeof(Header), why.data(), why.size());
  finish({.kind = ExactMessage::Kind::kSorry, .count = static_cast<std::uint32_t>(why.size())},
         bytes);
}

ExactMessages::ExactMessages(std::size_t largest) : bytes_(sizeof(Header) + largest) {}

std::span<std::byte> ExactMessages::room() {
  if (used_ > 0) {
    std::memmove(bytes_.data(), bytes_.data() + used_, filled_ - used_);
    filled_ -= used_;
    used_ = 0;
  }
  return std::span(bytes_).subspan(filled_);
}

void ExactMessages::add(std::size_t count) {
  PALPABLE_EXPECT(count <= bytes_.size() - filled_, "there is room for what was written");
  filled_ += count;
}

std::optional<ExactMessage> ExactMessages::next() {
  if (broken_ || filled_ - used_ < sizeof(Header)) return std::nullopt;
  Header header;
  std::memcpy(&header, bytes_.data() + used_, sizeof(Header));
  broken_ = header.magic != Header().magic || header.payload > bytes_.size() - sizeof(Header) ||
            !fits(header);
  if (broken_ || filled_ - used_ < sizeof(Header) + header.payload) return std::nullopt;
  const auto payload = std::span(bytes_).subspan(used_ + sizeof(Header), header.payload);
  broken_ = hash_of(payload) != header.hash;
  if (broken_) return std::nullopt;
  used_ += sizeof(Header) + header.payload;
  return ExactMessage{header.kind, header.number, header.count, payload};
}

}  // namespace palpable
