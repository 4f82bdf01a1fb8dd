#include "palpable/bake/solid/load_series.h"

#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/shape_gradients.h"
#include "palpable/common/material/simd.h"
#include "palpable/common/material/tensor.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// One number for each of eight loads.
struct alignas(kPackAlignment) Lanes {
  Pack of;
};

// One element; the eight loads of a group share it.
struct SeriesElement {
  double g[4][3];  // dN_a/dX, 1/m
  double volume, lambda, mu;
  int nodes[4];
};

// Six components of a symmetric tensor: xx yy zz xy yz zx.
struct alignas(kPackAlignment) Symmetric {
  Pack m[6];
};

constexpr int kOfEntry[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

PALPABLE_ALWAYS_INLINE Tensor<Pack> series_gradient(const SeriesElement& e, const Lanes* u) {
  Tensor<Pack> H;
  for (int i = 0; i < 3; ++i) {
    Pack at[4];
    for (int a = 0; a < 4; ++a) at[a] = u[3 * e.nodes[a] + i].of;
    for (int J = 0; J < 3; ++J) {
      H(i, J) = at[0] * e.g[0][J] + at[1] * e.g[1][J] + at[2] * e.g[2][J] + at[3] * e.g[3][J];
    }
  }
  return H;
}

// C : A = lambda tr A I + 2 mu A
PALPABLE_ALWAYS_INLINE Symmetric hooke(const SeriesElement& e, const Symmetric& A) {
  Symmetric S;
  const Pack pressure = e.lambda * (A.m[0] + A.m[1] + A.m[2]);
  for (int k = 0; k < 6; ++k) S.m[k] = 2.0 * e.mu * A.m[k];
  for (int k = 0; k < 3; ++k) S.m[k] += pressure;
  return S;
}

// The right-hand side of order p, from the orders 1 .. p-1, for eight loads.
struct NextOrder {
  // stress[q - 1] holds S_q for q <= p - 2 and C : Q_{p-1} for q = p - 1, to which C : sym H_{p-1}
  // is added here; C : Q_p goes to stress[p - 1]. -f_p is added to `force`.
  static constexpr int kMostOrders = 32;
  PALPABLE_ALWAYS_INLINE static int run(const std::vector<SeriesElement>& elements, int p,
                                        const std::vector<std::vector<Lanes>>& u,
                                        std::vector<std::vector<Symmetric>>& stress,
                                        std::vector<Lanes>& force) {
    Tensor<Pack> H[kMostOrders];
    for (std::size_t number = 0; number < elements.size(); ++number) {
      const SeriesElement& e = elements[number];
      for (int r = 1; r < p; ++r) H[r] = series_gradient(e, u[r].data());

      Symmetric& last = stress[p - 2][number];
      const Tensor<Pack>& h = H[p - 1];
      Symmetric strain;
      for (int i = 0; i < 3; ++i) strain.m[i] = h(i, i);
      strain.m[3] = 0.5 * (h(0, 1) + h(1, 0));
      strain.m[4] = 0.5 * (h(1, 2) + h(2, 1));
      strain.m[5] = 0.5 * (h(2, 0) + h(0, 2));
      strain = hooke(e, strain);
      for (int k = 0; k < 6; ++k) last.m[k] += strain.m[k];

      // Q_p: the sum is symmetric in r and p - r.
      Symmetric Q{};
      for (int r = 1; 2 * r <= p; ++r) {
        const Tensor<Pack>&A = H[r], &B = H[p - r];
        const double half = 2 * r == p ? 0.25 : 0.5;
        for (int i = 0; i < 3; ++i) {
          for (int j = i; j < 3; ++j) {
            Q.m[kOfEntry[i][j]] +=
                half * (A(0, i) * B(0, j) + A(1, i) * B(1, j) + A(2, i) * B(2, j) +
                        A(0, j) * B(0, i) + A(1, j) * B(1, i) + A(2, j) * B(2, i));
          }
        }
      }
      const Symmetric CQ = hooke(e, Q);
      stress[p - 1][number] = CQ;

      Tensor<Pack> P;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) P(i, j) = CQ.m[kOfEntry[i][j]];
      }
      for (int r = 1; r < p; ++r) {
        const Symmetric& S = stress[p - r - 1][number];
        for (int j = 0; j < 3; ++j) {
          for (int i = 0; i < 3; ++i) {
            P(i, j) += H[r](i, 0) * S.m[kOfEntry[0][j]] + H[r](i, 1) * S.m[kOfEntry[1][j]] +
                       H[r](i, 2) * S.m[kOfEntry[2][j]];
          }
        }
      }
      for (int a = 0; a < 4; ++a) {
        for (int i = 0; i < 3; ++i) {
          force[3 * e.nodes[a] + i].of -=
              e.volume * (P(i, 0) * e.g[a][0] + P(i, 1) * e.g[a][1] + P(i, 2) * e.g[a][2]);
        }
      }
    }
    return 0;
  }
};

SolidModel series_model(const SolidModel& model) {
  check_model(model);
  const auto refuse = [](const Material& material) {
    if (std::holds_alternative<SaintVenantKirchhoff>(material)) return;
    throw Error(fmt::format(
        "the power series needs the law saint-venant-kirchhoff, whose forces are a cubic "
        "polynomial of the displacement; this body is made of {}",
        law_name(material)));
  };
  refuse(model.material);
  for (const MaterialGroup& group : model.groups) refuse(group.material);
  if (model.mesh.is_quadratic()) {
    throw Error("the power series is written for 4-node tetrahedra; this mesh has ten nodes each");
  }
  for (const HeldComponent& held : held_components(model)) {
    if (held.displacement != 0.0) throw Error("the power series needs supports that stand still");
  }
  return model;
}

}  // namespace

struct LoadSeries::Core {
  SolidModel model;
  TetAssembly assembly;
  mutable FactorWorkspace workspace;  // for one caller at a time
  ExactFactor factor;
  std::vector<SeriesElement> elements;
  std::vector<Index> unknown;  // (free components) their index in a field of 3N
  std::vector<Index> row;      // their index in a vector of the assembly, 3M
  VectorXd free_mask, mass;

  explicit Core(const SolidModel& the_model)
      : model(series_model(the_model)), assembly(model), factor(factorise()) {
    const std::vector<int> group_of = material_groups(model);
    const std::vector<int>& free_nodes = assembly.free_nodes();
    for (int e = 0; e < model.mesh.tet_count(); ++e) {
      const ShapeGradients shape = shape_gradients(model.mesh, e);
      const int g = group_of[e];
      const auto [lambda, mu] = lame_constants(g < 0 ? model.material : model.groups[g].material);
      SeriesElement element{{}, shape.volume, lambda, mu, {}};
      for (int a = 0; a < 4; ++a) {
        element.nodes[a] = model.mesh.tets(a, e);
        for (int J = 0; J < 3; ++J) element.g[a][J] = shape.g(J, a);
      }
      elements.push_back(element);
    }
    free_mask = VectorXd::Ones(3 * model.mesh.node_count());
    for (const HeldComponent& held : held_components(model)) free_mask[held.at] = 0.0;
    for (std::size_t f = 0; f < free_nodes.size(); ++f) {
      for (Index i = 0; i < 3; ++i) {
        if (free_mask[3 * Index{free_nodes[f]} + i] == 0.0) continue;
        unknown.push_back(3 * Index{free_nodes[f]} + i);
        row.push_back(3 * static_cast<Index>(f) + i);
      }
    }
    mass = nodal_volumes(model.mesh).replicate(1, 3).transpose().reshaped();
  }

  [[nodiscard]] Index values() const { return free_mask.size(); }
  [[nodiscard]] Index rows() const { return 3 * Index{assembly.pattern().rows()}; }

 private:
  ExactFactor factorise() {
    BlockMatrix K(assembly.pattern());
    PassFields fields;
    assembly.set_state(Eigen::Matrix3Xd::Zero(3, assembly.node_count()), fields);
    assembly.tangent(fields, K);
    return {CholeskyAnalysis(assembly.pattern(), workspace), K, workspace};
  }
};

LoadSeries::LoadSeries(const SolidModel& model) : core_(std::make_unique<Core>(model)) {}
LoadSeries::~LoadSeries() = default;
LoadSeries::LoadSeries(LoadSeries&&) noexcept = default;

const SolidModel& LoadSeries::model() const { return core_->model; }
const VectorXd& LoadSeries::free_mask() const { return core_->free_mask; }
const VectorXd& LoadSeries::mass() const { return core_->mass; }

MatrixXd LoadSeries::linear_response(const MatrixXd& loads) const {
  PALPABLE_EXPECT(loads.rows() == core_->values(), "a load has three values a node");
  MatrixXd u = MatrixXd::Zero(loads.rows(), loads.cols());
  constexpr Index kLoadsAtATime = 64;
  for (Index first = 0; first < loads.cols(); first += kLoadsAtATime) {
    const Index count = std::min(kLoadsAtATime, loads.cols() - first);
    MatrixXd B = MatrixXd::Zero(core_->rows(), count);
    for (Index c = 0; c < count; ++c) {
      for (std::size_t k = 0; k < core_->row.size(); ++k) {
        B(core_->row[k], c) = loads(core_->unknown[k], first + c);
      }
    }
    core_->factor.solve(B, core_->workspace);
    for (Index c = 0; c < count; ++c) {
      for (std::size_t k = 0; k < core_->row.size(); ++k) {
        u(core_->unknown[k], first + c) = B(core_->row[k], c);
      }
    }
  }
  return u;
}

VectorXd LoadSeries::stiffness_times(const VectorXd& u) const {
  const Eigen::Map<const Eigen::Matrix3Xd> field(u.data(), 3, u.size() / 3);
  Eigen::Matrix3Xd force(3, field.cols());
  PassFields fields;
  core_->assembly.set_state(Eigen::Matrix3Xd::Zero(3, field.cols()), fields);
  core_->assembly.force_change(fields, field, force);
  return force.reshaped();
}

VectorXd LoadSeries::internal_force(const VectorXd& u) const {
  const Eigen::Map<const Eigen::Matrix3Xd> field(u.data(), 3, u.size() / 3);
  Eigen::Matrix3Xd force(3, field.cols());
  PassFields fields;
  core_->assembly.set_state(field, fields);
  core_->assembly.force(fields, force);
  return force.reshaped();
}

namespace {

// The series of some loads, order by order: eight loads to a group.
class LoadsTogether {
 public:
  LoadsTogether(Index count, std::size_t values, std::size_t elements)
      : values_(values),
        elements_(elements),
        orders_(count),
        norm_1_(orders_.size()),
        before_(orders_.size()),
        done_(orders_.size(), false),
        u_(static_cast<std::size_t>((count + kPackSize - 1) / kPackSize)),
        stress_(u_.size()) {
    for (std::size_t g = 0; g < u_.size(); ++g) {
      u_[g].emplace_back();
      stress_[g].emplace_back(elements);  // C : Q_1 = 0
    }
  }

  // B(row[k], load): the right-hand side of order p >= 2 from the orders before.
  void next_right_side(const std::vector<SeriesElement>& elements, SimdLevel simd, int p,
                       const std::vector<Index>& unknown, const std::vector<Index>& row,
                       MatrixXd& B) {
    for (std::size_t g = 0; g < u_.size(); ++g) {
      stress_[g].emplace_back(elements_);
      std::vector<Lanes> force(values_);
      run_at<NextOrder>(simd, elements, p, u_[g], stress_[g], force);
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Lanes& here = force[unknown[k]];
        for (Index lane = 0; lane < kPackSize; ++lane) {
          const Index c = static_cast<Index>(g) * kPackSize + lane;
          if (c < B.cols()) B(row[k], c) = here.of[lane];
        }
      }
    }
  }

  // Keeps order p, whose free values are in B. @returns whether all series have converged
  bool add_order(int p, const MatrixXd& B, const std::vector<Index>& unknown,
                 const std::vector<Index>& row, const VectorXd& mass, double tolerance) {
    bool all_done = true;
    for (auto& group : u_) group.emplace_back(values_);
    for (Index c = 0; c < B.cols(); ++c) {
      double square = 0.0;
      std::vector<Lanes>& lanes = u_[c / kPackSize].back();
      for (std::size_t k = 0; k < row.size(); ++k) {
        const double value = B(row[k], c);
        lanes[unknown[k]].of[c % kPackSize] = value;
        square += mass[unknown[k]] * value * value;
      }
      if (done_[c]) continue;
      const double norm = std::sqrt(square);
      if (p == 1) norm_1_[c] = norm;
      LoadOrders& orders = orders_[c];
      orders.radius =
          p == 1 || norm == 0.0 ? std::numeric_limits<double>::infinity() : before_[c] / norm;
      before_[c] = norm;
      orders.converged = done_[c] = norm <= tolerance * norm_1_[c];
      orders.u.resize(static_cast<Index>(values_), p);
      all_done = all_done && done_[c];
    }
    return all_done;
  }

  // Moves out the orders of each load, as many as it needed.
  std::vector<LoadOrders> result() {
    for (std::size_t c = 0; c < orders_.size(); ++c) {
      LoadOrders& orders = orders_[c];
      for (Index p = 1; p <= orders.u.cols(); ++p) {
        const std::vector<Lanes>& lanes = u_[c / kPackSize][p];
        for (std::size_t k = 0; k < values_; ++k) {
          orders.u(static_cast<Index>(k), p - 1) = lanes[k].of[c % kPackSize];
        }
      }
    }
    return std::move(orders_);
  }

 private:
  std::size_t values_, elements_;
  std::vector<LoadOrders> orders_;
  std::vector<double> norm_1_, before_;
  std::vector<bool> done_;
  // For each group of loads: u[p] (u[0] is not used) and stress[p - 1].
  std::vector<std::vector<std::vector<Lanes>>> u_;
  std::vector<std::vector<std::vector<Symmetric>>> stress_;
};

}  // namespace

std::vector<LoadOrders> LoadSeries::solve(const MatrixXd& loads,
                                          const SeriesSettings& settings) const {
  PALPABLE_EXPECT(loads.rows() == core_->values(), "a load has three values a node");
  PALPABLE_EXPECT(settings.most_orders >= 1 && settings.most_orders < NextOrder::kMostOrders,
                  "1 to 31 orders");
  constexpr Index kGroups = 2, kTogether = kGroups * kPackSize;
  const SimdLevel simd = best_simd_level();
  const std::vector<Index>&unknown = core_->unknown, &row = core_->row;
  std::vector<LoadOrders> all;
  for (Index first = 0; first < loads.cols(); first += kTogether) {
    const Index count = std::min(kTogether, loads.cols() - first);
    LoadsTogether series(count, static_cast<std::size_t>(core_->values()), core_->elements.size());
    MatrixXd B(core_->rows(), count);
    for (int p = 1; p <= settings.most_orders; ++p) {
      B.setZero();
      if (p == 1) {
        for (Index c = 0; c < count; ++c) {
          for (std::size_t k = 0; k < row.size(); ++k) B(row[k], c) = loads(unknown[k], first + c);
        }
      } else {
        series.next_right_side(core_->elements, simd, p, unknown, row, B);
      }
      core_->factor.solve(B, core_->workspace);
      if (series.add_order(p, B, unknown, row, core_->mass, settings.tolerance)) break;
    }
    for (LoadOrders& orders : series.result()) all.push_back(std::move(orders));
  }
  return all;
}

VectorXd pade_coefficients(const MatrixXd& gram, double a) {
  const Index n = gram.rows();
  VectorXd c = VectorXd::Zero(n);
  if (n == 1) {
    c[0] = a;
    return c;
  }
  // Scaled to unit diagonal, since the orders differ by many powers of ten.
  const VectorXd scale = gram.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd unit = scale.asDiagonal() * gram * scale.asDiagonal();
  const VectorXd b = -(unit.topLeftCorner(n - 1, n - 1).ldlt().solve(unit.col(n - 1).head(n - 1)));
  VectorXd d(n);  // d[j] of D
  d[0] = 1.0;
  for (Index j = 1; j < n; ++j) d[j] = b[n - 1 - j] * scale[n - 1 - j] / scale[n - 1];
  const auto D = [&](Index degree) {
    double sum = 0.0;
    for (Index j = degree; j >= 0; --j) sum = sum * a + d[j];
    return sum;
  };
  for (Index p = 1; p < n; ++p) {
    c[p - 1] = std::pow(a, static_cast<double>(p)) * D(n - 1 - p) / D(n - 1);
  }
  return c;
}

}  // namespace palpable
