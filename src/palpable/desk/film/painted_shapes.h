/// @file
/// Simple painted surfaces: rectangles, boxes, surfaces of revolution. Lengths in m, in any frame.
#pragma once

#include "palpable/desk/film/painted_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpable {

/// Adds a rectangle.
/// @param corners  counter-clockwise as seen from outside, the first two at the lower edge of the
///                 image
/// @param uv0,uv1  upper left and lower right corner of the part of the image that it shows
void add_quad(PaintedMesh& mesh, const std::array<Eigen::Vector3d, 4>& corners,
              const Eigen::Vector2d& uv0, const Eigen::Vector2d& uv1);

/// The part of the image that each face of a box shows: u0, v0, u1, v1.
struct BoxFaces {
  std::array<double, 4> top, front, back, left, right;
};

/// A box without a bottom.
/// @param base  middle of the bottom, m
/// @param size  along the box's own axes, m
/// @param yaw   rad, about the vertical
[[nodiscard]] PaintedMesh painted_box(const Eigen::Vector3d& base, const Eigen::Vector3d& size,
                                      double yaw, const BoxFaces& faces, int image);

/// Adds a surface of revolution round the vertical through `base`. The image goes round it once.
/// @param profile  (radius, height above base) from one end to the other
/// @param v0,v1    image coordinate at the first and at the last point of the profile
void add_turned(PaintedMesh& mesh, const Eigen::Vector3d& base,
                const std::vector<Eigen::Vector2d>& profile, double v0, double v1);

}  // namespace palpable
