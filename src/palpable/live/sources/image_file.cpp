#include "palpable/live/sources/image_file.h"

#include "palpable/common/base/whole_file.h"
#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/sources/exr_header.h"
#include "palpable/live/sources/image_header.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace palpable {
namespace {

// The reason as the end of "image FILE ...".
std::string why_not_read(const std::string& reason) {
  const bool is_clause =
      reason.starts_with("is ") || reason.starts_with("says ") || reason.starts_with("cannot ");
  return is_clause ? reason : "cannot be read: " + reason;
}

}  // namespace

struct ImageFileReader::Buffers {
  cv::Mat decoded;

  // Fills `decoded`. Returns an empty string, or why that failed.
  std::string decode(const std::filesystem::path& path, int flags) {
    Result<std::string> read =
        read_whole_file(path, {.most = kLargestImageFile, .why_not = why_no_image});
    if (!read) return why_not_read(read.problem().message);
    std::string& bytes = read.value();
    const std::string wrong = why_no_image(bytes, bytes.size());
    if (!wrong.empty()) return wrong;
    // Emptied first: given bytes that are not an image, imdecode leaves the previous
    // picture in place.
    decoded.release();
    try {
      const cv::Mat row(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
      decoded = cv::imdecode(row, flags | cv::IMREAD_IGNORE_ORIENTATION, &decoded);
    } catch (const std::exception&) {  // including cv::Exception
      decoded.release();
    }
    return decoded.empty() ? "is damaged" : "";
  }

  // The same for an OpenEXR file of one channel.
  std::string decode_exr(const std::filesystem::path& path) {
    Result<std::string> read = read_whole_file(path, {.most = kLargestImageFile});
    if (!read) return why_not_read(read.problem().message);
    std::string& bytes = read.value();
    if (std::string wrong = prepare_exr(bytes); !wrong.empty()) return wrong;
    decoded.release();
    try {
      const cv::Mat row(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
      decoded = cv::imdecode(row, cv::IMREAD_UNCHANGED, &decoded);
    } catch (const cv::Exception& e) {
      decoded.release();
      if (e.err.find("disabled") != std::string::npos) {
        return "is an OpenEXR file, which this OpenCV reads only with OPENCV_IO_ENABLE_OPENEXR=1 "
               "in the environment";
      }
    } catch (const std::exception&) { decoded.release(); }
    if (decoded.empty()) return "is damaged";
    return decoded.type() == CV_32FC1 ? "" : "is no image of floats of one channel";
  }
};

namespace {

std::string why_no_depth(const cv::Mat& decoded) {
  const std::size_t bits = 8 * decoded.elemSize1();
  if (decoded.channels() > 1 || bits == 8) {
    return fmt::format(
        "is not a 16-bit gray image ({} bit, {} channels); depth in 8 bits or in colours is for "
        "looking at only",
        bits, decoded.channels());
  }
  const bool is_real = decoded.depth() == CV_32F || decoded.depth() == CV_64F;
  return fmt::format(
      "has {} numbers of {} bits; write depths as unsigned 16-bit numbers, such as "
      "millimetres",
      is_real ? "floating" : "signed", bits);
}

}  // namespace

ImageFileReader::ImageFileReader() : buffers_(std::make_unique<Buffers>()) {}
ImageFileReader::~ImageFileReader() = default;

Result<bool> ImageFileReader::read_color(const std::filesystem::path& path, ColorImage& image) {
  std::string wrong = buffers_->decode(path, cv::IMREAD_COLOR);
  const cv::Mat& decoded = buffers_->decoded;
  if (wrong.empty() && decoded.type() != CV_8UC3) wrong = "is not an 8-bit image";
  if (!wrong.empty()) return Problem{fmt::format("image {} {}", path.string(), wrong)};
  image.resize(decoded.cols, decoded.rows);
  cv::Mat target = view(image);
  cv::cvtColor(decoded, target, cv::COLOR_BGR2RGB);
  return true;
}

Result<bool> ImageFileReader::read_16bit(const std::filesystem::path& path,
                                         Image<std::uint16_t>& image) {
  std::string wrong = buffers_->decode(path, cv::IMREAD_UNCHANGED);
  const cv::Mat& decoded = buffers_->decoded;
  if (wrong.empty() && decoded.type() != CV_16UC1) wrong = why_no_depth(decoded);
  if (!wrong.empty()) return Problem{fmt::format("image {} {}", path.string(), wrong)};
  image.resize(decoded.cols, decoded.rows);
  for (int y = 0; y < decoded.rows; ++y) {
    std::memcpy(image.row(y), decoded.ptr(y), sizeof(std::uint16_t) * decoded.cols);
  }
  return true;
}

Result<bool> ImageFileReader::read_8bit(const std::filesystem::path& path, MaskImage& image) {
  std::string wrong = buffers_->decode(path, cv::IMREAD_UNCHANGED);
  const cv::Mat& decoded = buffers_->decoded;
  if (wrong.empty() && decoded.type() != CV_8UC1) wrong = "is not an 8-bit gray image";
  if (!wrong.empty()) return Problem{fmt::format("image {} {}", path.string(), wrong)};
  image.resize(decoded.cols, decoded.rows);
  for (int y = 0; y < decoded.rows; ++y) std::memcpy(image.row(y), decoded.ptr(y), decoded.cols);
  return true;
}

Result<bool> ImageFileReader::read_metres(const std::filesystem::path& path, DepthImage& image) {
  const std::string wrong = buffers_->decode_exr(path);
  const cv::Mat& decoded = buffers_->decoded;
  if (!wrong.empty()) return Problem{fmt::format("image {} {}", path.string(), wrong)};
  image.resize(decoded.cols, decoded.rows);
  for (int y = 0; y < decoded.rows; ++y) {
    const auto* row = decoded.ptr<float>(y);
    std::transform(row, row + decoded.cols, image.row(y), [](float Z) {
      return Z > 0 && std::isfinite(Z) ? Z : std::numeric_limits<float>::quiet_NaN();
    });
  }
  return true;
}

}  // namespace palpable
