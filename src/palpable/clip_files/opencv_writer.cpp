#include "palpable/clip_files/opencv_writer.h"

#include "palpable/base/error.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>

namespace palpable {

std::vector<int> png_of_runs() {
  return {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE};
}

std::vector<int> png_of_repetitions() { return {cv::IMWRITE_PNG_COMPRESSION, 1}; }

void write_image(const std::filesystem::path& path, const cv::Mat& image,
                 const std::vector<int>& settings) {
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, settings);
  } catch (const cv::Exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.err));
  }
  if (!written) throw Error(fmt::format("{}: cannot be written (disk full?)", path.string()));
}

}  // namespace palpable
