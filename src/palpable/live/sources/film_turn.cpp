#include "palpable/live/sources/film_turn.h"

#include "palpable/common/base/whole_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

namespace palpable {
namespace {

// A box of the file: [begin, end) is its content, without the header.
struct FilmBox {
  std::string kind;
  std::uint64_t begin = 0, end = 0;
};

class FilmBoxes {
 public:
  explicit FilmBoxes(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    file_.seekg(0, std::ios::end);
    const std::streamoff size = file_ ? static_cast<std::streamoff>(file_.tellg()) : 0;
    size_ = size > 0 ? static_cast<std::uint64_t>(size) : 0;
  }

  std::uint64_t size() const { return size_; }

  // The big-endian number in `count` bytes, at most 8.
  std::optional<std::uint64_t> number(std::uint64_t at, std::size_t count) {
    std::array<char, 8> bytes{};
    if (at > size_ || size_ - at < count || left_ == 0) return std::nullopt;
    --left_;
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(at));
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(count))) return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) {
      value = value << 8 | static_cast<unsigned char>(bytes[i]);
    }
    return value;
  }

  // The box that begins at `at`, within [.., end); empty if there is none, or it is damaged.
  std::optional<FilmBox> box(std::uint64_t at, std::uint64_t end) {
    constexpr std::uint64_t kHeader = 8, kLongHeader = 16, kToTheEnd = 0, kIsLong = 1;
    if (at > end || end - at < kHeader) return std::nullopt;
    std::optional<std::uint64_t> size = number(at, 4);
    const auto kind = number(at + 4, 4);
    if (!size || !kind) return std::nullopt;
    std::uint64_t header = kHeader;
    if (*size == kIsLong) {
      header = kLongHeader;
      size = number(at + kHeader, 8);
    } else if (*size == kToTheEnd) {
      size = end - at;
    }
    if (!size || *size < header || *size > end - at) return std::nullopt;
    FilmBox box{{}, at + header, at + *size};
    for (int shift = 24; shift >= 0; shift -= 8) {
      box.kind += static_cast<char>(*kind >> shift & 0xff);
    }
    return box;
  }

  // The first box of this kind in [begin, end).
  std::optional<FilmBox> find(const char* kind, std::uint64_t begin, std::uint64_t end) {
    while (const std::optional<FilmBox> found = box(begin, end)) {
      if (found->kind == kind) return found;
      begin = found->end;
    }
    return std::nullopt;
  }

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
  int left_ = 20'000;  // reads, so that a file of endless tiny boxes is given up
};

bool is_video_track(FilmBoxes& boxes, const FilmBox& track) {
  const auto media = boxes.find("mdia", track.begin, track.end);
  if (!media) return false;
  const auto handler = boxes.find("hdlr", media->begin, media->end);
  constexpr std::uint64_t kVideo = 0x76696465;  // "vide", behind version, flags and a reserved word
  return handler && boxes.number(handler->begin + 8, 4) == kVideo;
}

FilmTurn turn_of_track(FilmBoxes& boxes, const FilmBox& track) {
  const auto header = boxes.find("tkhd", track.begin, track.end);
  if (!header) return FilmTurn::kNone;
  // Version 1 has three times in 8 instead of 4 bytes. x' = a x + c y, y' = b x + d y, in 16.16,
  // with a column of 2.30 between the two of each row.
  const bool is_long = boxes.number(header->begin, 1) == 1;
  const std::uint64_t matrix = header->begin + (is_long ? 52 : 40);
  if (header->end < matrix + 36) return FilmTurn::kNone;
  std::array<std::int32_t, 4> abcd{};
  constexpr std::array<std::uint64_t, 4> kPlaces{0, 4, 12, 16};
  for (std::size_t i = 0; i < abcd.size(); ++i) {
    const auto value = boxes.number(matrix + kPlaces[i], 4);
    if (!value) return FilmTurn::kNone;
    abcd[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(*value));
  }
  constexpr std::int32_t kOne = 0x10000;
  using Matrix = std::array<std::int32_t, 4>;
  if (abcd == Matrix{0, kOne, -kOne, 0}) return FilmTurn::kClockwise;
  if (abcd == Matrix{-kOne, 0, 0, -kOne}) return FilmTurn::kHalf;
  if (abcd == Matrix{0, -kOne, kOne, 0}) return FilmTurn::kCounterclockwise;
  return FilmTurn::kNone;
}

}  // namespace

FilmTurn turn_of_film(const std::filesystem::path& path) {
  if (!why_no_file(path).empty()) return FilmTurn::kNone;
  FilmBoxes boxes(path);
  constexpr std::uint64_t kFileType = 0x66747970, kMovie = 0x6d6f6f76, kData = 0x6d646174,
                          kWide = 0x77696465;  // "ftyp", "moov", "mdat", "wide"
  const std::uint64_t first = boxes.number(4, 4).value_or(0);
  if (first != kFileType && first != kMovie && first != kData && first != kWide) {
    return FilmTurn::kNone;
  }
  const auto movie = boxes.find("moov", 0, boxes.size());
  if (!movie) return FilmTurn::kNone;
  for (std::uint64_t at = movie->begin;;) {
    const auto track = boxes.find("trak", at, movie->end);
    if (!track) return FilmTurn::kNone;
    if (is_video_track(boxes, *track)) return turn_of_track(boxes, *track);
    at = track->end;
  }
}

std::string_view turn_text(FilmTurn turn) {
  switch (turn) {
    case FilmTurn::kClockwise:
      return "90 degrees clockwise";
    case FilmTurn::kHalf:
      return "180 degrees";
    case FilmTurn::kCounterclockwise:
      return "90 degrees counterclockwise";
    case FilmTurn::kNone:
      break;
  }
  return "not at all";
}

}  // namespace palpable
