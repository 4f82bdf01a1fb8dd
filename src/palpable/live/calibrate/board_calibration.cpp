#include "palpable/live/calibrate/board_calibration.h"

#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/calibrate/rectification.h"

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpable {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

using Points2 = std::vector<cv::Point2f>;
using Points3 = std::vector<cv::Point3f>;

std::optional<Points2> corners_of(const ColorImage& image, const BoardPattern& pattern) {
  cv::Mat gray;
  cv::cvtColor(view(image), gray, cv::COLOR_RGB2GRAY);
  const cv::Size size(pattern.columns, pattern.rows);
  Points2 corners;
  const bool found = cv::findChessboardCorners(
      gray, size, corners,
      cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK);
  if (!found) return std::nullopt;
  // The window around a corner must show its four squares and nothing else. On OpenCV's own
  // thirteen pairs a quarter of the spacing gives rows 0.15 px apart, 0.4 of it 0.26 px: on two
  // slanted boards the larger window contains neighbouring corners.
  double spacing = 1e9;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (i % pattern.columns == 0) continue;
    spacing = std::min(spacing, cv::norm(corners[i] - corners[i - 1]));
  }
  const int half = std::clamp(static_cast<int>(0.25 * spacing), 2, 7);
  cv::cornerSubPix(gray, corners, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-3));
  return corners;
}

std::vector<Eigen::Vector2d> to_eigen_points(const Points2& points) {
  std::vector<Eigen::Vector2d> result;
  for (const cv::Point2f& p : points) result.emplace_back(p.x, p.y);
  return result;
}

Points2 to_cv_points(const std::vector<Eigen::Vector2d>& points) {
  Points2 result;
  for (const Eigen::Vector2d& p : points) {
    result.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return result;
}

Points3 board_points(const BoardPattern& pattern) {
  Points3 points;
  for (int row = 0; row < pattern.rows; ++row) {
    for (int column = 0; column < pattern.columns; ++column) {
      points.emplace_back(static_cast<float>(column * pattern.square),
                          static_cast<float>(row * pattern.square), 0.0F);
    }
  }
  return points;
}

// The largest angle between the normals of two boards, rad, computed for a lens of ordinary focal
// length without distortion. It detects boards that are all parallel before the calibration is
// solved.
double largest_tilt(const Points3& board, const std::vector<Points2>& seen, int width, int height) {
  const cv::Matx33d K(0.9 * width, 0, 0.5 * width, 0, 0.9 * width, 0.5 * height, 0, 0, 1);
  std::vector<cv::Vec3d> normals;
  for (const Points2& points : seen) {
    cv::Vec3d turn;
    cv::Vec3d place;
    if (!cv::solvePnP(board, points, K, cv::noArray(), turn, place)) continue;
    cv::Matx33d R;
    cv::Rodrigues(turn, R);
    normals.emplace_back(R(0, 2), R(1, 2), R(2, 2));
  }
  double largest = 0;
  for (const cv::Vec3d& a : normals) {
    for (const cv::Vec3d& b : normals) {
      largest = std::max(largest, std::acos(std::clamp(a.dot(b), -1.0, 1.0)));
    }
  }
  return largest;
}

DistortedCamera camera_from(const cv::Mat& K, const cv::Mat& D, int width, int height) {
  DistortedCamera camera;
  camera.pinhole = {width,
                    height,
                    K.at<double>(0, 0),
                    K.at<double>(1, 1),
                    K.at<double>(0, 2),
                    K.at<double>(1, 2)};
  for (int i = 0; i < 5; ++i) camera.distortion[i] = D.at<double>(i);
  return camera;
}

Rigid3 rigid_of(const cv::Vec3d& turn, const cv::Vec3d& place) {
  Rigid3 pose = Rigid3::Identity();
  const Eigen::Vector3d axis(turn[0], turn[1], turn[2]);
  if (axis.norm() > 0) {
    pose.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
  }
  pose.translation() = Eigen::Vector3d(place[0], place[1], place[2]);
  return pose;
}

// Converts a pose to the board frame of find_board_pose().
// @param first  pose with the origin in the first corner, X along a row and Y along a column
Rigid3 centred_pose(const Rigid3& first, const BoardPattern& pattern) {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() =
      first * (0.5 * pattern.square * Eigen::Vector3d(pattern.columns - 1, pattern.rows - 1, 0));
  const Eigen::Vector3d along = first.linear().col(0);
  const Eigen::Vector3d across = first.linear().col(1);
  const Eigen::Vector3d side = std::abs(along.x()) >= std::abs(across.x()) ? along : across;
  const Eigen::Vector3d normal = first.linear().col(2);
  const Eigen::Vector3d X = side.x() >= 0 ? side : -side;
  const Eigen::Vector3d Z = normal.dot(pose.translation()) < 0 ? normal : -normal;
  pose.linear() << X, Z.cross(X), Z;
  return pose;
}

// y of the points after rectification, px.
std::vector<double> rows_of(const std::vector<Eigen::Vector2d>& points, const DistortedCamera& eye,
                            const Eigen::Matrix3d& rectified_from_eye,
                            const PinholeCamera& target) {
  const cv::Matx33d K(eye.pinhole.fx_px, 0, eye.pinhole.cx_px, 0, eye.pinhole.fy_px,
                      eye.pinhole.cy_px, 0, 0, 1);
  const cv::Vec<double, 5> D(eye.distortion.data());
  const cv::Matx33d P(target.fx_px, 0, target.cx_px, 0, target.fy_px, target.cy_px, 0, 0, 1);
  cv::Matx33d R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = rectified_from_eye(i, j);
  }
  Points2 straight;
  cv::undistortPoints(to_cv_points(points), straight, K, D, R, P);
  std::vector<double> rows;
  for (const cv::Point2f& p : straight) rows.push_back(p.y);
  return rows;
}

std::string no_rig(const std::string& wrong) {
  if (wrong.find("stands to the left") != std::string::npos) {
    return "the eyes are swapped: the images given as left are the right eye's; exchange them";
  }
  if (wrong.find("m apart") != std::string::npos) {
    return wrong + "; are the board's squares as large as was said?";
  }
  return wrong;
}

// The corners in OpenCV's types; one entry per view.
struct Corners {
  std::vector<Points3> boards;
  std::vector<Points2> left;
  std::vector<Points2> right;
};

Corners corners_of(std::span<const BoardView> views, const BoardPattern& pattern) {
  Corners corners;
  corners.boards.assign(views.size(), board_points(pattern));
  for (const BoardView& seen : views) {
    corners.left.push_back(to_cv_points(seen.left));
    corners.right.push_back(to_cv_points(seen.right));
  }
  return corners;
}

// Fills rig, focal_sigma, reprojection_px and reprojections_px.
void solve(const Corners& corners, int width, int height, BoardCalibration& result) {
  const cv::Size size(width, height);
  // k3 is fixed to 0: unless the boards extend into the picture's corners, it cannot be separated
  // from k2.
  constexpr int kFlags = cv::CALIB_FIX_K3;
  cv::Mat K1, D1, K2, D2, R, T, E, F, turns, places, sigma, of_places, errors;
  cv::calibrateCamera(corners.boards, corners.left, size, K1, D1, turns, places, sigma, of_places,
                      errors, kFlags);
  result.focal_sigma = sigma.at<double>(0) / K1.at<double>(0, 0);
  cv::calibrateCamera(corners.boards, corners.right, size, K2, D2, turns, places, kFlags);
  result.reprojection_px = cv::stereoCalibrate(
      corners.boards, corners.left, corners.right, K1, D1, K2, D2, size, R, T, E, F, errors,
      kFlags | cv::CALIB_USE_INTRINSIC_GUESS,
      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-7));
  for (int i = 0; i < errors.rows; ++i) {
    const double both = std::hypot(errors.at<double>(i, 0), errors.at<double>(i, 1));
    result.reprojections_px.push_back(both / std::numbers::sqrt2);
  }
  StereoRig& rig = result.calibration.rig;
  rig.left = camera_from(K1, D1, width, height);
  rig.right = camera_from(K2, D2, width, height);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rig.right_from_left.linear()(i, j) = R.at<double>(i, j);
    rig.right_from_left.translation()(i) = T.at<double>(i);
  }
}

std::optional<Problem> bad_reprojection(const BoardCalibration& result,
                                        std::span<const BoardView> views,
                                        const BoardPattern& pattern, const BoardLimits& limits) {
  if (result.reprojection_px <= limits.largest_reprojection_px) return std::nullopt;
  const std::vector<double>& of_views = result.reprojections_px;
  const auto worst = std::max_element(of_views.begin(), of_views.end()) - of_views.begin();
  return Problem{fmt::format(
      "the corners are off by {:.2f} px (rms); a good calibration has at most {:.2g}. The worst "
      "is pair {} with {:.2f} px: has the board {} x {} inner corners and no more, is it flat "
      "and still, and were both eyes taken at once",
      result.reprojection_px, limits.largest_reprojection_px, views[worst].number, of_views[worst],
      pattern.columns, pattern.rows)};
}

// Share of the image inside the convex hull of all corners.
double covered_share(const std::vector<Points2>& views, int width, int height) {
  Points2 all;
  for (const Points2& points : views) all.insert(all.end(), points.begin(), points.end());
  Points2 hull;
  cv::convexHull(all, hull);
  return cv::contourArea(hull) / (static_cast<double>(width) * height);
}

// Describes what the set of boards lacks, and the resulting uncertainty of the focal length; empty
// if it lacks nothing.
// @pre  solve() has filled `result`
std::string weakness_of(const BoardCalibration& result, int views, const BoardLimits& limits) {
  std::vector<std::string> wanting;
  if (views < limits.fewest_views) {
    wanting.push_back(
        fmt::format("the board was seen whole by both eyes in {} pairs; {} are wanted", views,
                    limits.fewest_views));
  }
  if (result.tilt < limits.least_tilt) {
    wanting.push_back(fmt::format(
        "the boards are tilted by at most {:.0f} degrees against each other; {:.0f} are wanted to "
        "tell focal length from distance",
        result.tilt * kDegrees, limits.least_tilt * kDegrees));
  }
  if (wanting.empty() && result.focal_sigma <= limits.largest_focal_sigma) return {};
  const double sigma = 100 * result.focal_sigma;
  const std::string known = !(sigma < 100) ? "not at all"
                                           : fmt::format("to {:.{}f} % (one standard deviation)",
                                                         sigma, sigma < 1 ? 2 : 1);
  return fmt::format("{}{}so the focal length, and with it every depth, is known {}",
                     fmt::join(wanting, ", and "), wanting.empty() ? "" : ": ", known);
}

Result<BoardCalibration> calibrate(std::span<const BoardView> views, const BoardPattern& pattern,
                                   int width, int height, const BoardLimits& limits) {
  const Corners corners = corners_of(views, pattern);
  BoardCalibration result;
  result.tilt = largest_tilt(board_points(pattern), corners.left, width, height);
  solve(corners, width, height, result);
  if (auto problem = bad_reprojection(result, views, pattern, limits)) return *problem;
  const StereoRig& rig = result.calibration.rig;
  result.weakness = weakness_of(result, static_cast<int>(views.size()), limits);
  const std::string wrong = what_is_wrong_with(rig);
  if (!wrong.empty()) {
    return Problem{result.weakness.empty() ? no_rig(wrong)
                                           : no_rig(wrong) + "; " + result.weakness};
  }
  if (!result.weakness.empty() && !limits.accept_weak) {
    return Problem{result.weakness +
                   "; take more boards, near enough to fill the picture and tilted to all sides, "
                   "or take it as it is with --accept"};
  }
  const Result<double> rows = row_error_px(views, rig);
  if (!rows.ok()) return rows.problem();
  result.row_error_px = rows.value();
  if (!(result.row_error_px <= limits.largest_row_error_px)) {
    return Problem{
        fmt::format("after rectification the eyes' rows are {:.2f} px apart (rms); {:.2g} are "
                    "allowed, since a match is looked for along one row",
                    result.row_error_px, limits.largest_row_error_px)};
  }
  result.covered = covered_share(corners.left, width, height);
  return result;
}

}  // namespace

std::optional<BoardView> find_board(const ColorImage& left, const ColorImage& right,
                                    const BoardPattern& pattern) {
  try {
    const auto in_left = corners_of(left, pattern);
    if (!in_left) return std::nullopt;
    auto in_right = corners_of(right, pattern);
    if (!in_right) return std::nullopt;
    // Some boards look the same upside down, so the corners may be found in opposite order in the
    // two images; but the eyes are not upside down relative to each other.
    if ((in_left->back() - in_left->front()).dot(in_right->back() - in_right->front()) < 0) {
      std::reverse(in_right->begin(), in_right->end());
    }
    return BoardView{0, to_eigen_points(*in_left), to_eigen_points(*in_right)};
  } catch (const cv::Exception&) { return std::nullopt; }  // an image too small, say
}

std::optional<Rigid3> find_board_pose(const ColorImage& image, const PinholeCamera& camera,
                                      const BoardPattern& pattern) {
  try {
    const auto corners = corners_of(image, pattern);
    if (!corners) return std::nullopt;
    const Points3 board = board_points(pattern);
    const cv::Matx33d K(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
    cv::Vec3d turn;
    cv::Vec3d place;
    if (!cv::solvePnP(board, *corners, K, cv::noArray(), turn, place, false, cv::SOLVEPNP_IPPE)) {
      return std::nullopt;
    }
    cv::solvePnPRefineLM(board, *corners, K, cv::noArray(), turn, place);
    const Rigid3 pose = centred_pose(rigid_of(turn, place), pattern);
    if (!pose.matrix().allFinite() || !(pose.translation().z() > 0)) return std::nullopt;
    return pose;
  } catch (const cv::Exception&) { return std::nullopt; }  // an image too small, say
}

double difference_px(const BoardView& a, const BoardView& b) {
  PALPABLE_EXPECT(a.left.size() == b.left.size() && a.right.size() == b.right.size() &&
                      !a.left.empty() && !a.right.empty(),
                  "both views are of one board");
  double sum = 0;
  for (std::size_t i = 0; i < a.left.size(); ++i) {
    sum += (a.left[i] - b.left[i]).norm() + (a.right[i] - b.right[i]).norm();
  }
  return sum / static_cast<double>(2 * a.left.size());
}

Result<BoardCalibration> calibrate_boards(std::span<const BoardView> views,
                                          const BoardPattern& pattern, int width, int height,
                                          const BoardLimits& limits) {
  const std::size_t corners = std::size_t{1} * pattern.columns * pattern.rows;
  for (const BoardView& seen : views) {
    PALPABLE_EXPECT(seen.left.size() == corners && seen.right.size() == corners,
                    "a view has all corners of its board");
  }
  constexpr std::size_t kFewest = 3;  // Zhang's method
  if (views.size() < kFewest) {
    return Problem{
        fmt::format("both eyes see the whole board of {} x {} inner corners in {} pairs; at least "
                    "{} are needed",
                    pattern.columns, pattern.rows, views.size(), limits.fewest_views)};
  }
  try {
    return calibrate(views, pattern, width, height, limits);
  } catch (const cv::Exception& e) { return Problem{"no camera explains these boards: " + e.err}; }
}

Result<double> row_error_px(std::span<const BoardView> views, const StereoRig& rig) {
  const Result<RectifiedGeometry> rectified = rectify_rig(rig);
  if (!rectified.ok()) return rectified.problem();
  const RectifiedGeometry& geometry = rectified.value();
  double squares = 0;
  std::size_t count = 0;
  for (const BoardView& seen : views) {
    const auto left =
        rows_of(seen.left, rig.left, geometry.rectified_from_left.linear(), geometry.stereo.camera);
    const auto right = rows_of(seen.right, rig.right, geometry.rectified_from_right.linear(),
                               geometry.stereo.camera);
    for (std::size_t i = 0; i < left.size(); ++i) {
      squares += (left[i] - right[i]) * (left[i] - right[i]);
    }
    count += left.size();
  }
  if (count == 0) return Problem{"no board was found"};
  return std::sqrt(squares / static_cast<double>(count));
}

}  // namespace palpable
