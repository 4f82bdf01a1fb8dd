#include "palpable/live/seen_object/medial_balls.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/seen_object/pixel_kernels.h"
#include "palpable/live/seen_object/ray_to_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;

// px per px: a neighbour's disc contains the pixel's own if it is larger by at least this ratio to
// the step between them. (A step towards the middle of a thing enlarges the disc by nearly the
// step's length.) Smaller values leave fewer balls: with 0.85 half of them, but the corners of a
// cup are rounded off, and it is missed in 25 of 172 frames instead of 2.
constexpr float kGrowth = 0.95f;

// Pixels nearer to the outline than min(kOutlinePx, kOutlineShare * the disc's radius) are left out
// of a fit: there the surface is steepest and matched worst. Ratio, and px.
constexpr float kOutlineShare = 0.4f;
constexpr float kOutlinePx = 1.5f;

// px: the largest difference in radius of the disc around the true middle, which lies between
// pixels, and that around its pixel.
constexpr float kMostBeside = 0.75f;

// Two pixels see opposite sides of a thing if the cosine of the angle between the directions to
// their nearest outlines is at most this.
constexpr float kOpposite = -0.8f;

// px per px. A thing ends in a direction in which distances to the outline fall by kFalls or more,
// while in the opposite direction they change by less than kFlat.
constexpr float kFalls = 0.3f, kFlat = 0.3f;

constexpr int kRowChunk = 64;  // px of a row that find_middles() tests in one call

constexpr float kThinnest = 1.0f / 3;  // px, the least radius of a disc

// Least variance of the pixels of a fit (px^2), so that the slope is known to about a tenth: a
// window that is one pixel wide does not determine the slope across.
constexpr double kLeastWindowSpread = 0.4;
constexpr int kLeastWindowPixels = 5;

// The cosine of the angle between ray and normal is taken to be at least this: 1 / cosine, by which
// the depth of the centre is found, is too uncertain for steeper fronts.
constexpr double kLeastFacing = 0.4;

// Before a ball is fitted, its centre is guessed to lie this number of radii behind the pixel's
// point. Of 41,000 balls of six films, the fitted ones lay up to 4 mm nearer to the region than the
// guess.
constexpr float kRadiiBehind = 1.25f;
constexpr float kGuess = 0.006f;  // m, tolerance of the guess

struct Finder {
  const DepthImage& depth;
  const PinholeCamera& camera;
  const Silhouette& silhouette;
  const MedialBallSettings& settings;
  const PixelKernels& kernels;

  [[nodiscard]] bool inside(int x, int y) const {
    const PixelBox& box = silhouette.box();
    return x >= box.x && y >= box.y && x < box.x + box.width && y < box.y + box.height;
  }

  [[nodiscard]] float most_px(float z) const {
    const auto r = static_cast<float>(settings.most_radius);
    return static_cast<float>(camera.fx_px) * r / (z + r);
  }

  struct Disc {
    float radius = 0;  // px
    Vector2f middle;   // px, from the pixel to the disc's middle
  };
  // The largest disc of the silhouette near a medial pixel. Its middle lies between pixels: the
  // pixel's own outline and that of a neighbour on the other side of the middle are equally far
  // from it. A ball at the pixel itself with this radius would stand up to 1 px out of the thing.
  [[nodiscard]] Disc disc_at(int x, int y) const {
    const float here = silhouette.distance(x, y);
    const Vector2f to_mine = direction_to_outline(x, y);
    float widest = here;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !inside(x + dx, y + dy)) continue;
        const float other = silhouette.distance(x + dx, y + dy);
        if (!(other > 0) || !std::isfinite(other)) continue;
        const Vector2f to_theirs = direction_to_outline(x + dx, y + dy);
        if (to_theirs.dot(to_mine) > kOpposite) continue;
        const Vector2f step(static_cast<float>(dx), static_cast<float>(dy));
        widest = std::max(widest, (step + other * to_theirs - here * to_mine).norm() / 2);
      }
    }
    const float radius = std::min(widest, here + kMostBeside);
    return {radius, (here - radius) * to_mine};
  }

  // The unit vector from a pixel towards its nearest outline, in the image. Undefined where
  // silhouette.distance() is infinite.
  [[nodiscard]] Vector2f direction_to_outline(int x, int y) const {
    const ToOutline to = silhouette.to_outline(x, y);
    return Vector2f(static_cast<float>(to.dx), static_cast<float>(to.dy)).normalized();
  }

  // The largest principal curvature of the front (1/m), positive where it curves away from the
  // camera. Nothing where the window has pixels without depth.
  [[nodiscard]] std::optional<double> largest_curvature(int x, int y) const;

  // Sums over a window, for pixels at (du, dv) from its middle (px): of 1, of e = 1/Z - 1/Z of the
  // middle, and of their products with du and dv.
  struct Sums {
    double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
    double e = 0, ue = 0, ve = 0, uue = 0, uve = 0, vve = 0;
  };
  // Sums over the pixels of the middle one's surface whose distance to the outline is `least` px or
  // more. @param radius  m: from each depth, the amount is subtracted by which a section that is a
  // circle of this radius recedes from its middle; 0: nothing is subtracted
  [[nodiscard]] Sums sum_window(int x, int y, float least, float radius) const;

  // The offset (px) from a medial pixel to the middle of its thing's end, less than one step. A
  // step towards the end lowers the distance to the outline by the step's length less that offset.
  [[nodiscard]] Vector2f to_end(int x, int y) const {
    constexpr std::array<std::array<int, 2>, 8> kAround{
        {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
    const float here = silhouette.distance(x, y);
    std::array<float, 8> falls;  // px per px
    for (std::size_t k = 0; k < kAround.size(); ++k) {
      const int u = x + kAround[k][0], v = y + kAround[k][1];
      const float there = inside(u, v) ? silhouette.distance(u, v) : 0;
      if (!(there > 0) || !std::isfinite(there)) return Vector2f::Zero();
      falls[k] = (here - there) / (k % 2 == 0 ? 1.0f : std::numbers::sqrt2_v<float>);
    }
    Vector2f way = Vector2f::Zero();
    float flattest = kFlat;
    for (std::size_t k = 0; k < kAround.size(); ++k) {
      const float behind = std::abs(falls[(k + 4) % 8]);
      // All three directions ahead must fall: on the middle line of a slanted thing, which lies
      // between pixels, a single one may fall.
      const float ahead = std::min({falls[k], falls[(k + 1) % 8], falls[(k + 7) % 8]});
      if (behind >= flattest || ahead < kFalls) continue;
      flattest = behind;
      way = std::max(1 - falls[k], 0.0f) *
            Vector2f(static_cast<float>(kAround[k][0]), static_cast<float>(kAround[k][1]));
    }
    return way;
  }

  // Fits the ball of a thing whose section is a circle of `radius`: a plane through the depths that
  // each pixel of the window gives for the section's middle, as 1/Z = a + b du + c dv, because
  // under perspective the inverse depth of a plane is linear.
  // @param on      px, from the pixel to where the ball is wanted
  // @param nearer  1/m, added to the measured inverse depth (MedialBallSettings::too_far)
  [[nodiscard]] std::optional<MedialBall> ball_at(int x, int y, float disc, float radius,
                                                  const Vector2f& on = {0, 0},
                                                  double nearer = 0) const {
    const auto fattening = static_cast<float>(settings.fattening);
    const Sums s = sum_window(x, y, fattening + std::min(kOutlinePx, kOutlineShare * disc), radius);
    if (s.n < kLeastWindowPixels) return std::nullopt;
    const double mu = s.u / s.n, mv = s.v / s.n, me = s.e / s.n;
    const double cuu = s.uu / s.n - mu * mu, cuv = s.uv / s.n - mu * mv;
    const double cvv = s.vv / s.n - mv * mv;
    const double cuw = s.ue / s.n - mu * me, cvw = s.ve / s.n - mv * me;
    const double determinant = cuu * cvv - cuv * cuv;
    double b = 0, c = 0;
    if (determinant >= kLeastWindowSpread * std::max(cuu, cvv)) {
      b = (cvv * cuw - cuv * cvw) / determinant;
      c = (cuu * cvw - cuv * cuw) / determinant;
    } else {  // the pixels form a line: only the slope along it
      const double trace = cuu + cvv;
      if (!(trace > kLeastWindowSpread)) return std::nullopt;
      const double along = (cuw * cuu + cvw * cuv) / (trace * trace);
      const double other = (cuw * cuv + cvw * cvv) / (trace * trace);
      b = along, c = other;
    }
    const double u = static_cast<double>(on.x()), v = static_cast<double>(on.y());
    const double w =
        1.0 / static_cast<double>(depth(x, y)) + me + b * (u - mu) + c * (v - mv) + nearer;
    if (!(w > 0)) return std::nullopt;
    const Vector3d ray((x + u - camera.cx_px) / camera.fx_px, (y + v - camera.cy_px) / camera.fy_px,
                       1);
    // The plane n.X = k is 1/Z = n.ray / k: n is proportional to the gradient of 1/Z with respect
    // to the ray, completed so that the plane passes through the point itself.
    const double bx = b * camera.fx_px, by = c * camera.fy_px;
    const Vector3d normal = -Vector3d(bx, by, w - bx * ray.x() - by * ray.y()).normalized();
    // The centre lies on the ray, not along the normal: for a finger that points away from the
    // camera the last disc shows its tip, but the normal of the front there leads back into its
    // shaft.
    const double facing = std::max(kLeastFacing, -normal.dot(ray.normalized()));
    const Vector3d centre = ray / w + static_cast<double>(radius) / facing * ray.normalized();
    return MedialBall{
        (ray / w).cast<float>(), normal.cast<float>(), centre.cast<float>(), radius, x, y,
        static_cast<int>(s.n)};
  }
};

using Lanes = Eigen::Array<float, kWindowColumns, 1>;
using Columns = Eigen::Map<const Lanes, Eigen::Aligned16>;

Finder::Sums Finder::sum_window(int x, int y, float least, float radius) const {
  const PixelBox& box = silhouette.box();
  const int reach = settings.reach;
  const float z = depth(x, y);
  PixelWindow window;
  window.stride = silhouette.stride();
  window.top = std::max(-reach, box.y - y);
  window.bottom = std::min(reach, box.y + box.height - 1 - y);
  window.z = z;
  window.least = least;
  window.radius = radius;
  window.fattening = static_cast<float>(settings.fattening);
  window.m_per_px = (z + radius) / static_cast<float>(camera.fx_px);
  const int right = std::min(x + reach, box.x + box.width - 1);
  Sums sums;
  for (int left = std::max(x - reach, box.x); left <= right; left += kWindowColumns) {
    const DistanceRow first = silhouette.distances(left, y + window.top);
    window.depth = first.depth;
    window.distance = first.distance;
    window.columns = std::min(right - left + 1, kWindowColumns);
    ColumnSums of;
    kernels.sum_window(window, silhouette.jump(), of);
    const Columns n(of.n.data()), nv(of.nv.data()), nvv(of.nvv.data());
    const Columns e(of.w.data()), ev(of.vw.data()), evv(of.vvw.data());
    const Lanes du =
        Lanes::LinSpaced(kWindowColumns, 0, kWindowColumns - 1) + static_cast<float>(left - x);
    const auto sum = [](const Lanes& of_columns) { return static_cast<double>(of_columns.sum()); };
    sums.n += sum(n), sums.u += sum(du * n), sums.v += sum(nv);
    sums.uu += sum(du.square() * n), sums.uv += sum(du * nv), sums.vv += sum(nvv);
    sums.e += sum(e), sums.ue += sum(du * e), sums.ve += sum(ev);
    sums.uue += sum(du.square() * e), sums.uve += sum(du * ev), sums.vve += sum(evv);
  }
  return sums;
}

// Fits a quadric to the front of a wide part
//     1/Z = a + b du + c dv + (p du^2 + 2 q du dv + r dv^2) / 2
// by least squares over the window. Under perspective a plane has p = q = r = 0. With X_u, X_v the
// displacement on the front per pixel, G = (X_u X_v)^T (X_u X_v), Q = (p q; q r), and s the factor
// from a change of 1/Z to a displacement along the normal, the curvature is -s G^-1 Q.
std::optional<double> Finder::largest_curvature(int x, int y) const {
  const int reach = settings.reach;
  const int side = 2 * reach + 1;
  constexpr float kAny = std::numeric_limits<float>::min();  // any pixel of a thing
  const Sums s = sum_window(x, y, kAny, 0);
  if (s.n < side * side) return std::nullopt;
  // On the full square the odd moments vanish.
  double m2 = 0, m4 = 0;
  for (int u = -reach; u <= reach; ++u) m2 += u * u, m4 += static_cast<double>(u * u) * u * u;
  const double n = side, mean2 = m2 / n, spread = n * (m4 - m2 * mean2);
  const double b = s.ue / (n * m2), c = s.ve / (n * m2);
  const double p = 2 * (s.uue - mean2 * s.e) / spread, r = 2 * (s.vve - mean2 * s.e) / spread;
  const double q = s.uve / (m2 * m2);
  const double w = 1.0 / static_cast<double>(depth(x, y)) + s.e / (n * n) - 0.5 * (p + r) * mean2;
  if (!(w > 0)) return std::nullopt;
  const Vector3d ray((x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px, 1);
  const Vector3d Xu = (Vector3d(1 / camera.fx_px, 0, 0) - ray * (b / w)) / w;
  const Vector3d Xv = (Vector3d(0, 1 / camera.fy_px, 0) - ray * (c / w)) / w;
  const Vector3d normal = Xu.cross(Xv).normalized();
  const double scale = std::abs(normal.dot(ray)) / (w * w);
  Eigen::Matrix2d G, Q;
  G << Xu.dot(Xu), Xu.dot(Xv), Xu.dot(Xv), Xv.dot(Xv);
  Q << p, q, q, r;
  const Eigen::Matrix2d S = -scale * G.inverse() * Q;
  const double half = S.trace() / 2;
  return half + std::sqrt(std::max(0.0, half * half - S.determinant()));
}

}  // namespace

void find_medial_balls(const DepthImage& depth, const PinholeCamera& camera,
                       const Silhouette& silhouette, const MedialBallSettings& settings,
                       const BallRegion& region, std::vector<MedialBall>& balls) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the camera is the depth image's own");
  PALPABLE_EXPECT(settings.most_radius > 0 && settings.reach >= 1 && settings.spacing > 0,
                  "radius, reach and spacing are above 0");
  balls.clear();
  const Finder find{depth, camera, silhouette, settings, best_pixel_kernels()};
  const auto fattening = static_cast<float>(settings.fattening);
  const PixelBox& box = silhouette.box();
  const RayToRegion to_region(camera, region.region_from_camera);
  const auto radius_of = [&](float disc, float z) {
    return z * disc / (static_cast<float>(camera.fx_px) - disc);
  };
  MiddleTest test;
  test.growth = kGrowth;
  test.fattening = fattening;
  test.r = static_cast<float>(settings.most_radius);
  test.f_r = static_cast<float>(camera.fx_px) * test.r;
  std::array<float, kRowChunk> distances;
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto [begin, end] = silhouette.things_of_row(y);
    for (int x = begin, chunk = kRowChunk; x < end; ++x, ++chunk) {
      if (chunk == kRowChunk) {
        chunk = 0;
        find.kernels.find_middles(silhouette.distances(x, y - 1), silhouette.distances(x, y),
                                  silhouette.distances(x, y + 1), std::min(kRowChunk, end - x),
                                  silhouette.jump(), test, distances.data());
      }
      const float distance = distances[static_cast<std::size_t>(chunk)];
      if (!(distance > 0)) continue;
      const float z = depth(x, y);
      const auto is_wanted = [&](float radius) {
        const Vector3f seen = to_region.point(x, y, z);
        if (!region.box.contains(seen)) return false;
        const Vector3f guess =
            seen + kRadiiBehind * radius * to_region.direction(x, y).normalized();
        return region.reached.squaredExteriorDistance(guess) <
               (radius + kGuess) * (radius + kGuess);
      };
      const float most = find.most_px(z);
      if (distance - fattening >= most) {
        const int stride =
            std::max(1, static_cast<int>(static_cast<float>(settings.spacing) * most));
        double radius = settings.most_radius;
        if (x % stride != 0 || y % stride != 0 || !is_wanted(static_cast<float>(radius))) continue;
        // Fingers side by side may have no outline between them, but their fronts are curved.
        if (const auto curvature = find.largest_curvature(x, y);
            curvature && *curvature * radius > 1) {
          radius = std::max(1 / *curvature, settings.least_relief);
        }
        if (auto ball = find.ball_at(x, y, most, static_cast<float>(radius))) {
          balls.push_back(*ball);
        }
        continue;
      }
      // Rejects most pixels early: a ball reaches no farther from the seen point than this.
      const float largest = std::clamp(distance + kMostBeside - fattening, kThinnest, most);
      const float farthest = (1 + kRadiiBehind) * radius_of(largest, z) + kGuess;
      if (region.reached.squaredExteriorDistance(to_region.point(x, y, z)) > farthest * farthest) {
        continue;
      }
      const auto [widest, middle] = find.disc_at(x, y);
      const float disc = std::clamp(widest - fattening, kThinnest, most);
      const float radius = radius_of(disc, z);
      if (!is_wanted(radius)) continue;
      if (auto ball =
              find.ball_at(x, y, disc, radius, middle + find.to_end(x, y), settings.too_far)) {
        balls.push_back(*ball);
      }
    }
  }
}

}  // namespace palpable
