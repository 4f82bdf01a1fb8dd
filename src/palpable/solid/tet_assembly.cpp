#include "palpable/solid/tet_assembly.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

TetAssembly::TetAssembly(const SolidModel& model) : material_(model.material) {
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

  // Neighbours of each free node, itself included.
  std::vector<std::vector<int>> neighbours(free_nodes_.size());
  const auto free_of = [&](int node) { return free_of_node_[static_cast<std::size_t>(node)]; };
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (int a = 0; a < 4; ++a) {
      const int row = free_of(mesh.tets(a, e));
      if (row < 0) continue;
      for (int b = 0; b < 4; ++b) {
        const int column = free_of(mesh.tets(b, e));
        if (column >= 0) neighbours[static_cast<std::size_t>(row)].push_back(column);
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

  for (const HeldComponent& h : held) {
    const int row = free_of(static_cast<int>(h.at / 3));
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

  elements_.resize(static_cast<std::size_t>(mesh.tet_count()));
  for (int e = 0; e < mesh.tet_count(); ++e) {
    Element& element = elements_[static_cast<std::size_t>(e)];
    const ShapeGradients shape = shape_gradients(mesh, e);
    element.g = shape.g;
    element.volume = shape.volume;
    element.nodes = mesh.tets.col(e);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const int row = free_of(element.nodes[a]), column = free_of(element.nodes[b]);
        element.place[static_cast<std::size_t>(4 * a + b)] =
            row < 0 || column < 0 ? -1 : pattern_.find(row, column);
      }
    }
  }
}

BodyState TetAssembly::force(const Matrix3Xd& u, Matrix3Xd& force) const {
  force.setZero();
  BodyState state;
  state.smallest_volume_ratio = std::numeric_limits<double>::infinity();
  std::visit(
      [&](const auto& law) {
        int number = 0;
        for (const Element& element : elements_) {
          const Matrix3d F = deformation_gradient(element.g, element.nodes, u);
          const double J = F.determinant();
          if (!(J >= state.smallest_volume_ratio)) {
            state.smallest_volume_ratio = J;
            state.most_compressed = number;
          }
          if (!(J > 0.0)) break;  // also when u is not finite
          state.energy += element.volume * energy_density(law, F);
          const Matrix3d stress = element.volume * first_piola(law, F);
          for (int a = 0; a < 4; ++a) {
            force.col(element.nodes[a]).noalias() += stress * element.g.col(a);
          }
          ++number;
        }
      },
      material_);
  if (!(state.smallest_volume_ratio > 0.0)) {
    state.energy = std::numeric_limits<double>::infinity();
  }
  return state;
}

void TetAssembly::tangent(const Matrix3Xd& u, BlockMatrix& K) const {
  K.set_zero();
  std::visit(
      [&](const auto& law) {
        for (const Element& element : elements_) {
          const auto& g = element.g;
          const Matrix3d F = deformation_gradient(g, element.nodes, u);
          const Tangent A = palpable::tangent(law, F);
          // K_ab,ik = V g_aJ A_iJkL g_bL: first over L for each b, then over J for each a <= b.
          for (int b = 0; b < 4; ++b) {
            if (element.place[static_cast<std::size_t>(5 * b)] < 0) continue;
            Eigen::Matrix<double, 9, 3> T = A.leftCols<3>() * (element.volume * g(0, b));
            T.noalias() += A.middleCols<3>(3) * (element.volume * g(1, b));
            T.noalias() += A.rightCols<3>() * (element.volume * g(2, b));
            for (int a = 0; a <= b; ++a) {
              const int place = element.place[static_cast<std::size_t>(4 * a + b)];
              if (place < 0) continue;
              Matrix3d block = T.topRows<3>() * g(0, a);
              block.noalias() += T.middleRows<3>(3) * g(1, a);
              block.noalias() += T.bottomRows<3>() * g(2, a);
              K.block(place) += block;
              if (a < b) {
                K.block(element.place[static_cast<std::size_t>(4 * b + a)]) += block.transpose();
              }
            }
          }
        }
      },
      material_);
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
