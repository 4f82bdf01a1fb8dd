/// @file
/// A body as the live half knows it: its skin, where it may be touched, and how it then gives way.
///
/// Body frame: metres, Z up, the body stands on Z = 0 around the Z axis.
///
///   V  surface vertices     T  triangles     S  sites     L  levels, level 0 (at rest) included
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/quartic_energy.h"
#include "palpable/common/reduced/separated_field.h"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <optional>
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

/// How the error of a field falls with the number of modes. Relative, L2.
///   q  numbers of modes   K  snapshots: site x level (without rest) x further parameters, the last
///   runs fastest
struct ErrorCourse {
  Eigen::VectorXi modes;      ///< (q) increasing; the last is that of the body
  Eigen::VectorXd pooled;     ///< (q) |A - A_m| / |A| over all snapshots together
  Eigen::MatrixXf snapshots;  ///< (K x q) of each snapshot, against its own norm
};

/// A body against states that were solved afresh, between the levels that it was made from.
///   H  such levels
struct HeldOutRecord {
  Eigen::VectorXd levels;          ///< (H) increasing
  Eigen::MatrixXf displacement;    ///< (H x S) relative L2 on the skin, against its own norm
  double displacement_pooled = 0;  ///< of all together
  Eigen::MatrixXf von_mises;       ///< (H x S) the worst vertex, against the same field's largest
};

/// What was given up in the reduction, and how large the parts are. All errors relative, L2.
struct ReductionError {
  double displacement_pooled = 0;  ///< |A - A_r| / |A| over all snapshots together
  double displacement_worst = 0;   ///< the largest of one snapshot's own error
  double stress_pooled = 0;
  double stress_worst = 0;
  /// What the numbers of the modes lost in the file: over all samples together, |A_r - A_file| /
  /// |A_r|.
  double displacement_rounding = 0;
  double stress_rounding = 0;
  /// Sites are categorical: a touch between them gets the field of the nearest. How wrong that is,
  /// against a full solve there, in the median; where somebody has measured it.
  std::optional<double> between_sites = {};
  /// Of the reduction, over the volume; where a method stores another number of modes than it
  /// found (blocks of sites), by those found.
  std::optional<ErrorCourse> displacement_course = {};
  std::optional<ErrorCourse> stress_course = {};
  /// Of von Mises stress on the skin, by the first modes (of each site) of the body as it is
  /// evaluated.
  std::optional<ErrorCourse> von_mises_course = {};
  std::optional<HeldOutRecord> held_out = {};
};

/// A parameter beyond site and level, e.g. how stiff a part of the body is.
struct FurtherParameter {
  std::string name;
  Eigen::VectorXd samples;  ///< (n) increasing
  double value = 0;         ///< what holds unless somebody asks for another
};

/// The inside of the body, which nobody sees live.
///   n  nodes   E  elements
struct BodyVolume {
  Eigen::Matrix3Xd nodes;                     ///< (3 x n) m, body frame
  Eigen::MatrixXi tets;                       ///< (4 x E) or (10 x E), in the order of VTK
  SeparatedField displacement;                ///< (3n) m, over the axes of the surface's
  std::optional<SeparatedField> stress = {};  ///< (6n) Pa
};

/// What it takes to load a body at several places at once (loaded_body.h). A body without it
/// answers one load at a time.
///   n  modes
struct SeveralLoads {
  QuarticEnergy energy;   ///< (n) K is positive definite
  Eigen::MatrixXf modes;  ///< (3V x n) m: what the skin does at amplitude 1 of each
  /// (R) where something may push back beside a press at the body's own sites; perhaps none.
  std::vector<Site> reactions = {};
  /// Displacement of the whole volume under a press and a reaction, against `checked` states solved
  /// afresh: relative L2, own norm. 0 states: not known.
  int checked = 0;
  double error_median = 0, error_worst = 0;

  [[nodiscard]] int mode_count() const { return energy.modes(); }
};

/// The body file's content. Plain data; read_body_file has checked every rule stated here.
struct ReducedBody {
  std::string name;                 ///< e.g. "bunny"
  SurfaceMesh surface;              ///< (V, T) at rest; watertight
  std::vector<std::uint8_t> fixed;  ///< (V) 1 where the support holds the vertex
  std::vector<Site> sites;          ///< (S) at least one

  /// (3V) m, over the axes "site" (samples 0..S-1, Between::kNothing) and "level" (0..1, kSmooth),
  /// and those of `further` while they are not settled.
  SeparatedField displacement;
  /// (6V) Pa, Cauchy stress xx yy zz xy yz zx per vertex; same axes.
  SeparatedField stress;

  /// (L x S) m: how far the patch of each site has moved along the load direction (weighted mean)
  /// at each sample of the level axis; 0 in the first row, strictly increasing downwards.
  Eigen::MatrixXd press_depth;
  /// (L x S) Between these samples depth over level and level over depth are cubics with these
  /// slopes at the samples, both strictly increasing. tabulate_press() makes them.
  Eigen::MatrixXd depth_slope = {};  ///< m
  Eigen::MatrixXd level_slope = {};  ///< 1/m

  double largest_von_mises = 0;  ///< Pa, over all snapshots and vertices: top of the colour scale
  ReductionError error;
  std::string material;  ///< one line for people: law and constants with units
  /// Where every number comes from: mesh source and sizes, material, method, program version,
  /// command line, ... as (key, value) lines in the order in which to show them.
  std::vector<std::pair<std::string, std::string>> provenance;
  /// How the modes were found: "per-site", "pgd", ... (ReductionMethod), "intrusive"; empty: not
  /// known, as of another program's modes.
  std::string method = {};

  /// Parameters 3, 4, ... K is the product of their counts of samples, the last one runs fastest.
  std::vector<FurtherParameter> further = {};
  Eigen::MatrixXd further_press_depth = {};  ///< (L x S K) m, column s + S k; empty when settled
  Eigen::MatrixXd further_full_load = {};    ///< (S x K) N; empty when settled

  std::optional<BodyVolume> volume = {};
  std::optional<SeveralLoads> several = {};  ///< of settled bodies only

  [[nodiscard]] const Eigen::VectorXd& levels() const { return displacement.axes()[1].samples; }
  /// Whether the fields hang on site and level alone, as the frame loop needs it.
  [[nodiscard]] bool is_settled() const { return displacement.axes().size() == 2; }
};

/// The body whose further parameters have the values in `values`, or their own: exact for the
/// fields; loads and depths are interpolated between samples as the fields are.
/// @returns a problem if `values` names what the body does not have, or lies outside of its samples
[[nodiscard]] Result<ReducedBody> settled(const ReducedBody& body,
                                          const std::map<std::string, double>& values = {});

/// Fills depth_slope and level_slope: splines through the samples (spline.h), cut where they would
/// not increase.
void tabulate_press(ReducedBody& body);

/// The level at which the patch of `site` has moved by `depth` (m) along its load: a table, no
/// iteration. Strictly increasing in `depth`, clamped to [0, 1]; 0 for NaN. Exact at the samples,
/// 2e-5 between 26 of them on a bunny. Allocates nothing.
[[nodiscard]] double level_of_press_depth(const ReducedBody& body, int site, double depth);

/// How far the patch of `site` has moved along its load at `level`, m. Strictly increasing;
/// `level` is clamped to [0, 1]. Allocates nothing.
[[nodiscard]] double press_depth_of_level(const ReducedBody& body, int site, double level);

/// Von Mises stress, sqrt(3/2 s:s) with s the deviator. Allocates nothing.
/// @param stress  (6V) Pa: xx yy zz xy yz zx per vertex
/// @param result  (V) Pa, overwritten
void von_mises(std::span<const float> stress, std::span<float> result);

}  // namespace palpable
