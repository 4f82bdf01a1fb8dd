#include "palpable/desk/clip_files/image_files.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/image_file.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestFrameNumber = 10'000'000;  // a name with a larger number is not a frame

bool is_of_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

constexpr double kLargestCount = 65534;  // of a known depth; the next count is kTooClose
static_assert(static_cast<float>(kDepthUnit) == 0.25e-3f);
static_assert(static_cast<float>(kBodyDepthUnit) == 1e-4f);

// Z / kDepthUnit, rounded in the precision of Number.
template <class Number>
DepthCounts rounded_counts(const DepthImage& depth) {
  DepthCounts counts(depth.width(), depth.height());
  std::transform(depth.begin(), depth.end(), counts.begin(), [](float z) {
    const Number count = std::round(static_cast<Number>(z) / static_cast<Number>(kDepthUnit));
    return count >= 1 && count <= static_cast<Number>(kLargestCount)  // false for NaN
               ? static_cast<std::uint16_t>(count)
               : kNoDepth;
  });
  return counts;
}

// The matrix is only read; cv::Mat has no const view, hence the cast.
template <class Pixel>
cv::Mat matrix_of(const Image<Pixel>& image, int type) {
  return {image.height(), image.width(), type, const_cast<Pixel*>(image.data())};
}

cv::Mat bgr_of(const ColorImage& picture) {
  static_assert(sizeof(Rgb) == 3, "three bytes without padding, as CV_8UC3 has it");
  cv::Mat bgr;
  cv::cvtColor(matrix_of(picture, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

// Settings of the images that a run writes: PNG, level 1 (OpenCV's default), with run-length
// encoding of the differences between neighbouring pixels instead of zlib's search for
// repetitions. For masks and smooth depth the files are about as small, in less than half the
// time. The level is not named, because with a named one OpenCV lets libpng try all its filters on
// each row: the four images of a 720p frame then took 16.6 ms; now they take 7.3 ms and are 4 %
// larger.
const std::vector<int> kPngOfRuns{cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE};
// Settings of the images of a truth: PNG, level 1, with zlib's search for repetitions.
const std::vector<int> kPngOfRepetitions{cv::IMWRITE_PNG_COMPRESSION, 1};
const std::vector<int> kJpeg{cv::IMWRITE_JPEG_QUALITY, 96};

// @param path      its ending determines the format
// @param settings  parameters of cv::imencode
// @throws Error naming the file and the reason when it cannot be written; no partial file remains
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

}  // namespace

std::string frame_name(int frame, std::string_view ending) {
  return fmt::format("{:06d}{}", frame, ending);
}

int frames_in(const fs::path& folder) {
  int frames = 0;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string stem = entry.path().stem().string();
    if (!is_of_digits(stem)) continue;
    const double number = to_number(stem).value_or(kLargestFrameNumber);
    if (number < kLargestFrameNumber) frames = std::max(frames, static_cast<int>(number) + 1);
  }
  return frames;
}

void expect_frames_in(const fs::path& folder, std::string_view ending) {
  if (!fs::is_directory(folder)) throw Error(fmt::format("{}: is no folder", folder.string()));
  std::string other;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const std::string stem = name.stem().string();
    if (name.extension() == ending && stem.size() == 6 && is_of_digits(stem)) return;
    if (stem.front() != '.' && (other.empty() || name.string() < other)) other = name.string();
  }
  if (!other.empty()) {
    throw Error(fmt::format("{}: {} is no frame's name: they are 000000{}, 000001{} and so on",
                            folder.string(), other, ending, ending));
  }
}

DepthCounts measured_counts(const DepthImage& depth, const MaskImage& too_close) {
  DepthCounts counts = rounded_counts<float>(depth);
  if (too_close.empty()) return counts;
  PALPABLE_EXPECT(too_close.size() == depth.size(), "the mask has the size of the depth");
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (too_close.data()[i] != 0) counts.data()[i] = kTooClose;
  }
  return counts;
}

DepthCounts true_counts(const DepthImage& depth) { return rounded_counts<double>(depth); }

DepthCounts body_counts(const DepthImage& full_size) {
  constexpr auto kUnit = static_cast<float>(kBodyDepthUnit);
  DepthCounts half(full_size.width() / 2, full_size.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    const float* upper = full_size.row(2 * y);
    const float* lower = full_size.row(2 * y + 1);
    std::uint16_t* out = half.row(y);
    for (int x = 0; x < half.width(); ++x) {
      float sum = 0;
      int known = 0;
      for (const float z : {upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]}) {
        if (std::isnan(z)) continue;
        sum += z;
        ++known;
      }
      const float count = known >= 2 ? std::round(sum / (static_cast<float>(known) * kUnit)) : 0.0f;
      out[x] = count < 65535.0f ? static_cast<std::uint16_t>(count) : kNoDepth;
    }
  }
  return half;
}

double write_measured_depth(const std::filesystem::path& path, const DepthImage& depth,
                            const MaskImage& too_close) {
  const DepthCounts counts = measured_counts(depth, too_close);
  write_image(path, matrix_of(counts, CV_16UC1), kPngOfRuns);
  const auto known = std::count_if(counts.begin(), counts.end(), [](std::uint16_t count) {
    return count != kNoDepth && count != kTooClose;
  });
  return static_cast<double>(known) / static_cast<double>(std::max<std::size_t>(counts.size(), 1));
}

void write_true_depth(const std::filesystem::path& path, const DepthImage& depth) {
  write_image(path, matrix_of(true_counts(depth), CV_16UC1), kPngOfRepetitions);
}

void write_body_depth(const std::filesystem::path& path, const DepthImage& full_size) {
  write_image(path, matrix_of(body_counts(full_size), CV_16UC1), kPngOfRuns);
}

std::optional<DepthCounts> read_depth_counts(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  ImageFileReader reader;
  DepthCounts counts;
  (void)value_or_throw(reader.read_16bit(path, counts));
  return counts;
}

DepthImage depth_of(const DepthCounts& counts, double unit) {
  const auto metres = static_cast<float>(unit);
  DepthImage depth(counts.width(), counts.height());
  std::transform(counts.begin(), counts.end(), depth.begin(), [&](std::uint16_t count) {
    return count == kNoDepth ? std::numeric_limits<float>::quiet_NaN()
                             : static_cast<float>(count) * metres;
  });
  return depth;
}

void write_mask(const std::filesystem::path& path, const MaskImage& mask) {
  write_image(path, matrix_of(mask, CV_8UC1), kPngOfRuns);
}

std::optional<MaskImage> read_mask(const std::filesystem::path& path) {
  std::optional<MaskImage> mask = read_labels(path);
  if (!mask) return std::nullopt;
  for (std::uint8_t& value : *mask) value = value > 127 ? 255 : 0;
  return mask;
}

void write_labels(const std::filesystem::path& path, const GrayImage& labels) {
  write_image(path, matrix_of(labels, CV_8UC1), kPngOfRepetitions);
}

std::optional<GrayImage> read_labels(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  ImageFileReader reader;
  ColorImage colors;
  (void)value_or_throw(reader.read_color(path, colors));
  GrayImage gray(colors.width(), colors.height());
  std::transform(colors.begin(), colors.end(), gray.begin(), [](Rgb c) { return c.r; });
  return gray;
}

void encode_jpeg(const ColorImage& picture, int quality, std::vector<std::uint8_t>& bytes) {
  try {
    cv::imencode(".jpg", bgr_of(picture), bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  } catch (const std::exception&) { bytes.clear(); }
}

void write_jpeg(const std::filesystem::path& path, const ColorImage& picture) {
  write_image(path, bgr_of(picture), kJpeg);
}

ColorImage through_jpeg(const ColorImage& picture) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", bgr_of(picture), bytes, kJpeg);
  const cv::Mat bgr = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ColorImage back(picture.width(), picture.height());
  cv::Mat rgb(back.height(), back.width(), CV_8UC3, back.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return back;
}

std::optional<TrueView> read_true_view(const std::filesystem::path& truth, int frame, double unit) {
  const std::string name = frame_name(frame, ".png");
  const auto depth = read_depth_counts(truth / "depth" / name);
  auto labels = read_labels(truth / "labels" / name);
  if (!depth || !labels) return std::nullopt;
  std::transform(labels->begin(), labels->end(), labels->begin(), [](std::uint8_t label) {
    return (label & kMovesLabel) != 0 ? kShowsPresser : kShowsRoom;
  });
  return TrueView{depth_of(*depth, unit), std::move(*labels)};
}

}  // namespace palpable
