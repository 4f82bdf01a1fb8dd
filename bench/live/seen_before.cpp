#include "bench/live/seen_before.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable::app {
namespace {

using Eigen::Vector3d;

constexpr double kNeighbours = 0.06;  // m, capsules with an end this near count as neighbours
constexpr double kSameSize = 1e-4;    // m, written lengths and radii have six digits
constexpr double kSameMotion = 5e-4;  // m, ends that miss a motion by this much hardly count
constexpr int kFits = 8;              // fits, each weighted by the residuals of the last one

// Ends of capsules in both frames.
struct EndPair {
  Vector3d now, then;
};

double length_of(const Capsule& c) { return (c.b - c.a).norm(); }

bool has_same_size(const Capsule& p, const Capsule& q) {
  return std::abs(p.ra - q.ra) < kSameSize && std::abs(p.rb - q.rb) < kSameSize &&
         std::abs(length_of(p) - length_of(q)) < kSameSize;
}

// The rigid motion from `then` to `now` with the smallest sum of weighted squares (Kabsch).
Rigid3 fitted(const std::vector<EndPair>& ends, const std::vector<double>& weights) {
  Vector3d mean_now = Vector3d::Zero(), mean_then = Vector3d::Zero();
  double sum = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    mean_now += weights[i] * ends[i].now;
    mean_then += weights[i] * ends[i].then;
    sum += weights[i];
  }
  mean_now /= sum;
  mean_then /= sum;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    products += weights[i] * (ends[i].now - mean_now) * (ends[i].then - mean_then).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0;
  Rigid3 motion = Rigid3::Identity();
  motion.linear() = svd.matrixU() * mirror * svd.matrixV().transpose();
  motion.translation() = mean_now - motion.linear() * mean_then;
  return motion;
}

// The motion on which most ends agree: weights fall with the residual (Geman and McClure).
Rigid3 agreed(const std::vector<EndPair>& ends) {
  std::vector<double> weights(ends.size(), 1.0);
  Rigid3 motion = fitted(ends, weights);
  double scale = 0.02;  // m; falls to kSameMotion, so that a poor first fit is left behind
  for (int fit = 0; fit < kFits; ++fit) {
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const double off = (ends[i].now - motion * ends[i].then).norm() / scale;
      weights[i] = 1.0 / ((1.0 + off * off) * (1.0 + off * off));
    }
    motion = fitted(ends, weights);
    scale = std::max(kSameMotion, 0.5 * scale);
  }
  return motion;
}

// Capsules of which a ray from the camera may meet one.
std::vector<Capsule> along_ray(std::span<const Capsule> things, const Vector3d& ray) {
  std::vector<Capsule> met;
  for (const Capsule& c : things) {
    const Vector3d middle = 0.5 * (c.a + c.b);
    const double beside = (middle - middle.dot(ray) * ray).norm();
    if (beside <= 0.5 * length_of(c) + std::max(c.ra, c.rb)) met.push_back(c);
  }
  return met;
}

bool is_seen(const Vector3d& x, const Vector3d& normal, std::span<const Capsule> things,
             const PinholeCamera& camera) {
  if (!(x.z() > 0) || normal.dot(x) >= 0) return false;
  const Eigen::Vector2d pixel = camera.project(x);
  if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > camera.width - 1 ||
      pixel.y() > camera.height - 1) {
    return false;
  }
  const double range = x.norm();
  const Vector3d ray = x / range;
  return ray_distance(along_ray(things, ray), Vector3d::Zero(), ray, range) >= range - kHidden;
}

}  // namespace

std::optional<Rigid3> motion_of_thing(std::span<const Capsule> now, std::span<const Capsule> then,
                                      int thing) {
  const std::ptrdiff_t shift = std::ssize(then) - std::ssize(now);
  const auto partner = [&](std::ptrdiff_t i) -> const Capsule* {
    const std::ptrdiff_t k = i + shift;
    if (k < 0 || k >= std::ssize(then)) return nullptr;
    const Capsule& other = then[static_cast<std::size_t>(k)];
    return has_same_size(now[static_cast<std::size_t>(i)], other) ? &other : nullptr;
  };
  const Capsule* const own_then = partner(thing);
  if (own_then == nullptr) return std::nullopt;
  const Capsule& own = now[static_cast<std::size_t>(thing)];
  const Vector3d middle = 0.5 * (own.a + own.b), middle_then = 0.5 * (own_then->a + own_then->b);
  std::vector<EndPair> ends;
  for (std::ptrdiff_t i = 0; i < std::ssize(now); ++i) {
    const Capsule* const other = partner(i);
    if (other == nullptr) continue;
    const Capsule& c = now[static_cast<std::size_t>(i)];
    if (signed_distance(own, c.a) < kNeighbours) ends.push_back({c.a, other->a});
    if (signed_distance(own, c.b) < kNeighbours) ends.push_back({c.b, other->b});
  }
  Rigid3 motion = agreed(ends);
  const Vector3d axis = own.b - own.a, moved = motion.linear() * (own_then->b - own_then->a);
  if (axis.norm() > kSameSize) {
    motion.linear() =
        Eigen::Quaterniond::FromTwoVectors(moved, axis).toRotationMatrix() * motion.linear();
  }
  motion.translation() = middle - motion.linear() * middle_then;
  return motion;
}

std::vector<bool> seen_before(const ThingPoints& points, std::span<const Capsule> now,
                              std::span<const std::span<const Capsule>> earlier,
                              const PinholeCamera& camera) {
  std::vector<bool> seen(points.size(), false);
  std::vector<std::optional<Rigid3>> then_from_now(now.size());
  for (const std::span<const Capsule> then : earlier) {
    std::vector<bool> known(now.size(), false);
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (seen[p]) continue;
      const auto thing = static_cast<std::size_t>(points[p].thing);
      if (!known[thing]) {
        known[thing] = true;
        const auto motion = motion_of_thing(now, then, points[p].thing);
        then_from_now[thing] = motion ? std::optional(motion->inverse()) : std::nullopt;
      }
      if (!then_from_now[thing]) continue;
      seen[p] = is_seen(*then_from_now[thing] * points[p].x,
                        then_from_now[thing]->linear() * points[p].normal, then, camera);
    }
  }
  return seen;
}

}  // namespace palpable::app
