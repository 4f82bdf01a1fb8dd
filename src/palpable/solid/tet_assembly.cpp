#include "palpable/solid/tet_assembly.h"

#include "palpable/solid/quadrature.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

namespace {

// Gradients and weights of element `number` at its integration points.
template <class Element>
void set_points(const TetMesh& mesh, int number, Element& element) {
  if constexpr (Element::kNodes == 4) {
    const ShapeGradients shape = shape_gradients(mesh, number);
    element.g[0] = shape.g;
    element.volume[0] = shape.volume;
    element.nodes = mesh.tets.col(number);
  } else {
    for (std::size_t q = 0; q < element.g.size(); ++q) {
      const auto& [L, weight] = four_point_rule()[q];
      const QuadraticGradients shape = quadratic_gradients(mesh, number, quadratic_shape(L));
      element.g[q] = shape.g;
      element.volume[q] = weight * shape.volume;
    }
    element.nodes = quadratic_nodes(mesh, number);
  }
}

// Adds one group's forces and energy; false, and `state` says where, if an element is inverted.
template <class Law, class Group>
bool add_force(const Law& law, const Group& group, const Matrix3Xd& u, Matrix3Xd& force,
               BodyState& state) {
  std::size_t number = 0;
  for (const auto& element : group.elements) {
    for (std::size_t q = 0; q < element.g.size(); ++q) {
      const auto& g = element.g[q];
      const Matrix3d F = deformation_gradient(g, element.nodes, u);
      const double J = F.determinant();
      if (!(J >= state.smallest_volume_ratio)) {
        state.smallest_volume_ratio = J;
        state.most_compressed = group.numbers[number];
      }
      if (!(J > 0.0)) return false;  // also when u is not finite
      state.energy += element.volume[q] * energy_density(law, F);
      const Matrix3d stress = element.volume[q] * first_piola(law, F);
      for (Eigen::Index a = 0; a < g.cols(); ++a) {
        force.col(element.nodes[a]).noalias() += stress * g.col(a);
      }
    }
    ++number;
  }
  return true;
}

// Adds one group's tangent: K_ab,ik = sum_q V_q g_aJ A_iJkL g_bL, first over L for each b, then
// over J for each a <= b; the other triangle is its mirror image.
template <class Law, class Group>
void add_tangent(const Law& law, const Group& group, const Matrix3Xd& u, BlockMatrix& K) {
  using Element = typename decltype(group.elements)::value_type;
  constexpr int A = Element::kNodes, Q = Element::kPoints;
  const auto place_of = [](const Element& element, int a, int b) {
    return element.place[static_cast<std::size_t>(A * a + b)];
  };
  const auto add = [&](const Element& element, int a, int b, int place, const Matrix3d& block) {
    K.block(place) += block;
    if (a < b) K.block(place_of(element, b, a)) += block.transpose();
  };
  std::array<Matrix3d, Q == 1 ? 1 : A*(A + 1) / 2> sums;  // over the points, if there are several
  for (const Element& element : group.elements) {
    if constexpr (Q > 1) sums.fill(Matrix3d::Zero());
    for (std::size_t q = 0; q < Q; ++q) {
      const auto& g = element.g[q];
      const Matrix3d F = deformation_gradient(g, element.nodes, u);
      const Tangent C = palpable::tangent(law, F);
      const double V = element.volume[q];
      std::size_t pair = 0;
      for (int b = 0; b < A; ++b) {
        if (place_of(element, b, b) < 0) {
          pair += static_cast<std::size_t>(b) + 1;
          continue;
        }
        Eigen::Matrix<double, 9, 3> T = C.leftCols<3>() * (V * g(0, b));
        T.noalias() += C.middleCols<3>(3) * (V * g(1, b));
        T.noalias() += C.rightCols<3>() * (V * g(2, b));
        for (int a = 0; a <= b; ++a, ++pair) {
          const int place = place_of(element, a, b);
          if (place < 0) continue;
          Matrix3d block = T.topRows<3>() * g(0, a);
          block.noalias() += T.middleRows<3>(3) * g(1, a);
          block.noalias() += T.bottomRows<3>() * g(2, a);
          if constexpr (Q > 1) {
            sums[pair] += block;
          } else {
            add(element, a, b, place, block);
          }
        }
      }
    }
    if constexpr (Q > 1) {
      std::size_t pair = 0;
      for (int b = 0; b < A; ++b) {
        for (int a = 0; a <= b; ++a, ++pair) {
          const int place = place_of(element, a, b);
          if (place >= 0) add(element, a, b, place, sums[pair]);
        }
      }
    }
  }
}

}  // namespace

TetAssembly::TetAssembly(const SolidModel& model) {
  const TetMesh& mesh = model.mesh;
  free_of_node_.assign(static_cast<std::size_t>(mesh.node_count()), 0);
  const std::vector<HeldComponent> held = held_components(model);
  std::vector<int> held_directions(static_cast<std::size_t>(mesh.node_count()), 0);
  for (const HeldComponent& h : held) ++held_directions[static_cast<std::size_t>(h.at / 3)];
  for (int n = 0; n < mesh.node_count(); ++n) {
    int& place = free_of_node_[static_cast<std::size_t>(n)];
    if (held_directions[static_cast<std::size_t>(n)] == 3) {
      place = -1;
      continue;
    }
    place = static_cast<int>(free_nodes_.size());
    free_nodes_.push_back(n);
  }

  if (mesh.is_quadratic()) {
    build(model, groups_.emplace<Groups<10, 4>>());
  } else {
    build(model, groups_.emplace<Groups<4, 1>>());
  }

  for (const HeldComponent& h : held) {
    const int row = free_of_node_[static_cast<std::size_t>(h.at / 3)];
    if (row < 0) continue;
    HeldAxis axis{row, static_cast<int>(h.at % 3), {}};
    // The pattern is symmetric: the rows in this column are the columns of this row.
    for (int p = pattern_.row_start[static_cast<std::size_t>(row)];
         p < pattern_.row_start[static_cast<std::size_t>(row) + 1]; ++p) {
      axis.column_places.push_back(
          pattern_.find(pattern_.column[static_cast<std::size_t>(p)], row));
    }
    held_axes_.push_back(std::move(axis));
  }
}

template <int A, int Q>
void TetAssembly::build(const SolidModel& model, Groups<A, Q>& groups) {
  const TetMesh& mesh = model.mesh;
  const std::vector<int> group_of_element = material_groups(model);
  groups.push_back({model.material, {}, {}});
  for (const MaterialGroup& group : model.groups) groups.push_back({group.material, {}, {}});
  for (int e = 0; e < mesh.tet_count(); ++e) {
    auto& group =
        groups[static_cast<std::size_t>(group_of_element[static_cast<std::size_t>(e)] + 1)];
    group.numbers.push_back(e);
    set_points(mesh, e, group.elements.emplace_back());
  }

  // Neighbours of each free node, itself included.
  std::vector<std::vector<int>> neighbours(free_nodes_.size());
  const auto free_of = [&](int node) { return free_of_node_[static_cast<std::size_t>(node)]; };
  for (const auto& group : groups) {
    for (const auto& element : group.elements) {
      for (const int a : element.nodes) {
        const int row = free_of(a);
        if (row < 0) continue;
        for (const int b : element.nodes) {
          const int column = free_of(b);
          if (column >= 0) neighbours[static_cast<std::size_t>(row)].push_back(column);
        }
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

  for (auto& group : groups) {
    for (auto& element : group.elements) {
      for (int a = 0; a < A; ++a) {
        for (int b = 0; b < A; ++b) {
          const int row = free_of(element.nodes[a]), column = free_of(element.nodes[b]);
          element.place[static_cast<std::size_t>(A * a + b)] =
              row < 0 || column < 0 ? -1 : pattern_.find(row, column);
        }
      }
    }
  }
}

BodyState TetAssembly::force(const Matrix3Xd& u, Matrix3Xd& force) const {
  force.setZero();
  BodyState state;
  state.smallest_volume_ratio = std::numeric_limits<double>::infinity();
  const bool sound = std::visit(
      [&](const auto& groups) {
        return std::all_of(groups.begin(), groups.end(), [&](const auto& group) {
          return std::visit([&](const auto& law) { return add_force(law, group, u, force, state); },
                            group.material);
        });
      },
      groups_);
  if (!sound) state.energy = std::numeric_limits<double>::infinity();
  return state;
}

void TetAssembly::tangent(const Matrix3Xd& u, BlockMatrix& K) const {
  K.set_zero();
  std::visit(
      [&](const auto& groups) {
        for (const auto& group : groups) {
          std::visit([&](const auto& law) { add_tangent(law, group, u, K); }, group.material);
        }
      },
      groups_);
  hold(K);
}

void TetAssembly::hold(BlockMatrix& K) const {
  for (const HeldAxis& held : held_axes_) {
    const int diagonal = pattern_.find(held.row, held.row);
    // Its own stiffness keeps the matrix as well scaled as it was.
    const double stiffness = K.block(diagonal)(held.axis, held.axis);
    for (int p = pattern_.row_start[static_cast<std::size_t>(held.row)];
         p < pattern_.row_start[static_cast<std::size_t>(held.row) + 1]; ++p) {
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
