#include "palpable/solid/modal_forms.h"

#include "palpable/base/contract.h"
#include "palpable/solid/energy_tensors.h"
#include "palpable/solid/quadrature.h"
#include "palpable/solid/shape_gradients.h"

#include <algorithm>
#include <array>
#include <cblas.h>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXf;

// Points whose products are summed by one matrix product: more would not fit into the cache.
constexpr Index kTogether = 32;

// A pair of entries of the gradient, a <= b, counts twice when they differ.
constexpr int kPairs = 45;

// One integration point.
struct Point {
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 10> g;  // dN_a/dX, 1/m
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, 10, 1> nodes;
  double weight = 0;  // m^3
  int tensors = 0;    // which of the law's derivatives
};

// The law's derivatives at a point, in the shapes in which they are used.
struct Derivatives {
  Eigen::Matrix<float, 81, 9> third;    // row 9 c + a, column b
  Eigen::Matrix<float, 405, 9> fourth;  // row 9 (cd) + a, column b; c < d twice
};

Derivatives derivatives_of(const Material& material, const Matrix3d& F) {
  const FullEnergyTensors full = unfolded(energy_tensors(material, F));
  Derivatives d;
  for (int a = 0; a < 9; ++a) {
    for (int b = 0; b < 9; ++b) {
      for (int c = 0; c < 9; ++c) {
        d.third(9 * c + a, b) = static_cast<float>(full.third[81 * a + 9 * b + c]);
      }
      int pair = 0;
      for (int c = 0; c < 9; ++c) {
        for (int e = c; e < 9; ++e, ++pair) {
          d.fourth(9 * pair + a, b) =
              static_cast<float>((c == e ? 1.0 : 2.0) * full.fourth[729 * a + 81 * b + 9 * c + e]);
        }
      }
    }
  }
  return d;
}

// Row of the pair (i, j), i <= j, of modes: 00 01 11 02 12 22 ...
Index pair_of(Index i, Index j) { return j * (j + 1) / 2 + i; }

// result(row, (i, j)) = sum_ab rows(9 row + a, b) G_i(a) G_j(b) for all pairs i <= j.
// @param G  (9 x n)
// @param result  (rows x pairs), written into columns of `stride` numbers
template <int kRows>
void contract_pairs(const Eigen::Matrix<float, 9 * kRows, 9>& rows, const MatrixXf& G, Index n,
                    float* result, Index stride) {
  Eigen::Matrix<float, 9 * kRows, 1> with_j;
  for (Index j = 0; j < n; ++j) {
    with_j.noalias() = rows * G.col(j);
    const Eigen::Map<const Eigen::Matrix<float, 9, kRows>> per_row(with_j.data());
    for (Index i = 0; i <= j; ++i) {
      Eigen::Map<Eigen::Matrix<float, kRows, 1>>(result + pair_of(i, j) * stride).noalias() =
          per_row.transpose() * G.col(i);
    }
  }
}

// C += A^T B in single precision.
void add_product(const MatrixXf& A, const MatrixXf& B, MatrixXf& C) {
  const auto size = [](Index n) { return static_cast<int>(n); };
  cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, size(A.cols()), size(B.cols()),
              size(A.rows()), 1.0F, A.data(), size(A.rows()), B.data(), size(B.rows()), 1.0F,
              C.data(), size(C.rows()));
}

// Distinct cubic coefficients from a table over (pair, k).
std::vector<double> distinct_cubic(const Eigen::MatrixXd& by_pair) {
  std::vector<double> distinct;
  const Index r = by_pair.cols();
  for (Index i = 0; i < r; ++i) {
    for (Index j = i; j < r; ++j) {
      // All three ways to split i, j, k are sums over the same points; their mean rounds least.
      for (Index k = j; k < r; ++k) {
        distinct.push_back(
            (by_pair(pair_of(i, j), k) + by_pair(pair_of(i, k), j) + by_pair(pair_of(j, k), i)) /
            3.0);
      }
    }
  }
  return distinct;
}

}  // namespace

struct ModalFormMaker::Parts {
  SolidModel model;
  std::vector<Point> points;
  std::vector<Derivatives> derivatives;

  Parts(const SolidModel& the_model, const Matrix3Xd& rest) : model(the_model) {
    check_model(model);
    const std::vector<int> group_of = material_groups(model);
    const bool undeformed = rest.isZero(0);
    std::map<int, int> of_group;  // undeformed, all points of a material have the same
    for (int e = 0; e < model.mesh.tet_count(); ++e) {
      for (Point& point : points_of(e)) {
        const int group = group_of[e];
        const auto [known, is_new] =
            undeformed ? of_group.try_emplace(group, static_cast<int>(derivatives.size()))
                       : std::pair{of_group.end(), true};
        if (is_new) {
          const Matrix3d F = Matrix3d::Identity() + gradient(point, rest);
          derivatives.push_back(
              derivatives_of(group < 0 ? model.material : model.groups[group].material, F));
        }
        point.tensors = undeformed ? known->second : static_cast<int>(derivatives.size()) - 1;
        points.push_back(std::move(point));
      }
    }
  }

  [[nodiscard]] std::vector<Point> points_of(int e) const {
    const TetMesh& mesh = model.mesh;
    if (!mesh.is_quadratic()) {
      const ShapeGradients shape = shape_gradients(mesh, e);
      return {{shape.g, mesh.tets.col(e), shape.volume, 0}};
    }
    std::vector<Point> four;
    for (const auto& [L, weight] : four_point_rule()) {
      const QuadraticGradients shape = quadratic_gradients(mesh, e, quadratic_shape(L));
      four.push_back({shape.g, quadratic_nodes(mesh, e), weight * shape.volume, 0});
    }
    return four;
  }

  static Matrix3d gradient(const Point& point, const Matrix3Xd& u) {
    Matrix3d H = Matrix3d::Zero();
    for (Index a = 0; a < point.nodes.size(); ++a) {
      H += u.col(point.nodes[a]) * point.g.col(a).transpose();
    }
    return H;
  }
};

namespace {

// (9 x r) gradients of all modes at a point.
MatrixXf gradients(const Point& point, const Eigen::MatrixXf& modes) {
  MatrixXf G = MatrixXf::Zero(9, modes.cols());
  for (Index a = 0; a < point.nodes.size(); ++a) {
    const auto u = modes.middleRows(3 * Index{point.nodes[a]}, 3);
    for (int J = 0; J < 3; ++J) G.middleRows(3 * J, 3) += static_cast<float>(point.g(J, a)) * u;
  }
  return G;
}

// The points that carry the forms: those with the largest weight |G|^3, until what is left is less
// than `neglect` of the whole.
std::vector<Index> carrying_points(const std::vector<Point>& points, const Eigen::MatrixXf& modes,
                                   double neglect) {
  std::vector<double> carries(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    carries[p] =
        points[p].weight * std::pow(static_cast<double>(gradients(points[p], modes).norm()), 3);
  }
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return carries[a] != carries[b] ? carries[a] > carries[b] : a < b;
  });
  double left = std::accumulate(carries.begin(), carries.end(), 0.0);
  const double enough = neglect * left;
  std::size_t count = 0;
  while (count < order.size() && left > enough) left -= carries[order[count++]];
  order.resize(count);
  std::sort(order.begin(), order.end());  // neighbours in memory
  return order;
}

// E from B and A, over pairs of leading modes: (i, j) by row, (k, l) by column.
std::vector<double> distinct_quartic(const Eigen::MatrixXd& B, const Eigen::MatrixXd& A, Index s) {
  const Eigen::MatrixXd lead = A.topLeftCorner(pair_of(s - 1, s - 1) + 1, s);
  const Eigen::MatrixXd AA = lead * lead.transpose();
  std::vector<double> distinct;
  for (Index i = 0; i < s; ++i) {
    for (Index j = i; j < s; ++j) {
      for (Index k = j; k < s; ++k) {
        for (Index l = k; l < s; ++l) {
          const auto three = [&](const Eigen::MatrixXd& M) {
            return M(pair_of(i, j), pair_of(k, l)) + M(pair_of(i, k), pair_of(j, l)) +
                   M(pair_of(i, l), pair_of(j, k));
          };
          distinct.push_back(three(B) / 3.0 - three(AA));
        }
      }
    }
  }
  return distinct;
}

}  // namespace

ModalFormMaker::ModalFormMaker(const SolidModel& model, const Matrix3Xd& rest)
    : parts_(std::make_unique<Parts>(model, rest)) {}
ModalFormMaker::~ModalFormMaker() = default;
ModalFormMaker::ModalFormMaker(ModalFormMaker&&) noexcept = default;

ModalForms ModalFormMaker::make(const Eigen::MatrixXd& modes, int leading, double neglect) const {
  PALPABLE_EXPECT(modes.rows() == 3 * Index{parts_->model.mesh.node_count()} && leading >= 0 &&
                      leading <= modes.cols(),
                  "modes of the body's nodes, and no more leading ones than there are");
  const Index r = modes.cols(), s = leading, pairs = r * (r + 1) / 2, few = s * (s + 1) / 2;
  const Eigen::MatrixXf U = modes.cast<float>();
  const std::vector<Index> order = carrying_points(parts_->points, U, neglect);
  MatrixXf cubic = MatrixXf::Zero(pairs, r), quartic = MatrixXf::Zero(few, few);
  Eigen::MatrixXd cubic_sum = Eigen::MatrixXd::Zero(pairs, r);
  Eigen::MatrixXd quartic_sum = Eigen::MatrixXd::Zero(few, few);
  MatrixXf left3(9 * kTogether, pairs), right3(9 * kTogether, r);
  MatrixXf left4(kPairs * kTogether, few), right4(kPairs * kTogether, few);
  for (std::size_t first = 0; first < order.size(); first += kTogether) {
    const Index count = std::min<Index>(kTogether, static_cast<Index>(order.size() - first));
    if (count < kTogether) {
      for (MatrixXf* block : {&left3, &right3, &left4, &right4}) block->setZero();
    }
    for (Index p = 0; p < count; ++p) {
      const Point& point = parts_->points[order[first + static_cast<std::size_t>(p)]];
      const Derivatives& d = parts_->derivatives[static_cast<std::size_t>(point.tensors)];
      const MatrixXf G = gradients(point, U);
      const auto weight = static_cast<float>(point.weight);
      contract_pairs<9>(d.third, G, r, left3.data() + 9 * p, left3.rows());
      right3.middleRows(9 * p, 9) = weight * G;
      contract_pairs<kPairs>(d.fourth, G, s, left4.data() + kPairs * p, left4.rows());
      for (Index j = 0; j < s; ++j) {
        for (Index i = 0; i <= j; ++i) {
          float* to = right4.data() + kPairs * p + pair_of(i, j) * right4.rows();
          for (int a = 0; a < 9; ++a) {
            for (int b = a; b < 9; ++b) {
              *to++ = weight * 0.5f * (G(a, i) * G(b, j) + G(b, i) * G(a, j));
            }
          }
        }
      }
    }
    add_product(left3, right3, cubic);
    add_product(left4, right4, quartic);
    // Sums of many blocks would lose digits in single precision.
    if (first / kTogether % 16 == 15 || first + kTogether >= order.size()) {
      cubic_sum += cubic.cast<double>();
      quartic_sum += quartic.cast<double>();
      cubic.setZero();
      quartic.setZero();
    }
  }
  ModalForms forms{static_cast<int>(r), leading, distinct_cubic(cubic_sum), {}};
  if (s > 0) forms.quartic = distinct_quartic(quartic_sum, cubic_sum, s);
  return forms;
}

}  // namespace palpable
