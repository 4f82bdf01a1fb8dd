/// @file
/// The chunks of a recording (docs/recording_file.md), for tests that truncate and damage them.
#pragma once

#include "palpable/common/base/checksum.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace palpable::test {

inline constexpr std::size_t kRecordingStart = 12;  ///< bytes before the first chunk
inline constexpr std::size_t kChunkHead = 20;       ///< kind, length, checksum

struct ChunkPlace {
  std::string kind;
  std::size_t begin = 0;    ///< of its head
  std::size_t payload = 0;  ///< its first byte
  std::size_t end = 0;
};

/// The chunks of a recording's bytes, up to an incomplete one.
inline std::vector<ChunkPlace> chunks_of(const std::string& bytes) {
  std::vector<ChunkPlace> chunks;
  for (std::size_t at = kRecordingStart; at + kChunkHead <= bytes.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + at + 4, sizeof size);
    if (size > bytes.size() - at - kChunkHead) break;
    chunks.push_back({bytes.substr(at, 4), at, at + kChunkHead, at + kChunkHead + size});
    at = chunks.back().end;
  }
  return chunks;
}

/// The same bytes with the correct checksum in each chunk.
inline std::string with_right_checksums(std::string bytes) {
  for (const ChunkPlace& chunk : chunks_of(bytes)) {
    std::uint32_t kind = 0;
    std::memcpy(&kind, bytes.data() + chunk.begin, sizeof kind);
    WordHash hash;
    hash.add(kind);
    hash.add(bytes.data() + chunk.payload, chunk.end - chunk.payload);
    const std::uint64_t value = hash.value();
    std::memcpy(bytes.data() + chunk.begin + 12, &value, sizeof value);
  }
  return bytes;
}

}  // namespace palpable::test
