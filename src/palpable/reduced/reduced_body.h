/// @file
/// A body as the live half knows it: its skin, where it may be touched, and how it then gives way.
///
/// Body frame: metres, Z up, the body stands on Z = 0 around the Z axis.
///
///   V  surface vertices     T  triangles     S  sites     L  levels, level 0 (at rest) included
#pragma once

#include "palpable/geometry/surface_mesh.h"
#include "palpable/reduced/separated_field.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// Where the body may be touched: a vertex and its patch of graph distance 2 (paper Fig. 15).
struct Site {
  int vertex = 0;              ///< the middle of the patch, surface vertex
  std::vector<int> patch;      ///< surface vertices that carry the load, `vertex` first
  std::vector<float> weights;  ///< share of the load per patch vertex (nodal areas); sums to 1
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit vector of the load, body frame
  double full_load = 0;                                 ///< N, the load at level 1
};

/// What was given up in the reduction, and how large the parts are. All errors relative, L2.
struct ReductionError {
  double displacement_pooled = 0;  ///< |A - A_r| / |A| over all snapshots together
  double displacement_worst = 0;   ///< the largest of one snapshot's own error
  double stress_pooled = 0;
  double stress_worst = 0;
};

/// The body file's content. Plain data; read_body_file has checked every rule stated here.
struct ReducedBody {
  std::string name;                 ///< e.g. "bunny"
  SurfaceMesh surface;              ///< (V, T) at rest; watertight
  std::vector<std::uint8_t> fixed;  ///< (V) 1 where the support holds the vertex
  std::vector<Site> sites;          ///< (S) at least one

  /// (3V) m, over the axes "site" (samples 0..S-1, Between::kNothing) and "level" (0..1, kSmooth).
  SeparatedField displacement;
  /// (6V) Pa, Cauchy stress xx yy zz xy yz zx per vertex; same axes.
  SeparatedField stress;

  /// (L x S) m: how far the patch of each site has moved along the load direction (weighted mean)
  /// at each sample of the level axis; 0 in the first row, strictly increasing downwards.
  Eigen::MatrixXd press_depth;

  double largest_von_mises = 0;  ///< Pa, over all snapshots and vertices: top of the colour scale
  ReductionError error;
  std::string material;  ///< one line for people: law and constants with units
  /// Where every number comes from: mesh source and sizes, material, method, program version,
  /// command line, ... as (key, value) lines in the order in which to show them.
  std::vector<std::pair<std::string, std::string>> provenance;

  [[nodiscard]] const Eigen::VectorXd& levels() const { return displacement.axes()[1].samples; }
};

/// The level at which the patch of `site` has moved by `depth` (m) along its load: the inverse of
/// press_depth, piecewise linear between samples. Clamped to [0, 1]. Allocates nothing.
[[nodiscard]] double level_of_press_depth(const ReducedBody& body, int site, double depth);

/// Von Mises stress, sqrt(3/2 s:s) with s the deviator. Allocates nothing.
/// @param stress  (6V) Pa: xx yy zz xy yz zx per vertex
/// @param result  (V) Pa, overwritten
void von_mises(std::span<const float> stress, std::span<float> result);

}  // namespace palpable
