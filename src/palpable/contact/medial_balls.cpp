#include "palpable/contact/medial_balls.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
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

  [[nodiscard]] bool is_medial(int x, int y) const {
    const float here = silhouette.distance(x, y);
    const float z = depth(x, y);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !inside(x + dx, y + dy)) continue;
        const float step = dx != 0 && dy != 0 ? 1.41421356f : 1.0f;
        if (silhouette.distance(x + dx, y + dy) >= here + kGrowth * step &&
            silhouette.joined(z, depth(x + dx, y + dy))) {
          return false;
        }
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

  // The front of a round thing of radius `radius` at its middle: each pixel of the window says how
  // deep that is, if the thing falls off to its outline like a circle. A plane through them, found
  // as 1/Z = a + b du + c dv: under perspective a plane is linear for the inverse depth.
  [[nodiscard]] std::optional<MedialBall> ball_at(int x, int y, float disc, float radius) const {
    const float z0 = depth(x, y);
    const float m_per_px = (z0 + radius) / static_cast<float>(camera.fx_px);
    const auto fattening = static_cast<float>(settings.fattening);
    const float outline = std::min(kOutlinePx, kOutlineShare * disc);
    double s = 0, su = 0, sv = 0, sw = 0, suu = 0, suv = 0, svv = 0, suw = 0, svw = 0;
    const PixelBox& box = silhouette.box();
    const int left = std::max(x - settings.reach, box.x);
    const int right = std::min(x + settings.reach, box.x + box.width - 1);
    const int top = std::max(y - settings.reach, box.y);
    const int bottom = std::min(y + settings.reach, box.y + box.height - 1);
    for (int v = top; v <= bottom; ++v) {
      for (int u = left; u <= right; ++u) {
        const float distance = silhouette.distance(u, v) - fattening;
        if (!(distance >= outline)) continue;
        const float z = depth(u, v);
        if (!silhouette.joined(z0, z)) continue;
        const float from_middle = radius - distance * m_per_px;
        const float falls =
            from_middle > 0
                ? radius - std::sqrt(std::max(0.0f, radius * radius - from_middle * from_middle))
                : 0.0f;
        const double w = 1.0 / static_cast<double>(z - falls);
        const double du = u - x, dv = v - y;
        s += 1, su += du, sv += dv, sw += w;
        suu += du * du, suv += du * dv, svv += dv * dv;
        suw += du * w, svw += dv * w;
      }
    }
    if (s < kLeastPixels) return std::nullopt;
    const double mu = su / s, mv = sv / s, mw = sw / s;
    const double cuu = suu / s - mu * mu, cuv = suv / s - mu * mv, cvv = svv / s - mv * mv;
    const double cuw = suw / s - mu * mw, cvw = svw / s - mv * mw;
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
    const double w = mw - b * mu - c * mv;  // at the pixel itself
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
        static_cast<int>(s)};
  }
};

// How much the front of a wide part bends at a pixel: a quadric
//     1/Z = a + b du + c dv + (p du^2 + 2 q du dv + r dv^2) / 2
// by least squares over the window. Under perspective a plane has p = q = r = 0. With X_u, X_v the
// steps on the front per pixel, its curvature is -c Q against G, G = (X_u X_v)^T (X_u X_v), and c
// turns a step of 1/Z to one along the normal.
std::optional<double> Finder::bends(int x, int y) const {
  const int reach = settings.reach;
  const float z0 = depth(x, y);
  double w00 = 0, wu = 0, wv = 0, wuu = 0, wuv = 0, wvv = 0;
  for (int v = -reach; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      if (!inside(x + u, y + v)) return std::nullopt;
      const float z = depth(x + u, y + v);
      if (!(silhouette.distance(x + u, y + v) > 0) || !silhouette.joined(z0, z)) {
        return std::nullopt;
      }
      const double w = 1.0 / static_cast<double>(z);
      w00 += w, wu += u * w, wv += v * w;
      wuu += u * u * w, wuv += u * v * w, wvv += v * v * w;
    }
  }
  // On the full square the odd moments vanish.
  const int side = 2 * reach + 1;
  double m2 = 0, m4 = 0;
  for (int u = -reach; u <= reach; ++u) m2 += u * u, m4 += static_cast<double>(u * u) * u * u;
  const double n = side, mean2 = m2 / n, spread = n * (m4 - m2 * mean2);
  const double a = w00 / (n * n), b = wu / (n * m2), c = wv / (n * m2);
  const double p = 2 * (wuu - mean2 * w00) / spread, r = 2 * (wvv - mean2 * w00) / spread;
  const double q = wuv / (m2 * m2);
  const double w = a - 0.5 * (p + r) * mean2;
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

// Points of pixels in another frame than the camera's.
class RayToRegion {
 public:
  RayToRegion(const PinholeCamera& camera, const Rigid3& region_from_camera)
      : origin_(region_from_camera.translation().cast<float>()) {
    const Eigen::Matrix3f R = region_from_camera.linear().cast<float>();
    across_ = R.col(0) / static_cast<float>(camera.fx_px);
    down_ = R.col(1) / static_cast<float>(camera.fy_px);
    first_ = R.col(2) - static_cast<float>(camera.cx_px) * across_ -
             static_cast<float>(camera.cy_px) * down_;
  }
  [[nodiscard]] Vector3f point(int x, int y, float z) const {
    return origin_ + z * (first_ + static_cast<float>(x) * across_ + static_cast<float>(y) * down_);
  }

 private:
  Vector3f origin_, across_, down_, first_;
};

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
      if (!region.box.contains(to_region.point(x, y, z))) continue;
      const float most = find.most_px(z);
      if (distance - fattening >= most) {
        const int stride =
            std::max(1, static_cast<int>(static_cast<float>(settings.spacing) * most));
        if (x % stride != 0 || y % stride != 0) continue;
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
      if (!find.is_medial(x, y)) continue;
      const float disc = std::clamp(find.disc_of(x, y) - fattening, kThinnest, most);
      const float radius = z * disc / (static_cast<float>(camera.fx_px) - disc);
      if (auto ball = find.ball_at(x, y, disc, radius)) balls.push_back(*ball);
    }
  }
}

}  // namespace palpable
