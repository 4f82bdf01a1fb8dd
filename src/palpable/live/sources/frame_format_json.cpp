#include "palpable/live/sources/frame_format_json.h"

#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/sources/depth_unit.h"
#include "palpable/live/sources/image_header.h"

#include <fmt/core.h>

#include <cstdint>
#include <string>

namespace palpable {
namespace {

constexpr int kSide = 4;              // rows and columns of a transform
constexpr int kLongestSide = 32'768;  // px

Json json_of_pinhole(const PinholeCamera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx_px", camera.fx_px},
          {"fy_px", camera.fy_px}, {"cx_px", camera.cx_px},   {"cy_px", camera.cy_px}};
}

Json json_of_lens(const DistortedCamera& camera) {
  return {{"pinhole", json_of_pinhole(camera.pinhole)}, {"distortion", camera.distortion}};
}

int side_of(const Json& json, std::string_view key) {
  const Json& value = json[key];
  if (!value.is_integer() || value.get<double>() < 1 || value.get<double>() > kLongestSide) {
    throw Error(fmt::format("its {} is not between 1 and {} px", key, kLongestSide));
  }
  return value.get<int>();
}

PinholeCamera pinhole_of(const Json& json) {
  return {side_of(json, "width"),      side_of(json, "height"),     json["fx_px"].get<double>(),
          json["fy_px"].get<double>(), json["cx_px"].get<double>(), json["cy_px"].get<double>()};
}

DistortedCamera lens_of(const Json& json) {
  DistortedCamera camera;
  camera.pinhole = pinhole_of(json["pinhole"]);
  for (int k = 0; k < static_cast<int>(camera.distortion.size()); ++k) {
    camera.distortion[k] = json["distortion"][k].get<double>();
  }
  return camera;
}

void read_stereo(const Json& json, FrameFormat& format) {
  format.already_rectified = json["rectified"].get<bool>();
  if (format.already_rectified) {
    format.rectified.camera = pinhole_of(json["camera"]);
    format.rectified.baseline = json["baseline"].get<double>();
    format.rectified.disparity_at_infinity_px = json["disparity_at_infinity_px"].get<double>();
  } else {
    format.rig = {lens_of(json["left"]), lens_of(json["right"]), rigid_of(json["right_from_left"])};
  }
}

// Recordings of 0.1 have no unit: it is not known of their depths, which are in metres.
void read_depth_unit(const Json& json, FrameFormat& format) {
  if (!json.contains("depth_unit_m")) return;
  format.depth_unit = json["depth_unit_m"].get<double>();
  format.depth_unit_assumed = json["depth_unit_assumed"].get<bool>();
  const std::string wrong = what_is_wrong_with_depth_unit(format.depth_unit);
  if (!wrong.empty()) throw Error(wrong);
}

// @throws Error for a size whose images would take too much memory
void bound_size(int width, int height) {
  if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > kMostImagePixels) {
    throw Error(fmt::format("{} x {} px are too many", width, height));
  }
}

FrameFormat format_or_throw(const Json& json) {
  FrameFormat format;
  format.width = side_of(json, "width");
  format.height = side_of(json, "height");
  bound_size(format.width, format.height);
  if (json.contains("starts_at")) format.starts_at = json["starts_at"].get<double>();
  const std::string kind = json["kind"].get<std::string>();
  if (kind == "stereo") {
    read_stereo(json, format);
  } else if (kind == "color and depth") {
    format.kind = FrameFormat::Kind::kColorDepth;
    format.depth_camera = pinhole_of(json["depth_camera"]);
    bound_size(format.depth_camera.width, format.depth_camera.height);
    const Json& color = json["color_sensor"];
    if (!color.is_null()) {
      format.color_sensor = {pinhole_of(color["camera"]), rigid_of(color["color_from_depth"])};
    }
    read_depth_unit(json, format);
  } else {
    throw Error(fmt::format("no camera is of the kind '{}'", kind));
  }
  const std::string wrong = what_is_wrong_with(format);
  if (!wrong.empty()) throw Error(wrong);
  return format;
}

}  // namespace

Json json_of(const Rigid3& transform) {
  Json rows = Json::array();
  for (int k = 0; k < kSide * kSide; ++k) {
    rows.push_back(transform.matrix()(k / kSide, k % kSide));
  }
  return rows;
}

Rigid3 rigid_of(const Json& rows) {
  if (rows.size() != kSide * kSide) throw Error("a transform has 16 numbers");
  Rigid3 transform;
  for (int k = 0; k < kSide * kSide; ++k) {
    transform.matrix()(k / kSide, k % kSide) = rows[k].get<double>();
  }
  return transform;
}

Json json_of(const FrameFormat& format) {
  Json json{{"width", format.width}, {"height", format.height}};
  if (format.starts_at != 0) json["starts_at"] = format.starts_at;
  if (format.kind == FrameFormat::Kind::kColorDepth) {
    json["kind"] = "color and depth";
    json["depth_camera"] = json_of_pinhole(format.depth_camera);
    json["color_sensor"] = nullptr;
    if (const auto& color = format.color_sensor) {
      json["color_sensor"] = {{"camera", json_of_pinhole(color->camera)},
                              {"color_from_depth", json_of(color->color_from_depth)}};
    }
    if (format.depth_unit > 0) {
      json["depth_unit_m"] = format.depth_unit;
      json["depth_unit_assumed"] = format.depth_unit_assumed;
    }
    return json;
  }
  json["kind"] = "stereo";
  json["rectified"] = format.already_rectified;
  if (format.already_rectified) {
    json["camera"] = json_of_pinhole(format.rectified.camera);
    json["baseline"] = format.rectified.baseline;
    json["disparity_at_infinity_px"] = format.rectified.disparity_at_infinity_px;
  } else {
    json["left"] = json_of_lens(format.rig.left);
    json["right"] = json_of_lens(format.rig.right);
    json["right_from_left"] = json_of(format.rig.right_from_left);
  }
  return json;
}

Result<FrameFormat> frame_format_of(const Json& json) {
  try {
    return format_or_throw(json);
  } catch (const Error& error) { return Problem{error.what()}; }
}

}  // namespace palpable
