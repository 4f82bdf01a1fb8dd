#include "palpable/live/sources/frame_format_json.h"

#include "palpable/live/calibrate/calibration_file.h"

#include <fmt/core.h>

#include <cstdint>
#include <string>

namespace palpable {
namespace {

constexpr int kSide = 4;                           // rows and columns of a transform
constexpr int kLongestSide = 32'768;               // px
constexpr std::int64_t kMostPixels = 200'000'000;  // a limit far above any camera

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
  const PinholeCamera camera{side_of(json, "width"),      side_of(json, "height"),
                             json["fx_px"].get<double>(), json["fy_px"].get<double>(),
                             json["cx_px"].get<double>(), json["cy_px"].get<double>()};
  if (!(camera.fx_px > 0) || !(camera.fy_px > 0)) {
    throw Error(fmt::format("a focal length of {} x {} px", camera.fx_px, camera.fy_px));
  }
  return camera;
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
  const std::string wrong = format.already_rectified ? what_is_wrong_with(format.rectified)
                                                     : what_is_wrong_with(format.rig);
  if (!wrong.empty()) throw Error(wrong);
}

FrameFormat format_or_throw(const Json& json) {
  FrameFormat format;
  format.width = side_of(json, "width");
  format.height = side_of(json, "height");
  if (std::int64_t{format.width} * format.height > kMostPixels) {
    throw Error(fmt::format("{} x {} px are too many", format.width, format.height));
  }
  if (json.contains("starts_at")) format.starts_at = json["starts_at"].get<double>();
  const std::string kind = json["kind"].get<std::string>();
  if (kind == "stereo") {
    read_stereo(json, format);
  } else if (kind == "color and depth") {
    format.kind = FrameFormat::Kind::kColorDepth;
    format.depth_camera = pinhole_of(json["depth_camera"]);
    const Json& color = json["color_sensor"];
    if (!color.is_null()) {
      format.color_sensor = {pinhole_of(color["camera"]), rigid_of(color["color_from_depth"])};
    }
  } else {
    throw Error(fmt::format("no camera is of the kind '{}'", kind));
  }
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
