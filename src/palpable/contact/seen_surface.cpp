#include "palpable/contact/seen_surface.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

// At most so many cells of the grid per axis, which bounds its memory. A body is under a metre
// long; of a longer one the outermost cells hold all the rest.
constexpr int kMostCells = 128;

// The margin at a left outline takes at most this share of the thickness.
constexpr float kMarginShare = 0.8f;

bool is_depth(float z) { return std::isfinite(z) && z > 0.0f; }

// The plane through the window around a pixel, found as 1/Z = a + b du + c dv: under perspective
// a plane is linear in the pixel for the inverse depth, not for the depth.
struct InverseDepthPlane {
  double b = 0;  // 1 / (m px)
  double c = 0;
};

// Fits by least squares over the window's pixels of known depth whose depth differs from the
// centre's by at most `jump`. Nothing when that leaves fewer than half of the window, or when the
// pixels left lie on one side of it.
std::optional<InverseDepthPlane> fit_plane(const DepthImage& depth, int u, int v, int reach,
                                           float jump) {
  const float z0 = depth(u, v);
  double suu = 0, suv = 0, svv = 0, su = 0, sv = 0, s = 0, suw = 0, svw = 0, sw = 0;
  for (int y = std::max(0, v - reach); y <= std::min(depth.height() - 1, v + reach); ++y) {
    const float* row = depth.row(y);
    for (int x = std::max(0, u - reach); x <= std::min(depth.width() - 1, u + reach); ++x) {
      const float z = row[x];
      if (!is_depth(z) || std::abs(z - z0) > jump) continue;
      const double du = x - u;
      const double dv = y - v;
      const double w = 1.0 / static_cast<double>(z);
      s += 1, su += du, sv += dv, sw += w;
      suu += du * du, suv += du * dv, svv += dv * dv;
      suw += du * w, svw += dv * w;
    }
  }
  const int side = 2 * reach + 1;
  if (2.0 * s < side * side) return std::nullopt;
  // At an outline only one side of the window is left, and on a round thing the slope there is that
  // of a place further in. Such points are not needed: the balls of the points further in reach the
  // outline.
  const double lopsided = 0.25 * reach * s;
  if (std::abs(su) > lopsided || std::abs(sv) > lopsided) return std::nullopt;
  // Normal equations with the means removed.
  const double cuu = suu - su * su / s;
  const double cuv = suv - su * sv / s;
  const double cvv = svv - sv * sv / s;
  const double cuw = suw - su * sw / s;
  const double cvw = svw - sv * sw / s;
  const double determinant = cuu * cvv - cuv * cuv;
  if (determinant < 0.5 * s) return std::nullopt;  // one row or column of pixels has 0
  return InverseDepthPlane{(cvv * cuw - cuv * cvw) / determinant,
                           (cuu * cvw - cuv * cuw) / determinant};
}

}  // namespace

SeenSurface::SeenSurface(const SeenSurfaceSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.step >= 1, "every pixel is the finest decimation");
  PALPABLE_EXPECT(settings.normal_reach >= 1, "a normal needs neighbours");
  PALPABLE_EXPECT(settings.left_margin >= 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.thickness > 0 && settings.band > 0 && settings.largest_jump_at_1m > 0,
                  "thickness, band and jump are lengths above 0");
  cell_size_ = static_cast<float>(settings.thickness / 2 + settings.band);
}

void SeenSurface::start(const Eigen::AlignedBox3d& region_in_body) {
  PALPABLE_EXPECT(!region_in_body.isEmpty(), "the region around a body is not empty");
  // A point matters to a query in the region when its ball reaches into the query's band.
  const Vector3f margin =
      Vector3f::Constant(static_cast<float>(settings_.thickness + settings_.band));
  region_ = Eigen::AlignedBox3f(region_in_body.min().cast<float>() - margin,
                                region_in_body.max().cast<float>() + margin);
  for (int axis = 0; axis < 3; ++axis) {
    cells_[axis] = std::clamp(static_cast<int>(std::ceil(region_.sizes()[axis] / cell_size_)) + 1,
                              1, kMostCells);
  }
  unsorted_.clear();
}

void SeenSurface::build(const DepthImage& depth, const PinholeCamera& camera,
                        const Rigid3& body_from_camera, const Eigen::AlignedBox3d& region_in_body) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the camera is the depth image's own");
  start(region_in_body);
  const Eigen::Matrix3f R = body_from_camera.linear().cast<float>();
  const Vector3f t = body_from_camera.translation().cast<float>();
  const auto radius = static_cast<float>(settings_.thickness / 2);
  const auto fx = static_cast<float>(camera.fx_px);
  const auto fy = static_cast<float>(camera.fy_px);
  const auto cx = static_cast<float>(camera.cx_px);
  const auto cy = static_cast<float>(camera.cy_px);
  const auto jump_at_1m = static_cast<float>(settings_.largest_jump_at_1m);

  for (int v = 1; v + 1 < depth.height(); v += settings_.step) {
    for (int u = 1; u + 1 < depth.width(); u += settings_.step) {
      const float z = depth(u, v);
      if (!is_depth(z)) continue;
      const Vector3f ray((static_cast<float>(u) - cx) / fx, (static_cast<float>(v) - cy) / fy, 1);
      const Vector3f in_camera = ray * z;
      const Vector3f in_body = R * in_camera + t;
      if (!region_.contains(in_body)) continue;

      // Never below 8 mm: near the camera Z^2 is so small that a finger's own slope would count as
      // a jump.
      const float jump = std::max(0.008f, jump_at_1m * z * z);
      const auto falls_off = [&](int x, int y) {
        const float other = depth(x, y);
        return is_depth(other) && other - z > jump;
      };
      if (falls_off(u - 1, v) || falls_off(u + 1, v) || falls_off(u, v - 1) ||
          falls_off(u, v + 1)) {
        continue;
      }
      const int margin =
          std::min(settings_.left_margin, static_cast<int>(kMarginShare * 2 * radius * fx / z));
      bool at_left_outline = u < margin;
      for (int k = 2; k <= margin && !at_left_outline; ++k) {
        at_left_outline = !is_depth(depth(u - k, v)) || falls_off(u - k, v);
      }
      if (at_left_outline) continue;
      const auto plane = fit_plane(depth, u, v, settings_.normal_reach, jump);
      if (!plane) continue;
      // The plane n.X = k is 1/Z = n.ray / k: n is proportional to the gradient of 1/Z with respect
      // to the ray, completed so that the plane passes through the point itself.
      const double b = plane->b * static_cast<double>(fx);
      const double c = plane->c * static_cast<double>(fy);
      const double a = 1.0 / static_cast<double>(z) - b * static_cast<double>(ray.x()) -
                       c * static_cast<double>(ray.y());
      Vector3f normal = -Eigen::Vector3d(b, c, a).normalized().cast<float>();
      const Vector3f normal_in_body = R * normal;
      unsorted_.push_back({in_body, normal_in_body, in_body - radius * normal_in_body, z});
    }
  }
  sort_into_grid();
}

void SeenSurface::build(std::span<const SeenPoint> points,
                        const Eigen::AlignedBox3d& region_in_body) {
  start(region_in_body);
  for (const SeenPoint& point : points) {
    if (region_.contains(point.point)) unsorted_.push_back(point);
  }
  sort_into_grid();
}

Vector3i SeenSurface::cell_of(const Vector3f& x) const {
  // What lies outside the grid goes into its outermost cells, so that nothing is lost.
  Vector3i cell;
  for (int axis = 0; axis < 3; ++axis) {
    const float position = (x[axis] - region_.min()[axis]) / cell_size_;
    cell[axis] = static_cast<int>(
        std::clamp(std::floor(position), 0.0f, static_cast<float>(cells_[axis] - 1)));
  }
  return cell;
}

std::size_t SeenSurface::cell_index(const Vector3i& cell) const {
  return (static_cast<std::size_t>(cell.z()) * cells_.y() + cell.y()) * cells_.x() + cell.x();
}

void SeenSurface::sort_into_grid() {
  const std::size_t count = static_cast<std::size_t>(cells_.x()) * cells_.y() * cells_.z();
  // Counting sort by the cell of the ball's centre; stable, so that a frame has one result.
  first_.assign(count + 1, 0);
  for (const SeenPoint& point : unsorted_) ++first_[cell_index(cell_of(point.centre)) + 1];
  for (std::size_t c = 0; c < count; ++c) first_[c + 1] += first_[c];
  points_.resize(unsorted_.size());
  for (const SeenPoint& point : unsorted_) {
    const std::size_t c = cell_index(cell_of(point.centre));
    points_[first_[c]++] = point;
  }
  // Each entry now says where its cell ends, which is where the next one begins.
  for (std::size_t c = count; c > 0; --c) first_[c] = first_[c - 1];
  first_[0] = 0;
}

std::optional<NearestSeen> SeenSurface::nearest(const Vector3f& x) const {
  if (points_.empty()) return std::nullopt;
  const auto radius = static_cast<float>(settings_.thickness / 2);
  const float reach = radius + static_cast<float>(settings_.band);
  float best = reach * reach;
  NearestSeen found;
  bool any = false;
  const Vector3i middle = cell_of(x);
  for (int z = std::max(0, middle.z() - 1); z <= std::min(cells_.z() - 1, middle.z() + 1); ++z) {
    for (int y = std::max(0, middle.y() - 1); y <= std::min(cells_.y() - 1, middle.y() + 1); ++y) {
      // The cells of one row are neighbours in memory, and so are their points.
      const int from = std::max(0, middle.x() - 1);
      const int to = std::min(cells_.x() - 1, middle.x() + 1);
      const int first = first_[cell_index({from, y, z})];
      const int last = first_[cell_index({to, y, z}) + 1];
      for (int i = first; i < last; ++i) {
        const float d2 = (points_[i].centre - x).squaredNorm();
        if (d2 < radius * radius) ++found.support;
        if (d2 < best) {
          best = d2;
          found.point = i;
          any = true;
        }
      }
    }
  }
  if (!any) return std::nullopt;
  found.distance = std::sqrt(best) - radius;
  return found;
}

std::optional<NearestSeen> SeenSurface::nearest_by_brute_force(const Vector3f& x) const {
  const auto radius = static_cast<float>(settings_.thickness / 2);
  const float reach = radius + static_cast<float>(settings_.band);
  float best = std::numeric_limits<float>::infinity();
  NearestSeen found;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const float d2 = (points_[i].centre - x).squaredNorm();
    if (d2 < radius * radius) ++found.support;
    if (d2 < best) {
      best = d2;
      found.point = static_cast<int>(i);
    }
  }
  if (!(best < reach * reach)) return std::nullopt;
  found.distance = std::sqrt(best) - radius;
  return found;
}

}  // namespace palpable
