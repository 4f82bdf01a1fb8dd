#include "palpable/live/sources/image_file.h"

#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/sources/jpeg_size.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kLargestImage = 64u << 20;  // px
constexpr std::uint64_t kLargestFile = 512u << 20;  // bytes

struct SizeInHeader {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

bool starts_with(const Bytes& bytes, std::string_view start) {
  return bytes.size() >= start.size() && std::memcmp(bytes.data(), start.data(), start.size()) == 0;
}

// Whether the first bytes are those of a format listed in folder_source.h. OpenCV supports many
// more and passes unknown files to GDAL, which would try about a hundred formats on a broken file.
bool is_known_format(const Bytes& bytes) {
  for (const std::string_view start :
       {std::string_view("\x89PNG\r\n\x1a\n"), std::string_view("\xff\xd8"), std::string_view("BM"),
        std::string_view("II*\0", 4), std::string_view("MM\0*", 4)}) {
    if (starts_with(bytes, start)) return true;
  }
  // PBM, PGM, PPM
  return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6';
}

// The end mark is searched in the last kilobyte, because some writers append padding.
bool ends_with_mark(const Bytes& bytes, std::string_view mark) {
  const auto tail = bytes.end() - std::min<std::ptrdiff_t>(1024, std::ssize(bytes));
  return std::search(tail, bytes.end(), mark.begin(), mark.end(), [](std::uint8_t a, char b) {
           return a == static_cast<std::uint8_t>(b);
         }) != bytes.end();
}

std::uint64_t big_endian(const Bytes& bytes, std::size_t at, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

// What is wrong with a file according to its first and last bytes, before it is decoded;
// empty if nothing.
std::string why_no_image(const Bytes& bytes) {
  if (!is_known_format(bytes)) return "is no image";
  std::optional<SizeInHeader> size;
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n")) {
    if (bytes.size() < 33 || !ends_with_mark(bytes, "IEND")) return "is cut off";
    size = {big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
  } else if (starts_with(bytes, "\xff\xd8")) {
    if (!ends_with_mark(bytes, "\xff\xd9")) return "is cut off";
    const std::optional<JpegSize> declared = jpeg_size(bytes.data(), bytes.size());
    if (!declared) return "is damaged";
    size = {declared->width, declared->height};
  }
  if (size &&
      (size->width == 0 || size->height == 0 || size->width * size->height > kLargestImage)) {
    return fmt::format("says it has {} x {} pixels", size->width, size->height);
  }
  return {};
}

}  // namespace

struct ImageFileReader::Buffers {
  Bytes bytes;
  cv::Mat decoded;

  // Fills `decoded`. Returns an empty string, or why that failed.
  std::string decode(const std::filesystem::path& path, int flags) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) return "cannot be read (" + error.message() + ")";
    if (size > kLargestFile) return "is larger than 512 MB";
    if (size == 0) return "is empty";
    bytes.resize(size);
    std::ifstream in(path, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) return "cannot be read";
    const std::string wrong = why_no_image(bytes);
    if (!wrong.empty()) return wrong;
    // Emptied first: given bytes that are not an image, imdecode leaves the previous
    // picture in place.
    decoded.release();
    try {
      decoded = cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION, &decoded);
    } catch (const std::exception&) {  // including cv::Exception
      decoded.release();
    }
    return decoded.empty() ? "is damaged" : "";
  }
};

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
  if (wrong.empty() && decoded.type() != CV_16UC1) {
    wrong = fmt::format("is not a 16-bit gray image ({} bit, {} channels)", 8 * decoded.elemSize1(),
                        decoded.channels());
  }
  if (!wrong.empty()) return Problem{fmt::format("image {} {}", path.string(), wrong)};
  image.resize(decoded.cols, decoded.rows);
  for (int y = 0; y < decoded.rows; ++y) {
    std::memcpy(image.row(y), decoded.ptr(y), sizeof(std::uint16_t) * decoded.cols);
  }
  return true;
}

}  // namespace palpable
