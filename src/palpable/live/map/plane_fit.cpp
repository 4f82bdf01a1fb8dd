#include "palpable/live/map/plane_fit.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace palpable {
namespace {

constexpr int kStep = 4;  // px between the pixels that are sampled
constexpr std::size_t kFewestPoints = 100;
constexpr std::size_t kVoteEvery = 4;  // a quarter of the points votes: enough to find the plane
constexpr double kInPlane = 3;         // sigma; largest residual of a point of the plane
constexpr int kRounds = 8;             // rounds of least squares
constexpr double kTukey = 4.685;       // sigma; 95 % efficiency for a normal distribution
// m; lower limit of sigma. Even an exact depth has this error: it is assigned to the pixel's
// middle.
constexpr double kLeastSigma = 0.001;

struct Point {
  Eigen::Vector3d x;
  double sigma;        // m, of its depth
  double from_middle;  // px^2, from the picture's middle
};

// A random number generator that is the same on every machine (Knuth's MMIX), so that the same
// picture gives the same plane.
class Draw {
 public:
  std::size_t below(std::size_t count) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33) % count);
  }

 private:
  std::uint64_t state_ = 1;
};

// Distance of a point from a plane along its ray, in units of the sigma of its depth. With x = Z r
// the ray meets the plane at Z' = offset / (n . r), so Z - Z' = (n . x - offset) / (n . r).
double off_by(const Point& p, const Eigen::Vector3d& normal, double offset) {
  const double along = normal.dot(p.x) / p.x.z();
  return (normal.dot(p.x) - offset) / (std::abs(along) * p.sigma + 1e-12);
}

std::vector<Point> sampled_points(const DepthImage& depth, const PinholeCamera& camera,
                                  const DepthNoise& noise, double farthest) {
  std::vector<Point> points;
  for (int y = kStep / 2; y < depth.height(); y += kStep) {
    for (int x = kStep / 2; x < depth.width(); x += kStep) {
      const auto Z = static_cast<double>(depth(x, y));
      if (!(Z > 0 && Z <= farthest)) continue;
      const double dx = x - 0.5 * depth.width(), dy = y - 0.5 * depth.height();
      points.push_back(
          {camera.unproject(x, y, Z), std::max(noise.sigma(Z), kLeastSigma), dx * dx + dy * dy});
    }
  }
  return points;
}

// Whether something could stand on a plane with this normal.
bool is_level(const Eigen::Vector3d& normal, double least_up) { return -normal.y() >= least_up; }

// The plane with the most votes among planes through three random points. Nothing if none is level.
std::optional<Plane> plane_by_vote(const std::vector<Point>& points, int trials, double least_up) {
  Draw draw;
  Plane best;
  std::size_t most = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Eigen::Vector3d& a = points[draw.below(points.size())].x;
    const Eigen::Vector3d& b = points[draw.below(points.size())].x;
    const Eigen::Vector3d& c = points[draw.below(points.size())].x;
    Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < 1e-6) continue;
    normal.normalize();
    if (normal.dot(a) > 0) normal = -normal;
    if (!is_level(normal, least_up)) continue;
    const double offset = normal.dot(a);
    std::size_t votes = 0;
    for (std::size_t i = 0; i < points.size(); i += kVoteEvery) {
      votes += std::abs(off_by(points[i], normal, offset)) < kInPlane ? 1 : 0;
    }
    if (votes <= most) continue;
    most = votes;
    best.normal = normal;
    best.offset = offset;
  }
  if (most == 0) return std::nullopt;
  return best;
}

// One round of weighted least squares: improves normal and offset. False when no point is near.
bool improve(const std::vector<Point>& points, Plane& plane) {
  double weights = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Point& p : points) {
    const double r = off_by(p, plane.normal, plane.offset) / kTukey;
    if (std::abs(r) >= 1) continue;
    // sigma of its distance from the plane: sigma of its depth times n . r.
    const double sigma = p.sigma * std::abs(plane.normal.dot(p.x)) / p.x.z() + 1e-12;
    const double tukey = 1 - r * r;
    const double w = tukey * tukey / (sigma * sigma);
    weights += w;
    mean += w * p.x;
    squares += w * p.x * p.x.transpose();
  }
  if (!(weights > 0)) return false;
  mean /= weights;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / weights -
                                                            mean * mean.transpose());
  Eigen::Vector3d normal = axes.eigenvectors().col(0);  // of the smallest spread
  if (normal.dot(mean) > 0) normal = -normal;
  plane.normal = normal;
  plane.offset = normal.dot(mean);
  return true;
}

// Sets plane.share to the share of the points that lie within kInPlane of the plane, and
// plane.middle to that of them which is nearest to the picture's middle, moved onto the plane along
// its ray.
void measure_extent(const std::vector<Point>& points, Plane& plane) {
  std::size_t inside = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& p : points) {
    if (std::abs(off_by(p, plane.normal, plane.offset)) >= kInPlane) continue;
    ++inside;
    if (p.from_middle >= nearest) continue;
    nearest = p.from_middle;
    plane.middle = p.x * (plane.offset / plane.normal.dot(p.x));  // on the plane, along its ray
  }
  plane.share = static_cast<double>(inside) / static_cast<double>(points.size());
}

// The median of the depths in the 5 x 5 pixels around a pixel, m. Nothing if fewer than half of
// them are known or inside the picture.
std::optional<double> depth_around(const DepthImage& depth, int x, int y) {
  constexpr int kAround = 2;
  std::vector<float> known;
  for (int j = y - kAround; j <= y + kAround; ++j) {
    for (int i = x - kAround; i <= x + kAround; ++i) {
      if (i < 0 || j < 0 || i >= depth.width() || j >= depth.height()) continue;
      if (depth(i, j) > 0) known.push_back(depth(i, j));
    }
  }
  constexpr std::size_t kAll = (2 * kAround + 1) * (2 * kAround + 1);
  if (2 * known.size() < kAll) return std::nullopt;
  const auto middle = known.begin() + std::ssize(known) / 2;
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

// The measured points within `reach` (m) of a point. Where the reach covers more than about 60 x 60
// pixels, only a regular subset of them is used.
std::vector<Point> points_near(const DepthImage& depth, const PinholeCamera& camera,
                               const DepthNoise& noise, const Eigen::Vector3d& at, double reach) {
  constexpr double kMostInRow = 60;
  const Eigen::Vector2d middle = camera.project(at);
  const double radius = camera.fx_px * reach / at.z();
  const int step = std::max(1, static_cast<int>(2 * radius / kMostInRow));
  const auto from = [&](double of) { return std::max(0, static_cast<int>(of - radius)); };
  const auto to = [&](double of, int size) {
    return std::min(size - 1, static_cast<int>(of + radius));
  };
  std::vector<Point> points;
  for (int y = from(middle.y()); y <= to(middle.y(), depth.height()); y += step) {
    for (int x = from(middle.x()); x <= to(middle.x(), depth.width()); x += step) {
      const auto Z = static_cast<double>(depth(x, y));
      if (!(Z > 0)) continue;
      const Eigen::Vector3d point = camera.unproject(x, y, Z);
      if ((point - at).norm() > reach) continue;
      const Eigen::Vector2d off = Eigen::Vector2d(x, y) - middle;
      points.push_back({point, std::max(noise.sigma(Z), kLeastSigma), off.squaredNorm()});
    }
  }
  return points;
}

constexpr double kAnyWay = -2;  // value of least_up that allows any orientation

// The plane with the most votes, improved and measured. Nothing if there is none with offset < 0.
std::optional<Plane> fit(const std::vector<Point>& points, int trials, double least_up) {
  std::optional<Plane> plane = plane_by_vote(points, trials, least_up);
  if (!plane) return std::nullopt;
  for (int round = 0; round < kRounds; ++round) {
    if (!improve(points, *plane)) return std::nullopt;
  }
  if (!(plane->offset < 0)) return std::nullopt;
  measure_extent(points, *plane);
  return plane;
}

}  // namespace

std::optional<Plane> fit_standing_plane(const DepthImage& depth, const PinholeCamera& camera,
                                        const DepthNoise& noise, const PlaneFitSettings& settings) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the depth is the camera's");
  const std::vector<Point> points = sampled_points(depth, camera, noise, settings.farthest);
  if (points.size() < kFewestPoints) return std::nullopt;
  const double least_up = std::cos(settings.steepest);
  std::optional<Plane> plane = fit(points, settings.trials, least_up);
  if (plane && is_level(plane->normal, least_up) && plane->share >= settings.least_share) {
    return plane;
  }
  plane = fit(points, settings.trials, kAnyWay);
  if (!plane || -plane->normal.z() < std::cos(settings.facing) ||
      plane->share < settings.share_facing) {
    return std::nullopt;
  }
  return plane;
}

std::optional<Plane> fit_plane_at(const DepthImage& depth, const PinholeCamera& camera,
                                  const DepthNoise& noise, double x_px, double y_px, double reach) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the depth is the camera's");
  const int x = static_cast<int>(std::lround(std::clamp(x_px, -1e6, 1e6)));
  const int y = static_cast<int>(std::lround(std::clamp(y_px, -1e6, 1e6)));
  const std::optional<double> Z = depth_around(depth, x, y);
  if (!Z) return std::nullopt;
  const Eigen::Vector3d at = camera.unproject(x_px, y_px, *Z);
  constexpr double kLeastRadius = 8;  // px: far away, a few centimetres contain too few points
  reach = std::max(reach, kLeastRadius * *Z / camera.fx_px);
  const std::vector<Point> points = points_near(depth, camera, noise, at, reach);
  if (points.size() < kFewestPoints) return std::nullopt;
  std::optional<Plane> plane = fit(points, PlaneFitSettings{}.trials, kAnyWay);
  if (!plane) return std::nullopt;
  const Eigen::Vector3d ray = camera.unproject(x_px, y_px, 1.0);
  plane->middle = ray * (plane->offset / plane->normal.dot(ray));
  if (!((plane->middle - at).norm() <= reach / 2)) return std::nullopt;
  return plane;
}

Plane moved_by(const Rigid3& to_from, const Plane& plane) {
  Plane moved = plane;
  moved.normal = to_from.linear() * plane.normal;
  moved.offset = plane.offset + moved.normal.dot(to_from.translation());
  moved.middle = to_from * plane.middle;
  return moved;
}

Rigid3 camera_from_body_on(const Plane& plane) {
  const Eigen::Vector3d& Z = plane.normal;
  Eigen::Vector3d X = Eigen::Vector3d::UnitX() - Z.x() * Z;
  // On a plane that faces exactly left or right no direction points right; X then points forward.
  if (X.norm() < 1e-3) X = Eigen::Vector3d::UnitZ() - Z.z() * Z;
  X.normalize();
  Rigid3 pose = Rigid3::Identity();
  pose.linear().col(0) = X;
  pose.linear().col(1) = Z.cross(X);
  pose.linear().col(2) = Z;
  pose.translation() = plane.middle;
  return pose;
}

}  // namespace palpable
