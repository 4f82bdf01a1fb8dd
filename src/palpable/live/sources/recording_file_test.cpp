#include "palpable/live/sources/recording_file.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/frame_format_json.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/sources/source_guard.h"
#include "tests/support/full_disk.h"
#include "tests/support/recording_bytes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 11, kHeight = 7;

FrameFormat rectified_format() {
  FrameFormat format;
  format.width = kWidth;
  format.height = kHeight;
  format.already_rectified = true;
  format.rectified = {{kWidth, kHeight, 9.5, 9.25, 5, 3}, 0.063, -1.0 / 3};
  return format;
}

FrameFormat raw_format() {
  StereoRig rig;
  rig.left = {{kWidth, kHeight, 9.1, 9.2, 5.3, 3.4}, {-0.17, 0.027, 1e-4, -2e-4, 1.0 / 7}};
  rig.right = {{kWidth, kHeight, 9.3, 9.4, 5.1, 3.2}, {-0.16, 0.02, 0, 0, 0}};
  rig.right_from_left = Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY());
  rig.right_from_left.translation() << -0.063, 1e-4, 2e-4;
  return format_of(rig);
}

FrameFormat depth_format(bool own_color) {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.width = kWidth;
  format.height = kHeight;
  format.depth_camera = {kWidth, kHeight, 9, 9.5, 5, 3};
  format.depth_unit = own_color ? 2e-4 : 1e-3;
  format.depth_unit_assumed = !own_color;
  if (own_color) {
    format.color_sensor = {{kWidth, kHeight, 8, 8.5, 5.5, 3.5}, Rigid3::Identity()};
    format.color_sensor->color_from_depth.translation() << 0.025, 0, 1e-3;
  }
  return format;
}

// A phone's: half as many depths.
FrameFormat phone_format() {
  FrameFormat format = depth_format(true);
  format.depth_camera = {kWidth / 2, kHeight / 2, 4.5, 4.75, 2, 1};
  return format;
}

Frame some_frame(const FrameFormat& format, int number) {
  auto random = test::random_case(static_cast<unsigned>(number));
  Frame frame;
  frame.number = number;
  frame.time = number / 30.0;
  const auto fill = [&](ColorImage& image) {
    image.resize(kWidth, kHeight);
    for (Rgb& pixel : image) pixel.r = pixel.g = pixel.b = static_cast<std::uint8_t>(random());
  };
  fill(frame.left);
  if (format.kind == FrameFormat::Kind::kStereo) {
    fill(frame.right);
  } else {
    const auto [width, height] = depth_size_of(format);
    frame.depth = DepthImage(width, height, 0.4F + 0.001F * static_cast<float>(number));
    frame.depth(3, 2) = std::numeric_limits<float>::quiet_NaN();
  }
  return frame;
}

// A frame as a camera sends it in YUYV.
Frame some_yuyv_frame(int number) {
  auto random = test::random_case(static_cast<unsigned>(number));
  Frame frame;
  frame.number = number;
  frame.time = number / 30.0;
  frame.both.resize(kWidth, kHeight);
  for (Yuyv& pair : frame.both) {
    pair = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()), 7, 9};
  }
  return frame;
}

bool same(const Frame& a, const Frame& b) {
  return a.number == b.number && a.time == b.time && a.left == b.left && a.right == b.right &&
         a.both == b.both && a.depth.size() == b.depth.size() &&
         (a.depth.empty() ||
          std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0);
}

// Frames 0, 1, 2, an unreadable one, a silence, frame 7; states of all but the last.
void write_some(const fs::path& path, const FrameFormat& format, bool finish = true) {
  RecordingWriter writer(path, format, {{"who", "a test"}});
  for (int n = 0; n < 3; ++n) {
    writer.add_frame(some_frame(format, n), n == 0 ? std::nullopt : std::optional(1000.0 + n));
    writer.add_state({n, 0xfedcba9876543210U + static_cast<unsigned>(n), "state\n"});
  }
  writer.add_unreadable(3, "the picture is cut off");
  writer.add_silence(SourceState::kGone, "no such device");
  writer.add_frame(some_frame(format, 7), 1007.0);
  if (finish) writer.finish();
}

// A readable line for every item of a source.
std::vector<std::string> lines_of(FrameSource& source, const FrameFormat& format) {
  std::vector<std::string> lines;
  Frame frame;
  for (int calls = 0; calls < 100; ++calls) {
    switch (source.next(frame)) {
      case FrameStatus::kFrame:
        lines.push_back("frame " + std::to_string(frame.number) +
                        (same(frame, some_frame(format, frame.number)) ? "" : ", changed"));
        break;
      case FrameStatus::kUnreadable:
        lines.push_back("unreadable " + std::to_string(frame.number) + ": " +
                        source.last_trouble());
        break;
      case FrameStatus::kWaiting:
        lines.push_back(source.last_trouble());
        break;
      case FrameStatus::kEnd:
        return lines;
    }
    if (source.state() == SourceState::kGone) lines.back() += " (gone)";
  }
  return lines;
}

const std::vector<std::string> kAll{"frame 0",
                                    "frame 1",
                                    "frame 2",
                                    "unreadable 3: the picture is cut off",
                                    "no such device (gone)",
                                    "frame 7"};

TEST_CASE("what was recorded is played: frames, what could not be read, silence, states",
          "[sources][recording]") {
  const test::ScratchFolder folder("recording");
  for (const FrameFormat& format : {rectified_format(), raw_format(), depth_format(false),
                                    depth_format(true), phone_format()}) {
    const fs::path path = folder / "a.palprec";
    write_some(path, format);
    const RecordingContents contents = read_recording(path).value();
    CHECK(contents.run["who"].get<std::string>() == "a test");
    CHECK(contents.frames == 4);
    CHECK(contents.finished);
    CHECK_FALSE(contents.damaged);
    CHECK(contents.ending.empty());
    REQUIRE(contents.states.size() == 3);
    CHECK(contents.states[1].number == 1);
    CHECK(contents.states[1].hash == 0xfedcba9876543211U);
    CHECK(contents.states[2].line == "state\n");
    CHECK(json_of(contents.format).dump() == json_of(format).dump());

    CameraRequest request;
    request.device = path.string();
    const auto source = value_or_throw(open_source(request));
    CHECK(source->frame_count() == 4);
    CHECK_FALSE(source->is_live());
    CHECK(source->take_notes().empty());
    CHECK(lines_of(*source, format) == kAll);
    CHECK(source->state() == SourceState::kRunning);
  }
}

TEST_CASE("what was refined belongs to the state that follows it", "[sources][recording]") {
  const test::ScratchFolder folder("refined");
  const fs::path path = folder / "a.palprec";
  {
    RecordingWriter writer(path, rectified_format(), Json::object());
    writer.add_frame(some_frame(rectified_format(), 0), {});
    writer.add_state({0, 10, ""});
    writer.add_refinement({true, {}});
    writer.add_state({1, 11, ""});
    writer.add_refinement({false, Eigen::Matrix3Xf::Constant(3, 4, 0.1F)});
    writer.add_state({2, 12, ""});
  }
  CHECK(read_recording(path).value().states.size() == 3);
  RecordedRefinements refinements = std::move(RecordedRefinements::open(path)).value();
  RecordedRefinement read;
  refinements.read(2, read);
  CHECK_FALSE(read.asked);
  CHECK(read.exact == Eigen::Matrix3Xf::Constant(3, 4, 0.1F));
  refinements.read(1, read);
  CHECK(read.asked);
  CHECK(read.exact.cols() == 0);
  for (const int n : {0, 3, -1}) {
    refinements.read(n, read);
    CHECK_FALSE(read.asked);
    CHECK(read.exact.cols() == 0);
  }
}

TEST_CASE("the format of a recording is the source's to the bit", "[sources][recording]") {
  const StereoRig rig = raw_format().rig;
  const FrameFormat read =
      frame_format_of(Json::parse(json_of(raw_format()).dump()).value()).value();
  CHECK(read.rig.left == rig.left);
  CHECK(read.rig.right == rig.right);
  CHECK(read.rig.right_from_left.matrix() == rig.right_from_left.matrix());
  CHECK_FALSE(read.already_rectified);
  const FrameFormat depth = frame_format_of(json_of(depth_format(true))).value();
  CHECK(depth.kind == FrameFormat::Kind::kColorDepth);
  CHECK(depth.depth_camera == depth_format(true).depth_camera);
  CHECK(depth.depth_unit == 2e-4);
  CHECK_FALSE(depth.depth_unit_assumed);
  CHECK(frame_format_of(json_of(depth_format(false))).value().depth_unit_assumed);
  FrameFormat of_0_1 = depth_format(false);  // has no unit
  of_0_1.depth_unit = 0;
  CHECK_FALSE(json_of(of_0_1).contains("depth_unit_m"));
  CHECK(frame_format_of(json_of(of_0_1)).value().depth_unit == 0);
  REQUIRE(depth.color_sensor);
  CHECK(depth.color_sensor->camera == depth_format(true).color_sensor->camera);
  FrameFormat own_clock = rectified_format();
  own_clock.starts_at = 1403636579.763555584;
  CHECK(frame_format_of(json_of(own_clock)).value().starts_at == own_clock.starts_at);
  CHECK(frame_format_of(json_of(rectified_format())).value().starts_at == 0);
  CHECK(frame_format_of(json_of(rectified_format())).value().rectified.disparity_at_infinity_px ==
        -1.0 / 3);
}

TEST_CASE("numbers that make no camera are refused", "[sources][recording][errors]") {
  const auto refused = [](const FrameFormat& format) {
    return !frame_format_of(json_of(format)).ok();
  };
  FrameFormat format = rectified_format();
  CHECK_FALSE(refused(format));
  format.width = 0;
  CHECK(refused(format));
  format.width = 40'000;
  CHECK(refused(format));
  format = rectified_format();
  format.width = format.height = 32'000;  // a gigapixel
  CHECK(refused(format));
  format = rectified_format();
  format.rectified.baseline = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(format));
  format = raw_format();
  format.rig.right_from_left.linear() *= 2;
  CHECK(refused(format));
  format = depth_format(false);
  format.depth_camera.fx_px = -1;
  CHECK(refused(format));
  Json json = json_of(rectified_format());
  json["kind"] = "sonar";
  CHECK_FALSE(frame_format_of(json).ok());
}

TEST_CASE("a pose in a recording is its matrix row by row", "[sources][recording]") {
  FrameFormat format = raw_format();
  Eigen::Matrix3d R;  // a small turn about three axes
  R = Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  format.rig.right_from_left.linear() = R;
  format.rig.right_from_left.translation() << -0.063, 1e-4, 2e-4;
  const Json json = json_of(format);
  const Json& rows = json["right_from_left"];
  REQUIRE(rows.size() == 16);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) CHECK(rows[4 * k + i].get<double>() == R(k, i));
    CHECK(rows[4 * k + 3].get<double>() == format.rig.right_from_left.translation()[k]);
    CHECK(rows[12 + k].get<double>() == 0);
  }
  const FrameFormat back = value_or_throw(frame_format_of(json));
  CHECK(back.rig.right_from_left.matrix() == format.rig.right_from_left.matrix());
}

TEST_CASE("a recording that was cut off anywhere is played up to its last whole chunk",
          "[sources][recording][errors]") {
  const test::ScratchFolder folder("cut");
  const FrameFormat format = rectified_format();
  write_some(folder / "whole.palprec", format);
  const std::string bytes = test::file_bytes(folder / "whole.palprec");
  const std::vector<test::ChunkPlace> chunks = test::chunks_of(bytes);
  REQUIRE(chunks.size() == 1 + 4 + 3 + 2 + 1);
  REQUIRE(chunks.back().end == bytes.size());
  const fs::path path = folder / "cut.palprec";
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    INFO("cut to " << size << " of " << bytes.size() << " bytes");
    test::write_bytes(path, bytes.substr(0, size));
    const Result<RecordingContents> contents = read_recording(path);
    if (size < chunks.front().end) {
      REQUIRE_FALSE(contents.ok());
      CHECK(contents.problem().message.starts_with(path.string() + ": "));
      continue;
    }
    REQUIRE(contents.ok());
    std::size_t events = 0, states = 0;
    for (const test::ChunkPlace& chunk : chunks) {
      if (chunk.end > size || chunk.kind == "ABOU") continue;
      ++(chunk.kind == "STAT" ? states : events);
    }
    CHECK(contents.value().states.size() == states);
    CHECK_FALSE(contents.value().finished);
    CHECK_FALSE(contents.value().damaged);
    CHECK(contents.value().ending.starts_with("was cut off"));
    if (events == 0) {
      CHECK_FALSE(open_recording(path).ok());
      continue;
    }
    const auto source = value_or_throw(open_recording(path));
    const auto notes = source->take_notes();
    REQUIRE(notes.size() == 1);
    CHECK(notes.front() == path.string() + " " + contents.value().ending);
    CHECK(lines_of(*source, format) ==
          std::vector(kAll.begin(), kAll.begin() + static_cast<std::ptrdiff_t>(events)));
  }
}

TEST_CASE("any changed bit of a recording ends it there, and never changes a frame",
          "[sources][recording][errors]") {
  const test::ScratchFolder folder("changed");
  const FrameFormat format = rectified_format();
  write_some(folder / "whole.palprec", format);
  const std::string bytes = test::file_bytes(folder / "whole.palprec");
  const fs::path path = folder / "changed.palprec";
  int unreadable = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    INFO("byte " << at << " of " << bytes.size());
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    test::write_bytes(path, changed);
    const Result<RecordingContents> contents = read_recording(path);
    if (!contents.ok()) continue;
    const Result<std::unique_ptr<FrameSource>> source = open_recording(path);
    if (!source.ok()) continue;
    std::vector<std::string> lines = lines_of(*source.value(), format);
    const bool reports_damage =
        !lines.empty() && lines.back().find("is damaged at byte") < lines.back().size();
    if (reports_damage) lines.pop_back();
    unreadable += reports_damage;
    // The damage is reported by the source or in the contents.
    CHECK((reports_damage || !contents.value().ending.empty()));
    REQUIRE(lines.size() <= kAll.size());
    CHECK(std::equal(lines.begin(), lines.end(), kAll.begin()));
  }
  CHECK(unreadable > 1000);  // most bytes belong to images
}

TEST_CASE("damage behind right checksums, such as lengths of exabytes, does no harm",
          "[sources][recording][errors]") {
  const test::ScratchFolder folder("spoilt");
  const FrameFormat format = depth_format(true);
  write_some(folder / "whole.palprec", format);
  const std::string bytes = test::file_bytes(folder / "whole.palprec");
  const std::vector<test::ChunkPlace> chunks = test::chunks_of(bytes);
  const fs::path path = folder / "spoilt.palprec";
  for (unsigned seed = 0; seed < 2000; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::string spoilt = bytes;
    for (int k = 0; k <= static_cast<int>(seed % 4); ++k) {
      const test::ChunkPlace& chunk = chunks[random() % chunks.size()];
      const bool in_head = random() % 4 == 0;
      const std::size_t at = in_head ? chunk.begin + random() % test::kChunkHead
                                     : chunk.payload + random() % (chunk.end - chunk.payload + 1);
      if (at < spoilt.size()) spoilt[at] = static_cast<char>(random());
    }
    test::write_bytes(path, test::with_right_checksums(spoilt));
    static_cast<void>(read_recording(path));
    const Result<std::unique_ptr<FrameSource>> source = open_recording(path);
    if (!source.ok()) continue;
    SourceGuard guard(*source.value());
    Frame frame;
    int calls = 0;
    while (guard.next(frame) != FrameStatus::kEnd) REQUIRE(++calls < 100);
  }
}

TEST_CASE("what is no recording, of another layout or without frames is refused in one line",
          "[sources][recording][errors]") {
  const test::ScratchFolder folder("refused");
  const fs::path path = folder / "a.palprec";
  const auto says = [&](const std::string& what) {
    for (const std::string& said :
         {read_recording(path).ok() ? std::string() : read_recording(path).problem().message,
          open_recording(path).problem().message}) {
      if (said.empty()) continue;
      INFO(said);
      CHECK(said.starts_with(path.string() + ": "));
      CHECK(said.find(what) < said.size());
      CHECK(said.find('\n') == std::string::npos);
    }
  };
  says("No such file");
  fs::create_directory(path);
  says("is no file");
  fs::remove(path);
  test::write_bytes(path, "a film, by its bytes");
  says("is no recording");
  write_some(path, rectified_format());
  std::string bytes = test::file_bytes(path);
  bytes[8] = 2;
  test::write_bytes(path, bytes);
  says("has layout 2; this program reads layout 1");
  RecordingWriter(path, rectified_format(), Json::object()).finish();
  CHECK(read_recording(path).ok());
  says("holds no frame");

  CameraRequest request;
  request.device = path.string();
  request.right = "other.palprec";
  CHECK(open_source(request).problem().message.find("leave out --right") < 1000);
}

TEST_CASE("on a full disk a recording ends with its last whole chunk",
          "[sources][recording][errors]") {
  const test::ScratchFolder folder("full");
  const fs::path path = folder / "a.palprec";
  const FrameFormat format = rectified_format();
  int written = 0;
  {
    RecordingWriter writer(path, format, Json::object());
    const test::FileSizeLimit limit(4000);
    try {
      for (; written < 1000; ++written) writer.add_frame(some_frame(format, written), {});
    } catch (const Error& error) {
      CHECK(std::string(error.what()).starts_with(path.string() + ": cannot be written: "));
    }
    CHECK(writer.size() == fs::file_size(path));
  }
  CHECK(written > 1);
  CHECK(written < 1000);
  const RecordingContents contents = read_recording(path).value();
  CHECK(contents.frames == written);
  CHECK_FALSE(contents.damaged);
}

TEST_CASE("pictures that a camera sends in YUYV are played as they were sent, beside others",
          "[sources][recording]") {
  const test::ScratchFolder folder("recorded-yuyv");
  const fs::path file = folder.path() / "a.palprec";
  {
    RecordingWriter writer(file, raw_format(), Json{{"any", 1}});
    writer.add_frame(some_yuyv_frame(0), std::nullopt);
    writer.add_frame(some_frame(raw_format(), 1), std::nullopt);
    writer.add_frame(some_yuyv_frame(2), std::nullopt);
    writer.finish();
  }
  const auto source = value_or_throw(open_recording(file));
  Frame frame;
  for (int n = 0; n < 3; ++n) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(same(frame, n == 1 ? some_frame(raw_format(), 1) : some_yuyv_frame(n)));
    CHECK(wrong_size(frame, source->format()).empty());
  }
  CHECK(source->next(frame) == FrameStatus::kEnd);
}

TEST_CASE("a frame's chunk that is too short, and a changed answer, end a recording there",
          "[sources][recording]") {
  const test::ScratchFolder folder("recorded-short");
  const fs::path file = folder.path() / "a.palprec";
  {
    RecordingWriter writer(file, raw_format(), Json{{"any", 1}});
    writer.add_frame(some_frame(raw_format(), 0), std::nullopt);
    RecordedRefinement refinement{.asked = true, .exact = Eigen::Matrix3Xf::Ones(3, 5)};
    writer.add_refinement(refinement);
    writer.add_state({0, 7, "{}"});
    writer.add_frame(some_frame(raw_format(), 1), std::nullopt);
    writer.finish();
  }
  const std::string whole = test::file_bytes(file);
  const auto chunks = test::chunks_of(whole);
  for (const test::ChunkPlace& chunk : chunks) {
    if (chunk.kind == "EXAC") {
      std::string changed = whole;
      changed[chunk.payload + 9] ^= 1;
      test::write_bytes(file, changed);
      const RecordingContents contents = value_or_throw(read_recording(file));
      CHECK(contents.damaged);
      CHECK(contents.states.empty());
    }
    if (chunk.kind != "FRAM" || chunk.begin != chunks[1].begin) continue;
    for (std::size_t size = 0; size <= 25; ++size) {
      INFO(size << " bytes");
      std::string cut = whole.substr(0, chunk.payload + size);
      const std::uint64_t length = size;
      std::memcpy(cut.data() + chunk.begin + 4, &length, sizeof length);
      test::write_bytes(file, test::with_right_checksums(cut));
      const auto source = value_or_throw(open_recording(file));
      Frame frame;
      CHECK(source->next(frame) == FrameStatus::kUnreadable);
      CHECK(source->next(frame) == FrameStatus::kEnd);
    }
  }
}

}  // namespace
}  // namespace palpable
