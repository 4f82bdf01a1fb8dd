#include "palpable/bake/intrusive/reduced_energy.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Seven numbers whose products sum up to V A : C : B.
using Strain = Eigen::Matrix<double, 7, 1>;

Strain weighted(const Matrix3d& A, const LameConstants& k, double volume) {
  const double shear = std::sqrt(2.0 * k.mu * volume), off = std::sqrt(2.0) * shear;
  Strain s;
  s << shear * A.diagonal(), off * A(0, 1), off * A(1, 2), off * A(2, 0),
      std::sqrt(k.lambda * volume) * A.trace();
  return s;
}

}  // namespace

QuarticEnergy quartic_energy(const SolidModel& model, const MatrixXd& F) {
  const Index n = F.cols(), P = n * (n + 1) / 2;
  PALPABLE_EXPECT(F.rows() == model.mesh.nodes.size() && !model.mesh.is_quadratic(),
                  "modes of a body of 4-node tetrahedra");
  const std::vector<int> group_of = material_groups(model);
  MatrixXd gram = MatrixXd::Zero(n + P, n + P);
  // Rows of e_0 .. e_n-1 g_00 g_01 g_11 ... for some elements at a time: 30 MB.
  constexpr int kElements = 512;
  MatrixXd strains;
  for (int first = 0; first < model.mesh.tet_count(); first += kElements) {
    const int count = std::min(kElements, model.mesh.tet_count() - first);
    strains.resize(7 * Index{count}, n + P);
    for (int c = 0; c < count; ++c) {
      const int e = first + c, group = group_of[e];
      const LameConstants k =
          lame_constants(group < 0 ? model.material : model.groups[group].material);
      const ShapeGradients shape = shape_gradients(model.mesh, e);
      std::vector<Matrix3d> H(n, Matrix3d::Zero());
      for (Index i = 0; i < n; ++i) {
        for (int a = 0; a < 4; ++a) {
          H[i] +=
              F.col(i).segment<3>(3 * Index{model.mesh.tets(a, e)}) * shape.g.col(a).transpose();
        }
      }
      for (Index j = 0; j < n; ++j) {
        const Matrix3d& B = H[j];
        strains.col(j).segment<7>(7 * Index{c}) =
            weighted(0.5 * (B + B.transpose()), k, shape.volume);
        for (Index i = 0; i <= j; ++i) {
          const Matrix3d product = H[i].transpose() * B;
          strains.col(n + pair_row(i, j)).segment<7>(7 * Index{c}) =
              weighted(0.5 * (product + product.transpose()), k, shape.volume);
        }
      }
    }
    add_gram(strains, gram);
  }
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();

  const auto e = [](Index i) { return i; };
  const auto g = [&](Index i, Index j) { return n + pair_row(i, j); };
  // Equal coefficients are computed once: summed in another order they would differ by rounding.
  DistinctCoefficients distinct{VectorXd(P), VectorXd(distinct_count(n, 3)),
                                VectorXd(distinct_count(n, 4))};
  Index of_pair = 0, of_three = 0, of_four = 0;
  for (Index l = 0; l < n; ++l) {
    for (Index k = 0; k <= l; ++k) {
      distinct.quadratic[of_pair++] = gram(e(k), e(l));
      for (Index j = 0; j <= k; ++j) {
        distinct.cubic[of_three++] =
            gram(e(j), g(k, l)) + gram(e(k), g(j, l)) + gram(e(l), g(j, k));
        for (Index i = 0; i <= j; ++i) {
          distinct.quartic[of_four++] =
              gram(g(i, j), g(k, l)) + gram(g(i, k), g(j, l)) + gram(g(i, l), g(j, k));
        }
      }
    }
  }
  return energy_of(static_cast<int>(n), distinct);
}

MatrixXd energy_modes(const LoadSeries& body, const Eigen::SparseMatrix<double>& loads, int linear,
                      int curved) {
  PALPABLE_EXPECT(1 <= curved && curved <= linear && linear <= loads.cols(), "modes of the loads");
  const VectorXd& M = body.mass();
  const VectorXd root = M.cwiseSqrt();
  // The SVD of all responses, each of unit length: by its Gram matrix, in blocks.
  MatrixXd responses = body.linear_response(MatrixXd(loads));
  VectorXd length(loads.cols());
  for (Index s = 0; s < loads.cols(); ++s) {
    length[s] = std::sqrt(responses.col(s).dot(M.cwiseProduct(responses.col(s))));
    responses.col(s) = root.cwiseProduct(responses.col(s)) / length[s];
  }
  MatrixXd gram = MatrixXd::Zero(loads.cols(), loads.cols());
  add_gram(responses, gram);
  const SymmetricEigen eigen = symmetric_eigen(gram);
  // Linearly dependent loads have fewer independent responses; rounding leaves eigenvalues of
  // 1e-15.
  const Index independent = (eigen.values.array() > 1e-10 * eigen.values.maxCoeff()).count();
  linear = std::min(linear, static_cast<int>(independent));
  curved = std::min(curved, linear);
  const MatrixXd V = eigen.vectors.rightCols(linear).rowwise().reverse();
  const MatrixXd basis = orthonormal_basis(times(responses, V));  // orthonormal after root
  responses.resize(0, 0);

  // phi_i at the size that the largest load gives it; u_2(phi_i + phi_j) - u_2(phi_i) - u_2(phi_j).
  const MatrixXd phi =
      root.cwiseInverse().asDiagonal() * basis.leftCols(curved) * length.maxCoeff();
  std::vector<VectorXd> fields;
  for (Index j = 0; j < curved; ++j) {
    for (Index i = 0; i <= j; ++i) {
      fields.emplace_back(i == j ? VectorXd(phi.col(i)) : VectorXd(phi.col(i) + phi.col(j)));
    }
  }
  MatrixXd forces(loads.rows(), static_cast<Index>(fields.size()));
  for (std::size_t k = 0; k < fields.size(); ++k) {
    forces.col(static_cast<Index>(k)) = body.stiffness_times(fields[k]);
  }
  const std::vector<LoadOrders> orders = body.solve(forces, {.most_orders = 2, .tolerance = 0.0});
  MatrixXd all(loads.rows(), linear + static_cast<Index>(fields.size()));
  all.leftCols(linear) = basis;
  for (Index j = 0; j < curved; ++j) {
    for (Index i = 0; i <= j; ++i) {
      const auto second = [&](Index a, Index b) { return orders[pair_row(a, b)].u.col(1); };
      VectorXd derivative = second(i, j);
      if (i != j) derivative -= second(i, i) + second(j, j);
      derivative = root.cwiseProduct(derivative);
      all.col(linear + pair_row(i, j)) = derivative / derivative.norm();
    }
  }
  return root.cwiseInverse().asDiagonal() * orthonormal_basis(all);
}

}  // namespace palpable
