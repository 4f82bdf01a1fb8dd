#include "palpable/desk/clip_files/place.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <numbers>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kLargestPosition = 100;  // m; a larger position was probably given in mm

Rigid3 pose_of_numbers(const std::vector<double>& n, const std::string& where) {
  for (const double value : n) {
    if (!std::isfinite(value)) throw Error(fmt::format("{}: {} is no place", where, value));
  }
  Rigid3 pose = Rigid3::Identity();
  if (n.size() == 6) {
    pose = upright_pose(n[0], n[1], n[2], n[3], n[4], n[5]);
  } else if (n.size() == 16) {
    Eigen::Matrix4d matrix;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) { matrix(row, column) = n[4 * row + column]; }
    }
    const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
    const double skew = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    const bool last_row = (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-9;
    if (skew > 1e-3 || R.determinant() < 0 || !last_row) {
      throw Error(
          fmt::format("{}: the 16 numbers are no rigid motion (R R^T differs from 1 by {:.2g}, det "
                      "R = {:.4g}); "
                      "give camera_from_body row by row, in metres",
                      where, skew, R.determinant()));
    }
    pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    pose.translation() = matrix.topRightCorner<3, 1>();
  } else {
    throw Error(
        fmt::format("{}: {} numbers; a place has 6 (x y z in m, roll pitch yaw in degrees) or 16 "
                    "(camera_from_body row by row)",
                    where, n.size()));
  }
  if (!(pose.translation().z() > 0)) {
    throw Error(fmt::format("{}: the body would stand behind the camera (z = {} m)", where,
                            pose.translation().z()));
  }
  if (pose.translation().norm() > kLargestPosition) {
    throw Error(fmt::format("{}: the body would stand {:.3g} m away; places are in metres", where,
                            pose.translation().norm()));
  }
  return pose;
}

toml::table parse_place_file(const fs::path& path) {
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kToml));
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}: line {}: {}", path.string(), error.source().begin.line,
                            std::string_view(error.description())));
  }
}

std::optional<Rigid3> pose_in(const toml::table& table, const std::string& where) {
  const toml::node* node = table.get("camera_from_body");
  if (node == nullptr) return std::nullopt;
  const toml::array* array = node->as_array();
  if (array == nullptr) throw Error(fmt::format("{}: camera_from_body is no array", where));
  std::vector<double> numbers;
  for (const toml::node& element : *array) {
    const auto value = element.value<double>();
    if (!value) throw Error(fmt::format("{}: camera_from_body holds what is no number", where));
    numbers.push_back(*value);
  }
  return pose_of_numbers(numbers, where + ": camera_from_body");
}

}  // namespace

Rigid3 upright_pose(double x, double y, double z, double roll, double pitch, double yaw) {
  constexpr double kRadians = std::numbers::pi / 180;
  Eigen::Matrix3d upright;  // columns: the body's axes in the camera
  upright << 1, 0, 0,       //
      0, 0, -1,             //
      0, 1, 0;
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = (Eigen::AngleAxisd(roll * kRadians, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch * kRadians, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix() *
                  upright *
                  Eigen::AngleAxisd(yaw * kRadians, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

Rigid3 read_pose(const std::string& text, const std::string& option) {
  if (const auto numbers = to_numbers(text); numbers && !numbers->empty()) {
    return pose_of_numbers(*numbers, option);
  }
  std::error_code ignored;
  if (!fs::is_regular_file(text, ignored)) {
    throw Error(fmt::format("{} '{}': neither 6 or 16 finite numbers nor a file that can be read",
                            option, text));
  }
  if (fs::path(text).extension() == ".toml") {
    if (const auto pose = pose_in(parse_place_file(text), text)) return *pose;
    throw Error(fmt::format("{}: has no camera_from_body", text));
  }
  const auto lines = read_lines(text);
  if (!lines) throw Error(fmt::format("{}: cannot be read", text));
  const auto numbers = to_numbers(fmt::format("{}", fmt::join(*lines, " ")));
  if (!numbers) throw Error(fmt::format("{}: holds what is no finite number", text));
  return pose_of_numbers(*numbers, text);
}

SceneFile read_scene_file(const fs::path& path) {
  SceneFile scene;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return scene;
  const toml::table table = parse_place_file(path);
  scene.camera_from_body = pose_in(table, path.string());
  if (const toml::node* node = table.get("press_static")) {
    const auto press_static = node->value_exact<bool>();
    if (!press_static) {
      throw Error(fmt::format("{}: press_static is to be true or false", path.string()));
    }
    scene.press_static = *press_static;
  }
  return scene;
}

}  // namespace palpable
