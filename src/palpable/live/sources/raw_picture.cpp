#include "palpable/live/sources/raw_picture.h"

#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/sources/jpeg_size.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <limits>
#include <optional>
#include <utility>

namespace palpable {
namespace {

struct ColorFormat {
  std::uint32_t code;
  int type;        // OpenCV's
  int conversion;  // OpenCV's, to RGB; -1: not needed
  int bits;        // per pixel
};

constexpr std::array kColorFormats{
    ColorFormat{four_letters("YUYV"), CV_8UC2, cv::COLOR_YUV2RGB_YUYV, 16},
    ColorFormat{four_letters("UYVY"), CV_8UC2, cv::COLOR_YUV2RGB_UYVY, 16},
    ColorFormat{four_letters("NV12"), CV_8UC1, cv::COLOR_YUV2RGB_NV12, 12},
    ColorFormat{four_letters("GREY"), CV_8UC1, cv::COLOR_GRAY2RGB, 8},
    ColorFormat{four_letters("RGB3"), CV_8UC3, -1, 24},
    ColorFormat{four_letters("BGR3"), CV_8UC3, cv::COLOR_BGR2RGB, 24}};
constexpr std::uint32_t kMotionJpeg = four_letters("MJPG");
constexpr std::uint32_t kJpeg = four_letters("JPEG");
constexpr std::uint32_t kY8i = four_letters("Y8I ");
constexpr std::uint32_t kY12i = four_letters("Y12I");

const ColorFormat* color_format(std::uint32_t code) {
  for (const ColorFormat& format : kColorFormats) {
    if (format.code == code) return &format;
  }
  return nullptr;
}

std::string too_short(const RawPicture& raw, std::size_t wanted) {
  return fmt::format("the camera sent {} of {} bytes", raw.size, wanted);
}

// Rows shorter than their pixels would be read beyond their end. Returns empty, or what is wrong.
std::string row_trouble(const RawPicture& raw, int pixel_bytes) {
  const std::size_t least = static_cast<std::size_t>(raw.width) * pixel_bytes;
  if (raw.row_bytes >= least) return {};
  return fmt::format("the camera says that a row has {} bytes; {} px have {}", raw.row_bytes,
                     raw.width, least);
}

constexpr int kEyeBits = 12;           // of one eye in Y12I
constexpr int kRealSenseEyeBits = 10;  // of those that a RealSense uses

Rgb grey(int value) {
  const auto level = static_cast<std::uint8_t>(std::min(value, 255));
  return {level, level, level};
}

// Rows of both eyes from one row of Y12I.
void split_y12i_row(const std::uint8_t* row, bool by_realsense, ColorImage& left, ColorImage& right,
                    int y) {
  const int surplus = (by_realsense ? kRealSenseEyeBits : kEyeBits) - 8;
  ColorImage& low_eye = by_realsense ? right : left;
  ColorImage& high_eye = by_realsense ? left : right;
  for (int x = 0; x < left.width(); ++x) {
    const int word = row[3 * x] | row[3 * x + 1] << 8 | row[3 * x + 2] << 16;
    low_eye(x, y) = grey((word & 0xFFF) >> surplus);
    high_eye(x, y) = grey((word >> kEyeBits) >> surplus);
  }
}

std::string decode_jpeg(const RawPicture& raw, ColorImage& image) {
  // A decoder silently completes a truncated picture with grey. Cameras append padding
  // after the last mark.
  constexpr std::array<std::uint8_t, 2> kEnd{0xFF, 0xD9};
  const std::uint8_t* end = raw.data + raw.size;
  const std::uint8_t* tail = end - std::min<std::size_t>(raw.size, 1024);
  if (raw.size < 4 || raw.data[0] != 0xFF || raw.data[1] != 0xD8) return "the picture is no JPEG";
  if (std::search(tail, end, kEnd.begin(), kEnd.end()) == end) return "the picture is cut off";
  const std::optional<JpegSize> size = jpeg_size(raw.data, raw.size);
  if (!size) return "the picture is damaged";
  if (std::cmp_not_equal(size->width, raw.width) || std::cmp_not_equal(size->height, raw.height)) {
    return fmt::format("the picture says it has {} x {} px, not {} x {}", size->width, size->height,
                       raw.width, raw.height);
  }
  // Only read; OpenCV has no matrix of const data.
  const cv::Mat bytes(1, static_cast<int>(raw.size), CV_8UC1,
                      const_cast<std::uint8_t*>(raw.data));  // NOLINT
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (decoded.empty()) return "the picture is damaged";
  image.resize(decoded.cols, decoded.rows);
  cv::Mat target = view(image);
  cv::cvtColor(decoded, target, cv::COLOR_BGR2RGB);
  return {};
}

}  // namespace

std::string letters_of(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += static_cast<char>(code >> (8 * i) & 0x7F);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

bool is_color_format(std::uint32_t format) {
  return color_format(format) != nullptr || format == kMotionJpeg || format == kJpeg;
}

bool is_depth_format(std::uint32_t format) { return format == four_letters("Z16 "); }

bool is_interleaved_format(std::uint32_t format) { return format == kY8i || format == kY12i; }

bool is_gray16_format(std::uint32_t format) { return format == four_letters("Y16 "); }

std::string to_color(const RawPicture& raw, ColorImage& image) {
  try {
    if (raw.format == kMotionJpeg || raw.format == kJpeg) return decode_jpeg(raw, image);
    const ColorFormat* format = color_format(raw.format);
    if (format == nullptr) return fmt::format("no picture in {}", letters_of(raw.format));
    if (std::string trouble = row_trouble(raw, CV_ELEM_SIZE(format->type)); !trouble.empty()) {
      return trouble;
    }
    const bool planes = format->bits == 12;  // NV12: luma rows, then half as many chroma rows
    const int rows = planes ? raw.height * 3 / 2 : raw.height;
    const std::size_t wanted = raw.row_bytes * rows;
    if (raw.size < wanted) return too_short(raw, wanted);
    const cv::Mat source(rows, raw.width, format->type,
                         const_cast<std::uint8_t*>(raw.data),  // NOLINT
                         raw.row_bytes);
    image.resize(raw.width, raw.height);
    cv::Mat target = view(image);
    if (format->conversion < 0) {
      source.copyTo(target);
    } else {
      cv::cvtColor(source, target, format->conversion);
    }
    return {};
  } catch (const cv::Exception& e) {
    return "the picture is damaged: " + e.err;
  } catch (const std::exception& e) {  // out of memory
    return fmt::format("the picture cannot be kept: {}", e.what());
  }
}

std::string to_eyes(const RawPicture& raw, ColorImage& left, ColorImage& right) {
  if (!is_interleaved_format(raw.format)) {
    return fmt::format("no two eyes in {}", letters_of(raw.format));
  }
  if (std::string trouble = row_trouble(raw, raw.format == kY8i ? 2 : 3); !trouble.empty()) {
    return trouble;
  }
  const std::size_t wanted = raw.row_bytes * raw.height;
  if (raw.size < wanted) return too_short(raw, wanted);
  try {
    left.resize(raw.width, raw.height);
    right.resize(raw.width, raw.height);
  } catch (const std::exception& e) {  // out of memory
    return fmt::format("the picture cannot be kept: {}", e.what());
  }
  for (int y = 0; y < raw.height; ++y) {
    const std::uint8_t* row = raw.data + raw.row_bytes * y;
    if (raw.format == kY12i) {
      split_y12i_row(row, raw.by_realsense, left, right, y);
      continue;
    }
    for (int x = 0; x < raw.width; ++x) {
      left(x, y) = grey(row[2 * x]);
      right(x, y) = grey(row[2 * x + 1]);
    }
  }
  return {};
}

std::string to_yuyv(const RawPicture& raw, YuyvImage& image) {
  if (std::string trouble = row_trouble(raw, 2); !trouble.empty()) return trouble;
  const std::size_t wanted = raw.row_bytes * raw.height;
  if (raw.size < wanted) return too_short(raw, wanted);
  try {
    image.resize(raw.width / 2, raw.height);
  } catch (const std::exception& e) {  // out of memory
    return fmt::format("the picture cannot be kept: {}", e.what());
  }
  const std::size_t row = static_cast<std::size_t>(image.width()) * sizeof(Yuyv);
  for (int y = 0; y < raw.height; ++y) {
    std::memcpy(image.row(y), raw.data + raw.row_bytes * y, row);
  }
  return {};
}

std::string to_depth(const RawPicture& raw, double unit, DepthImage& image) {
  if (std::string trouble = row_trouble(raw, 2); !trouble.empty()) return trouble;
  const std::size_t wanted = raw.row_bytes * raw.height;
  if (raw.size < wanted) return too_short(raw, wanted);
  image.resize(raw.width, raw.height);
  const auto scale = static_cast<float>(unit);
  for (int y = 0; y < raw.height; ++y) {
    const std::uint8_t* row = raw.data + raw.row_bytes * y;
    for (int x = 0; x < raw.width; ++x) {
      const int step = row[2 * x] | row[2 * x + 1] << 8;
      image(x, y) = step == 0 || step == 65535 ? std::numeric_limits<float>::quiet_NaN()
                                               : static_cast<float>(step) * scale;
    }
  }
  return {};
}

}  // namespace palpable
