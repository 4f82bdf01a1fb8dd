#include "palpable/live/calibrate/kalibr_camchain.h"

#include <fmt/core.h>

namespace palpable {
namespace {

Result<std::vector<double>> list_of(const KeyedText& text, const std::string& path,
                                    std::size_t count) {
  const auto numbers = text.numbers(path);
  if (!numbers || numbers->size() != count) {
    return Problem{fmt::format("has no {} numbers {}", count, path)};
  }
  return *numbers;
}

Result<DistortedCamera> camera_of(const KeyedText& text, const std::string& name) {
  const std::string model = text.word(name + ".camera_model");
  const std::string lens = text.word(name + ".distortion_model");
  if (model != "pinhole") {
    return Problem{fmt::format(
        "has {} of the camera model {} (lens {}); only pinhole with radtan is known here: "
        "calibrate "
        "with the models pinhole-radtan pinhole-radtan, or with palpable calibrate",
        name, model.empty() ? "(none stated)" : model, lens.empty() ? "(none stated)" : lens)};
  }
  if (lens != "radtan" && lens != "none" && lens != "radtan5") {
    return Problem{fmt::format(
        "has {} with a lens of the model {}; only radtan is known here: calibrate with the models "
        "pinhole-radtan pinhole-radtan, or with palpable calibrate",
        name, lens.empty() ? "(none stated)" : lens)};
  }
  const auto f = list_of(text, name + ".intrinsics", 4);
  if (!f.ok()) return f.problem();
  const auto size = list_of(text, name + ".resolution", 2);
  if (!size.ok()) return size.problem();
  const auto& n = f.value();
  const auto camera = with_size({0, 0, n[0], n[1], n[2], n[3]}, size.value()[0], size.value()[1]);
  if (!camera.ok()) return camera.problem();
  if (lens == "none") return DistortedCamera{camera.value(), {}};
  const auto k = text.numbers(name + ".distortion_coeffs");
  if (!k || k->empty()) {
    return Problem{fmt::format("has no numbers {}.distortion_coeffs", name)};
  }
  return lens_of_model(camera.value(), *k, "radtan");
}

// cam1_from_cam0
Result<Rigid3> pose_between(const KeyedText& text) {
  if (const auto direct = text.numbers("cam1.T_cn_cnm1")) {
    return pose_of_rows(*direct, "cam1.T_cn_cnm1");
  }
  for (const char* key : {"T_cam_imu", "T_imu_cam"}) {
    const std::string first = fmt::format("cam0.{}", key), second = fmt::format("cam1.{}", key);
    const auto left = text.numbers(first), right = text.numbers(second);
    if (!left || !right) continue;
    const Result<Rigid3> a = pose_of_rows(*left, first);
    if (!a.ok()) return a.problem();
    const Result<Rigid3> b = pose_of_rows(*right, second);
    if (!b.ok()) return b.problem();
    return std::string_view(key) == "T_cam_imu" ? Rigid3(b.value() * a.value().inverse())
                                                : Rigid3(b.value().inverse() * a.value());
  }
  return Problem{
      "has no 4 x 4 numbers cam1.T_cn_cnm1, the pose of cam0 in cam1: calibrate both cameras "
      "together"};
}

}  // namespace

bool is_camchain(const KeyedText& text) {
  return text.has("cam0.camera_model") || text.has("cam0.distortion_model") ||
         text.has("cam1.camera_model") || text.has("cam0.cam_overlaps");
}

Result<DistortedCamera> camera_of_camchain(const KeyedText& text) {
  return camera_of(text, "cam0");
}

Result<StereoRig> rig_of_camchain(const KeyedText& text) {
  const Result<DistortedCamera> left = camera_of(text, "cam0");
  if (!left.ok()) return left.problem();
  if (!text.has("cam1")) {
    return Problem{"has cam0 alone, one eye: calibrate both cameras together"};
  }
  const Result<DistortedCamera> right = camera_of(text, "cam1");
  if (!right.ok()) return right.problem();
  const Result<Rigid3> pose = pose_between(text);
  if (!pose.ok()) return pose.problem();
  return StereoRig{left.value(), right.value(), pose.value()};
}

}  // namespace palpable
