#include "palpable/live/player/recorder.h"

#include "palpable/live/player/live_loop.h"
#include "palpable/live/sources/paced_source.h"
#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/full_disk.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <atomic>
#include <fcntl.h>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::Act;
using test::Shows;
namespace fs = std::filesystem;

// A run with a sphere of radius 5 cm; in a room it stands beside the tracked features.
LiveRun run_on(std::unique_ptr<FrameSource> source, bool room, int threads = 2) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  pose.translation() = Eigen::Vector3d(room ? 0.06 : 0, 0.05, 0.4);
  SessionSettings settings{.press_static = !room, .track = room, .map = room};
  settings.depth.threads = threads;
  std::vector<PlacedBody> bodies;
  bodies.push_back({test::DentedSphere{}.body(), pose});
  return run_of(std::move(bodies), std::move(source), settings, "a test's source");
}

// All malfunctions of a camera, and a jump of its clock that is accepted because of a
// stall before it.
std::vector<Act> all_acts(bool stereo) {
  std::vector<Act> acts(test::MisbehavingCamera::kAlone, Act::kGood);
  for (const Act bad : {Act::kStall, Act::kDrop, Act::kResize, Act::kGarbage, Act::kNoTime,
                        stereo ? Act::kRightResize : Act::kNoDepth, Act::kBackInTime, Act::kGone,
                        Act::kFarFuture}) {
    acts.insert(acts.end(), 3, bad);
    acts.insert(acts.end(), 3, Act::kGood);
  }
  acts.push_back(Act::kStall);
  acts.push_back(Act::kLateClock);
  acts.insert(acts.end(), 4, Act::kGood);
  acts.push_back(Act::kNewClock);
  acts.insert(acts.end(), 12, Act::kGood);
  return acts;
}

struct Answered {
  std::vector<RecordedState> states;
  LiveCounts counts;
};

Answered play(LiveRun& run, int frames = -1, Recorder* recorder = nullptr) {
  Answered answered;
  LiveLoop loop(run, frames);
  while (!loop.ended()) {
    const Scene* scene = loop.next_within(0.001);
    if (scene == nullptr) continue;
    answered.states.push_back({scene->number, state_hash(*scene)});
    if (recorder != nullptr) recorder->add_state(scene->number, state_hash(*scene), "a line");
  }
  answered.counts = loop.counts();
  return answered;
}

std::vector<std::uint64_t> hashes(const std::vector<RecordedState>& states) {
  std::vector<std::uint64_t> list;
  for (const RecordedState& state : states) list.push_back(state.hash);
  return list;
}

std::vector<std::string> sorted(std::vector<std::string> lines) {
  std::sort(lines.begin(), lines.end());
  return lines;
}

TEST_CASE("a replay has the states of the live run, on one thread and on eight, at any pace",
          "[player][threads][recording]") {
  const test::ScratchFolder folder("replay");
  const fs::path file = folder / "a.palprec";
  for (const Shows shows : {Shows::kFinger, Shows::kRoom, Shows::kStereoRoom}) {
    INFO("shows " << static_cast<int>(shows));
    const bool room = shows != Shows::kFinger;
    auto camera =
        std::make_unique<test::MisbehavingCamera>(all_acts(shows == Shows::kStereoRoom), shows);
    Recorder recorder(file, camera->format(), Json::object());
    LiveRun run = run_on(recorded(std::move(camera), recorder), room);
    const Answered live = play(run, -1, &recorder);
    const RecorderCounts counts = recorder.finish();
    CHECK_FALSE(recorder.take_trouble());
    CHECK(counts.bytes == fs::file_size(file));
    CHECK(counts.states.count() == static_cast<int>(live.states.size()));
    CHECK(live.states.size() > 40);

    const RecordingContents contents = read_recording(file).value();
    CHECK(contents.finished);
    CHECK(contents.frames == counts.frames);
    CHECK(hashes(contents.states) == hashes(live.states));
    CHECK(contents.states.back().line == "a line");
    // Only stereo pairs are matched with several threads.
    const bool pairs = shows == Shows::kStereoRoom;
    for (const int threads : pairs ? std::vector{1, 2, 8} : std::vector{2}) {
      INFO(threads << " threads");
      auto source = value_or_throw(open_recording(file));
      if (!room) source = paced(std::move(source), system_clock(), Late::kKept);
      LiveRun again = run_on(std::move(source), room, threads);
      const Answered replayed = play(again);
      CHECK(hashes(replayed.states) == hashes(live.states));
      CHECK(replayed.counts.processed == live.counts.processed);
      CHECK(replayed.counts.troubles.unreadable == live.counts.troubles.unreadable);
      CHECK(replayed.counts.troubles.back_in_time == live.counts.troubles.back_in_time);
      CHECK(replayed.counts.troubles.dropped == live.counts.troubles.dropped);
      CHECK(replayed.counts.troubles.stalls == live.counts.troubles.stalls);
      CHECK(replayed.counts.troubles.losses == live.counts.troubles.losses);
      // What the source's thread reports may come before or after what the loop says of the
      // same frames.
      CHECK(sorted(replayed.counts.reports) == sorted(live.counts.reports));
    }
  }
}

TEST_CASE("a run that ends before its source does is replayed up to its last answer",
          "[player][threads][recording]") {
  const test::ScratchFolder folder("ended");
  const fs::path file = folder / "a.palprec";
  auto camera = std::make_unique<test::MisbehavingCamera>(std::vector<Act>(40, Act::kGood));
  Recorder recorder(file, camera->format(), Json::object());
  LiveRun run = run_on(recorded(std::move(camera), recorder), false);
  const Answered live = play(run, 20, &recorder);
  static_cast<void>(recorder.finish());
  const RecordingContents contents = read_recording(file).value();
  REQUIRE(contents.states.size() == 20);
  CHECK(contents.frames >= 20);
  LiveRun again = run_on(value_or_throw(open_recording(file)), false);
  CHECK(hashes(play(again, 20).states) == hashes(live.states));
}

// A camera with noise pictures, which are incompressible: 80 kB each.
class NoiseSource final : public FrameSource {
 public:
  NoiseSource(int frames, bool live) : frames_(frames), live_(live) {
    format_.kind = FrameFormat::Kind::kColorDepth;
    format_.width = 161;
    format_.height = 121;
    format_.depth_camera = {161, 121, 250, 250, 80, 60};
  }
  const FrameFormat& format() const override { return format_; }
  FrameStatus next(Frame& frame) override {
    if (number_ == frames_) return FrameStatus::kEnd;
    frame.number = number_++;
    frame.time = frame.number / 30.0;
    auto random = test::random_case(static_cast<unsigned>(frame.number));
    frame.left.resize(161, 121);
    for (Rgb& pixel : frame.left) {
      const auto bits = random();
      pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
               static_cast<std::uint8_t>(bits >> 16)};
    }
    frame.depth = DepthImage(161, 121, 0.5F);
    return FrameStatus::kFrame;
  }
  int frame_count() const override { return -1; }
  std::string last_trouble() const override { return {}; }
  bool is_live() const override { return live_; }

 private:
  FrameFormat format_;
  int frames_, number_ = 0;
  bool live_;
};

// A disk that blocks until go_on(): a pipe that is not read before.
class StuckDisk {
 public:
  explicit StuckDisk(fs::path pipe) : pipe_(std::move(pipe)) {
    REQUIRE(::mkfifo(pipe_.c_str(), 0600) == 0);
    descriptor_ = ::open(pipe_.c_str(), O_RDONLY | O_NONBLOCK);
    REQUIRE(descriptor_ >= 0);
  }
  StuckDisk(const StuckDisk&) = delete;
  StuckDisk& operator=(const StuckDisk&) = delete;
  ~StuckDisk() {
    if (thread_.joinable()) thread_.join();
    ::close(descriptor_);
  }
  void go_on() {
    ::fcntl(descriptor_, F_SETFL, 0);
    thread_ = std::thread([this] {
      std::string piece(4096, '\0');
      for (ssize_t got = 1; got > 0;) {
        got = ::read(descriptor_, piece.data(), piece.size());
        if (got > 0) bytes_.append(piece, 0, static_cast<std::size_t>(got));
      }
    });
  }
  // The written bytes; waits for the end.
  std::string bytes() {
    thread_.join();
    return bytes_;
  }

 private:
  fs::path pipe_;
  int descriptor_ = -1;
  std::thread thread_;
  std::string bytes_;
};

TEST_CASE("what the disk has no time for, the loop of a camera does not get either",
          "[player][threads][recording]") {
  const test::ScratchFolder folder("behind");
  StuckDisk disk(folder / "pipe");
  std::vector<int> given;
  RecorderCounts counts;
  {
    auto camera = std::make_unique<NoiseSource>(60, true);
    Recorder recorder(folder / "pipe", camera->format(), Json::object());
    const auto source = recorded(std::move(camera), recorder);
    CHECK(source->is_live());
    Frame frame;
    for (int calls = 0; calls < 60; ++calls) {
      const FrameStatus status = source->next(frame);
      if (status == FrameStatus::kFrame) given.push_back(frame.number);
      if (status != FrameStatus::kFrame) CHECK(status == FrameStatus::kWaiting);
    }
    CHECK(given.size() >= Recorder::kFrames);
    CHECK(given.size() <= Recorder::kFrames + 2);  // one being written, one in the pipe
    disk.go_on();
    counts = recorder.finish();
  }
  CHECK(counts.frames == static_cast<int>(given.size()));
  CHECK(counts.left_out == 60 - counts.frames);
  const fs::path file = folder / "a.palprec";
  test::write_bytes(file, disk.bytes());
  const auto source = value_or_throw(open_recording(file));
  Frame frame;
  std::vector<int> played;
  while (source->next(frame) == FrameStatus::kFrame) played.push_back(frame.number);
  CHECK(played == given);
}

TEST_CASE("a source that waits for its reader waits for the disk", "[player][threads][recording]") {
  const test::ScratchFolder folder("waits");
  StuckDisk disk(folder / "pipe");
  RecorderCounts counts;
  {
    auto film = std::make_unique<NoiseSource>(20, false);
    Recorder recorder(folder / "pipe", film->format(), Json::object());
    const auto source = recorded(std::move(film), recorder);
    CHECK_FALSE(source->is_live());
    std::atomic<int> given = 0;
    std::thread reader([&] {
      Frame frame;
      while (source->next(frame) == FrameStatus::kFrame) ++given;
    });
    while (given < static_cast<int>(Recorder::kFrames)) std::this_thread::yield();
    CHECK(given <= static_cast<int>(Recorder::kFrames) + 2);
    disk.go_on();
    reader.join();
    CHECK(given == 20);
    counts = recorder.finish();
  }
  CHECK(counts.frames == 20);
  CHECK(counts.left_out == 0);
}

TEST_CASE("on a full disk the run goes on, is told once, and what is there replays",
          "[player][threads][recording][errors]") {
  const test::ScratchFolder folder("full_recording");
  const fs::path file = folder / "a.palprec";
  auto camera = std::make_unique<test::MisbehavingCamera>(std::vector<Act>(40, Act::kGood));
  Recorder recorder(file, camera->format(), Json::object());
  LiveRun run = run_on(recorded(std::move(camera), recorder), false);
  RecorderCounts counts;
  Answered live;
  {
    const test::FileSizeLimit limit(20'000);
    live = play(run, -1, &recorder);
    counts = recorder.finish();
  }
  const auto trouble = recorder.take_trouble();
  REQUIRE(trouble);
  CHECK(trouble->starts_with(file.string() + ": cannot be written: "));
  CHECK(trouble->find("the run goes on") < trouble->size());
  CHECK_FALSE(recorder.take_trouble());
  CHECK(live.states.size() > 30);  // including frames dropped before the recorder knew
  const RecordingContents contents = read_recording(file).value();
  CHECK_FALSE(contents.finished);
  CHECK_FALSE(contents.damaged);
  CHECK(contents.frames == counts.frames);
  CHECK(contents.frames > 1);
  CHECK(contents.frames < static_cast<int>(live.states.size()));
  CHECK(static_cast<int>(contents.states.size()) == counts.states.count());
  LiveRun again = run_on(value_or_throw(open_recording(file)), false);
  StateComparison comparison(contents.states);
  for (const RecordedState& state : play(again).states) comparison.add(state.number, state.hash);
  CHECK(comparison.compared() == comparison.expected());
  CHECK_FALSE(comparison.first_different());
}

TEST_CASE("a recording that somebody removes, replaces or cuts off is lost, and that is said",
          "[player][recording][errors]") {
  const test::ScratchFolder folder("lost");
  const fs::path file = folder / "a.palprec";
  const auto record = [&](int frames, const std::function<void()>& meanwhile) {
    auto film = std::make_unique<NoiseSource>(frames, false);
    Recorder recorder(file, film->format(), Json::object());
    Frame frame;
    for (int k = 0; film->next(frame) == FrameStatus::kFrame; ++k) {
      recorder.add_frame(frame, {}, true);
      recorder.add_state(k, static_cast<std::uint64_t>(k), "a line");
    }
    meanwhile();
    return recorder.finish();
  };
  const RecorderCounts counts = record(5, [] {});
  CHECK(lost_of_recording(file, counts).empty());
  const std::string whole = test::file_bytes(file);
  record(7, [] {});
  const std::string other = test::file_bytes(file);
  const auto lost = [&](const std::function<void()>& meanwhile) {
    const std::string why = lost_of_recording(file, record(5, meanwhile));
    CHECK_THAT(why, Catch::Contains("5 frames were written to " + file.string() + ", which was"));
    return why;
  };
  CHECK_THAT(lost([&] { fs::remove(file); }), Catch::Contains("No such file"));
  lost([&] {
    fs::remove(file);
    test::write_bytes(file, other);
  });
  CHECK(test::file_bytes(file) == other);
  fs::remove(file);
  CHECK_FALSE(lost_of_recording(file, counts).empty());
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{40}, whole.size() / 2, whole.size() - 1}) {
    test::write_bytes(file, whole.substr(0, size));
    INFO(size);
    CHECK_FALSE(lost_of_recording(file, counts).empty());
  }
  // A run that ends before its first frame replaces nothing.
  test::write_bytes(file, whole);
  {
    NoiseSource film(5, false);
    Recorder recorder(file, film.format(), Json::object());
    recorder.add_unreadable(0, "garbage", true);
  }
  CHECK(test::file_bytes(file) == whole);
  // What follows is written behind the hole.
  fs::remove(file);
  lost([&] {
    while (fs::file_size(file) < 1000) std::this_thread::yield();
    fs::resize_file(file, 100);
  });
}

TEST_CASE("recording takes no memory once it runs", "[player][recording]") {
  const test::ScratchFolder folder("steady");
  auto film = std::make_unique<NoiseSource>(200, false);
  Recorder recorder(folder / "a.palprec", film->format(), Json::object());
  Frame frame;
  REQUIRE(film->next(frame) == FrameStatus::kFrame);
  const std::string line(300, 'x');
  const auto record = [&](int count) {
    for (int k = 0; k < count; ++k) {
      recorder.add_frame(frame, {}, true);
      recorder.add_state(k, 1, line);
    }
  };
  record(200);  // every item has been used once
  CHECK(test::allocations_during([&] { record(50); }) == 0);
}

TEST_CASE("a source whose recording is finished goes on unrecorded, and can be recorded again",
          "[player][threads][recording]") {
  const test::ScratchFolder folder("twice");
  const std::vector<Act> acts(40, Act::kGood);
  std::unique_ptr<FrameSource> source = std::make_unique<test::MisbehavingCamera>(acts);
  const FrameFormat format = source->format();
  Frame frame;
  int number = 0;
  for (const char* name : {"one.palprec", "two.palprec"}) {
    Recorder recorder(folder.path() / name, format, Json::object());
    source = recorded(std::move(source), recorder);
    for (int k = 0; k < 5; ++k, ++number) {
      REQUIRE(source->next(frame) == FrameStatus::kFrame);
      CHECK(frame.number == number);
    }
    CHECK(recorder.finish().frames == 5);
    // More frames than the recorder has room for.
    for (std::size_t k = 0; k < 2 * Recorder::kFrames; ++k, ++number) {
      REQUIRE(source->next(frame) == FrameStatus::kFrame);
      CHECK(frame.number == number);
    }
    CHECK(value_or_throw(read_recording(folder.path() / name)).frames == 5);
    source = unrecorded(std::move(source));
  }
}

}  // namespace
}  // namespace palpable
