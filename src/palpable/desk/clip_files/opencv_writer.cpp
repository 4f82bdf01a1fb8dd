#include "palpable/desk/clip_files/opencv_writer.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>

namespace palpable {

std::vector<int> png_of_runs() { return {cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE}; }

std::vector<int> png_of_repetitions() { return {cv::IMWRITE_PNG_COMPRESSION, 1}; }

void write_image(const std::filesystem::path& path, const cv::Mat& image,
                 const std::vector<int>& settings) {
  // Not cv::imwrite, which ignores errors of closing its file: for a picture smaller than a disk
  // block, closing is the only operation that reports a full disk.
  std::vector<unsigned char> bytes;
  bool encoded = false;
  try {
    encoded = cv::imencode(path.extension().string(), image, bytes, settings);
  } catch (const cv::Exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.err));
  }
  if (!encoded) throw Error(fmt::format("{}: cannot be encoded", path.string()));
  write_whole_file(path,
                   std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace palpable
