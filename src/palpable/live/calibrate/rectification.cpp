#include "palpable/live/calibrate/rectification.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/calibrate/yuyv_kernels.h"

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace palpable {
namespace {

cv::Matx33d camera_matrix(const PinholeCamera& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

cv::Vec<double, 5> distortion(const DistortedCamera& camera) {
  return cv::Vec<double, 5>(camera.distortion.data());
}

cv::Matx33d to_cv(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}

// Whether the principal point is less than the longer side away from the picture. That of a file's
// camera lies inside (calibration_check.h), but rectification may move it out.
bool is_near_picture(const PinholeCamera& camera) {
  const double side = std::max(camera.width, camera.height);
  const auto is_near = [side](double centre) { return centre > -side && centre < 2 * side; };
  return is_near(camera.cx_px) && is_near(camera.cy_px);
}

Eigen::Matrix3d to_eigen(const cv::Matx33d& m) {
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result(i, j) = m(i, j);
  }
  return result;
}

}  // namespace

Result<RectifiedGeometry> rectify_rig(const StereoRig& rig) {
  const std::string wrong = what_is_wrong_with(rig);
  if (!wrong.empty()) return Problem{wrong};
  const cv::Size size(rig.left.pinhole.width, rig.left.pinhole.height);
  const Eigen::Vector3d t = rig.right_from_left.translation();
  cv::Matx33d R1;
  cv::Matx33d R2;
  cv::Matx34d P1;
  cv::Matx34d P2;
  cv::Matx44d Q;
  try {
    cv::stereoRectify(camera_matrix(rig.left.pinhole), distortion(rig.left),
                      camera_matrix(rig.right.pinhole), distortion(rig.right), size,
                      to_cv(rig.right_from_left.linear()), cv::Vec3d(t.x(), t.y(), t.z()), R1, R2,
                      P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  } catch (const cv::Exception& e) { return Problem{"the rig cannot be rectified: " + e.err}; }
  RectifiedGeometry geometry;
  geometry.stereo.camera = {size.width, size.height, P1(0, 0), P1(1, 1), P1(0, 2), P1(1, 2)};
  geometry.stereo.baseline = -P2(0, 3) / P2(0, 0);
  geometry.rectified_from_left.linear() = to_eigen(R1);
  geometry.rectified_from_right.linear() = to_eigen(R2);
  geometry.rectified_from_right.translation().x() = geometry.stereo.baseline;
  // alpha = 0 zooms in until no blank pixel is left. If the distortion folds the image over, almost
  // no part of it is usable, and OpenCV returns an arbitrary focal length.
  constexpr double kLargestZoom = 4;
  const double zoom = geometry.stereo.camera.fx_px / rig.left.pinhole.fx_px;
  if (!is_near_picture(geometry.stereo.camera) || !(zoom <= kLargestZoom) ||
      !(zoom >= 1 / kLargestZoom)) {
    const double angle = Eigen::AngleAxisd(rig.right_from_left.linear()).angle();
    return Problem{fmt::format(
        "rectified, the pictures of {} x {} px have no common part without blank pixels: the "
        "distortion or the rotation between the eyes ({:.1f} degrees) is too large; calibrate "
        "again, with boards in all corners of both pictures (palpable calibrate)",
        size.width, size.height, angle * 180 / std::numbers::pi)};
  }
  return geometry;
}

RectifiedGeometry rectified_geometry(const StereoRig& rig) {
  const Result<RectifiedGeometry> result = rectify_rig(rig);
  PALPABLE_EXPECT(result.ok(), result.problem().message.c_str());
  return result.value();
}

struct Rectification::Maps {
  // Maps rectified to raw pixels. xy: CV_16SC2, integer pixels; fraction: CV_16UC1, index into
  // OpenCV's 32 x 32 interpolation weights.
  struct Table {
    cv::Mat xy;
    cv::Mat fraction;
  };
  bool warps[2] = {true, true};
  DistortedCamera raw[2];
  Table tables[2];
  WarpGrid grids[2];  // the same, for pictures in YUYV
  cv::Mat gray;       // luma of a raw image
};

namespace {

// @param at  function from (column, row) of the rectified picture to px of the raw one
template <class At>
void fill_grid(const PinholeCamera& camera, const At& at, WarpGrid& grid) {
  grid.resize(camera.width, camera.height);
  const int last = camera.width - 1;
  for (int v = 0; v < camera.height; ++v) {
    for (int i = 0; i < grid.columns; ++i) {
      const int u = i * WarpGrid::kStep;
      const int inside = std::min(u, last);
      Eigen::Vector2d p = at(inside, v);
      // Columns beyond the picture's end are extrapolated linearly.
      if (u > last) p += (u - last) * (p - at(last - 1, v));
      grid.set(v, u, p.x(), p.y());
    }
  }
  grid.prepare(camera.width, camera.height);
}

}  // namespace

void Rectification::make_tables(Eye eye) {
  const auto i = static_cast<std::size_t>(eye);
  const PinholeCamera& camera = geometry_.stereo.camera;
  const DistortedCamera& raw = maps_->raw[i];
  const Rigid3& rectified_from_raw =
      eye == Eye::kLeft ? geometry_.rectified_from_left : geometry_.rectified_from_right;
  cv::Mat x;
  cv::Mat y;
  cv::initUndistortRectifyMap(camera_matrix(raw.pinhole), distortion(raw),
                              to_cv(rectified_from_raw.linear()), camera_matrix(camera),
                              cv::Size(camera.width, camera.height), CV_32FC1, x, y);
  cv::convertMaps(x, y, maps_->tables[i].xy, maps_->tables[i].fraction, CV_16SC2);
  fill_grid(
      camera,
      [&](int u, int v) {
        return Eigen::Vector2d(static_cast<double>(x.at<float>(v, u)),
                               static_cast<double>(y.at<float>(v, u)));
      },
      maps_->grids[i]);
}

Rectification::Rectification(const StereoRig& rig)
    : geometry_(rectified_geometry(rig)), maps_(std::make_unique<Maps>()) {
  maps_->raw[0] = rig.left;
  maps_->raw[1] = rig.right;
  make_tables(Eye::kLeft);
  make_tables(Eye::kRight);
}

Rectification::Rectification(const RectifiedStereo& stereo) : maps_(std::make_unique<Maps>()) {
  const std::string wrong = what_is_wrong_with(stereo);
  PALPABLE_EXPECT(wrong.empty(), wrong.c_str());
  geometry_.stereo = stereo;
  geometry_.rectified_from_right.translation().x() = stereo.baseline;
  maps_->warps[0] = maps_->warps[1] = false;
  maps_->raw[0].pinhole = maps_->raw[1].pinhole = stereo.camera;
  for (WarpGrid& grid : maps_->grids) {
    fill_grid(
        stereo.camera, [](int u, int v) { return Eigen::Vector2d(u, v); }, grid);
  }
}

void Rectification::turn_right(const Eigen::Matrix3d& turn) {
  geometry_.rectified_from_right.linear() = turn * geometry_.rectified_from_right.linear();
  make_tables(Eye::kRight);
  maps_->warps[1] = true;
}

Rectification::Rectification(Rectification&&) noexcept = default;
Rectification& Rectification::operator=(Rectification&&) noexcept = default;
Rectification::~Rectification() = default;

void Rectification::rectify(Eye eye, const ColorImage& raw, ColorImage& rectified) {
  const PinholeCamera& camera = geometry_.stereo.camera;
  PALPABLE_EXPECT(raw.width() == camera.width && raw.height() == camera.height,
                  "an image has the size of its rig");
  rectified.resize(camera.width, camera.height);
  cv::Mat target = view(rectified);
  if (!maps_->warps[static_cast<std::size_t>(eye)]) {
    view(raw).copyTo(target);
    return;
  }
  const Maps::Table& table = maps_->tables[static_cast<std::size_t>(eye)];
  cv::remap(view(raw), target, table.xy, table.fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
}

void Rectification::luma(const ColorImage& color, GrayImage& luma) {
  luma.resize(color.width(), color.height());
  cv::Mat target = view(luma);
  cv::cvtColor(view(color), target, cv::COLOR_RGB2GRAY);
}

void Rectification::halve(const GrayImage& image, GrayImage& half) {
  half.resize(image.width() / 2, image.height() / 2);
  cv::Mat target = view(half);
  const cv::Mat even = view(image)(cv::Rect(0, 0, 2 * half.width(), 2 * half.height()));
  cv::resize(even, target, target.size(), 0, 0, cv::INTER_AREA);
}

void Rectification::rectify_luma(Eye eye, const ColorImage& raw, GrayImage& rectified) {
  const PinholeCamera& camera = geometry_.stereo.camera;
  PALPABLE_EXPECT(raw.width() == camera.width && raw.height() == camera.height,
                  "an image has the size of its rig");
  rectified.resize(camera.width, camera.height);
  cv::Mat target = view(rectified);
  if (!maps_->warps[static_cast<std::size_t>(eye)]) {
    cv::cvtColor(view(raw), target, cv::COLOR_RGB2GRAY);
    return;
  }
  cv::cvtColor(view(raw), maps_->gray, cv::COLOR_RGB2GRAY);
  const Maps::Table& table = maps_->tables[static_cast<std::size_t>(eye)];
  cv::remap(maps_->gray, target, table.xy, table.fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
}

namespace {

YuyvEye eye_in(const YuyvImage& both, Rectification::Eye eye, const PinholeCamera& camera) {
  PALPABLE_EXPECT(both.width() == camera.width && both.height() == camera.height &&
                      camera.width % 2 == 0 && camera.width >= 4,
                  "a picture of both eyes has twice the size of one, which is even");
  const bool left = eye == Rectification::Eye::kLeft;
  return {.first = both.row(0) + (left ? 0 : camera.width / 2),
          .row_pairs = static_cast<std::size_t>(both.width()),
          .width = camera.width,
          .height = camera.height};
}

}  // namespace

void Rectification::rectify_luma(Eye eye, const YuyvImage& both, GrayImage& rectified) {
  const PinholeCamera& camera = geometry_.stereo.camera;
  const YuyvEye raw = eye_in(both, eye, camera);
  rectified.resize(camera.width, camera.height);
  yuyv_kernels().front().luma(maps_->grids[static_cast<std::size_t>(eye)], raw, rectified);
}

void Rectification::rectify_left(const YuyvImage& both, const GrayImage& luma,
                                 ColorImage& rectified) {
  const PinholeCamera& camera = geometry_.stereo.camera;
  const YuyvEye raw = eye_in(both, Eye::kLeft, camera);
  PALPABLE_EXPECT(luma.width() == camera.width && luma.height() == camera.height,
                  "luma has the size of its rig");
  rectified.resize(camera.width, camera.height);
  yuyv_kernels().front().color(maps_->grids[0], raw, luma, rectified);
}

}  // namespace palpable
