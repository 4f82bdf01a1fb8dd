#include "palpable/bake/truth/obstacle_way.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/desk/clip_files/camera_paths.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr const char* kForms =
    "an obstacle is like \"sphere 8mm at 0,0,0.16 to 0,0,0.14\", "
    "\"capsule 1mm,4mm at 0,0,0.16 and 0,0,0.3 to 0,0,0.14\", "
    "\"plane 0,0,-1 at 0,0,0.16 to 0,0,0.14\", or a closed surface's file";

// Reads the words of one obstacle from front to back.
class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {
    std::istringstream stream(text);
    for (std::string word; stream >> word;) words_.push_back(word);
  }

  [[nodiscard]] bool done() const { return at_ == words_.size(); }
  [[nodiscard]] bool skip(std::string_view word) {
    if (done() || words_[at_] != word) return false;
    ++at_;
    return true;
  }
  void expect(std::string_view word) {
    if (!skip(word)) bad(fmt::format("'{}' is missing", word));
  }

  // "0,8mm,0.1": lengths in m
  std::vector<double> lengths(std::size_t least, std::size_t most) {
    if (done()) bad("it ends too early");
    std::vector<double> found;
    std::istringstream stream(words_[at_]);
    for (std::string part; std::getline(stream, part, ',');) found.push_back(length(part));
    if (found.size() < least || found.size() > most) {
      bad(fmt::format("'{}' has {} numbers", words_[at_], found.size()));
    }
    ++at_;
    return found;
  }
  Vector3d point() {
    const std::vector<double> p = lengths(3, 3);
    return {p[0], p[1], p[2]};
  }

  [[noreturn]] void bad(const std::string& what) const {
    throw Error(fmt::format("obstacle '{}': {}; {}", text_, what, kForms));
  }

 private:
  [[nodiscard]] double length(std::string_view part) const {
    // A number without a unit is in m.
    std::optional<double> value = to_number(part);
    if (!value) value = to_quantity(part, Quantity::kLength);
    if (!value || !std::isfinite(*value)) bad(fmt::format("'{}' is no length", part));
    return *value;
  }

  const std::string& text_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

struct Moving {
  Obstacle obstacle;
  Vector3d way = Vector3d::Zero();  // translation from t = 0 to 1, m
};

double radius_of(const Reader& reader, double radius) {
  if (!(radius > 0.0)) reader.bad("a radius is above 0");
  return radius;
}

std::optional<Moving> read_form(const std::string& text) {
  Reader reader(text);
  Moving moving;
  Vector3d from;
  if (reader.skip("sphere")) {
    const double radius = radius_of(reader, reader.lengths(1, 1)[0]);
    reader.expect("at");
    from = reader.point();
    moving.obstacle.capsules = {ball(from, radius)};
  } else if (reader.skip("capsule")) {
    const std::vector<double> radii = reader.lengths(1, 2);
    reader.expect("at");
    from = reader.point();
    reader.expect("and");
    const Vector3d other = reader.point();
    moving.obstacle.capsules = {
        {from, other, radius_of(reader, radii.front()), radius_of(reader, radii.back())}};
  } else if (reader.skip("plane")) {
    const Vector3d normal = reader.point();
    if (!(normal.norm() > 0.0)) reader.bad("a normal has a length");
    reader.expect("at");
    from = reader.point();
    moving.obstacle.half_spaces = {{from, normal.normalized()}};
  } else {
    return std::nullopt;
  }
  if (reader.skip("to")) moving.way = reader.point() - from;
  if (!reader.done()) reader.bad("something stands behind it");
  return moving;
}

std::shared_ptr<const SurfaceDistance> read_shape(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    throw Error(fmt::format("obstacle '{}': is no form and no file; {}", file, kForms));
  }
  SurfaceMesh surface = value_or_throw(read_surface_file(file));
  const WatertightReport report = check_watertight(surface);
  if (!report.watertight()) {
    throw Error(
        fmt::format("{}: an obstacle's surface encloses a solid: {}", file, report.describe()));
  }
  return std::make_shared<const SurfaceDistance>(std::move(surface));
}

// Interpolates between the poses of a file; t = 0 at the first, 1 at the last.
Rigid3 pose_at(const std::vector<StampedPose>& poses, double t) {
  if (poses.size() == 1) return poses.front().world_from_camera;
  const double time =
      poses.front().time + std::clamp(t, 0.0, 1.0) * (poses.back().time - poses.front().time);
  std::size_t next = 1;
  while (next + 1 < poses.size() && poses[next].time < time) ++next;
  const StampedPose &a = poses[next - 1], &b = poses[next];
  const double share = (time - a.time) / (b.time - a.time);
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(a.world_from_camera.linear())
                      .slerp(share, Eigen::Quaterniond(b.world_from_camera.linear()))
                      .toRotationMatrix();
  pose.translation() =
      (1.0 - share) * a.world_from_camera.translation() + share * b.world_from_camera.translation();
  return pose;
}

}  // namespace

ObstacleMotion read_obstacle_way(std::span<const std::string> texts,
                                 const std::filesystem::path& pose_file) {
  std::vector<Moving> moving;
  std::vector<std::shared_ptr<const SurfaceDistance>> shapes;
  for (const std::string& text : texts) {
    if (auto form = read_form(text)) {
      moving.push_back(*std::move(form));
      continue;
    }
    if (pose_file.empty()) {
      (void)read_shape(text);
      throw Error(
          fmt::format("obstacle {}: a file of poses is needed, a line "
                      "\"time tx ty tz qx qy qz qw\" (body_from_surface) for each place",
                      text));
    }
    shapes.push_back(read_shape(text));
  }
  std::vector<StampedPose> poses;
  if (!pose_file.empty()) {
    poses = read_trajectory(pose_file);
    if (poses.empty()) throw Error(fmt::format("{}: holds no pose", pose_file.string()));
    if (shapes.empty()) {
      throw Error(fmt::format("poses {}: no obstacle is a surface", pose_file.string()));
    }
  }
  return
      [moving = std::move(moving), shapes = std::move(shapes), poses = std::move(poses)](double t) {
        Obstacle all;
        for (const Moving& part : moving) {
          Rigid3 shift = Rigid3::Identity();
          shift.translation() = t * part.way;
          const Obstacle here = moved(part.obstacle, shift);
          all.capsules.insert(all.capsules.end(), here.capsules.begin(), here.capsules.end());
          all.half_spaces.insert(all.half_spaces.end(), here.half_spaces.begin(),
                                 here.half_spaces.end());
        }
        for (const auto& shape : shapes) all.surfaces.push_back({shape, pose_at(poses, t)});
        return all;
      };
}

}  // namespace palpable
