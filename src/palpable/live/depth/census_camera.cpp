#include "palpable/live/depth/census_camera.h"

#include "palpable/live/depth/pair_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>

namespace palpable {
namespace {

// Smallest depth that the guard of the matcher searches, m: at 40 mm neither camera is in focus.
constexpr double kGuardNearest = 0.05;

// px by which the searched range extends below the disparity of infinity. The ends of the range are
// not trusted, so without this very distant things would not be matched and could not be used to
// measure the row error; fill_depth() leaves out depths that are too large.
constexpr int kBehindInfinity = 2;

// Frames without a measured row error after which find_rows() is tried. It takes 50 ms and is
// repeated at 4, 16, 64 ... times this number of frames.
constexpr int kUnmeasured = 8;
constexpr double kLeastRows = 0.4;  // px of the matched images; the row watch measures smaller ones

bool searches_rows(int unmeasured) {
  int due = kUnmeasured;
  while (due < unmeasured && due < (1 << 24)) due *= 4;
  return due == unmeasured;
}

StereoMatcherSettings matching_of(const StereoEyes& eyes, const DepthSettings& settings) {
  StereoMatcherSettings s = eyes.halved() ? near_matching() : full_matching();
  const RectifiedStereo& matched = eyes.matched();
  s.first =
      std::min(eyes.first_disparity(),
               static_cast<int>(std::floor(matched.disparity_at_infinity_px)) - kBehindInfinity);
  const int most = (kMostDisparities - 1 - std::abs(s.first)) / 16 * 16;
  s.disparities = std::min((eyes.last_disparity() - s.first + 1 + 15) / 16 * 16, most);
  const double f_T = matched.camera.fx_px * matched.baseline;
  // The guard works at a quarter of the resolution and begins at the same end of the range.
  const double widest = matched.camera.width;
  s.guard_disparities =
      static_cast<int>(std::min(f_T / kGuardNearest + std::abs(s.first), widest) / 4);
  s.guard_disparities = std::min(s.guard_disparities, most);
  s.threads = settings.threads;
  return s;
}

}  // namespace

Result<CensusCamera> CensusCamera::make(const FrameFormat& format, const DepthSettings& settings) {
  Result<StereoEyes> eyes = StereoEyes::make(format, settings);
  if (!eyes.ok()) return eyes.problem();
  if (settings.threads < 1 || settings.threads > kMostThreads) {
    return Problem{fmt::format("matching on {} threads: 1 to {} are possible", settings.threads,
                               kMostThreads)};
  }
  if (std::abs(eyes.value().first_disparity()) > kMostDisparities / 2) {
    return Problem{fmt::format("the disparity at infinity is {} px; the matcher reaches {}",
                               eyes.value().matched().disparity_at_infinity_px,
                               kMostDisparities / 2)};
  }
  return CensusCamera(std::move(eyes).value(), settings);
}

CensusCamera::CensusCamera(StereoEyes eyes, const DepthSettings& settings)
    : eyes_(std::move(eyes)),
      noise_(eyes_.noise()),
      farthest_(eyes_.farthest()),
      matcher_(matching_of(eyes_, settings)) {
  if (settings.watch_rows) watch_.emplace(camera());
}

bool CensusCamera::measure(const Frame& frame, SeenFrame& seen, StageTimes& times) {
  seen.row_correction_px = row_correction_px_;
  seen.too_close.resize(depth_camera().width, depth_camera().height);
  seen.confidence.resize(depth_camera().width, depth_camera().height);
  if (!eyes_.fits(frame)) return false;
  {
    const StageTimer timer(times, "rectify");
    eyes_.rectify(frame, seen);
  }
  {
    const StageTimer timer(times, "disparity");
    match(seen);
  }
  const StageTimer timer(times, "depth");
  if (watch_) watch_rows(seen);
  fill_depth(seen);
  return true;
}

void CensusCamera::match(SeenFrame& seen) {
  matcher_.match(eyes_.left(seen), eyes_.right(seen), pair_);
  if (eyes_.halved()) matcher_.refine(seen.left, seen.right, pair_);
}

// A correction that is found in this frame is applied from the next frame on.
void CensusCamera::watch_rows(SeenFrame& seen) {
  const RowError& error = watch_->measure(seen.left, seen.right, pair_.disparity, pair_.confidence,
                                          eyes_.halved() ? 2 : 1);
  seen.row_error_px = error.median_px;
  if (std::isnan(error.median_px) && !fit_is_known_) find_misfit(seen);
  fit_is_known_ = true;
  unmeasured_ = std::isnan(error.median_px) ? unmeasured_ + 1 : 0;
  if (searches_rows(unmeasured_)) find_rows(seen);
  if (const std::optional<EyeTilt> due = watch_->correction_due()) {
    eyes_.turn_right(due->rotation());
    row_correction_px_ += due->pitch * camera().fy_px;
  }
}

void CensusCamera::find_misfit(SeenFrame& seen) const {
  const double infinity = eyes_.matched().disparity_at_infinity_px;
  seen.misfit =
      misfit_of(eyes_.left(seen), eyes_.right(seen), static_cast<int>(std::lround(infinity)),
                std::max(matcher_.settings().disparities, 1));
  if (seen.misfit && eyes_.halved()) seen.misfit->rows_px *= 2;
}

// If too few points match to measure their row error, the row error itself may be the reason. This
// searches points over many rows, and turns the right camera so that the row watch can measure.
void CensusCamera::find_rows(const SeenFrame& seen) {
  const double infinity = eyes_.matched().disparity_at_infinity_px;
  const std::optional<double> rows =
      rows_between(eyes_.left(seen), eyes_.right(seen), static_cast<int>(std::lround(infinity)),
                   std::max(matcher_.settings().disparities, 1));
  if (!rows || std::abs(*rows) < kLeastRows) return;
  const EyeTilt tilt{*rows / eyes_.matched().camera.fy_px, 0};
  eyes_.turn_right(tilt.rotation());
  row_correction_px_ += tilt.pitch * camera().fy_px;
}

void CensusCamera::fill_depth(SeenFrame& seen) const {
  const RectifiedStereo& matched = eyes_.matched();
  const auto f_T = static_cast<float>(kDisparitySteps * matched.camera.fx_px * matched.baseline);
  const auto infinity = static_cast<float>(kDisparitySteps * matched.disparity_at_infinity_px);
  const auto farthest = static_cast<float>(farthest_);
  std::size_t measured = 0, kept = 0, too_close = 0;
  for (std::size_t i = 0; i < seen.depth.size(); ++i) {
    const std::int16_t d = pair_.disparity.data()[i];
    const float Z = f_T / (static_cast<float>(d) - infinity);
    const bool known = is_measured(d) && Z > 0 && Z <= farthest;
    seen.depth.data()[i] = known ? Z : std::numeric_limits<float>::quiet_NaN();
    seen.confidence.data()[i] = known ? pair_.confidence.data()[i] : std::uint8_t{0};
    seen.too_close.data()[i] = d == kTooCloseDisparity ? 255 : 0;
    measured += is_measured(d);
    kept += known;
    too_close += d == kTooCloseDisparity;
  }
  const auto pixels = static_cast<double>(std::max<std::size_t>(seen.depth.size(), 1));
  seen.measured.measured = static_cast<double>(measured + too_close) / pixels;
  seen.measured.too_far = static_cast<double>(measured - kept) / pixels;
  const int height = seen.depth.height();
  for (int y = 0; y < height; y += sample_step(height)) {
    for (int x = 0; x < seen.depth.width(); ++x) {
      const std::int16_t d = pair_.disparity(x, y);
      if (is_measured(d)) seen.measured.sample(f_T / (static_cast<float>(d) - infinity));
    }
  }
}

}  // namespace palpable
