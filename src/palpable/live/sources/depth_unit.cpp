#include "palpable/live/sources/depth_unit.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace palpable {
namespace {

constexpr double kMm = 1e3;  // mm per m

struct KnownDevice {
  std::string_view maker;  // both are parts of the name, in small letters
  std::string_view model;
  double unit;  // m
};

// The units with which the devices start; their makers' software can change some of them. A
// RealSense's name may be cut off before its number (v4l2_capability.card has 31 letters): such a
// name is not known, because the D405 has another unit than the other cameras.
// https://github.com/realsenseai/librealsense/issues/9494 and /pull/8946 have the numbers.
constexpr std::array kKnownDevices{
    KnownDevice{"realsense", "405", 1e-4},      KnownDevice{"realsense", "l515", 2.5e-4},
    KnownDevice{"realsense", "sr300", 1.25e-4}, KnownDevice{"realsense", "sr305", 1.25e-4},
    KnownDevice{"realsense", "415", 1e-3},      KnownDevice{"realsense", "430", 1e-3},
    KnownDevice{"realsense", "435", 1e-3},      KnownDevice{"realsense", "455", 1e-3}};

}  // namespace

std::string what_is_wrong_with_depth_unit(double metres) {
  if (metres >= kLeastDepthUnit && metres <= kLargestDepthUnit) return {};
  std::string text = fmt::format(
      "depth steps of {:g} m; a sensor in millimetres has steps of 0.001 m, and 0.001 mm to 1 m "
      "are possible",
      metres);
  const double steps = 1 / metres;
  if (steps >= kLeastDepthUnit && steps <= kLargestDepthUnit) {
    text += fmt::format(" ({:g} steps in a metre are {:g} m)", metres, steps);
  }
  return text;
}

std::string depth_unit_text(double metres) { return fmt::format("{:.6g} mm", kMm * metres); }

std::optional<double> known_depth_unit(std::string_view device) {
  std::string name(device);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const KnownDevice& known : kKnownDevices) {
    const bool is_one =
        name.find(known.maker) != std::string::npos && name.find(known.model) != std::string::npos;
    if (is_one) return known.unit;
  }
  return std::nullopt;
}

std::vector<std::string> decide_depth_unit(const DepthUnitStatements& stated,
                                           const std::string& source, FrameFormat& format) {
  format.depth_unit_assumed = false;
  for (const std::optional<double>& unit : {stated.asked, stated.calibration}) {
    if (!unit) continue;
    format.depth_unit = *unit;
    return {};
  }
  if (stated.known) {
    format.depth_unit = *stated.known;
    return {
        fmt::format("{}: one step of its depth is {}, as known of {}; --depth-unit overrides "
                    "it",
                    source, depth_unit_text(*stated.known), stated.known_of)};
  }
  format.depth_unit = kUsualDepthUnit;
  format.depth_unit_assumed = true;
  return {
      fmt::format("{}: nothing states the unit of its depth; one step is taken as {}. If that "
                  "is wrong, state it with --depth-unit or unit_m in intrinsics.txt (5000 "
                  "steps in a metre: 0.2mm)",
                  source, depth_unit_text(kUsualDepthUnit))};
}

}  // namespace palpable
