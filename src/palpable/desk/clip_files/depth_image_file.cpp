#include "palpable/desk/clip_files/depth_image_file.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/opencv_writer.h"
#include "palpable/live/sources/image_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace palpable {
namespace {

constexpr double kLargestCount = 65534;  // of a known depth; the next count is kTooClose
static_assert(static_cast<float>(kDepthUnit) == 0.25e-3f);
static_assert(static_cast<float>(kBodyDepthUnit) == 1e-4f);

cv::Mat depth_matrix(const DepthCounts& counts) {
  // The matrix is only read; cv::Mat has no const view, hence the cast.
  return {counts.height(), counts.width(), CV_16UC1, const_cast<std::uint16_t*>(counts.data())};
}

}  // namespace

DepthCounts measured_counts(const DepthImage& depth, const MaskImage& too_close) {
  constexpr auto kUnit = static_cast<float>(kDepthUnit);
  constexpr auto kLargest = static_cast<float>(kLargestCount);
  DepthCounts counts(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float count = std::round(depth.data()[i] / kUnit);
    counts.data()[i] = count >= 1.0f && count <= kLargest  // false for NaN
                           ? static_cast<std::uint16_t>(count)
                           : kNoDepth;
  }
  if (too_close.empty()) return counts;
  PALPABLE_EXPECT(too_close.size() == depth.size(), "the mask has the size of the depth");
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (too_close.data()[i] != 0) counts.data()[i] = kTooClose;
  }
  return counts;
}

DepthCounts true_counts(const DepthImage& depth) {
  DepthCounts counts(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double count = std::round(static_cast<double>(depth.data()[i]) / kDepthUnit);
    counts.data()[i] = count >= 1.0 && count <= kLargestCount  // false for NaN
                           ? static_cast<std::uint16_t>(count)
                           : kNoDepth;
  }
  return counts;
}

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

void write_measured_depth(const std::filesystem::path& path, const DepthImage& depth,
                          const MaskImage& too_close) {
  const DepthCounts counts = measured_counts(depth, too_close);
  write_image(path, depth_matrix(counts), png_of_runs());
}

void write_true_depth(const std::filesystem::path& path, const DepthImage& depth) {
  const DepthCounts counts = true_counts(depth);
  write_image(path, depth_matrix(counts), png_of_repetitions());
}

void write_body_depth(const std::filesystem::path& path, const DepthImage& full_size) {
  const DepthCounts counts = body_counts(full_size);
  write_image(path, depth_matrix(counts), png_of_runs());
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

}  // namespace palpable
