#include "palpable/live/sources/film_file.h"

#include "palpable/common/base/whole_file.h"
#include "palpable/live/calibrate/opencv_views.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <system_error>
#include <utility>

namespace palpable {
namespace {

int opencv_turn(FilmTurn turn) {
  if (turn == FilmTurn::kClockwise) return cv::ROTATE_90_CLOCKWISE;
  return turn == FilmTurn::kHalf ? cv::ROTATE_180 : cv::ROTATE_90_COUNTERCLOCKWISE;
}

}  // namespace

std::string FilmFile::open(FilmPose pose) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return "does not exist";
  if (std::string why = why_no_file(path); !why.empty()) return why;
  try {
    // Only these two: OpenCV's other readers interpret a name as a pattern or a camera.
    for (const int reader : {cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG}) {
      if (capture_.open(path.string(), reader)) break;
    }
    if (!capture_.isOpened()) return "is no video that can be decoded";
    // Its own turn has the wrong direction in some versions (opencv/opencv#22088).
    capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    turn = pose == FilmPose::kUpright ? turn_of_film(path) : FilmTurn::kNone;
    width = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    height = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    rate = capture_.get(cv::CAP_PROP_FPS);
    const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (count > 0 && count < 1e8) frames = static_cast<int>(count);
  } catch (const cv::Exception& e) { return "is no video that can be decoded: " + e.err; }
  if (turn == FilmTurn::kClockwise || turn == FilmTurn::kCounterclockwise) std::swap(width, height);
  if (!(rate > 0 && rate < 10000)) rate = 0;
  if (width < 1 || height < 1) return "has no picture size";
  return {};
}

bool FilmFile::next(ColorImage& image) {
  try {
    if (!capture_.read(decoded_) || decoded_.type() != CV_8UC3) return false;
    if (turn != FilmTurn::kNone) cv::rotate(decoded_, turned_, opencv_turn(turn));
    const cv::Mat& upright = turn == FilmTurn::kNone ? decoded_ : turned_;
    image.resize(upright.cols, upright.rows);
    cv::Mat target = view(image);
    cv::cvtColor(upright, target, cv::COLOR_BGR2RGB);
    return true;
  } catch (const cv::Exception&) { return false; }  // damaged from here on
}

bool FilmFile::skip() {
  try {
    return capture_.grab();
  } catch (const cv::Exception&) { return false; }
}

double FilmFile::time() const {
  constexpr double kMillisecond = 1e-3;  // s
  return kMillisecond * capture_.get(cv::CAP_PROP_POS_MSEC);
}

}  // namespace palpable
