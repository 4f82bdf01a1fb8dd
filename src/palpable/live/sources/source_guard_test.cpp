#include "palpable/live/sources/source_guard.h"

#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::Act;
using test::MisbehavingCamera;

struct Run {
  std::vector<int> frames;    // numbers of the frames passed on
  std::vector<double> times;  // s
  std::vector<std::string> reports;
  SourceTroubles troubles;
  std::string last_trouble;
};

Run run(const std::vector<Act>& acts, test::Shows shows = test::Shows::kFinger) {
  MisbehavingCamera camera(acts, shows);
  SourceGuard guard(camera);
  Run result;
  Frame frame;
  for (FrameStatus status = guard.next(frame); status != FrameStatus::kEnd;
       status = guard.next(frame)) {
    if (status == FrameStatus::kFrame) {
      result.frames.push_back(frame.number);
      result.times.push_back(frame.time);
      CHECK(frame.left.width() == MisbehavingCamera::kWidth);
      CHECK((shows == test::Shows::kStereoRoom ? frame.right.size() : frame.depth.size()) ==
            frame.left.size());
    }
    for (std::string& line : guard.take_reports()) result.reports.push_back(std::move(line));
  }
  result.troubles = guard.troubles();
  result.last_trouble = guard.last_trouble();
  for (std::size_t i = 1; i < result.times.size(); ++i) {
    CHECK(result.times[i] > result.times[i - 1]);
  }
  return result;
}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("frames that are well pass as they are and nothing is reported", "[sources][guard]") {
  const Run result = run({Act::kGood, Act::kGood, Act::kGood});
  CHECK(result.frames == std::vector<int>{0, 1, 2});
  CHECK(result.times == std::vector<double>{0, 1 / 30.0, 2 / 30.0});
  CHECK(result.reports.empty());
  CHECK(result.troubles.unreadable == 0);
}

TEST_CASE("of a pair both images have to be there, each of its size", "[sources][guard][refusal]") {
  for (const auto& [act, says] :
       {std::pair{Act::kResize, "its left image is 80 x 121 px, not 161 x"},
        std::pair{Act::kRightResize, "its right image is 80 x 121 px"}}) {
    INFO(says);
    const Run result = run({Act::kGood, act, Act::kGood}, test::Shows::kStereoRoom);
    CHECK(result.frames == std::vector<int>{0, 2});
    REQUIRE(result.reports.size() == 2);
    CHECK(result.reports[0] == "the eyes are 60.0 mm apart");
    CHECK(contains(result.reports[1], says));
  }
}

// Returns pictures with both eyes side by side, of these widths in turn.
class SideBySide final : public FrameSource {
 public:
  explicit SideBySide(std::vector<int> pairs) : pairs_(std::move(pairs)) {
    format_.width = 8;
    format_.height = 4;
  }
  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return static_cast<int>(pairs_.size()); }
  std::string last_trouble() const override { return {}; }
  FrameStatus next(Frame& frame) override {
    if (next_ == pairs_.size()) return FrameStatus::kEnd;
    frame.number = static_cast<int>(next_);
    frame.time = frame.number / 30.0;
    frame.both.resize(pairs_[next_++], format_.height);
    return FrameStatus::kFrame;
  }

 private:
  FrameFormat format_;
  std::vector<int> pairs_;
  std::size_t next_ = 0;
};

TEST_CASE("a picture of both eyes passes without any of one, if it has their size",
          "[sources][guard][refusal]") {
  SideBySide camera({8, 6, 8});
  SourceGuard guard(camera);
  Frame frame;
  CHECK(guard.next(frame) == FrameStatus::kFrame);
  CHECK(guard.next(frame) == FrameStatus::kUnreadable);
  CHECK(contains(guard.last_trouble(), "its side-by-side image is 6 x 4 px, not 8 x 4"));
  CHECK(guard.next(frame) == FrameStatus::kFrame);
}

TEST_CASE("a frame that the loop cannot use is left out, counted and explained",
          "[sources][guard][refusal]") {
  struct Case {
    Act act;
    const char* says;
  };
  for (const Case& c : {Case{Act::kResize, "its colour image is 80 x 121 px, not 161 x 121"},
                        Case{Act::kNoDepth, "its depth image is 0 x 0 px"},
                        Case{Act::kGarbage, "the picture is cut off"},
                        Case{Act::kNoise, "depths are negative, 0 or infinite"},
                        Case{Act::kNoTime, "its time is not a number"},
                        Case{Act::kFarFuture, "it is from 1000000.067 s, after one from 0.033 s"},
                        Case{Act::kBackInTime, "it is from -4.933 s, after one from 0.033 s"}}) {
    INFO(c.says);
    const Run result = run({Act::kGood, Act::kGood, c.act, Act::kGood});
    CHECK(result.frames == std::vector<int>{0, 1, 3});
    CHECK(result.troubles.unreadable == 1);
    CHECK(result.troubles.back_in_time == (c.act == Act::kBackInTime ? 1 : 0));
    REQUIRE(result.reports.size() == 1);
    CHECK(contains(result.reports[0], "frame 2 is left out"));
    CHECK(contains(result.reports[0], c.says));
    CHECK(contains(result.last_trouble, c.says));
  }
}

TEST_CASE("a row of bad frames is one report, and the next row another", "[sources][guard]") {
  const Run result = run({Act::kGood, Act::kGarbage, Act::kResize, Act::kGarbage, Act::kGood,
                          Act::kGarbage, Act::kGood});
  CHECK(result.troubles.unreadable == 4);
  CHECK(result.reports.size() == 2);
}

TEST_CASE("numbers that are missing count as dropped", "[sources][guard]") {
  const Run result =
      run({Act::kGood, Act::kDrop, Act::kDrop, Act::kGood, Act::kDrop, Act::kGarbage, Act::kGood});
  CHECK(result.frames == std::vector<int>{0, 3, 6});
  CHECK(result.troubles.dropped == 3);
  CHECK(result.troubles.unreadable == 1);
}

TEST_CASE("a stall, a loss and the return are reported once each", "[sources][guard]") {
  const Run result = run({Act::kGood, Act::kStall, Act::kStall, Act::kGone, Act::kGone, Act::kGood,
                          Act::kStall, Act::kGood});
  CHECK(result.frames == std::vector<int>{0, 1, 2});
  CHECK(result.troubles.stalls == 2);
  CHECK(result.troubles.losses == 1);
  REQUIRE(result.reports.size() == 5);
  CHECK(contains(result.reports[0], "no pictures after frame 0"));
  CHECK(contains(result.reports[1], "the camera is gone after frame 0: no such device"));
  CHECK(contains(result.reports[2], "pictures come again"));
}

TEST_CASE("a clock that begins anew costs a few frames and then goes on", "[sources][guard]") {
  std::vector<Act> acts(10, Act::kGood);
  acts.push_back(Act::kNewClock);
  acts.insert(acts.end(), 9, Act::kGood);
  const Run result = run(acts);
  CHECK(result.troubles.back_in_time == SourceGuard::kClockRestart - 1);
  REQUIRE(result.frames.size() == 20 - (SourceGuard::kClockRestart - 1));
  CHECK(result.frames.back() == 19);
  for (std::size_t i = 11; i < result.times.size(); ++i) {
    CHECK(result.times[i] - result.times[i - 1] == Approx(1 / 30.0));
  }
  REQUIRE(result.reports.size() == 2);
  CHECK(contains(result.reports[1], "clock began anew before frame 14"));
}

TEST_CASE("frames from the far future never move the clock", "[sources][guard]") {
  std::vector<Act> acts;
  for (int i = 0; i < 3 * SourceGuard::kClockRestart; ++i) {
    acts.push_back(Act::kGood);
    acts.push_back(Act::kFarFuture);
  }
  const Run result = run(acts);
  CHECK(result.frames.size() == 3 * SourceGuard::kClockRestart);
  CHECK(result.times.back() == Approx(result.frames.back() / 30.0));
}

TEST_CASE("a recording's gap costs a few frames and leaves the clock's pace as it was",
          "[sources][guard]") {
  std::vector<Act> acts(10, Act::kGood);
  acts.push_back(Act::kLateClock);
  acts.insert(acts.end(), SourceGuard::kClockRestart - 1, Act::kGood);
  acts.push_back(Act::kNewClock);  // its times continue after a period, not after a minute
  acts.insert(acts.end(), 9, Act::kGood);
  const Run result = run(acts);
  const int held = SourceGuard::kClockRestart - 1;
  REQUIRE(result.frames.size() == acts.size() - static_cast<std::size_t>(2 * held));
  CHECK(result.times[10] == Approx(60 + (10 + held) / 30.0));
  CHECK(result.times[11] - result.times[10] == Approx(1 / 30.0));
  CHECK(result.troubles.back_in_time == held);
  REQUIRE(result.reports.size() == 4);
  CHECK(contains(result.reports[1], "clock went on by 60"));
}

TEST_CASE("after a stall pictures may be from any later time", "[sources][guard]") {
  const Run result = run({Act::kGood, Act::kStall, Act::kLateClock, Act::kGood});
  CHECK(result.frames == std::vector<int>{0, 1, 2});
  CHECK(result.times[1] == Approx(60 + 1 / 30.0));
}

TEST_CASE("old frames that come between new ones never move the clock", "[sources][guard]") {
  std::vector<Act> acts;
  for (int i = 0; i < 3 * SourceGuard::kClockRestart; ++i) {
    acts.push_back(Act::kGood);
    acts.push_back(Act::kBackInTime);
  }
  const Run result = run(acts);
  CHECK(result.frames.size() == 3 * SourceGuard::kClockRestart);
  CHECK(result.times.back() == Approx(result.frames.back() / 30.0));
}

TEST_CASE("a clock that stands still is no new clock", "[sources][guard]") {
  std::vector<Act> acts(3, Act::kGood);
  acts.insert(acts.end(), 3 * SourceGuard::kClockRestart, Act::kStuckClock);
  acts.push_back(Act::kGood);
  const Run result = run(acts);
  CHECK(result.troubles.back_in_time == 3 * SourceGuard::kClockRestart);
  CHECK(result.frames == std::vector<int>{0, 1, 2, 3 + 3 * SourceGuard::kClockRestart});
  CHECK(result.reports.size() == 1);
}

TEST_CASE("a camera that fails all day is counted without end but not reported without end",
          "[sources][guard]") {
  std::vector<Act> acts;
  for (int i = 0; i < 300; ++i) {
    acts.push_back(Act::kGood);
    acts.push_back(Act::kGarbage);
  }
  const Run result = run(acts);
  CHECK(result.troubles.unreadable == 300);
  CHECK(result.reports.size() == SourceGuard::kMostReports);

  acts.insert(acts.end(), {Act::kGone, Act::kGood});
  const Run lost = run(acts);
  REQUIRE(lost.reports.size() == SourceGuard::kMostReports + 2);
  CHECK(contains(lost.reports[SourceGuard::kMostReports], "the camera is gone"));
  CHECK(contains(lost.reports.back(), "come again"));
}

}  // namespace
}  // namespace palpable
