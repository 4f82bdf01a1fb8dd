#include "palpable/live/render/real_shadows.h"

#include "palpable/live/render/occlusion_bias.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr float kPlane = 0.008f;      // m: a surface this near to the plane is taken to be on it
constexpr float kSoftTop = 0.04f;     // m over which a shadow fades out at its upper end
constexpr float kOnThings = 0.5f;     // ratio of the shade on standing things to that on the plane
constexpr float kThickness = 0.035f;  // m, of a hand
constexpr float kLift = 0.003f;    // m from the vertex, along its normal, to the start of the ray
constexpr float kDarkest = 0.85f;  // largest shade on a body: light gets around a finger
constexpr int kBlock = 8;          // texels, side of a block

// Distances along the ray to the lamp, m; dense near the vertex, where things touch.
constexpr std::array<float, 12> kSteps = [] {
  std::array<float, 12> steps{};
  for (int i = 1; i <= 12; ++i) {
    const auto k = static_cast<float>(i);
    steps[static_cast<std::size_t>(i - 1)] = 0.006f * k + 0.0004f * k * k;
  }
  return steps;
}();

}  // namespace

void ShadeOnReal::clear(const PixelBox& box) {
  box_ = box;
  shaded_ = {};
  width_ = (box.width + 1) / 2;
  height_ = (box.height + 1) / 2;
  left_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 1.0f);
}

void ShadeOnReal::add(const GroundShadow& shadow, const Rigid3& camera_from_body, double strength,
                      const RealSurface& real) {
  constexpr int N = GroundShadow::kSide;
  const PinholeCamera& camera = real.camera;
  const Eigen::Isometry3f body_from_camera = camera_from_body.inverse().cast<float>();
  const Eigen::Vector3f eye = body_from_camera.translation();
  const Eigen::Vector3f right = body_from_camera.linear().col(0) / static_cast<float>(camera.fx_px);
  const Eigen::Vector3f down = body_from_camera.linear().col(1) / static_cast<float>(camera.fy_px);
  const Eigen::Vector4f& patch = shadow.box();
  const Eigen::Array2f corner = patch.head<2>();
  const Eigen::Array2f cells = N / (patch.tail<2>() - patch.head<2>()).array();
  for (int j = 0; j < height_; ++j) {
    const double v = box_.y + 2 * j + 1;  // px from the picture's edge
    for (int i = 0; i < width_; ++i) {
      const double u = box_.x + 2 * i + 1;
      // The pixel's ray in the body frame, per m of Z in the camera.
      const Eigen::Vector3f along = body_from_camera.linear().col(2) +
                                    static_cast<float>(u - 0.5 - camera.cx_px) * right +
                                    static_cast<float>(v - 0.5 - camera.cy_px) * down;
      const float plane_z = -eye.z() / along.z();  // below 0: the ray never meets the plane
      const float real_z = real.at(u, v);
      if (!(real_z > 0.0f) && !(plane_z > 0.0f)) continue;
      Eigen::Vector3f at = eye + along * (real_z > 0.0f ? real_z : plane_z);
      const float tolerance = kPlane + 2.0f * glsl::occlusion_bias(real_z);
      const bool on_plane = plane_z > 0.0f && std::abs(at.z()) < tolerance;
      if (on_plane) at = eye + along * plane_z;
      if (at.z() < -2.0f * tolerance) continue;
      const Eigen::Array2f cell =
          (at.head<2>().array() - (shadow.slope() * at.z()).array() - corner) * cells - 0.5f;
      // The rim of the shadow's image is lit, so cells without four neighbours can be left out.
      if (!(cell.minCoeff() >= 0.0f && cell.maxCoeff() < N - 1)) continue;
      const int x = static_cast<int>(cell.x()), y = static_cast<int>(cell.y());
      const float fx = cell.x() - static_cast<float>(x), fy = cell.y() - static_cast<float>(y);
      const float* shade = shadow.shade().data() + y * N + x;
      const float dark = (1 - fy) * ((1 - fx) * shade[0] + fx * shade[1]) +
                         fy * ((1 - fx) * shade[N] + fx * shade[N + 1]);
      if (dark == 0.0f) continue;
      // On the plane at.z() is 0 up to rounding, so its sign must not be used there.
      float below = 1.0f;
      if (!on_plane && at.z() > 0.0f) {
        const float* top = shadow.height().data() + y * N + x;
        const float high = std::max({top[0], top[1], top[N], top[N + 1]});
        const float thing = glsl::smoothstep(tolerance, 2.0f * tolerance, at.z());
        below -= glsl::smoothstep(high - kSoftTop, high, at.z());
        below *= 1.0f - (1.0f - kOnThings) * thing;
      } else if (!on_plane) {
        below -= glsl::smoothstep(tolerance, 2.0f * tolerance, -at.z());
      }
      // The texture is interpolated, so the shade extends by one texel on each side.
      shaded_ = united(shaded_, box_.cut({box_.x + 2 * i - 2, box_.y + 2 * j - 2, 6, 6}));
      left_[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) +
            static_cast<std::size_t>(i)] *= 1.0f - static_cast<float>(strength) * below * dark;
    }
  }
}

void ShadeOnBody::see(const RealSurface& real) {
  real_ = real;
  blocks_x_ = (real.box.width + kBlock - 1) / kBlock;
  blocks_y_ = (real.box.height + kBlock - 1) / kBlock;
  nearest_.assign(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_y_),
                  std::numeric_limits<float>::infinity());
  const auto w = static_cast<std::size_t>(real.box.width);
  for (int y = 0; y < real.box.height; ++y) {
    const float* row = real.depth.data() + static_cast<std::size_t>(y) * w;
    float* blocks = nearest_.data() + static_cast<std::ptrdiff_t>(y / kBlock) * blocks_x_;
    for (int x = 0; x < real.box.width; ++x) {
      if (row[x] > 0.0f) blocks[x / kBlock] = std::min(blocks[x / kBlock], row[x]);
    }
  }
}

// Whether no texel is nearer than z in the blocks between two positions (texels of the box).
bool ShadeOnBody::free_up_to(float z, const Eigen::Vector2f& a, const Eigen::Vector2f& b) const {
  const auto block = [](float texel, int count) {
    return std::clamp(static_cast<int>(std::floor(texel)) / kBlock, 0, count - 1);
  };
  const int x0 = block(std::min(a.x(), b.x()), blocks_x_);
  const int x1 = block(std::max(a.x(), b.x()), blocks_x_);
  const int y0 = block(std::min(a.y(), b.y()), blocks_y_);
  const int y1 = block(std::max(a.y(), b.y()), blocks_y_);
  for (int y = y0; y <= y1; ++y) {
    const float* row = nearest_.data() + static_cast<std::ptrdiff_t>(y) * blocks_x_;
    for (int x = x0; x <= x1; ++x) {
      if (row[x] < z) return false;
    }
  }
  return true;
}

void ShadeOnBody::find(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xf& normals,
                       const Rigid3& camera_from_body, const Eigen::Vector3f& to_light,
                       std::span<float> shaded) const {
  std::fill(shaded.begin(), shaded.end(), 0.0f);
  if (real_.box.empty()) return;
  const Eigen::Isometry3f to_camera = camera_from_body.cast<float>();
  const Eigen::Vector3f light_in_body = to_camera.linear().transpose() * to_light;
  const PinholeCamera& c = real_.camera;
  const auto fx = static_cast<float>(c.fx_px), fy = static_cast<float>(c.fy_px);
  const auto cx = static_cast<float>(c.cx_px), cy = static_cast<float>(c.cy_px);
  const Eigen::Vector2f scale = real_.texels_per_pixel.cast<float>();
  const Eigen::Vector2f corner = Eigen::Vector2i(real_.box.x, real_.box.y).cast<float>();
  const auto texel_of = [&](const Eigen::Vector3f& p) {
    return Eigen::Vector2f(Eigen::Vector2f((fx * p.x() / p.z() + cx + 0.5f) * scale.x(),
                                           (fy * p.y() / p.z() + cy + 0.5f) * scale.y()) -
                           corner);
  };
  constexpr float kLeastZ = 0.01f;
  for (Eigen::Index k = 0; k < vertices.cols(); ++k) {
    if (normals.col(k).dot(light_in_body) <= 0.0f) continue;
    const Eigen::Vector3f x = to_camera * Eigen::Vector3f(vertices.col(k) + kLift * normals.col(k));
    const Eigen::Vector3f end = x + kSteps.back() * to_light;
    if (x.z() < kLeastZ || end.z() < kLeastZ) continue;
    if (free_up_to(std::max(x.z(), end.z()), texel_of(x), texel_of(end))) continue;
    float most = 0.0f;
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
      const Eigen::Vector3f p = x + kSteps[i] * to_light;
      const Eigen::Vector2f texel = texel_of(p);
      const int u = static_cast<int>(std::floor(texel.x()));
      const int v = static_cast<int>(std::floor(texel.y()));
      if (u < 0 || v < 0 || u >= real_.box.width || v >= real_.box.height) break;
      const float real =
          real_.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(real_.box.width) +
                      static_cast<std::size_t>(u)];
      if (!(real > 0.0f)) continue;
      const float behind = p.z() - real;
      const float bias = 0.002f + glsl::occlusion_bias(p.z());
      // Farther things throw softer shadows.
      const float here = glsl::smoothstep(bias, 1.5f * bias, behind) *
                         (1.0f - glsl::smoothstep(0.8f * kThickness, kThickness, behind)) *
                         (1.0f - 0.05f * static_cast<float>(i + 1));
      most = std::max(most, here);
    }
    shaded[static_cast<std::size_t>(k)] = kDarkest * most;
  }
}

}  // namespace palpable
