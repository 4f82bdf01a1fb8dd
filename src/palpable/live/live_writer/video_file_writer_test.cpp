#include "palpable/live/live_writer/video_file_writer.h"

#include "palpable/common/base/error.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64;  // px
constexpr int kHeight = 48;
constexpr double kRate = 20;    // frames per second
constexpr int kPictures = 100;  // more than the encoder holds

// Every picture is brighter than the previous one, so that its grey level identifies it.
std::uint8_t grey_of(int number) { return static_cast<std::uint8_t>(20 + 2 * number); }

ColorImage picture_of(int number) {
  const std::uint8_t grey = grey_of(number);
  return {kWidth, kHeight, Rgb{grey, grey, grey}};
}

// The mean grey of each picture that a player decodes.
std::vector<double> played(const fs::path& film) {
  cv::VideoCapture capture(film.string(), cv::CAP_FFMPEG);
  std::vector<double> greys;
  for (cv::Mat picture; capture.read(picture);) greys.push_back(cv::mean(picture)[1]);
  return greys;
}

// Checks that the film contains the first pictures in their order.
void check_order(const std::vector<double>& greys) {
  for (std::size_t i = 0; i < greys.size(); ++i) {
    INFO("picture " << i);
    CHECK(greys[i] == Approx(grey_of(static_cast<int>(i))).margin(1.5));  // error of the encoder
  }
}

// The top-level boxes of an MP4, e.g. "ftyp moov moof mdat"; a truncated box has '!'.
std::string boxes_of(const std::string& bytes) {
  std::string names;
  for (std::size_t at = 0; at + 8 <= bytes.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
      size = 256 * size + static_cast<unsigned char>(bytes[at + i]);
    if (!names.empty()) names += " ";
    names += bytes.substr(at + 4, 4);
    if (size < 8 || at + size > bytes.size()) return names + "!";
    at += size;
  }
  return names;
}

TEST_CASE("a film that was ended is an ordinary one with all its pictures",
          "[live_writer][video]") {
  const test::ScratchFolder folder("video_ended");
  const fs::path film = folder / "a:b.mp4";  // the colon must not be read as a protocol
  VideoFileWriter writer(film, kWidth + 1, kHeight + 1, kRate);
  CHECK_FALSE(writer.codec().empty());
  for (int i = 0; i < kPictures; ++i) {
    ColorImage odd(kWidth + 1, kHeight + 1, picture_of(i)(0, 0));
    writer.append(odd);
    if (i % 30 == 0) writer.flush();
  }
  writer.close();
  const std::string boxes = boxes_of(test::file_bytes(film));
  CHECK_THAT(boxes, Catch::Contains("moov") && !Catch::Contains("moof") && !Catch::Contains("!"));
  CHECK_FALSE(fs::exists(folder / "a:b.mp4.part"));
  const std::vector<double> greys = played(film);
  CHECK(greys.size() == kPictures);
  check_order(greys);

  cv::VideoCapture capture(film.string(), cv::CAP_FFMPEG);
  CHECK(capture.get(cv::CAP_PROP_FRAME_COUNT) == kPictures);
  CHECK(capture.get(cv::CAP_PROP_FPS) == Approx(kRate));
  CHECK(capture.get(cv::CAP_PROP_FRAME_WIDTH) == kWidth);
  CHECK(capture.get(cv::CAP_PROP_FRAME_HEIGHT) == kHeight);
  for (const int wanted : {70, 13, 99}) {  // seeking
    INFO(wanted);
    cv::Mat picture;
    capture.set(cv::CAP_PROP_POS_FRAMES, wanted);
    REQUIRE(capture.read(picture));
    CHECK(cv::mean(picture)[1] == Approx(grey_of(wanted)).margin(1.5));
  }
}

TEST_CASE("a film whose program was killed plays up to its last flush", "[live_writer][video]") {
  const test::ScratchFolder folder("video_killed");
  VideoFileWriter writer(folder / "film.mp4", kWidth, kHeight, kRate);
  for (int i = 0; i < kPictures; ++i) {
    writer.append(picture_of(i));
    if (i % 10 == 0) writer.flush();
  }
  // The file on the disk now is what a killed program would leave.
  fs::copy_file(folder / "film.mp4", folder / "left.mp4");
  const std::string left = test::file_bytes(folder / "left.mp4");
  CHECK_THAT(boxes_of(left), Catch::StartsWith("ftyp moov moof mdat") && !Catch::Contains("!"));
  const std::vector<double> greys = played(folder / "left.mp4");
  CHECK(greys.size() >= 20);
  check_order(greys);
  cv::VideoCapture capture((folder / "left.mp4").string(), cv::CAP_FFMPEG);
  CHECK(capture.get(cv::CAP_PROP_FRAME_COUNT) == static_cast<double>(greys.size()));
  CHECK(capture.get(cv::CAP_PROP_FPS) == Approx(kRate));

  // Killed while it wrote: the last fragment is truncated anywhere; those before can be played.
  const std::size_t last = left.rfind("moof") - 4;
  test::write_bytes(folder / "before.mp4", left.substr(0, last));
  const std::size_t whole = played(folder / "before.mp4").size();
  CHECK(whole >= 10);
  const std::size_t data = left.rfind("mdat") + 4 - last;
  for (const std::size_t more :
       {std::size_t{1}, std::size_t{60}, data + 1, left.size() - last - 1}) {
    INFO(more);
    test::write_bytes(folder / "cut.mp4", left.substr(0, last + more));
    CHECK(played(folder / "cut.mp4").size() >= whole);
  }
}

TEST_CASE("a film that is given up has the pictures that it was given", "[live_writer][video]") {
  const test::ScratchFolder folder("video_given_up");
  {
    VideoFileWriter writer(folder / "film.mp4", kWidth, kHeight, kRate);
    for (int i = 0; i < kPictures; ++i) writer.append(picture_of(i));
  }
  CHECK(played(folder / "film.mp4").size() == kPictures);
}

TEST_CASE("a film without room for its copy stays in fragments, all of it",
          "[live_writer][video]") {
  const test::ScratchFolder folder("video_no_copy");
  test::write_bytes(folder / "film.mp4.part" / "file", "in the way");
  VideoFileWriter writer(folder / "film.mp4", kWidth, kHeight, kRate);
  for (int i = 0; i < kPictures; ++i) writer.append(picture_of(i));
  writer.close();
  CHECK_THAT(boxes_of(test::file_bytes(folder / "film.mp4")), Catch::Contains("moof"));
  const std::vector<double> greys = played(folder / "film.mp4");
  CHECK(greys.size() == kPictures);
  check_order(greys);
}

TEST_CASE("a film on a full disk says so and keeps what it has", "[live_writer][video][refusal]") {
  const test::ScratchFolder folder("video_full");
  const fs::path film = folder / "film.mp4";
  {
    VideoFileWriter writer(film, kWidth, kHeight, kRate);
    const test::FileSizeLimit limit(3000);
    const auto play = [&] {
      for (int i = 0; i < 10 * kPictures; ++i) {
        writer.append(picture_of(i % kPictures));
        writer.flush();
      }
    };
    CHECK_THROWS_WITH(play(), Catch::Contains("film.mp4: cannot be written: File too large"));
    CHECK_THAT(boxes_of(test::file_bytes(film)),
               Catch::StartsWith("ftyp moov moof mdat") && !Catch::Contains("!"));
  }
  CHECK_THAT(boxes_of(test::file_bytes(film)), !Catch::Contains("!"));
  const std::vector<double> greys = played(film);
  CHECK_FALSE(greys.empty());
  check_order(greys);
  CHECK_THROWS_WITH(VideoFileWriter(folder / "none" / "film.mp4", kWidth, kHeight, kRate),
                    Catch::EndsWith("film.mp4: cannot be written: No such file or directory"));
}

TEST_CASE("a film keeps its pace where pictures were left out", "[live_writer]") {
  const test::ScratchFolder folder("video_gaps");
  const fs::path film = folder / "film.mp4";
  VideoFileWriter writer(film, kWidth, kHeight, kRate);
  // OpenCV does not report the times of the last few pictures.
  constexpr std::size_t kTimed = 10;
  const std::vector<int> after{1, 1, 1, 20, 1, 5, 1, 1, 40, 1, 1, 1, 1, 1, 1};
  std::vector<double> expected;  // s
  for (std::size_t i = 0; i < after.size(); ++i) {
    writer.append(picture_of(static_cast<int>(i)), after[i]);
    expected.push_back(i == 0 ? 0 : expected.back() + after[i] / kRate);
    if (i == 4) writer.flush();
  }
  writer.close();
  cv::VideoCapture capture(film.string(), cv::CAP_FFMPEG);
  std::vector<double> times;
  for (cv::Mat picture; capture.read(picture);) {
    times.push_back(1e-3 * capture.get(cv::CAP_PROP_POS_MSEC));
  }
  REQUIRE(times.size() == after.size());
  for (std::size_t i = 0; i < kTimed; ++i) {
    INFO("picture " << i);
    CHECK(times[i] - times[0] == Approx(expected[i]).margin(1e-3));
  }
}

}  // namespace
}  // namespace palpable
