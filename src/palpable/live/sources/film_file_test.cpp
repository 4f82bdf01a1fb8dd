#include "palpable/live/sources/film_file.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/video_file_source.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

// Two eyes side by side: the left one bright below, the right one bright above.
cv::Mat two_eyes(int width, int height) {
  cv::Mat image(height, width, CV_8UC3, cv::Scalar::all(40));
  image(cv::Rect(0, height / 2, width / 2, height - height / 2)).setTo(cv::Scalar::all(200));
  image(cv::Rect(width / 2, 0, width - width / 2, height / 2)).setTo(cv::Scalar::all(120));
  return image;
}

void write_mp4(const fs::path& path, const cv::Mat& picture) {
  cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                         20, picture.size());
  REQUIRE(writer.isOpened());
  for (int i = 0; i < 4; ++i) writer.write(picture);
}

// Writes the first four numbers of the track header's matrix: a film of one track.
void set_matrix(const fs::path& path, const std::array<int, 4>& abcd) {
  std::string bytes = test::file_bytes(path);
  const std::size_t matrix = bytes.find("tkhd") + 4 + 40;
  constexpr std::array<std::size_t, 4> kPlaces{0, 4, 12, 16};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = static_cast<std::uint32_t>(abcd[i]) << 16;
    for (std::size_t k = 0; k < 4; ++k) {
      bytes.at(matrix + kPlaces[i] + k) = static_cast<char>(value >> (24 - 8 * k) & 0xff);
    }
  }
  test::write_bytes(path, bytes);
}

bool is_near(const Rgb& pixel, int level) {
  return std::abs(pixel.g - level) <= 6;  // MPEG-4's loss within an area of one colour
}

TEST_CASE("a film that a phone has held upright is played upright", "[sources][video][turn]") {
  const ScratchFolder folder("film_turn");
  constexpr int kEye = 64, kHeight = 48;
  const cv::Mat upright = two_eyes(2 * kEye, kHeight);
  write_rectified_calibration(folder / "clip.yml",
                              {{{kEye, kHeight, 60, 60, 32, 24}, 0.06, 0}, 30});
  struct Case {
    std::array<int, 4> abcd;  // x' = a x + c y, y' = b x + d y: with b = 1 right becomes down
    int filmed;               // how the camera lay: cv::rotate of the upright picture; -1: upright
    FilmTurn turn;
  };
  for (const Case& c : {Case{{1, 0, 0, 1}, -1, FilmTurn::kNone},
                        Case{{0, 1, -1, 0}, cv::ROTATE_90_COUNTERCLOCKWISE, FilmTurn::kClockwise},
                        Case{{0, -1, 1, 0}, cv::ROTATE_90_CLOCKWISE, FilmTurn::kCounterclockwise},
                        Case{{-1, 0, 0, -1}, cv::ROTATE_180, FilmTurn::kHalf}}) {
    INFO(turn_text(c.turn));
    cv::Mat filmed = upright;
    if (c.filmed >= 0) cv::rotate(upright, filmed, c.filmed);
    write_mp4(folder / "clip.mp4", filmed);
    set_matrix(folder / "clip.mp4", c.abcd);
    CHECK(turn_of_film(folder / "clip.mp4") == c.turn);
    const auto source = value_or_throw(open_video(folder / "clip.mp4", ""));
    const std::vector<std::string> notes = source->take_notes();
    CHECK(notes.size() == (c.turn == FilmTurn::kNone ? 0 : 1));
    if (!notes.empty()) CHECK(notes[0].find(turn_text(c.turn)) != std::string::npos);
    Frame frame;
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    REQUIRE(frame.left.width() == kEye);
    REQUIRE(frame.left.height() == kHeight);
    CHECK(is_near(frame.left(10, 8), 40));
    CHECK(is_near(frame.left(10, 40), 200));
    CHECK(is_near(frame.right(50, 8), 120));
    CHECK(is_near(frame.right(50, 40), 40));
    // A folder with depth takes it as the sensor lies.
    FilmFile raw;
    raw.path = folder / "clip.mp4";
    REQUIRE(raw.open(FilmPose::kAsFilmed).empty());
    CHECK(raw.width == filmed.cols);
    ColorImage picture;
    REQUIRE(raw.next(picture));
    CHECK(picture.height() == filmed.rows);
  }
}

TEST_CASE("the turn of other, mirrored and damaged films is none", "[sources][video][turn]") {
  const ScratchFolder folder("film_turn_none");
  CHECK(turn_of_film(folder / "none.mp4") == FilmTurn::kNone);
  CHECK(turn_of_film(folder.path()) == FilmTurn::kNone);
  write_mp4(folder / "clip.mp4", two_eyes(128, 48));
  set_matrix(folder / "clip.mp4", {-1, 0, 0, 1});
  CHECK(turn_of_film(folder / "clip.mp4") == FilmTurn::kNone);
  set_matrix(folder / "clip.mp4", {0, 1, -1, 0});
  CHECK(turn_of_film(folder / "clip.mp4") == FilmTurn::kClockwise);
  const std::string bytes = test::file_bytes(folder / "clip.mp4");
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    test::write_bytes(folder / "cut.mp4", bytes.substr(0, size));
    // The box that holds the turn is the last one of the file.
    CHECK(turn_of_film(folder / "cut.mp4") == FilmTurn::kNone);
  }
  // Boxes of size 0 and of the largest size end the search.
  for (const char c : {'\0', '\xff'}) {
    std::string bad = bytes;
    const std::size_t movie = bad.find("moov");
    for (std::size_t k = 4; k < 12; ++k) bad[movie + k] = c;
    test::write_bytes(folder / "bad.mp4", bad);
    CHECK(turn_of_film(folder / "bad.mp4") == FilmTurn::kNone);
  }
}

TEST_CASE("two eyes of an odd width are parted at the middle column", "[sources][video]") {
  const ScratchFolder folder("film_854");
  constexpr int kEye = 427;
  for (const int height : {240, 480}) {  // 480: squeezed, which only the calibration tells
    INFO("height " << height);
    write_mp4(folder / "clip.mp4", two_eyes(2 * kEye, height));
    write_rectified_calibration(folder / "clip.yml",
                                {{{kEye, height, 400, 400, 213, height / 2.0}, 0.06, 0}, 30});
    const auto source = value_or_throw(open_video(folder / "clip.mp4", ""));
    Frame frame;
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    REQUIRE(frame.left.width() == kEye);
    REQUIRE(frame.right.width() == kEye);
    CHECK(is_near(frame.left(0, height - 9), 200));
    CHECK(is_near(frame.left(kEye - 12, height - 9), 200));
    CHECK(is_near(frame.left(kEye - 12, 8), 40));
    CHECK(is_near(frame.right(12, 8), 120));
    CHECK(is_near(frame.right(kEye - 1, 8), 120));
    CHECK(is_near(frame.right(12, height - 9), 40));
  }
}

}  // namespace
}  // namespace palpable
