/// @file
/// Normals of a skin that deforms, equal to those of vertex_normals() (geometry/surface_mesh.h) up
/// to rounding in single precision: eight triangles at a time.
///
///   V  vertices     T  triangles
#pragma once

#include "palpable/common/material/simd.h"

#include <Eigen/Core>

#include <memory>

namespace palpable {

/// Allocates in its constructor.
class SkinNormals {
 public:
  /// @param triangles  (3 x T) of V vertices
  SkinNormals(const Eigen::Matrix3Xi& triangles, int vertices, SimdLevel level = best_simd_level());
  ~SkinNormals();
  SkinNormals(SkinNormals&&) noexcept;

  /// The same positions give the same bytes on every processor.
  /// @param x        (3 x V) m
  /// @param normals  (3 x V) unit, mean of the adjacent faces weighted by area; 0 without any
  void find(const Eigen::Matrix3Xf& x, Eigen::Matrix3Xf& normals);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
