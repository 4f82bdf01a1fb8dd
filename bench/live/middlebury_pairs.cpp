#include "bench/live/middlebury_pairs.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable::app {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

cv::Mat read_gray(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  return cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
}

GrayImage image_of(const cv::Mat& mat) {
  GrayImage image(mat.cols, mat.rows);
  for (int y = 0; y < mat.rows; ++y) std::copy_n(mat.ptr<std::uint8_t>(y), mat.cols, image.row(y));
  return image;
}

// Steps per px of the published disparities: 16 for tsukuba, 4 for the other sets of 2003, 2 for
// the half-size sets of 2006.
double steps_of(const std::filesystem::path& folder) {
  return folder.filename() == "tsukuba" ? 16 : 4;
}
constexpr double kSteps2006 = 2;

}  // namespace

std::optional<MiddleburyPair> read_middlebury_pair(const std::filesystem::path& folder) {
  const bool is_2006 = std::filesystem::exists(folder / "view1.png");
  const cv::Mat left = read_gray(folder / (is_2006 ? "view1.png" : "imL.png"));
  const cv::Mat right = read_gray(folder / (is_2006 ? "view5.png" : "imR.png"));
  const cv::Mat truth = read_gray(folder / (is_2006 ? "disp1.png" : "groundtruth.png"));
  const cv::Mat second = read_gray(folder / (is_2006 ? "disp5.png" : "nonocc.png"));
  for (const cv::Mat& other : {right, truth, second}) {
    if (left.empty() || other.size() != left.size()) return std::nullopt;
  }
  MiddleburyPair pair{image_of(left), image_of(right), DepthImage(left.cols, left.rows, kUnknown)};
  const double steps = is_2006 ? kSteps2006 : steps_of(folder);
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      const double d = truth.at<std::uint8_t>(y, x) / steps;
      if (!(d > 0)) continue;
      bool seen = second.at<std::uint8_t>(y, x) == 255;
      if (is_2006) {
        const auto partner = static_cast<int>(std::lround(x - d));
        seen = partner >= 0 && second.at<std::uint8_t>(y, partner) > 0 &&
               std::abs(second.at<std::uint8_t>(y, partner) / steps - d) <= 1;
      }
      if (seen) pair.truth(x, y) = static_cast<float>(d);
    }
  }
  return pair;
}

}  // namespace palpable::app
