#include "palpable/bake/solid/tet_assembly.h"

#include "palpable/bake/solid/series_kernels.h"
#include "palpable/common/geometry/element_order.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

namespace {

// Gradients, weights (m^3) and nodes of one element at its integration points.
template <int A, int Q>
struct ElementPoints {
  std::array<Eigen::Matrix<double, 3, A>, Q> g;
  std::array<double, Q> weight;
  Eigen::Matrix<int, A, 1> nodes;
};

ElementPoints<4, 1> points_of(const TetMesh& mesh, int number, ElementPoints<4, 1>) {
  const ShapeGradients shape = shape_gradients(mesh, number);
  return {{shape.g}, {shape.volume}, mesh.tets.col(number)};
}

ElementPoints<10, 4> points_of(const TetMesh& mesh, int number, ElementPoints<10, 4> element) {
  for (std::size_t q = 0; q < 4; ++q) {
    const auto& [L, weight] = four_point_rule()[q];
    const QuadraticGradients shape = quadratic_gradients(mesh, number, quadratic_shape(L));
    element.g[q] = shape.g;
    element.weight[q] = weight * shape.volume;
  }
  element.nodes = quadratic_nodes(mesh, number);
  return element;
}

// Mean of the corners of each element.
Matrix3Xd centres(const TetMesh& mesh, const std::vector<int>& numbers) {
  Matrix3Xd points(3, static_cast<Eigen::Index>(numbers.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const auto corners = mesh.tets.col(numbers[k]);
    points.col(k).setZero();
    for (const int node : corners) points.col(k) += 0.25 * mesh.nodes.col(node);
  }
  return points;
}

// The block of the elements numbers[first], numbers[first + 1], ...
// @param row_of_node  the row of a node in PassFields
template <int A, int Q>
ElementBlock<A, Q> block_of(const TetMesh& mesh, const std::vector<int>& numbers, std::size_t first,
                            const std::vector<int>& row_of_node) {
  ElementBlock<A, Q> block;
  for (int lane = 0; lane < kPackSize; ++lane) {
    const std::size_t wanted = first + static_cast<std::size_t>(lane);
    const bool exists = wanted < numbers.size();
    const ElementPoints<A, Q> element =
        points_of(mesh, exists ? numbers[wanted] : numbers.back(), ElementPoints<A, Q>{});
    for (std::size_t q = 0; q < Q; ++q) {
      for (int a = 1; a < A; ++a) {
        for (int J = 0; J < 3; ++J) block.points[q].g[a - 1][J][lane] = element.g[q](J, a);
      }
      block.points[q].weight[lane] = exists ? element.weight[q] : 0.0;
    }
    for (int a = 0; a < A; ++a) { block.nodes[a][lane] = row_of_node[element.nodes[a]]; }
  }
  return block;
}

}  // namespace

TetAssembly::TetAssembly(const SolidModel& model, SimdLevel simd) : simd_(simd) {
  const TetMesh& mesh = model.mesh;
  free_of_node_.assign(mesh.node_count(), 0);
  const std::vector<HeldComponent> held = held_components(model);
  std::vector<int> held_directions(mesh.node_count(), 0);
  for (const HeldComponent& h : held) ++held_directions[h.at / 3];
  for (int n = 0; n < mesh.node_count(); ++n) {
    int& row = free_of_node_[n];
    if (held_directions[n] == 3) {
      row = -1;
      continue;
    }
    row = static_cast<int>(free_nodes_.size());
    free_nodes_.push_back(n);
  }

  if (mesh.is_quadratic()) {
    build(model, groups_.emplace<Groups<10, 4>>());
  } else {
    build(model, groups_.emplace<Groups<4, 1>>());
  }
  for (const int n : free_nodes_) { row_of_free_.push_back(row_of_node_[n]); }

  for (const HeldComponent& h : held) {
    const int row = free_of_node_[h.at / 3];
    if (row < 0) continue;
    HeldAxis axis{row, static_cast<int>(h.at % 3), {}};
    // The pattern is symmetric: the rows in this column are the columns of this row.
    for (int p = pattern_.row_start[row]; p < pattern_.row_start[row + 1]; ++p) {
      axis.column_places.push_back(pattern_.find(pattern_.column[p], row));
    }
    held_axes_.push_back(std::move(axis));
  }
}

namespace {

// The node indices of an element of A nodes.
template <int A>
Eigen::Matrix<int, A, 1> nodes_of(const TetMesh& mesh, int e) {
  if constexpr (A == 4) {
    return mesh.tets.col(e);
  } else {
    return quadratic_nodes(mesh, e);
  }
}

}  // namespace

template <int A, int Q>
void TetAssembly::build(const SolidModel& model, Groups<A, Q>& groups) {
  const TetMesh& mesh = model.mesh;
  const std::vector<int> group_of_element = material_groups(model);
  groups.push_back({model.material, {}, {}, {}});
  for (const MaterialGroup& group : model.groups) groups.push_back({group.material, {}, {}, {}});
  for (int e = 0; e < mesh.tet_count(); ++e) {
    groups[group_of_element[e] + 1].numbers.push_back(e);
  }
  estimate_noise<A, Q>(mesh, groups);
  build_pattern<A>(mesh);

  // Elements are sorted along a curve; nodes in the order in which these elements first use them.
  row_of_node_.assign(mesh.node_count(), -1);
  int rows = 0;
  for (auto& group : groups) {
    std::vector<int> sorted;
    for (const int k : order_along_curve(centres(mesh, group.numbers))) {
      sorted.push_back(group.numbers[k]);
    }
    group.numbers = std::move(sorted);
    for (const int e : group.numbers) {
      for (const int n : nodes_of<A>(mesh, e)) {
        int& row = row_of_node_[n];
        if (row < 0) row = rows++;
      }
    }
  }

  for (auto& group : groups) {
    for (std::size_t first = 0; first < group.numbers.size(); first += kPackSize) {
      group.blocks.push_back(block_of<A, Q>(mesh, group.numbers, first, row_of_node_));
    }
    for (const int e : group.numbers) {
      const auto nodes = nodes_of<A>(mesh, e);
      std::array<int, A* A>& places = group.places.emplace_back();
      for (int a = 0; a < A; ++a) {
        for (int b = 0; b < A; ++b) {
          const int row = free_of_node_[nodes[a]], column = free_of_node_[nodes[b]];
          places[A * a + b] = row < 0 || column < 0 ? -1 : pattern_.find(row, column);
        }
      }
    }
  }
}

// A few rounding errors of the products from which an element's energy and stress are computed.
template <int A, int Q>
void TetAssembly::estimate_noise(const TetMesh& mesh, const Groups<A, Q>& groups) {
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  double squares = 0.0;
  for (const auto& group : groups) {
    const auto [lambda, mu] = lame_constants(group.material);
    const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * (lambda + 2.0 * mu);
    for (const int e : group.numbers) {
      energy_noise_ += rounding * volumes[e];
      // A regular tetrahedron of volume V has faces of 1.8 V^(2/3) each.
      squares += 4.0 * std::pow(1.8 * rounding * std::cbrt(volumes[e] * volumes[e]), 2);
    }
  }
  force_noise_ = std::sqrt(squares);
}

// The row of a free node holds the free nodes of its elements, itself included.
template <int A>
void TetAssembly::build_pattern(const TetMesh& mesh) {
  std::vector<std::vector<int>> neighbours(free_nodes_.size());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto nodes = nodes_of<A>(mesh, e);
    for (const int a : nodes) {
      const int row = free_of_node_[a];
      if (row < 0) continue;
      for (const int b : nodes) {
        const int column = free_of_node_[b];
        if (column >= 0) neighbours[row].push_back(column);
      }
    }
  }
  pattern_.row_start.push_back(0);
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    pattern_.column.insert(pattern_.column.end(), row.begin(), row.end());
    pattern_.row_start.push_back(static_cast<int>(pattern_.column.size()));
  }
}

std::size_t TetAssembly::bytes() const {
  std::size_t sum = 0;
  const auto add_group = [&]<int A, int Q>(const Group<A, Q>& group) {
    sum += group.blocks.size() * sizeof(ElementBlock<A, Q>);
  };
  std::visit([&](const auto& groups) { std::for_each(groups.begin(), groups.end(), add_group); },
             groups_);
  return sum;
}

void TetAssembly::set_state(const Matrix3Xd& u, PassFields& fields) const {
  fields.rows.assign(row_of_node_.size(), NodeRow{});
  for (std::size_t n = 0; n < row_of_node_.size(); ++n) {
    const auto at = u.col(static_cast<Eigen::Index>(n));
    fields.rows[row_of_node_[n]].u = Quad{at[0], at[1], at[2], 0.0};
  }
}

BodyState TetAssembly::force(PassFields& fields, Matrix3Xd& force) const {
  fields.sums.assign(fields.rows.size(), NodeSum{});
  BodyState state;
  state.smallest_volume_ratio = std::numeric_limits<double>::infinity();
  const auto add_group = [&]<int A, int Q>(const Group<A, Q>& group) {
    const ForceSums sums = add_forces<A, Q>(simd_, group.material, group.blocks, fields.rows.data(),
                                            fields.sums.data());
    state.energy += sums.inverted ? std::numeric_limits<double>::infinity() : sums.energy;
    if (sums.most_compressed < 0 || sums.smallest_volume_ratio >= state.smallest_volume_ratio) {
      return;
    }
    state.smallest_volume_ratio = sums.smallest_volume_ratio;
    const auto last = group.numbers.size() - 1;
    state.most_compressed =
        group.numbers[std::min(static_cast<std::size_t>(sums.most_compressed), last)];
  };
  std::visit([&](const auto& groups) { std::for_each(groups.begin(), groups.end(), add_group); },
             groups_);
  if (std::isnan(state.energy)) state.energy = std::numeric_limits<double>::infinity();
  copy_sums(fields.sums, force);
  return state;
}

// d force / du along the rows' du, into the sums.
void TetAssembly::add_changes(PassFields& fields) const {
  fields.sums.assign(fields.rows.size(), NodeSum{});
  const auto add_group = [&]<int A, int Q>(const Group<A, Q>& group) {
    add_force_changes<A, Q>(simd_, group.material, group.blocks, fields.rows.data(),
                            fields.sums.data());
  };
  std::visit([&](const auto& groups) { std::for_each(groups.begin(), groups.end(), add_group); },
             groups_);
}

void TetAssembly::tangent_product(PassFields& fields, const Eigen::VectorXd& x,
                                  Eigen::VectorXd& y) const {
  const double* from = x.data();
  for (const int row : row_of_free_) {
    fields.rows[row].du = Quad{from[0], from[1], from[2], 0.0};
    from += 3;
  }
  add_changes(fields);
  y.resize(x.size());
  double* to = y.data();
  for (const int row : row_of_free_) {
    const Quad& force = fields.sums[row].force;
    for (int i = 0; i < 3; ++i) to[i] = force[i];
    to += 3;
  }
  for (const HeldAxis& held : held_axes_) y[3 * held.row + held.axis] = 0.0;
}

void TetAssembly::force_change(PassFields& fields, const Matrix3Xd& du, Matrix3Xd& change) const {
  for (std::size_t n = 0; n < row_of_node_.size(); ++n) {
    const auto along = du.col(static_cast<Eigen::Index>(n));
    fields.rows[row_of_node_[n]].du = Quad{along[0], along[1], along[2], 0.0};
  }
  add_changes(fields);
  for (NodeRow& row : fields.rows) row.du = Quad{};
  copy_sums(fields.sums, change);
}

void TetAssembly::force_term(int order, const Matrix3Xd& u_0, const Matrix3Xd& u_1,
                             const Matrix3Xd& u_2, SeriesFields& scratch, Matrix3Xd& term) const {
  scratch.rows.resize(row_of_node_.size());
  scratch.sums.assign(row_of_node_.size(), NodeSum{});
  const auto quad = [](const auto& x) { return Quad{x[0], x[1], x[2], 0.0}; };
  for (std::size_t n = 0; n < row_of_node_.size(); ++n) {
    const auto c = static_cast<Eigen::Index>(n);
    scratch.rows[row_of_node_[n]] = {quad(u_0.col(c)), quad(u_1.col(c)),
                                     order > 2 ? quad(u_2.col(c)) : Quad{}, Quad{}};
  }
  const auto add_group = [&]<int A, int Q>(const Group<A, Q>& group) {
    add_force_term<A, Q>(simd_, group.material, group.blocks, order, scratch.rows.data(),
                         scratch.sums.data());
  };
  std::visit([&](const auto& groups) { std::for_each(groups.begin(), groups.end(), add_group); },
             groups_);
  term.resize(3, node_count());
  copy_sums(scratch.sums, term);
}

// Copies the sums into the order of the mesh.
void TetAssembly::copy_sums(const std::vector<NodeSum>& sums, Matrix3Xd& field) const {
  for (std::size_t n = 0; n < row_of_node_.size(); ++n) {
    const Quad& force = sums[row_of_node_[n]].force;
    for (int i = 0; i < 3; ++i) field(i, static_cast<Eigen::Index>(n)) = force[i];
  }
}

void TetAssembly::tangent(const PassFields& fields, BlockMatrix& K) const {
  K.set_zero();
  const auto add_group = [&]<int A, int Q>(const Group<A, Q>& group) {
    ElementTangents<A> eight;
    std::size_t element = 0;
    for (const ElementBlock<A, Q>& block : group.blocks) {
      element_tangents<A, Q>(simd_, group.material, block, fields.rows.data(), eight);
      for (int lane = 0; lane < kPackSize && element < group.places.size(); ++lane, ++element) {
        const std::array<int, A* A>& places = group.places[element];
        for (int a = 0; a < A; ++a) {
          for (int b = a; b < A; ++b) {
            const int place = places[A * a + b];
            if (place < 0) continue;
            Matrix3d ab;
            for (int k = 0; k < 9; ++k) ab(k) = eight.K[a][b][k][lane];
            K.block(place) += ab;
            if (a < b) K.block(places[A * b + a]) += ab.transpose();
          }
        }
      }
    }
  };
  std::visit([&](const auto& groups) { std::for_each(groups.begin(), groups.end(), add_group); },
             groups_);
  hold(K);
}

void TetAssembly::hold(BlockMatrix& K) const {
  for (const HeldAxis& held : held_axes_) {
    const int diagonal = pattern_.find(held.row, held.row);
    // The diagonal keeps its own stiffness, so that the matrix stays as well scaled as before.
    const double stiffness = K.block(diagonal)(held.axis, held.axis);
    for (int p = pattern_.row_start[held.row]; p < pattern_.row_start[held.row + 1]; ++p) {
      K.block(p).row(held.axis).setZero();
    }
    for (const int p : held.column_places) K.block(p).col(held.axis).setZero();
    K.block(diagonal)(held.axis, held.axis) = stiffness;
  }
}

void TetAssembly::gather(const Matrix3Xd& field, Eigen::VectorXd& free) const {
  free.resize(static_cast<Eigen::Index>(3 * free_nodes_.size()));
  Eigen::Index at = 0;
  for (const int n : free_nodes_) {
    free.segment<3>(at) = field.col(n);
    at += 3;
  }
  for (const HeldAxis& held : held_axes_) free[3 * held.row + held.axis] = 0.0;
}

void TetAssembly::add_scattered(const Eigen::VectorXd& free, double scale, Matrix3Xd& field) const {
  Eigen::Index at = 0;
  for (const int n : free_nodes_) {
    field.col(n) += scale * free.segment<3>(at);
    at += 3;
  }
}

}  // namespace palpable
