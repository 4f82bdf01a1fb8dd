#include "palpable/live/calibrate/ros_camera_info.h"

#include "palpable/live/calibrate/yaml_matrix.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

// Names of the same entry: of the file, of ROS 1's message, of ROS 2's.
struct RosKeys {
  std::vector<std::string_view> width{"image_width", "width"};
  std::vector<std::string_view> height{"image_height", "height"};
  std::vector<std::string_view> K{"camera_matrix", "Camera_Matrix", "K", "k"};
  std::vector<std::string_view> D{"distortion_coefficients", "Distortion_Coefficients", "D", "d"};
  std::vector<std::string_view> R{"rectification_matrix", "R", "r"};
  std::vector<std::string_view> P{"projection_matrix", "P", "p"};
};

std::optional<std::vector<double>> first_numbers(const KeyedText& text,
                                                 const std::vector<std::string_view>& names) {
  return text.numbers(text.first_of(names));
}

// R and P, where the file has them.
std::string add_rectification(const KeyedText& text, const RosKeys& keys, RosCamera& camera) {
  if (!text.first_of(keys.R).empty()) {
    const auto R = first_numbers(text, keys.R);
    if (!R || R->size() != 9) return "has no 9 numbers in its rectification_matrix";
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rows(R->data());
    // Some drivers publish zeros for "none".
    if (!rows.isZero(0)) camera.rectified_from_camera = nearest_rotation(rows);
  }
  if (!text.first_of(keys.P).empty()) {
    const auto P = first_numbers(text, keys.P);
    if (!P || P->size() != 12) return "has no 12 numbers in its projection_matrix";
    const std::vector<double>& n = *P;
    constexpr double kRounding = 1e-9;  // of fx
    const bool is_plain = std::abs(n[1]) <= kRounding * std::abs(n[0]) && n[4] == 0 && n[8] == 0 &&
                          n[9] == 0 && n[10] == 1 && n[11] == 0;
    // A driver that has no calibration publishes zeros.
    const bool is_none = std::all_of(n.begin(), n.end(), [](double value) { return value == 0; });
    if (!is_plain && !is_none) {
      return "has a projection_matrix that is not fx 0 cx Tx / 0 fy cy Ty / 0 0 1 0, as rectified "
             "pictures have: its driver computed it otherwise; make a calibration with palpable "
             "calibrate";
    }
    camera.projection = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(P->data());
  }
  return {};
}

template <class Matrix>
std::string ros_matrix_text(std::string_view name, const Matrix& m) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, m.rows(), m.cols(),
                     yaml_list(numbers_by_row(m)));
}

}  // namespace

bool is_ros_camera(const KeyedText& text) {
  const RosKeys keys;
  const bool has_message = text.has_all({"K", "P", "D"}) || text.has_all({"k", "p", "d"});
  const bool has_file = text.has("camera_matrix") || text.has("Camera_Matrix");
  return has_message ||
         (has_file && (!text.first_of(keys.width).empty() || !text.first_of(keys.P).empty()));
}

Result<RosCamera> read_ros_camera(const KeyedText& text) {
  const RosKeys keys;
  const auto width = text.number(text.first_of(keys.width));
  const auto height = text.number(text.first_of(keys.height));
  if (!width || !height) return Problem{"has no image_width and image_height"};
  const auto size = with_size({}, *width, *height);
  if (!size.ok()) return size.problem();
  const auto K = first_numbers(text, keys.K);
  if (!K) return Problem{"has no numbers in its camera_matrix"};
  const auto camera =
      camera_of_matrix(*K, "a camera_matrix", size.value().width, size.value().height);
  if (!camera.ok()) return camera.problem();
  std::vector<double> D;
  if (const std::string key = text.first_of(keys.D); !key.empty()) {
    const auto numbers = text.numbers(key);
    if (!numbers) return Problem{"has no numbers in its distortion_coefficients"};
    D = *numbers;
  }
  const auto lens = lens_of_model(camera.value(), D, text.word("distortion_model"));
  if (!lens.ok()) return lens.problem();
  RosCamera result;
  result.lens = lens.value();
  const std::string wrong = add_rectification(text, keys, result);
  if (!wrong.empty()) return Problem{wrong};
  return result;
}

// A point in the left eye's rectified frame is x_1 = R1 x_left. P2 sees it at x_1 + t with
// t = (P2[3] / P2[0], 0, 0), which is R2 x_right; so
//
//     x_right = R2^T R1 x_left + R2^T t
Result<StereoRig> rig_of_ros(const RosCamera& left, const RosCamera& right) {
  const auto& P1 = left.projection;
  const auto& P2 = right.projection;
  for (const auto* P : {&P1, &P2}) {
    if (!((*P)(0, 0) > 0 && (*P)(1, 1) > 0)) {
      return Problem{
          "have no projection_matrix, which holds the distance of the eyes: calibrate both eyes "
          "together (camera_calibration, or palpable calibrate)"};
    }
  }
  if (P1(0, 3) == 0 && P2(0, 3) == 0) {
    return Problem{
        "have P[3] = 0 in both projection matrices, so no distance of the eyes: each was "
        "calibrated "
        "alone; calibrate them together (camera_calibration, or palpable calibrate)"};
  }
  const Eigen::Vector3d t(P2(0, 3) / P2(0, 0) - P1(0, 3) / P1(0, 0),
                          P2(1, 3) / P2(1, 1) - P1(1, 3) / P1(1, 1), 0);
  StereoRig rig{left.lens, right.lens, Rigid3::Identity()};
  rig.right_from_left.linear() =
      nearest_rotation(right.rectified_from_camera.transpose() * left.rectified_from_camera);
  rig.right_from_left.translation() = right.rectified_from_camera.transpose() * t;
  return rig;
}

std::optional<RectifiedStereo> rectified_of_ros(const RosCamera& left, const RosCamera& right) {
  constexpr double kSame = 1e-6;  // of the digits of a text
  for (const RosCamera* eye : {&left, &right}) {
    const PinholeCamera& c = eye->lens.pinhole;
    const auto& P = eye->projection;
    const Eigen::Vector4d K(c.fx_px, c.fy_px, c.cx_px, c.cy_px);
    const Eigen::Vector4d rectified(P(0, 0), P(1, 1), P(0, 2), P(1, 2));
    const auto& k = eye->lens.distortion;
    const bool has_lens = std::any_of(k.begin(), k.end(), [](double value) { return value != 0; });
    if (has_lens || !K.isApprox(rectified, kSame) || P(1, 3) != 0 ||
        !eye->rectified_from_camera.isIdentity(kSame)) {
      return std::nullopt;
    }
  }
  const PinholeCamera& a = left.lens.pinhole;
  const PinholeCamera& b = right.lens.pinhole;
  const double shift = right.projection(0, 3) - left.projection(0, 3);
  const bool rows_agree = std::abs(a.fx_px - b.fx_px) <= kSame * a.fx_px &&
                          std::abs(a.fy_px - b.fy_px) <= kSame * a.fy_px &&
                          std::abs(a.cy_px - b.cy_px) <= kSame * a.fy_px && a.width == b.width &&
                          a.height == b.height;
  if (!rows_agree || shift == 0) return std::nullopt;
  return RectifiedStereo{a, -shift / a.fx_px, a.cx_px - b.cx_px};
}

std::string ros_camera_text(const RosCamera& camera, std::string_view name) {
  const PinholeCamera& c = camera.lens.pinhole;
  Eigen::Matrix3d K;
  K << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1;
  const Eigen::Map<const Eigen::Matrix<double, 1, 5>> D(camera.lens.distortion.data());
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", c.width, c.height,
                     name) +
         ros_matrix_text("camera_matrix", K) + "distortion_model: plumb_bob\n" +
         ros_matrix_text("distortion_coefficients", D) +
         ros_matrix_text("rectification_matrix", camera.rectified_from_camera) +
         ros_matrix_text("projection_matrix", camera.projection);
}

}  // namespace palpable
