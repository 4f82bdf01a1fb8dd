#include "palpable/bake/solid/modal_forms.h"

#include "palpable/bake/solid/energy_tensors.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/element_order.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

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

// Number of pairs (a, b), a <= b, of the nine entries of a gradient. A pair with a < b counts
// twice.
constexpr int kPairs = 45;

// One integration point.
struct Point {
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 10> g;  // dN_a/dX, 1/m
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, 10, 1> nodes;
  double weight = 0;  // m^3
  int tensors = 0;    // index of the law's derivatives there
};

// The law's derivatives at a point, over pairs (ab), a <= b, of entries of F.
struct Derivatives {
  Eigen::Matrix<float, kPairs, 9> third;        // D3 Psi (ab, c)
  Eigen::Matrix<float, kPairs, kPairs> fourth;  // D4 Psi (ab, cd)
};

Derivatives derivatives_of(const Material& material, const Matrix3d& F) {
  const FullEnergyTensors full = unfolded(energy_tensors(material, F));
  Derivatives d;
  int ab = 0;
  for (int a = 0; a < 9; ++a) {
    for (int b = a; b < 9; ++b, ++ab) {
      for (int c = 0; c < 9; ++c) {
        d.third(ab, c) = static_cast<float>(full.third[81 * a + 9 * b + c]);
      }
      int cd = 0;
      for (int c = 0; c < 9; ++c) {
        for (int e = c; e < 9; ++e, ++cd) {
          d.fourth(ab, cd) = static_cast<float>(full.fourth[729 * a + 81 * b + 9 * c + e]);
        }
      }
    }
  }
  return d;
}

// Row of the pair (i, j), i <= j, of modes: 00 01 11 02 12 22 ...
Index pair_of(Index i, Index j) { return j * (j + 1) / 2 + i; }

// products((i, j), ab) = G_i(a) G_j(b) + G_i(b) G_j(a), or the first alone where a = b, for the
// first n modes.
// @param G  (r x 9)
void find_products(const MatrixXf& G, Index n, Eigen::Ref<MatrixXf> products) {
  Index ab = 0;
  for (int a = 0; a < 9; ++a) {
    for (int b = a; b < 9; ++b, ++ab) {
      for (Index j = 0; j < n; ++j) {
        auto to = products.col(ab).segment(pair_of(0, j), j + 1);
        to = G(j, b) * G.col(a).head(j + 1);
        if (a != b) to += G(j, a) * G.col(b).head(j + 1);
      }
    }
  }
}

// C += A B, or A B^T, in single precision.
void add_product(const Eigen::Ref<const MatrixXf>& A, const Eigen::Ref<const MatrixXf>& B,
                 bool transpose, Eigen::Ref<MatrixXf> C) {
  const auto size = [](Index n) { return static_cast<int>(n); };
  cblas_sgemm(CblasColMajor, CblasNoTrans, transpose ? CblasTrans : CblasNoTrans, size(C.rows()),
              size(C.cols()), size(A.cols()), 1.0F, A.data(), size(A.outerStride()), B.data(),
              size(B.outerStride()), 1.0F, C.data(), size(C.outerStride()));
}

// Distinct cubic coefficients from a table over (pair, k).
std::vector<double> distinct_cubic(const Eigen::MatrixXd& by_pair) {
  std::vector<double> distinct;
  const Index r = by_pair.cols();
  for (Index i = 0; i < r; ++i) {
    for (Index j = i; j < r; ++j) {
      // The three ways to split (i, j, k) differ by rounding only; their mean has the least of it.
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
    std::map<int, int> of_group;  // at rest undeformed, all points of a material share theirs
    for (const int e : order_along_curve(centres(model.mesh))) {
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

  static Matrix3Xd centres(const TetMesh& mesh) {
    Matrix3Xd middle = Matrix3Xd::Zero(3, mesh.tet_count());
    for (Index e = 0; e < middle.cols(); ++e) {
      for (int k = 0; k < 4; ++k) middle.col(e) += 0.25 * mesh.nodes.col(mesh.tets(k, e));
    }
    return middle;
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

// (r x 9) gradients of all modes at a point.
MatrixXf gradients(const Point& point, const MatrixXf& modes) {
  MatrixXf G = MatrixXf::Zero(modes.cols(), 9);
  for (Index a = 0; a < point.nodes.size(); ++a) {
    const auto u = modes.middleRows(3 * Index{point.nodes[a]}, 3);
    for (int J = 0; J < 3; ++J) {
      G.middleCols(3 * J, 3) += static_cast<float>(point.g(J, a)) * u.transpose();
    }
  }
  return G;
}

// The points that are summed. Each has the volume of all points that it represents.
struct Sample {
  std::vector<Index> points;
  std::vector<double> weights;  // m^3
};

// @param points  in the order of a space-filling curve (order_along_curve()): points that are
//                neighbours in the list are neighbours in the body
Sample sampled(const std::vector<Point>& points, const MatrixXf& modes,
               const FormSampling& sampling) {
  std::vector<double> contribution(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    contribution[p] =
        points[p].weight * std::pow(static_cast<double>(gradients(points[p], modes).norm()), 3);
  }
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return contribution[a] != contribution[b] ? contribution[a] > contribution[b] : a < b;
  });
  const double whole = std::accumulate(contribution.begin(), contribution.end(), 0.0);
  enum Rank : char { kLeftOut, kSampled, kExact };
  std::vector<Rank> rank(points.size(), kLeftOut);
  double before = 0;
  for (const std::size_t p : order) {
    if (before >= (1 - sampling.neglect) * whole) break;
    rank[p] = before < sampling.exact * whole ? kExact : kSampled;
    before += contribution[p];
  }
  Sample sample;
  std::vector<std::size_t> group;
  const auto close_group = [&] {
    if (group.empty()) return;
    double weight = 0;
    for (const std::size_t p : group) weight += points[p].weight;
    sample.points.push_back(static_cast<Index>(group[group.size() / 2]));
    sample.weights.push_back(weight);
    group.clear();
  };
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (rank[p] == kExact) {
      sample.points.push_back(static_cast<Index>(p));
      sample.weights.push_back(points[p].weight);
    } else if (rank[p] == kSampled) {
      group.push_back(p);
      if (group.size() >= static_cast<std::size_t>(sampling.every)) close_group();
    }
  }
  close_group();
  return sample;
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

ModalForms ModalFormMaker::make(const Eigen::MatrixXd& modes, int leading,
                                const FormSampling& sampling) const {
  PALPABLE_EXPECT(modes.rows() == 3 * Index{parts_->model.mesh.node_count()} && leading >= 0 &&
                      leading <= modes.cols(),
                  "modes of the body's nodes, and no more leading ones than there are");
  const Index r = modes.cols(), s = leading, pairs = r * (r + 1) / 2, few = s * (s + 1) / 2;
  const Eigen::MatrixXf U = modes.cast<float>();
  const Sample sample = sampled(parts_->points, U, sampling);
  const std::vector<Index>& order = sample.points;
  MatrixXf cubic = MatrixXf::Zero(pairs, r), quartic = MatrixXf::Zero(few, few);
  Eigen::MatrixXd cubic_sum = Eigen::MatrixXd::Zero(pairs, r);
  Eigen::MatrixXd quartic_sum = Eigen::MatrixXd::Zero(few, few);
  // For each point: the products of its gradients (pairs x 45), and these times the law's
  // derivatives.
  MatrixXf products(pairs, kPairs), with_law(pairs, 9 * kTogether), rows(9 * kTogether, r);
  MatrixXf left(few, kPairs * kTogether), right(few, kPairs * kTogether);
  for (std::size_t first = 0; first < order.size(); first += kTogether) {
    const Index count = std::min<Index>(kTogether, static_cast<Index>(order.size() - first));
    with_law.setZero();
    left.setZero();
    for (Index p = 0; p < count; ++p) {
      const Point& point = parts_->points[order[first + static_cast<std::size_t>(p)]];
      const Derivatives& d = parts_->derivatives[static_cast<std::size_t>(point.tensors)];
      const MatrixXf G = gradients(point, U);
      const auto weight = static_cast<float>(sample.weights[first + static_cast<std::size_t>(p)]);
      find_products(G, r, products);
      add_product(products, d.third, false, with_law.middleCols(9 * p, 9));
      rows.middleRows(9 * p, 9) = weight * G.transpose();
      if (s == 0) continue;
      add_product(products.topRows(few), d.fourth, false, left.middleCols(kPairs * p, kPairs));
      right.middleCols(kPairs * p, kPairs) = weight * products.topRows(few);
    }
    add_product(with_law.leftCols(9 * count), rows.topRows(9 * count), false, cubic);
    if (s > 0) {
      add_product(left.leftCols(kPairs * count), right.leftCols(kPairs * count), true, quartic);
    }
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
