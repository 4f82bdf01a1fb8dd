#include "palpable/bake/touch_bake/region_maker.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTilt = 0.5;             // largest tangential part, ratio to the normal part
constexpr double kPointSpacing = 0.0011;  // m, between the points at which pressure is summed
// Pressure at the rim of a load, ratio to that in its middle: no load is zero at all its points.
constexpr double kFloor = 0.05;
// Points whose normal has a smaller cosine with the load's lie on the other side of a thin part,
// such as an ear, and get no pressure.
constexpr double kOtherSide = -0.2;
// Modes with a smaller eigenvalue, as a ratio to the largest, are rounding and are left out.
constexpr double kLeastEigenvalue = 1e-9;

// (3V x k) random loads near a vertex.
MatrixXd some_loads(const SkinResponse& skin, int middle, const RegionSettings& settings) {
  std::mt19937_64 random(static_cast<std::uint64_t>(middle) + 1);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<int> near;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    // By plain distance, so that both sides of an ear and both walls of a cleft are included:
    // obstacles press them together.
    if (skin.fixed()[v] == 0 &&
        (skin.skin().vertices.col(v) - skin.skin().vertices.col(middle)).norm() < settings.reach) {
      near.push_back(v);
    }
  }
  if (near.empty()) near.push_back(middle);
  std::vector<SkinPoint> points = skin_points(skin.skin(), skin.fixed(), kPointSpacing);
  const Eigen::Matrix3Xf X = skin.skin().vertices.cast<float>();
  const auto reach = static_cast<float>(settings.reach + settings.largest_load);
  points.erase(
      std::remove_if(points.begin(), points.end(),
                     [&](const SkinPoint& p) { return (p.at(X) - X.col(middle)).norm() > reach; }),
      points.end());
  MatrixXd loads = MatrixXd::Zero(3 * Index{skin.vertex_count()}, settings.loads);
  for (Index k = 0; k < loads.cols(); ++k) {
    const int at = near[static_cast<std::size_t>(share(random) * static_cast<double>(near.size()))];
    const double R =
        settings.least_load + (settings.largest_load - settings.least_load) * share(random);
    const Vector3d out = skin.mean_normal(at, std::max(0.004, R));
    const double angle = 2 * std::numbers::pi * share(random), tilt = kTilt * share(random);
    const Vector3d t = out.unitOrthogonal();
    const Vector3d direction =
        (-out + tilt * (std::cos(angle) * t + std::sin(angle) * out.cross(t))).normalized();
    loads.middleRows(3 * Index{at}, 3).col(k) = 1e-9 * direction;  // N: keeps the load nonzero
    for (const SkinPoint& point : points) {
      const double r = static_cast<double>((point.at(X) - X.col(at)).norm()) / R;
      const bool other_side =
          skin.normals().col(point.corners[0]).dot(skin.normals().col(at)) < kOtherSide;
      if (r > 1 || other_side) continue;
      const double force = (std::sqrt(1 - r * r) + kFloor) * static_cast<double>(point.area);
      for (int c = 0; c < 3; ++c) {
        loads.block<3, 1>(3 * Index{point.corners[static_cast<std::size_t>(c)]}, k) +=
            force * static_cast<double>(point.weights[c]) * direction;
      }
    }
  }
  return loads;
}

// Displacement fields u and their forces K u, in single precision to halve the memory.
struct Snapshots {
  Eigen::MatrixXf u, force;  // (3N x 2k) for k loads: the first orders, then the second orders

  [[nodiscard]] auto second_forces() const { return force.rightCols(force.cols() / 2); }
};

// The displacements of first and second order under the loads, each scaled to u . K u = 1.
Snapshots snapshots_of(const SkinResponse& skin, const MatrixXd& loads) {
  const LoadResponse& body = skin.body();
  const Index k = loads.cols();
  MatrixXd force = skin.at_nodes(loads);
  MatrixXd u = body.linear(force);
  Snapshots all{Eigen::MatrixXf(u.rows(), 2 * k), Eigen::MatrixXf(u.rows(), 2 * k)};
  const auto keep = [&](Index first) {
    for (Index i = 0; i < k; ++i) {
      const double size = std::sqrt(std::max(u.col(i).dot(force.col(i)), 1e-300));
      u.col(i) /= size;
      force.col(i) /= size;
    }
    all.u.middleCols(first, k) = u.cast<float>();
    all.force.middleCols(first, k) = force.cast<float>();
  };
  keep(0);
  for (Index i = 0; i < k; ++i) {
    force.col(i) = -body.second_force(u.col(i)).cwiseProduct(body.free_mask());
  }
  u = body.linear(force);
  keep(k);
  return all;
}

// (3N x count) the leading directions of the snapshots in the stiffness' norm, orthonormal in it.
// If the snapshots span fewer directions, the last columns are 0.
MatrixXd leading_modes(const Snapshots& all, int count) {
  const MatrixXd u = all.u.cast<double>();
  MatrixXd gram = transposed_times(u, all.force.cast<double>());
  gram = 0.5 * (gram + gram.transpose().eval());
  const SymmetricEigen eigen = symmetric_eigen(gram);  // increasing
  const Index n = gram.rows();
  Index kept = 0;
  while (kept < std::min<Index>(count, n) &&
         eigen.values[n - 1 - kept] > kLeastEigenvalue * eigen.values[n - 1]) {
    ++kept;
  }
  MatrixXd weights(n, kept);
  for (Index k = 0; k < kept; ++k) {
    weights.col(k) = eigen.vectors.col(n - 1 - k) / std::sqrt(eigen.values[n - 1 - k]);
  }
  MatrixXd modes = MatrixXd::Zero(u.rows(), count);
  modes.leftCols(kept) = times(u, weights);
  return modes;
}

// Clusters whose centroids lie within `radius` of a vertex, and always the vertex's own cluster.
std::vector<int> clusters_around(const SkinResponse& skin, const Compliance& compliance, int middle,
                                 double radius) {
  std::vector<int> found{compliance.cluster_of(middle)};
  const auto& X = skin.skin().vertices;
  std::vector<Vector3d> sum(static_cast<std::size_t>(compliance.clusters()), Vector3d::Zero());
  std::vector<int> count(sum.size(), 0);
  for (int v = 0; v < skin.vertex_count(); ++v) {
    sum[compliance.cluster_of(v)] += X.col(v);
    ++count[compliance.cluster_of(v)];
  }
  for (int c = 0; c < compliance.clusters(); ++c) {
    if (count[c] == 0 || c == found.front()) continue;
    if ((sum[c] / count[c] - X.col(middle)).norm() <= radius) found.push_back(c);
  }
  std::sort(found.begin(), found.end());
  return found;
}

// All nodes of clusters that are near at least one of these clusters.
std::vector<int> nodes_around(const Compliance& compliance, const std::vector<int>& clusters) {
  std::vector<int> found;
  for (int v = 0; v < compliance.nodes(); ++v) {
    if (std::any_of(clusters.begin(), clusters.end(),
                    [&](int c) { return !compliance.are_far(c, compliance.cluster_of(v)); })) {
      found.push_back(v);
    }
  }
  return found;
}

// (k x clusters, modes) the modes' targets in all clusters that have no node among these: k rows
// for each of those clusters.
MatrixXd far_targets(const Compliance& compliance, const std::vector<int>& own_nodes,
                     const MatrixXd& in_shell) {
  const auto k = static_cast<Index>(compliance.rank());
  std::vector<char> own(static_cast<std::size_t>(compliance.clusters()), 0);
  for (const int n : own_nodes) own[compliance.cluster_of(n)] = 1;
  std::vector<Index> row(own.size(), 0);  // of the cluster's first target
  Index rows = 0;
  for (std::size_t c = 0; c < own.size(); ++c) {
    row[c] = rows;
    if (own[c] == 0) rows += k;
  }
  const MatrixXd P = as_numbers(compliance.table().beyond);
  MatrixXd targets = MatrixXd::Zero(rows, in_shell.cols());
  for (int v = 0; v < compliance.vertices(); ++v) {
    const int c = compliance.cluster_of(v);
    if (own[c] != 0) continue;
    targets.middleRows(row[c], k) +=
        P.middleRows(3 * Index{v}, 3).transpose() * in_shell.middleRows(3 * Index{v}, 3);
  }
  return targets;
}

// Approximates the targets of the modes by shapes (rows x f) times shares (f x r). The shapes are
// the leading directions of the targets of the fields with these modal coordinates.
// @param coordinates  (r x fields)
void keep_far_shapes(const MatrixXd& targets, const MatrixXd& coordinates, int count,
                     RegionTable& region) {
  const MatrixXd fields = times(targets, coordinates);
  MatrixXd gram = MatrixXd::Zero(fields.cols(), fields.cols());
  add_gram(fields, gram);
  const SymmetricEigen eigen = symmetric_eigen(gram);  // increasing
  const Index n = gram.rows(), last = std::max<Index>(0, n - 1);
  MatrixXd shapes = MatrixXd::Zero(targets.rows(), count);
  for (Index k = 0; k < std::min<Index>(count, n); ++k) {
    const double value = eigen.values[last - k];
    if (!(value > kLeastEigenvalue * eigen.values[last])) break;
    shapes.col(k) = fields * eigen.vectors.col(last - k) / std::sqrt(value);
  }
  region.far_shapes = rounded(shapes.cast<float>());
  region.far_shares = rounded(transposed_times(shapes, targets).cast<float>());
}

}  // namespace

std::vector<int> region_nodes(const SkinResponse& skin, const Compliance& compliance, int vertex,
                              const RegionSettings& settings) {
  return nodes_around(compliance, clusters_around(skin, compliance, vertex, settings.core));
}

RegionTable make_region(const SkinResponse& skin, const ModalFormMaker& forms,
                        const Compliance& compliance, int vertex, const RegionSettings& settings) {
  PALPABLE_EXPECT(settings.modes % static_cast<int>(kRowStep) == 0 &&
                      settings.leading <= settings.modes &&
                      settings.far_shapes % static_cast<int>(kRowStep) == 0,
                  "modes and far shapes by sixteens, and no more leading modes than there are");
  RegionTable region;
  region.vertex = vertex;
  MatrixXd modes, second_coordinates;
  {
    const Snapshots snapshots = snapshots_of(skin, some_loads(skin, vertex, settings));
    modes = leading_modes(snapshots, settings.modes);
    second_coordinates = transposed_times(modes, snapshots.second_forces().cast<double>());
  }
  const MatrixXd in_shell = skin.in_shell(modes);
  region.vertices = region_nodes(skin, compliance, vertex, settings);
  RowsOfFloats rows(3 * static_cast<Index>(region.vertices.size()), modes.cols());
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    rows.middleRows(3 * static_cast<Index>(k), 3) =
        in_shell.middleRows(3 * Index{region.vertices[k]}, 3).cast<float>();
  }
  region.modes = rounded(rows);
  keep_far_shapes(far_targets(compliance, region.vertices, in_shell), second_coordinates,
                  settings.far_shapes, region);
  const ModalForms made = forms.make(modes, settings.leading);
  region.cubic = rounded(made.modes, 3, made.cubic);
  region.quartic = rounded(made.leading, 4, made.quartic);
  return region;
}

}  // namespace palpable
