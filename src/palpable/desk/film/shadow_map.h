/// @file
/// The sun (the parallel light of a window) and its shadow maps. Desk frame (script/desk_body.h),
/// m. The OpenGL context must be current.
#pragma once

#include "palpable/live/render/gl_objects.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <array>

namespace palpable {

/// The direction to the sun: unit vector, desk frame.
[[nodiscard]] inline const Eigen::Vector3d& to_sun() {
  static const Eigen::Vector3d kToSun = Eigen::Vector3d(-0.46, -0.30, 0.84).normalized();
  return kToSun;
}

/// From the desk frame to a map of parallel light, 0..1. The map shows a square perpendicular to
/// the light.
/// @param centre      of the square, m
/// @param half_width  of the square, m
/// @param reach       depth range of the map along the light, to either side of the centre, m
[[nodiscard]] inline Eigen::Matrix4d light_from_desk(const Eigen::Vector3d& centre,
                                                     double half_width, double reach) {
  Eigen::Matrix3d R;
  R.row(2) = -to_sun();
  R.row(0) = Eigen::Vector3d::UnitY().cross(to_sun()).normalized();
  R.row(1) = R.row(2).cross(R.row(0));
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<2, 3>(0, 0) = R.topRows<2>() / (2.0 * half_width);
  m.block<1, 3>(2, 0) = R.row(2) / (2.0 * reach);
  m.block<3, 1>(0, 3) = Eigen::Vector3d::Constant(0.5) - m.block<3, 3>(0, 0) * centre;
  return m;
}

/// `m` with its result in clip coordinates, -1..1 instead of 0..1.
[[nodiscard]] inline Eigen::Matrix4f to_clip(const Eigen::Matrix4d& m) {
  Eigen::Matrix4d scale = 2.0 * Eigen::Matrix4d::Identity();
  scale.block<3, 1>(0, 3).setConstant(-1.0);
  scale(3, 3) = 1.0;
  return (scale * m).cast<float>();
}

/// The depth as seen from the sun; the texture unit compares with it and filters. Points outside of
/// the map are lit.
struct ShadowMap {
  GlTexture depth;
  GlFramebuffer target;
  /// From the desk frame to the map: 0..1 across it and in depth.
  Eigen::Matrix4d light;
  /// Share of the sun's light that reaches the desk's top, 0..1, where the map shows it.
  GlTexture top;
  GlFramebuffer top_target;

  ShadowMap(int size, const Eigen::Matrix4d& light_from_desk_matrix)
      : depth(GL_DEPTH_COMPONENT32F, size, size, GL_LINEAR),
        target({}, &depth),
        light(light_from_desk_matrix),
        top(GL_R8, size, size, GL_LINEAR) {
    const std::array<const GlTexture*, 1> colors = {&top};
    top_target = GlFramebuffer(colors, nullptr);
    const GLuint name = depth.get();
    glTextureParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    const std::array<float, 4> lit = {1, 1, 1, 1};
    glTextureParameterfv(name, GL_TEXTURE_BORDER_COLOR, lit.data());
    glNamedFramebufferDrawBuffer(target.get(), GL_NONE);
    glNamedFramebufferReadBuffer(target.get(), GL_NONE);
  }
  /// Spacing of the four comparisons of a look-up (lit.glsl), ratio to the map's width; soft edges
  /// of about three texels.
  [[nodiscard]] float spread() const { return 2.25F / static_cast<float>(depth.width()); }
  /// The depth of the desk's top at (u, v) in the map is the dot product of this with (u, v, 1).
  [[nodiscard]] Eigen::Vector3f depth_of_top() const {
    Eigen::Matrix3d uv1_from_xy1;  // for points at height 0
    uv1_from_xy1 << light.block<2, 2>(0, 0), light.block<2, 1>(0, 3), 0, 0, 1;
    const Eigen::RowVector3d z(light(2, 0), light(2, 1), light(2, 3));
    return (z * uv1_from_xy1.inverse()).transpose().cast<float>();
  }
};

}  // namespace palpable
