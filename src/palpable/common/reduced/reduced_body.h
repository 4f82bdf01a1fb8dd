/// @file
/// A body in the form that the live half uses: its skin, its sites, and its response to loads
/// there.
///
/// Body frame: metres, Z up, the body stands on Z = 0 around the Z axis.
///
///   V  surface vertices     T  triangles     S  sites     L  levels, level 0 (at rest) included
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/provenance.h"
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

/// A site, at which the body was pressed: a vertex and its patch of graph distance 2 (paper Fig.
/// 15).
struct Site {
  int vertex = 0;              ///< the middle of the patch, surface vertex
  std::vector<int> patch;      ///< surface vertices that carry the load, `vertex` first
  std::vector<float> weights;  ///< share of the load per patch vertex (nodal areas); sum 1
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

/// Errors of a body at levels between those it was made from, against full-order solutions there.
///   H  number of these levels
struct HeldOutRecord {
  Eigen::VectorXd levels;          ///< (H) increasing
  Eigen::MatrixXf displacement;    ///< (H x S) relative L2 on the skin, against its own norm
  double displacement_pooled = 0;  ///< over all of them together
  Eigen::MatrixXf von_mises;       ///< (H x S) of the worst vertex, ratio to the field's largest
};

/// The errors of the reduction by their causes. All errors are relative, L2.
struct ReductionError {
  double displacement_pooled = 0;  ///< |A - A_r| / |A| over all snapshots together
  double displacement_worst = 0;   ///< the largest error of a snapshot relative to its own norm
  double stress_pooled = 0;
  double stress_worst = 0;
  /// Error from rounding the modes in the file: |A_r - A_file| / |A_r| over all samples together.
  double displacement_rounding = 0;
  double stress_rounding = 0;
  /// Sites are categorical: a touch between them gets the field of the nearest site. This is the
  /// median error of that, against full-order solutions between sites, if it was measured.
  std::optional<double> between_sites = {};
  /// Errors of the reduction over the volume. For methods that store another number of modes than
  /// they found (as blocks of sites), by the number of modes found.
  std::optional<ErrorCourse> displacement_course = {};
  std::optional<ErrorCourse> stress_course = {};
  /// Errors of the von Mises stress on the skin when the body is evaluated with its first modes (of
  /// each site) only.
  std::optional<ErrorCourse> von_mises_course = {};
  std::optional<HeldOutRecord> held_out = {};
};

/// A parameter beyond site and level, e.g. the stiffness of a part of the body.
struct FurtherParameter {
  std::string name;
  Eigen::VectorXd samples;  ///< (n) increasing
  double value = 0;         ///< default
};

/// The volume of the body, which the live half does not use.
///   n  nodes   E  elements
struct BodyVolume {
  Eigen::Matrix3Xd nodes;                     ///< (3 x n) m, body frame
  Eigen::MatrixXi tets;                       ///< (4 x E) or (10 x E), in the order of VTK
  SeparatedField displacement;                ///< (3n) m, over the same axes as the surface's
  std::optional<SeparatedField> stress = {};  ///< (6n) Pa
};

/// The data for loading a body at several places at once (loaded_body.h). A body without them has a
/// response to one load at a time only.
///   n  modes
struct SeveralLoads {
  QuarticEnergy energy;   ///< (n) K is positive definite
  Eigen::MatrixXf modes;  ///< (3V x n) m, displacement of the skin at amplitude 1 of each mode
  /// (R) reactions: places where something may push against the body while a site is pressed. May
  /// be empty.
  std::vector<Site> reactions = {};
  /// Error of the displacement of the whole volume under a press and a reaction, against `checked`
  /// full-order solutions, each relative to its own norm (L2). If `checked` is 0, the error is not
  /// known.
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
  /// and, unless the body is settled, those of `further`.
  SeparatedField displacement;
  /// (6V) Pa, Cauchy stress xx yy zz xy yz zx per vertex; same axes.
  SeparatedField stress;

  /// (L x S) m, displacement of each site's patch along the load direction (weighted mean) at each
  /// sample of the level axis; 0 in the first row, strictly increasing from row to row.
  Eigen::MatrixXd press_depth;
  /// (L x S) Slopes at these samples of two piecewise cubics, depth over level and level over
  /// depth, both strictly increasing. tabulate_press() fills them.
  Eigen::MatrixXd depth_slope = {};  ///< m
  Eigen::MatrixXd level_slope = {};  ///< 1/m

  double largest_von_mises = 0;  ///< Pa, over all snapshots and vertices: top of the colour scale
  ReductionError error;
  std::string material;  ///< one line for users: law and constants with units
  Provenance provenance = {};
  /// The method that found the modes: "per-site", "pgd", ... (ReductionMethod), "intrusive"; empty
  /// if it is not known, e.g. for another program's modes.
  std::string method = {};

  /// Parameters 3, 4, ... K is the product of their counts of samples, the last one runs fastest.
  std::vector<FurtherParameter> further = {};
  Eigen::MatrixXd further_press_depth = {};  ///< (L x S K) m, column s + S k; empty when settled
  Eigen::MatrixXd further_full_load = {};    ///< (S x K) N; empty when settled

  std::optional<BodyVolume> volume = {};
  std::optional<SeveralLoads> several = {};  ///< only in settled bodies

  [[nodiscard]] const Eigen::VectorXd& levels() const { return displacement.axes()[1].samples; }
  /// Whether the fields depend on site and level only, as the frame loop requires.
  [[nodiscard]] bool is_settled() const { return displacement.axes().size() == 2; }
};

/// The body with its further parameters set to `values`, or to their defaults. Exact for the
/// fields; loads and depths are interpolated between samples like the fields.
/// @returns a problem if `values` names a parameter that the body does not have, or a value outside
///          of its samples
[[nodiscard]] Result<ReducedBody> settled(const ReducedBody& body,
                                          const std::map<std::string, double>& values = {});

/// Fills depth_slope and level_slope: slopes of splines through the samples (spline.h), limited
/// where the spline would not increase.
void tabulate_press(ReducedBody& body);

/// The level at which the press depth of `site` is `depth` (m), by a table, without iteration.
/// Strictly increasing in `depth`, clamped to [0, 1]; 0 for NaN. Exact at the samples; the error
/// between 26 of them is 2e-5 on a bunny. Allocates nothing.
[[nodiscard]] double level_of_press_depth(const ReducedBody& body, int site, double depth);

/// The press depth of `site` at `level`, m. Strictly increasing; `level` is clamped to [0, 1].
/// Allocates nothing.
[[nodiscard]] double press_depth_of_level(const ReducedBody& body, int site, double level);

/// Von Mises stress, sqrt(3/2 s:s) with s the deviator. Allocates nothing.
/// @param stress  (6V) Pa: xx yy zz xy yz zx per vertex
/// @param result  (V) Pa, overwritten
void von_mises(std::span<const float> stress, std::span<float> result);

/// The body in another size. Multiplies every length by `factor`: skin, displacement and press
/// depth. Without body forces the same material deforms to a similar shape with the same stress if
/// the loads are multiplied by factor^2, so forces (and energies, by factor^3) are the only other
/// quantities that change. Adds a line to the provenance.
/// @throws ContractViolation unless 0 < factor < infinity
[[nodiscard]] ReducedBody scaled(const ReducedBody& body, double factor);

}  // namespace palpable
