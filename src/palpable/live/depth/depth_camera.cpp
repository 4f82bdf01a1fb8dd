#include "palpable/live/depth/depth_camera.h"

#include "palpable/live/depth/census_camera.h"
#include "palpable/live/depth/depth_sensor_camera.h"
#include "palpable/live/depth/sgbm_camera.h"

#include <fmt/core.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

namespace palpable {
namespace {

using AnyCamera = std::variant<DepthSensorCamera, CensusCamera, SgbmCamera>;

template <class Camera>
Result<AnyCamera> make_any(const FrameFormat& format, const DepthSettings& settings) {
  Result<Camera> made = Camera::make(format, settings);
  if (!made.ok()) return made.problem();
  return AnyCamera(std::move(made).value());
}

Result<AnyCamera> camera_for(const FrameFormat& format, const DepthSettings& settings) {
  if (format.kind == FrameFormat::Kind::kColorDepth) {
    return make_any<DepthSensorCamera>(format, settings);
  }
  if (settings.matcher == DepthSettings::Matcher::kCensus) {
    return make_any<CensusCamera>(format, settings);
  }
  return make_any<SgbmCamera>(format, settings);
}

// An image without colour and depth, for a frame that cannot be used.
void blank(SeenFrame& seen) {
  seen.measured.clear();
  seen.left.resize(0, 0);
  seen.left_half.resize(0, 0);
  seen.right.resize(0, 0);
  std::fill(seen.color.begin(), seen.color.end(), Rgb{});
  std::fill(seen.depth.begin(), seen.depth.end(), std::numeric_limits<float>::quiet_NaN());
  std::fill(seen.too_close.begin(), seen.too_close.end(), std::uint8_t{0});
  std::fill(seen.confidence.begin(), seen.confidence.end(), std::uint8_t{0});
}

// Fills the shares of the pixels whose depth is known, or that are too close.
void find_density(SeenFrame& seen) {
  seen.density = seen.measured.kept = seen.measured.too_close = 0;
  if (seen.depth.empty()) return;
  const auto pixels = static_cast<double>(seen.depth.size());
  const auto known = std::count_if(seen.depth.begin(), seen.depth.end(),
                                   [](float Z) { return Z > 0; });  // NaN is not
  const auto close = std::count(seen.too_close.begin(), seen.too_close.end(), std::uint8_t{255});
  seen.measured.kept = static_cast<double>(known) / pixels;
  seen.measured.too_close = static_cast<double>(close) / pixels;
  seen.density = static_cast<double>(known + close) / pixels;
}

}  // namespace

struct DepthCamera::Parts {
  AnyCamera any;
  DepthWatch watch;
  StageTimes times;
};

DepthCamera::DepthCamera(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
DepthCamera::DepthCamera(DepthCamera&&) noexcept = default;
DepthCamera& DepthCamera::operator=(DepthCamera&&) noexcept = default;
DepthCamera::~DepthCamera() = default;

Result<DepthCamera> DepthCamera::make(const FrameFormat& format, const DepthSettings& settings) {
  const double farthest = settings.farthest.value_or(kUsualFarthest);
  if (!(settings.nearest > 0 && farthest > settings.nearest && std::isfinite(farthest))) {
    return Problem{
        fmt::format("depth is searched from {} m to {} m; both should be positive and "
                    "the second larger",
                    settings.nearest, farthest)};
  }
  Result<AnyCamera> any = camera_for(format, settings);
  if (!any.ok()) return any.problem();
  return DepthCamera(std::make_unique<Parts>(Parts{std::move(any).value(), DepthWatch(), {}}));
}

void DepthCamera::see(const Frame& frame, SeenFrame& seen) {
  Parts& p = *parts_;
  p.times.clear();
  seen.number = frame.number;
  seen.time = frame.time;
  seen.camera = camera();
  seen.depth_camera = depth_camera();
  seen.row_error_px = std::numeric_limits<double>::quiet_NaN();
  seen.row_correction_px = 0;
  seen.misfit.reset();
  seen.measured.clear();
  seen.color.resize(seen.camera.width, seen.camera.height);
  seen.depth.resize(seen.depth_camera.width, seen.depth_camera.height);
  bool usable = false;
  try {
    usable = std::visit([&](auto& any) { return any.measure(frame, seen, p.times); }, p.any);
  } catch (const cv::Exception&) {}  // for instance out of memory: this frame has no depth
  if (!usable) blank(seen);
  find_density(seen);
  seen.trouble = p.watch.look(seen.density, seen.row_error_px);
}

const PinholeCamera& DepthCamera::camera() const {
  return std::visit([](const auto& any) -> const PinholeCamera& { return any.camera(); },
                    parts_->any);
}
const PinholeCamera& DepthCamera::depth_camera() const {
  return std::visit([](const auto& any) -> const PinholeCamera& { return any.depth_camera(); },
                    parts_->any);
}
const DepthNoise& DepthCamera::noise() const {
  return std::visit([](const auto& any) -> const DepthNoise& { return any.noise(); }, parts_->any);
}
bool DepthCamera::has_two_sensors() const {
  const auto* sensor = std::get_if<DepthSensorCamera>(&parts_->any);
  return sensor != nullptr && sensor->has_two_sensors();
}
const StageTimes& DepthCamera::last_times() const { return parts_->times; }

const RectifiedStereo* DepthCamera::rectified() const {
  const auto of = [](const auto& any) -> const RectifiedStereo* {
    if constexpr (std::is_same_v<std::decay_t<decltype(any)>, DepthSensorCamera>) {
      return nullptr;
    } else {
      return &any.rectified();
    }
  };
  return std::visit(of, parts_->any);
}

}  // namespace palpable
