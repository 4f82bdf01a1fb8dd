/// @file
/// Normals of a skin that deforms, as vertex_normals() has them (geometry/surface_mesh.h), to a
/// float's rounding: eight triangles at a time.
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

  /// The same places give the same bytes on every processor.
  /// @param x        (3 x V) m
  /// @param normals  (3 x V) unit, of the faces around by their areas; 0 where there are none
  void find(const Eigen::Matrix3Xf& x, Eigen::Matrix3Xf& normals);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
