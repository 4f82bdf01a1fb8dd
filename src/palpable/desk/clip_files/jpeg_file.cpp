#include "palpable/desk/clip_files/jpeg_file.h"

#include "palpable/desk/clip_files/opencv_writer.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cstdint>
#include <vector>

namespace palpable {
namespace {

const std::vector<int> kSettings{cv::IMWRITE_JPEG_QUALITY, 96};

cv::Mat bgr_of(const ColorImage& picture) {
  static_assert(sizeof(Rgb) == 3, "three bytes without padding, as CV_8UC3 has it");
  // The matrix is only read; cv::Mat has no const view, hence the cast.
  const cv::Mat rgb(picture.height(), picture.width(), CV_8UC3, const_cast<Rgb*>(picture.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

}  // namespace

void write_jpeg(const std::filesystem::path& path, const ColorImage& picture) {
  write_image(path, bgr_of(picture), kSettings);
}

ColorImage through_jpeg(const ColorImage& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr_of(picture), bytes, kSettings);
  const cv::Mat bgr = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ColorImage back(picture.width(), picture.height());
  cv::Mat rgb(back.height(), back.width(), CV_8UC3, back.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return back;
}

}  // namespace palpable
