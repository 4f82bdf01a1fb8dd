#include "palpable/live/calibrate/opencv_stereo_files.h"

#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/calibrate/yaml_matrix.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <cmath>

namespace palpable {
namespace {

using Names = std::vector<std::string_view>;

// Both eyes' names of a matrix, the left one's first.
struct EyeNames {
  Names K, D;
};

const EyeNames& names_of(int eye) {
  static const EyeNames kLeft{
      {"M1", "K1", "cameraMatrix1", "cameraMatrixL", "camera_matrix_1", "camera_matrix_left",
       "left_camera_matrix", "cameraMatrixLeft", "K_left", "KL", "K_l", "M_L"},
      {"D1", "distCoeffs1", "distCoeffsL", "dist_coeffs_1", "dist_coeffs_left",
       "left_distortion_coefficients", "distCoeffsLeft", "D_left", "DL", "D_l", "distL",
       "distortion_left"}};
  static const EyeNames kRight{
      {"M2", "K2", "cameraMatrix2", "cameraMatrixR", "camera_matrix_2", "camera_matrix_right",
       "right_camera_matrix", "cameraMatrixRight", "K_right", "KR", "K_r", "M_R"},
      {"D2", "distCoeffs2", "distCoeffsR", "dist_coeffs_2", "dist_coeffs_right",
       "right_distortion_coefficients", "distCoeffsRight", "D_right", "DR", "D_r", "distR",
       "distortion_right"}};
  return eye == 0 ? kLeft : kRight;
}

const Names kPair{"image_size", "imageSize", "img_size", "size", "resolution"};
const Names kWidth{"image_width", "imageWidth", "width"};
const Names kHeight{"image_height", "imageHeight", "height"};

// Width and height, px; nothing if no such key is there.
std::optional<Eigen::Vector2d> size_in(const KeyedText& text) {
  const auto pair = text.numbers(text.first_of(kPair));
  if (pair && pair->size() == 2) return Eigen::Vector2d((*pair)[0], (*pair)[1]);
  const auto width = text.number(text.first_of(kWidth));
  const auto height = text.number(text.first_of(kHeight));
  if (width && height) return Eigen::Vector2d(*width, *height);
  return std::nullopt;
}

Result<DistortedCamera> eye_of(const KeyedText& text, int eye, int width, int height) {
  const EyeNames& names = names_of(eye);
  const std::string K = text.first_of(names.K), D = text.first_of(names.D);
  const auto matrix = text.numbers(K);
  if (!matrix) return Problem{fmt::format("has no matrix {}", K.empty() ? names.K.front() : K)};
  const auto camera = camera_of_matrix(*matrix, K, width, height);
  if (!camera.ok()) return camera.problem();
  const auto lens = text.numbers(D);
  if (!lens || lens->empty()) {
    return Problem{fmt::format("has no numbers {}", D.empty() ? names.D.front() : D)};
  }
  return lens_of_model(camera.value(), *lens, "");
}

// A file without a size is for pictures in whose middle its principal point lies.
std::string wrong_with_stated(const PinholeCamera& camera) {
  constexpr double kFarthest = 0.15;  // of a side; lenses are off by 0.05, half a size by 0.25
  const double x = camera.cx_px / camera.width, y = camera.cy_px / camera.height;
  if (std::abs(x - 0.5) <= kFarthest && std::abs(y - 0.5) <= kFarthest) return {};
  return fmt::format(
      "states no picture size, and its principal point ({:.1f}, {:.1f}) px is not near the middle "
      "of these pictures of {} x {}: it seems to be for pictures of about {:.0f} x {:.0f}",
      camera.cx_px, camera.cy_px, camera.width, camera.height, 2 * camera.cx_px, 2 * camera.cy_px);
}

Result<Eigen::Matrix3d> rotation_of(const std::vector<double>& R) {
  if (R.size() == 9) {
    return nearest_rotation(
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data()));
  }
  if (R.size() != 3) {
    return Problem{fmt::format("has R of {} numbers; it should have 9", R.size())};
  }
  const Eigen::Vector3d turn(R[0], R[1], R[2]);  // a rotation vector, rad
  const double angle = turn.norm();
  if (!(angle > 0)) return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

}  // namespace

bool has_opencv_lenses(const KeyedText& text) {
  return !text.first_of(names_of(0).K).empty() && !text.first_of(names_of(1).K).empty();
}

bool has_opencv_pose(const KeyedText& text) { return text.has_all({"R", "T"}); }

bool states_opencv_size(const KeyedText& text) { return size_in(text).has_value(); }

Result<StereoRig> rig_of_opencv(const KeyedText& lenses, const KeyedText& pose, int width,
                                int height) {
  std::optional<Eigen::Vector2d> size = size_in(lenses);
  if (!size) size = size_in(pose);
  if (size) {
    const auto stated = with_size({}, size->x(), size->y());
    if (!stated.ok()) return stated.problem();
    width = stated.value().width;
    height = stated.value().height;
  }
  StereoRig rig;
  for (int eye = 0; eye < 2; ++eye) {
    const Result<DistortedCamera> read = eye_of(lenses, eye, width, height);
    if (!read.ok()) return read.problem();
    if (!size && width > 0 && height > 0) {
      const std::string wrong = wrong_with_stated(read.value().pinhole);
      if (!wrong.empty()) return Problem{wrong};
    }
    (eye == 0 ? rig.left : rig.right) = read.value();
  }
  const auto R = pose.numbers("R"), T = pose.numbers("T");
  if (!R) return Problem{"has no numbers R"};
  if (!T || T->size() != 3) return Problem{"has no 3 numbers T"};
  const auto rotation = rotation_of(*R);
  if (!rotation.ok()) return rotation.problem();
  rig.right_from_left.linear() = rotation.value();
  rig.right_from_left.translation() = Eigen::Map<const Eigen::Vector3d>(T->data());
  return rig;
}

OpencvTexts opencv_texts(const StereoRig& rig) {
  const RectifiedGeometry geometry = rectified_geometry(rig);
  const PinholeCamera& c = geometry.stereo.camera;
  const double baseline = geometry.stereo.baseline;
  const Eigen::Vector3d T = rig.right_from_left.translation();
  Eigen::Matrix<double, 3, 4> P1, P2;
  P1 << c.fx_px, 0, c.cx_px, 0, 0, c.fy_px, c.cy_px, 0, 0, 0, 1, 0;
  P2 = P1;
  P2(0, 3) = -c.fx_px * baseline;
  Eigen::Matrix4d Q;  // (u, v, disparity, 1) to (X, Y, Z, 1) times a factor
  Q << 1, 0, 0, -c.cx_px, 0, 1, 0, -c.cy_px, 0, 0, 0, c.fx_px, 0, 0, 1 / baseline, 0;
  const std::string head = "%YAML:1.0\n---\n";
  OpencvTexts texts;
  texts.intrinsics = head + fmt::format("image_width: {}\nimage_height: {}\n",
                                        rig.left.pinhole.width, rig.left.pinhole.height);
  texts.intrinsics += yaml_matrix("M1", 3, 3, camera_matrix_rows(rig.left.pinhole));
  texts.intrinsics += yaml_matrix("D1", 1, 5, rig.left.distortion);
  texts.intrinsics += yaml_matrix("M2", 3, 3, camera_matrix_rows(rig.right.pinhole));
  texts.intrinsics += yaml_matrix("D2", 1, 5, rig.right.distortion);
  texts.extrinsics = head + yaml_matrix("R", rig.right_from_left.linear()) +
                     yaml_matrix("T", 3, 1, std::vector<double>(T.data(), T.data() + 3)) +
                     yaml_matrix("R1", geometry.rectified_from_left.linear()) +
                     yaml_matrix("R2", geometry.rectified_from_right.linear()) +
                     yaml_matrix("P1", P1) + yaml_matrix("P2", P2) + yaml_matrix("Q", Q);
  return texts;
}

}  // namespace palpable
