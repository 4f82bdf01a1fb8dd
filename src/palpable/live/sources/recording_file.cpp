#include "palpable/live/sources/recording_file.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/file_format.h"
#include "palpable/live/sources/frame_format_json.h"
#include "palpable/live/sources/little_endian.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/read_ahead.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <map>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kStart = kRecordingMark.size() + sizeof kVersion;
// Bytes of a chunk before its payload: kind, length of the payload, checksum of kind,
// length and payload.
constexpr std::size_t kHead = sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t);

constexpr std::uint32_t kAbout = four_letters("ABOU");
constexpr std::uint32_t kFrame = four_letters("FRAM");
constexpr std::uint32_t kUnreadable = four_letters("BAD ");
constexpr std::uint32_t kSilence = four_letters("SILE");
constexpr std::uint32_t kRefinement = four_letters("EXAC");
constexpr std::uint32_t kState = four_letters("STAT");
constexpr std::uint32_t kEnd = four_letters("END ");

// Bits of the set of images that a frame has. The images follow in this order.
constexpr std::uint8_t kLeft = 1;
constexpr std::uint8_t kRight = 2;
constexpr std::uint8_t kDepth = 4;
constexpr std::uint8_t kBoth = 8;

// Largest number of bytes of a payload without images, far above any real one, including a
// full-order solution with 12 bytes for each of a million nodes.
constexpr std::uint64_t kLongestText = 16'000'000;

std::uint64_t checksum_of(std::uint32_t kind, std::string_view payload) {
  WordHash hash;
  hash.add(kind);
  hash.add(payload.data(), payload.size());
  return hash.value();
}

// More bytes than packing makes of incompressible images.
std::uint64_t longest_frame(const FrameFormat& format) {
  constexpr std::uint64_t kPerPixel = 2 * (sizeof(Rgb) + sizeof(float));
  return kPerPixel * static_cast<std::uint64_t>(format.width) *
             static_cast<std::uint64_t>(format.height) +
         kLongestText;
}

// A file with random access. It is opened without waiting, as a pipe would wait for its writer.
class OpenFile {
 public:
  explicit OpenFile(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    struct stat status {};
    if (descriptor_ < 0) {
      why_ = std::strerror(errno);
    } else if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
      why_ = "is no file";
    } else {
      size_ = static_cast<std::uint64_t>(status.st_size);
    }
  }
  OpenFile(OpenFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        size_(other.size_),
        why_(std::move(other.why_)) {}
  OpenFile& operator=(OpenFile&&) = delete;
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  // Why the file could not be opened; empty: it is open.
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  // Fills `bytes` from `offset` on. @return false if the file ends before
  [[nodiscard]] bool read(std::uint64_t offset, char* bytes, std::size_t count) const {
    while (count > 0) {
      const ssize_t got = ::pread(descriptor_, bytes, count, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      bytes += got;
      offset += static_cast<std::uint64_t>(got);
      count -= static_cast<std::size_t>(got);
    }
    return true;
  }

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::string why_;
};

struct Chunk {
  std::uint32_t kind = 0;
  std::uint64_t begin = 0;  // position of the payload in the file
  std::uint64_t size = 0;   // of the payload
  std::uint64_t checksum = 0;
};

// Reads a chunk's payload. @return whether its checksum is right
bool read_payload(const OpenFile& file, const Chunk& chunk, std::string& payload) {
  payload.resize(chunk.size);
  return file.read(chunk.begin, payload.data(), payload.size()) &&
         checksum_of(chunk.kind, payload) == chunk.checksum;
}

struct Index {
  OpenFile file;
  RecordingContents contents;
  std::vector<Chunk> events;         // frames, unreadable ones and silences
  std::map<int, Chunk> refinements;  // key: index of their state
};

// What is at a position of the file.
enum class Next {
  kChunk,
  kNothing,  // the end of the file
  kCut,      // a chunk that exceeds the end of the file
  kGarbage
};

bool is_event(std::uint32_t kind) {
  return kind == kFrame || kind == kUnreadable || kind == kSilence;
}

// Largest payload of a chunk, bytes; empty for an unknown kind. @param frame that of a frame
std::optional<std::uint64_t> longest_payload(std::uint32_t kind, std::uint64_t frame) {
  if (kind == kFrame) return frame;
  if (is_event(kind) || kind == kAbout || kind == kState || kind == kRefinement || kind == kEnd) {
    return kLongestText;
  }
  return std::nullopt;
}

// @param most  bytes of a frame's payload
Next next_chunk(const OpenFile& file, std::uint64_t at, std::uint64_t most, Chunk& chunk) {
  if (at == file.size()) return Next::kNothing;
  std::string head(kHead, '\0');
  if (file.size() - at < kHead || !file.read(at, head.data(), kHead)) return Next::kCut;
  std::string_view rest(head);
  chunk.kind = *take<std::uint32_t>(rest);
  chunk.size = *take<std::uint64_t>(rest);
  chunk.checksum = *take<std::uint64_t>(rest);
  chunk.begin = at + kHead;
  const std::optional<std::uint64_t> longest = longest_payload(chunk.kind, most);
  if (!longest || chunk.size > *longest) return Next::kGarbage;
  return chunk.size > file.size() - chunk.begin ? Next::kCut : Next::kChunk;
}

// Adds a chunk that is not an event to the contents. @return whether the chunk is valid
bool take_up(const OpenFile& file, const Chunk& chunk, RecordingContents& contents) {
  std::string payload;
  if (!read_payload(file, chunk, payload)) return false;
  std::string_view rest(payload);
  if (chunk.kind == kEnd) return contents.finished = true;
  const auto number = take<std::int32_t>(rest);
  const auto hash = take<std::uint64_t>(rest);
  if (chunk.kind != kState || !hash) return false;
  contents.states.push_back({*number, *hash, std::string(rest)});
  return true;
}

// Scans all chunks after the first, up to an invalid one.
void look_through(Index& index, std::uint64_t at) {
  RecordingContents& contents = index.contents;
  const std::uint64_t most = longest_frame(contents.format);
  Chunk chunk;
  std::string payload;
  while (!contents.finished) {
    const Next next = next_chunk(index.file, at, most, chunk);
    if (next == Next::kNothing || next == Next::kCut) {
      contents.ending = "was cut off: what recorded it was ended before its time";
      return;
    }
    const bool event = next == Next::kChunk && is_event(chunk.kind);
    const bool refinement = next == Next::kChunk && chunk.kind == kRefinement &&
                            read_payload(index.file, chunk, payload);
    if (!event && !refinement &&
        (next == Next::kGarbage || !take_up(index.file, chunk, contents))) {
      contents.ending = fmt::format("is damaged at byte {}", at);
      contents.damaged = true;
      return;
    }
    if (event) index.events.push_back(chunk);
    if (refinement) index.refinements[static_cast<int>(contents.states.size())] = chunk;
    if (chunk.kind == kFrame) ++contents.frames;
    at = chunk.begin + chunk.size;
  }
}

// Reads the first chunk. Returns what is wrong with it; empty if nothing.
std::string read_about(const OpenFile& file, const Chunk& chunk, RecordingContents& contents) {
  std::string payload;
  if (chunk.kind != kAbout || !read_payload(file, chunk, payload))
    return "its beginning is damaged";
  Result<Json> about = Json::parse(payload);
  if (!about.ok()) return about.problem().message;
  for (const char* key : {"format", "run"}) {
    if (!about.value().contains(key)) return fmt::format("its beginning has no '{}'", key);
  }
  Result<FrameFormat> format = frame_format_of(about.value()["format"]);
  if (!format.ok()) return format.problem().message;
  contents.format = std::move(format).value();
  contents.run = about.value()["run"];
  return {};
}

Result<Index> index_of(const fs::path& path) {
  const auto problem = [&](const std::string& what) {
    return Problem{fmt::format("{}: {}", path.string(), what)};
  };
  Index index{OpenFile(path), {}, {}, {}};
  const OpenFile& file = index.file;
  if (!file.why().empty()) return problem(file.why());
  std::string start(kStart, '\0');
  if (!file.read(0, start.data(), start.size()) || !start.starts_with(kRecordingMark)) {
    return problem("is no recording of palpable live --record");
  }
  std::string_view rest = std::string_view(start).substr(kRecordingMark.size());
  if (const auto version = *take<std::uint32_t>(rest); version != kVersion) {
    return problem(fmt::format("has layout {}; this program reads layout {}", version, kVersion));
  }
  Chunk chunk;
  if (next_chunk(file, kStart, 0, chunk) != Next::kChunk) {
    return problem("was cut off before its first frame");
  }
  if (const std::string wrong = read_about(file, chunk, index.contents); !wrong.empty()) {
    return problem(wrong);
  }
  look_through(index, chunk.begin + chunk.size);
  return index;
}

class RecordingReader final : public FrameReader {
 public:
  RecordingReader(fs::path path, Index index) : path_(std::move(path)), index_(std::move(index)) {}

  const FrameFormat& format() const override { return index_.contents.format; }
  int count() const override { return index_.contents.frames; }
  SourceState state() const override { return state_; }
  std::vector<std::string> notes() const override {
    if (index_.contents.ending.empty()) return {};
    return {fmt::format("{} {}", path_.string(), index_.contents.ending)};
  }

  FrameStatus read(int number, Frame& frame, std::string& trouble) override {
    if (is_damaged_ || number >= std::ssize(index_.events)) return FrameStatus::kEnd;
    const Chunk& chunk = index_.events[static_cast<std::size_t>(number)];
    std::optional<FrameStatus> status;
    if (read_payload(index_.file, chunk, payload_)) {
      std::string_view rest(payload_);
      status = chunk.kind == kFrame        ? read_frame(rest, frame)
               : chunk.kind == kUnreadable ? read_unreadable(rest, frame, trouble)
                                           : read_silence(rest, trouble);
    }
    if (!status) {
      is_damaged_ = true;
      frame.number = last_number_ + 1;
      trouble = fmt::format("{} is damaged at byte {}; it is played up to there", path_.string(),
                            chunk.begin - kHead);
      return FrameStatus::kUnreadable;
    }
    if (*status == FrameStatus::kWaiting) return *status;
    last_number_ = frame.number;
    state_ = SourceState::kRunning;
    return *status;
  }

 private:
  // The functions below return nothing if the payload is invalid.
  std::optional<FrameStatus> read_frame(std::string_view rest, Frame& frame) {
    const FrameFormat& format = index_.contents.format;
    const auto number = take<std::int32_t>(rest);
    const auto time = take<double>(rest);
    const auto taken = take<double>(rest);  // by a clock of the past: not returned
    const auto images = take<std::uint8_t>(rest);
    if (!number || !time || !taken || !images) return {};
    frame.number = *number;
    frame.time = *time;
    const std::pair color_size{format.width, format.height};
    const auto unpack = [&](std::uint8_t which, const std::pair<int, int>& size, auto& image) {
      if ((*images & which) != 0) return unpacker_.unpack(rest, size.first, size.second, image);
      image.resize(0, 0);
      return true;
    };
    const bool whole = unpack(kLeft, color_size, frame.left) &&
                       unpack(kRight, color_size, frame.right) &&
                       unpack(kDepth, depth_size_of(format), frame.depth) &&
                       unpack(kBoth, color_size, frame.both) && rest.empty();
    if (!whole) return {};
    return FrameStatus::kFrame;
  }

  std::optional<FrameStatus> read_unreadable(std::string_view rest, Frame& frame,
                                             std::string& trouble) {
    const auto number = take<std::int32_t>(rest);
    if (!number) return {};
    frame.number = *number;
    trouble = rest;
    return FrameStatus::kUnreadable;
  }

  std::optional<FrameStatus> read_silence(std::string_view rest, std::string& trouble) {
    const auto gone = take<std::uint8_t>(rest);
    if (!gone) return {};
    state_ = *gone != 0 ? SourceState::kGone : SourceState::kStalled;
    trouble = rest;
    return FrameStatus::kWaiting;
  }

  fs::path path_;
  Index index_;
  ImageUnpacker unpacker_;
  std::string payload_;
  int last_number_ = -1;
  bool is_damaged_ = false;
  SourceState state_ = SourceState::kRunning;
};

}  // namespace

bool is_recording_name(const fs::path& path) { return path.extension() == kRecordingEnding; }

RecordingWriter::RecordingWriter(const fs::path& path, const FrameFormat& format, const Json& run,
                                 Opening opening)
    : file_(path, opening) {
  pending_ = kRecordingMark;
  put(pending_, kVersion);
  begin(kAbout);
  chunk_ += Json{
      {"holds", "pictures of the room in which it was recorded"},
      {"format", json_of(format)},
      {"run",
       run}}.dump();
  append();
}

void RecordingWriter::begin(std::uint32_t kind) {
  chunk_.assign(kHead, '\0');
  std::memcpy(chunk_.data(), &kind, sizeof kind);
}

// Writes what came before the first frame, once.
void RecordingWriter::write_pending() {
  if (begun_) return;
  file_.append(pending_);
  size_ += pending_.size();
  begun_ = true;
  pending_ = {};
}

// Completes the chunk that was begun and appends it to the file, or to what is pending.
void RecordingWriter::append() {
  std::uint32_t kind = 0;
  std::memcpy(&kind, chunk_.data(), sizeof kind);
  const std::uint64_t size = chunk_.size() - kHead;
  const std::uint64_t checksum = checksum_of(kind, std::string_view(chunk_).substr(kHead));
  std::memcpy(chunk_.data() + sizeof kind, &size, sizeof size);
  std::memcpy(chunk_.data() + sizeof kind + sizeof size, &checksum, sizeof checksum);
  if (!begun_) {
    pending_ += chunk_;
    return;
  }
  file_.append(chunk_);
  size_ += chunk_.size();
}

void RecordingWriter::add_frame(const Frame& frame, std::optional<double> taken) {
  write_pending();
  begin(kFrame);
  put(chunk_, std::int32_t{frame.number});
  put(chunk_, frame.time);
  put(chunk_, taken.value_or(std::numeric_limits<double>::quiet_NaN()));
  const auto images = (frame.left.empty() ? 0 : kLeft) | (frame.right.empty() ? 0 : kRight) |
                      (frame.depth.empty() ? 0 : kDepth) | (frame.both.empty() ? 0 : kBoth);
  put(chunk_, static_cast<std::uint8_t>(images));
  if (!frame.left.empty()) packer_.pack(frame.left, chunk_);
  if (!frame.right.empty()) packer_.pack(frame.right, chunk_);
  if (!frame.depth.empty()) packer_.pack(frame.depth, chunk_);
  if (!frame.both.empty()) packer_.pack(frame.both, chunk_);
  append();
}

void RecordingWriter::add_unreadable(int number, std::string_view why) {
  begin(kUnreadable);
  put(chunk_, std::int32_t{number});
  chunk_ += why;
  append();
}

void RecordingWriter::add_silence(SourceState state, std::string_view why) {
  begin(kSilence);
  put(chunk_, static_cast<std::uint8_t>(state == SourceState::kGone));
  chunk_ += why;
  append();
}

void RecordingWriter::add_refinement(const RecordedRefinement& refinement) {
  begin(kRefinement);
  put(chunk_, static_cast<std::uint8_t>(refinement.asked));
  chunk_.append(reinterpret_cast<const char*>(refinement.exact.data()),
                static_cast<std::size_t>(refinement.exact.size()) * sizeof(float));
  append();
}

void RecordingWriter::add_state(const RecordedState& state) {
  begin(kState);
  put(chunk_, std::int32_t{state.number});
  put(chunk_, state.hash);
  chunk_ += state.line;
  append();
}

void RecordingWriter::finish() {
  write_pending();
  begin(kEnd);
  append();
  file_.close();
}

Result<RecordingContents> read_recording(const fs::path& path) {
  Result<Index> index = index_of(path);
  if (!index.ok()) return index.problem();
  return std::move(index.value().contents);
}

struct RecordedRefinements::Parts {
  Index index;
  std::string payload;
};

RecordedRefinements::RecordedRefinements(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
RecordedRefinements::RecordedRefinements(RecordedRefinements&&) noexcept = default;
RecordedRefinements& RecordedRefinements::operator=(RecordedRefinements&&) noexcept = default;
RecordedRefinements::~RecordedRefinements() = default;

Result<RecordedRefinements> RecordedRefinements::open(const fs::path& path) {
  Result<Index> index = index_of(path);
  if (!index.ok()) return index.problem();
  return RecordedRefinements(std::make_unique<Parts>(Parts{std::move(index).value(), {}}));
}

void RecordedRefinements::read(int n, RecordedRefinement& refinement) {
  refinement.asked = false;
  refinement.exact.resize(3, 0);
  const auto found = parts_->index.refinements.find(n);
  if (found == parts_->index.refinements.end()) return;
  if (!read_payload(parts_->index.file, found->second, parts_->payload)) return;
  std::string_view rest(parts_->payload);
  const auto asked = take<std::uint8_t>(rest);
  constexpr std::size_t kColumn = 3 * sizeof(float);
  if (!asked || rest.size() % kColumn != 0) return;
  refinement.asked = *asked != 0;
  if (rest.empty()) return;
  refinement.exact.resize(3, static_cast<Eigen::Index>(rest.size() / kColumn));
  std::memcpy(refinement.exact.data(), rest.data(), rest.size());
}

Result<std::unique_ptr<FrameSource>> open_recording(const fs::path& path) {
  Result<Index> index = index_of(path);
  if (!index.ok()) return index.problem();
  if (index.value().contents.frames == 0) {
    return Problem{fmt::format("{}: holds no frame", path.string())};
  }
  return read_ahead(std::make_unique<RecordingReader>(path, std::move(index).value()));
}

}  // namespace palpable
