#include "palpable/contact/medial_balls.h"

#include "palpable/base/contract.h"
#include "palpable/contact/ray_to_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// A step towards the middle of a thing makes its disc grow by nearly its length. A neighbour whose
// disc is larger by this share of the step holds the pixel's own. With 0.85 half of the balls are
// left, but the corners of a cup are rounded off: it is missed in 25 of 172 frames instead of 2.
constexpr float kGrowth = 0.95f;

// Pixels at the outline are the steepest and the worst matched. They are left out of a fit unless
// nothing else is there.
constexpr float kOutlineShare = 0.4f;
constexpr float kOutlinePx = 1.5f;

constexpr float kThinnest = 1.0f / 3;  // px, a disc

// The direction of a front must be known to about a tenth: a window that is one pixel wide says
// nothing across.
constexpr double kLeastSpread = 0.4;  // px^2, variance of the pixels in the window
constexpr int kLeastPixels = 5;

// A front that is seen flatter than this says little about how deep its thing is.
constexpr double kLeastFacing = 0.4;

struct Finder {
  const DepthImage& depth;
  const PinholeCamera& camera;
  const Silhouette& silhouette;
  const MedialBallSettings& settings;

  [[nodiscard]] bool inside(int x, int y) const {
    const PixelBox& box = silhouette.box();
    return x >= box.x && y >= box.y && x < box.x + box.width && y < box.y + box.height;
  }

  [[nodiscard]] float most_px(float z) const {
    const auto r = static_cast<float>(settings.most_radius);
    return static_cast<float>(camera.fx_px) * r / (z + r);
  }

  // Whether the disc of the neighbour at (dx, dy) holds that of pixel (x, y).
  [[nodiscard]] bool is_held(int x, int y, int dx, int dy) const {
    if (!inside(x + dx, y + dy)) return false;
    const float step = dx != 0 && dy != 0 ? 1.41421356f : 1.0f;
    return silhouette.distance(x + dx, y + dy) >= silhouette.distance(x, y) + kGrowth * step &&
           silhouette.joined(depth(x, y), depth(x + dx, y + dy));
  }

  [[nodiscard]] bool is_medial(int x, int y) const {
    // Most pixels are not, and of those most are held by a neighbour away from the outline.
    const ToOutline out = silhouette.to_outline(x, y);
    const int u = (out.dx < 0 ? 1 : 0) - (out.dx > 0 ? 1 : 0);
    const int v = (out.dy < 0 ? 1 : 0) - (out.dy > 0 ? 1 : 0);
    if (std::abs(out.dx) > 2 * std::abs(out.dy)   ? is_held(x, y, u, 0)
        : std::abs(out.dy) > 2 * std::abs(out.dx) ? is_held(x, y, 0, v)
                                                  : is_held(x, y, u, v)) {
      return false;
    }
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx != 0 || dy != 0) && is_held(x, y, dx, dy)) return false;
      }
    }
    return true;
  }

  // px, of the disc round a medial pixel. The true middle lies between pixels; there the outlines
  // on both sides are equally far.
  [[nodiscard]] float disc_of(int x, int y) const {
    const float here = silhouette.distance(x, y);
    const ToOutline mine = silhouette.to_outline(x, y);
    float widest = here;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !inside(x + dx, y + dy)) continue;
        const float other = silhouette.distance(x + dx, y + dy);
        if (!(other > 0) || !std::isfinite(other)) continue;
        const ToOutline theirs = silhouette.to_outline(x + dx, y + dy);
        const auto across = static_cast<float>(theirs.dx * mine.dx + theirs.dy * mine.dy);
        const float lengths = (here + 0.5f) * (other + 0.5f);
        if (across > -0.8f * lengths) continue;  // not on the other side
        const auto wx = static_cast<float>(dx + theirs.dx - mine.dx);
        const auto wy = static_cast<float>(dy + theirs.dy - mine.dy);
        widest = std::max(widest, std::sqrt(wx * wx + wy * wy) / 2 - 0.5f);
      }
    }
    return std::min(widest, here + 0.75f);
  }

  // 1/m: the largest principal curvature of the front, positive where it bends away from the
  // camera. Nothing where the window is not whole.
  [[nodiscard]] std::optional<double> bends(int x, int y) const;

  // Sums over a window, of pixels at (du, dv) from its middle (px): 1, their inverse depth less
  // 1/Z of the middle one, and the products of these with du and dv.
  struct Sums {
    double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
    double e = 0, ue = 0, ve = 0, uue = 0, uve = 0, vve = 0;
  };
  // Of the pixels of the middle one's surface whose distance is `least` px or more. What a thing
  // whose section is a circle of `radius` falls off from its middle is taken out; 0: nothing is.
  [[nodiscard]] Sums sum_window(int x, int y, float least, float radius) const;

  // The front of a round thing of radius `radius` at its middle: each pixel of the window says how
  // deep that is, if the thing falls off to its outline like a circle. A plane through them, found
  // as 1/Z = a + b du + c dv: under perspective a plane is linear for the inverse depth.
  [[nodiscard]] std::optional<MedialBall> ball_at(int x, int y, float disc, float radius) const {
    const auto fattening = static_cast<float>(settings.fattening);
    const Sums s = sum_window(x, y, fattening + std::min(kOutlinePx, kOutlineShare * disc), radius);
    if (s.n < kLeastPixels) return std::nullopt;
    const double mu = s.u / s.n, mv = s.v / s.n, me = s.e / s.n;
    const double cuu = s.uu / s.n - mu * mu, cuv = s.uv / s.n - mu * mv;
    const double cvv = s.vv / s.n - mv * mv;
    const double cuw = s.ue / s.n - mu * me, cvw = s.ve / s.n - mv * me;
    const double determinant = cuu * cvv - cuv * cuv;
    double b = 0, c = 0;
    if (determinant >= kLeastSpread * std::max(cuu, cvv)) {
      b = (cvv * cuw - cuv * cvw) / determinant;
      c = (cuu * cvw - cuv * cuw) / determinant;
    } else {  // a line of pixels: the slope along it alone
      const double trace = cuu + cvv;
      if (!(trace > kLeastSpread)) return std::nullopt;
      const double along = (cuw * cuu + cvw * cuv) / (trace * trace);
      const double other = (cuw * cuv + cvw * cvv) / (trace * trace);
      b = along, c = other;
    }
    const double w =
        1.0 / static_cast<double>(depth(x, y)) + me - b * mu - c * mv;  // at the pixel itself
    if (!(w > 0)) return std::nullopt;
    const Vector3d ray((x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px, 1);
    // The plane n.X = k is 1/Z = n.ray / k: n is proportional to the gradient of 1/Z with respect
    // to the ray, completed so that the plane passes through the point itself.
    const double bx = b * camera.fx_px, by = c * camera.fy_px;
    const Vector3d normal = -Vector3d(bx, by, w - bx * ray.x() - by * ray.y()).normalized();
    // On the ray, as deep as the front's slope has it: of a finger that points away from the camera
    // the last disc shows its tip, while the normal of the front there leads back into its shaft.
    const double facing = std::max(kLeastFacing, -normal.dot(ray.normalized()));
    const Vector3d centre = ray / w + static_cast<double>(radius) / facing * ray.normalized();
    return MedialBall{
        (ray / w).cast<float>(), normal.cast<float>(), centre.cast<float>(), radius, x, y,
        static_cast<int>(s.n)};
  }
};

// Twelve pixels of a row at a time: a window of the usual reach is eleven wide.
constexpr int kLanes = 12;
using Lanes = Eigen::Array<float, kLanes, 1>;

Finder::Sums Finder::sum_window(int x, int y, float least, float radius) const {
  const PixelBox& box = silhouette.box();
  const int reach = settings.reach;
  const int top = std::max(y - reach, box.y), bottom = std::min(y + reach, box.y + box.height - 1);
  const int right = std::min(x + reach, box.x + box.width - 1);
  const float z0 = depth(x, y), w0 = 1 / z0;
  const float m_per_px = (z0 + radius) / static_cast<float>(camera.fx_px);
  const auto fattening = static_cast<float>(settings.fattening);
  const auto least_jump = static_cast<float>(silhouette.settings().least_jump);
  const auto jump = static_cast<float>(silhouette.settings().largest_jump_at_1m);
  Sums sums;
  for (int left = std::max(x - reach, box.x); left <= right; left += kLanes) {
    const int count = std::min(right - left + 1, kLanes);
    const bool whole = left + kLanes <= box.x + box.width;  // else the row ends before
    alignas(16) std::array<float, kLanes> z_end{}, distance_end{};
    Lanes n = Lanes::Zero(), nv = n, nvv = n, e = n, ev = n, evv = n;
    for (int v = top; v <= bottom; ++v) {
      const float* z = depth.row(v) + left;
      const float* distance = silhouette.row(v) + (left - box.x);
      if (!whole) {
        std::copy_n(z, count, z_end.data());
        std::copy_n(distance, count, distance_end.data());
        z = z_end.data(), distance = distance_end.data();
      }
      Lanes counts, depths, inside;
      for (int k = 0; k < kLanes; ++k) {
        const float nearer = z[k] < z0 ? z[k] : z0;
        const float apart = std::max(least_jump, jump * nearer * nearer);
        const bool is_in = static_cast<int>(distance[k] >= least) &
                           static_cast<int>(std::abs(z[k] - z0) <= apart) &
                           static_cast<int>(k < count);
        counts[k] = is_in ? 1.0f : 0.0f;
        depths[k] = is_in ? z[k] : z0;
        inside[k] = is_in ? distance[k] : least;
      }
      if (radius > 0) {
        const Lanes from_middle = (radius - (inside - fattening) * m_per_px).max(0.0f);
        depths -= radius - (radius * radius - from_middle.square()).max(0.0f).sqrt();
      }
      const Lanes apart = counts * (depths.inverse() - w0);
      const auto dv = static_cast<float>(v - y);
      n += counts, nv += dv * counts, nvv += dv * dv * counts;
      e += apart, ev += dv * apart, evv += dv * dv * apart;
    }
    const Lanes du = Lanes::LinSpaced(kLanes, 0, kLanes - 1) + static_cast<float>(left - x);
    const auto sum = [](const Lanes& of) { return static_cast<double>(of.sum()); };
    sums.n += sum(n), sums.u += sum(du * n), sums.v += sum(nv);
    sums.uu += sum(du.square() * n), sums.uv += sum(du * nv), sums.vv += sum(nvv);
    sums.e += sum(e), sums.ue += sum(du * e), sums.ve += sum(ev);
    sums.uue += sum(du.square() * e), sums.uve += sum(du * ev), sums.vve += sum(evv);
  }
  return sums;
}

// How much the front of a wide part bends at a pixel: a quadric
//     1/Z = a + b du + c dv + (p du^2 + 2 q du dv + r dv^2) / 2
// by least squares over the window. Under perspective a plane has p = q = r = 0. With X_u, X_v the
// steps on the front per pixel, its curvature is -c Q against G, G = (X_u X_v)^T (X_u X_v), and c
// turns a step of 1/Z to one along the normal.
std::optional<double> Finder::bends(int x, int y) const {
  const int reach = settings.reach;
  const int side = 2 * reach + 1;
  constexpr float kAny = std::numeric_limits<float>::min();  // of a thing
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
  const Finder find{depth, camera, silhouette, settings};
  const auto fattening = static_cast<float>(settings.fattening);
  const PixelBox& box = silhouette.box();
  const RayToRegion to_region(camera, region.region_from_camera);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const float distance = silhouette.distance(x, y);
      if (!(distance > 0)) continue;
      const float z = depth(x, y);
      const auto is_wanted = [&] { return region.box.contains(to_region.point(x, y, z)); };
      const float most = find.most_px(z);
      if (distance - fattening >= most) {
        const int stride =
            std::max(1, static_cast<int>(static_cast<float>(settings.spacing) * most));
        if (x % stride != 0 || y % stride != 0 || !is_wanted()) continue;
        double radius = settings.most_radius;
        // Fingers side by side have no outline between them, but they bend.
        if (const auto bend = find.bends(x, y); bend && *bend * radius > 1) {
          radius = std::max(1 / *bend, settings.least_relief);
        }
        if (auto ball = find.ball_at(x, y, most, static_cast<float>(radius))) {
          balls.push_back(*ball);
        }
        continue;
      }
      if (!find.is_medial(x, y) || !is_wanted()) continue;
      const float disc = std::clamp(find.disc_of(x, y) - fattening, kThinnest, most);
      const float radius = z * disc / (static_cast<float>(camera.fx_px) - disc);
      if (auto ball = find.ball_at(x, y, disc, radius)) balls.push_back(*ball);
    }
  }
}

}  // namespace palpable
