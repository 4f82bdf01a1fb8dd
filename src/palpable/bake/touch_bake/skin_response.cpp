#include "palpable/bake/touch_bake/skin_response.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

namespace {

// Added to the distance of two vertices on opposite sides of a thin part.
constexpr double kOtherSideWithin = 0.03;  // m
// Two vertices lie on opposite sides if the cosine between their normals is smaller.
constexpr double kApart = -0.2;

// The elements whose stress the recovery at the skin's vertices reads.
std::vector<int> elements_of(const StressRecovery& recovery, const TetMesh& mesh,
                             const Boundary& boundary) {
  const int Q = mesh.is_quadratic() ? 4 : 1;
  std::vector<int> elements;
  for (const int n : boundary.node_of_vertex) {
    for (const StressRecovery::Term& term : recovery.terms_of(n))
      elements.push_back(term.point / Q);
  }
  std::sort(elements.begin(), elements.end());
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
  return elements;
}

MatrixXd rows_of(const MatrixXd& fields, std::span<const int> nodes) {
  MatrixXd rows(3 * static_cast<Index>(nodes.size()), fields.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    rows.middleRows(3 * static_cast<Index>(k), 3) = fields.middleRows(3 * Index{nodes[k]}, 3);
  }
  return rows;
}

}  // namespace

SkinResponse::SkinResponse(const SolidModel& model, Boundary boundary, const Preloaded* preloaded)
    : boundary_(std::move(boundary)),
      response_(model, preloaded),
      skin_(boundary_.surface),
      normals_(3, skin_.vertex_count()),
      recovery_(model.mesh),
      shell_nodes_(boundary_.node_of_vertex.begin(), boundary_.node_of_vertex.end()),
      shell_elements_(elements_of(recovery_, model.mesh, boundary_)) {
  for (int v = 0; v < skin_.vertex_count(); ++v) {
    skin_.vertices.col(v) += response_.rest().col(node_of(v));
    const auto free = response_.free_mask().segment<3>(3 * Index{node_of(v)});
    fixed_.push_back(free.isZero(0) ? 1 : 0);
  }
  vertex_normals(skin_.vertices, skin_.triangles, normals_);
  // The inner nodes, rising.
  std::vector<char> wanted(static_cast<std::size_t>(model.mesh.node_count()), 0);
  for (const int e : shell_elements_) {
    for (const int n : model.mesh.tets.col(e)) wanted[n] = 1;
    if (!model.mesh.is_quadratic()) continue;
    for (const int n : model.mesh.edge_nodes.col(e)) wanted[n] = 1;
  }
  for (const int n : boundary_.node_of_vertex) wanted[n] = 0;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (wanted[n] != 0) shell_nodes_.push_back(n);
  }
}

MatrixXd SkinResponse::at_nodes(const MatrixXd& loads) const {
  PALPABLE_EXPECT(loads.rows() == 3 * Index{vertex_count()}, "a load has three values a vertex");
  MatrixXd nodal = MatrixXd::Zero(response_.free_mask().size(), loads.cols());
  for (int v = 0; v < vertex_count(); ++v) {
    const Index at = 3 * Index{node_of(v)};
    nodal.middleRows(at, 3) =
        response_.free_mask().segment<3>(at).asDiagonal() * loads.middleRows(3 * Index{v}, 3);
  }
  return nodal;
}

MatrixXd SkinResponse::on_skin(const MatrixXd& fields) const {
  return rows_of(fields, std::span(shell_nodes_).first(static_cast<std::size_t>(vertex_count())));
}

MatrixXd SkinResponse::in_shell(const MatrixXd& fields) const {
  return rows_of(fields, shell_nodes_);
}

double SkinResponse::distance(int a, int b) const {
  const bool apart = normals_.col(a).dot(normals_.col(b)) < kApart;
  return (skin_.vertices.col(a) - skin_.vertices.col(b)).norm() + (apart ? kOtherSideWithin : 0.0);
}

Vector3d SkinResponse::mean_normal(int vertex, double radius) const {
  Vector3d sum = normals_.col(vertex);
  for (int v = 0; v < vertex_count(); ++v) {
    if (distance(v, vertex) < radius) sum += normals_.col(v);
  }
  return sum.normalized();
}

std::vector<int> spread_vertices(const SkinResponse& skin, double spacing, int most) {
  std::vector<int> chosen;
  std::vector<double> nearest(static_cast<std::size_t>(skin.vertex_count()));
  for (std::size_t v = 0; v < nearest.size(); ++v) {
    nearest[v] = skin.fixed()[v] != 0 ? -1.0 : std::numeric_limits<double>::infinity();
  }
  while (static_cast<int>(chosen.size()) < most) {
    const auto farthest = std::max_element(nearest.begin(), nearest.end());
    if (farthest == nearest.end() || *farthest < spacing) break;
    const int v = static_cast<int>(farthest - nearest.begin());
    chosen.push_back(v);
    for (std::size_t w = 0; w < nearest.size(); ++w) {
      nearest[w] = std::min(nearest[w], skin.distance(static_cast<int>(w), v));
    }
  }
  return chosen;
}

}  // namespace palpable
