#include "palpable/bake/separate/sparse_pgd.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index basis_size(const SparseAxis& axis) {
  return axis.basis == SparseAxis::Basis::kNodal ? axis.choices : axis.highest_degree + 1;
}

// How many of an axis's basis functions a mode of this degree may use.
Index used(const SparseAxis& axis, int degree) {
  return axis.basis == SparseAxis::Basis::kNodal ? axis.choices
                                                 : std::min<Index>(degree + 1, basis_size(axis));
}

VectorXd solve_with_ridge(MatrixXd normal, const VectorXd& right, double ridge) {
  const double mean = normal.trace() / static_cast<double>(normal.rows());
  normal.diagonal().array() += std::max(ridge * mean, 1e-300);
  return normal.ldlt().solve(right);
}

// The basis functions of all axes at all samples: (b_j x T) each.
using Tables = std::vector<MatrixXd>;

Tables columns_of(const Tables& tables, const std::vector<Index>& samples) {
  Tables some;
  for (const MatrixXd& table : tables) some.emplace_back(table(Eigen::all, samples));
  return some;
}

struct Mode {
  VectorXd F;
  std::vector<VectorXd> a;  // (p) of (b_j), zero beyond the mode's degree
};

// (T) the product of the mode's functions at the samples, without that of axis `skip`.
VectorXd products_of(const Mode& mode, const Tables& tables, Index skip = -1) {
  VectorXd product = VectorXd::Ones(tables[0].cols());
  for (std::size_t j = 0; j < tables.size(); ++j) {
    if (static_cast<Index>(j) == skip) continue;
    product.array() *= (tables[j].transpose() * mode.a[j]).array();
  }
  return product;
}

// Fits one mode to the residual R (N x T) by alternating directions. @param starts  (p) of (b_j)
// coefficients to begin with. @param sizes  (p) how many basis functions of each axis may be used
Mode fit_mode(const MatrixXd& R, const Tables& tables, const std::vector<VectorXd>& starts,
              const std::vector<Index>& sizes, const SparseSettings& settings) {
  const std::size_t p = tables.size();
  Index largest = 0;
  R.colwise().squaredNorm().maxCoeff(&largest);
  Mode mode{R.col(largest).normalized(), starts};
  double size = 0;
  for (int pass = 0; pass < settings.max_passes; ++pass) {
    const VectorXd t = R.transpose() * mode.F;  // (T) the residual's component along F
    for (std::size_t j = 0; j < p; ++j) {
      const VectorXd w = products_of(mode, tables, static_cast<Index>(j));
      const MatrixXd rows = tables[j].topRows(sizes[j]) * w.asDiagonal();
      VectorXd a = solve_with_ridge(rows * rows.transpose(), rows * t, settings.ridge);
      const double length = (tables[j].topRows(sizes[j]).transpose() * a).norm();
      if (!(length > 0.0)) return {VectorXd::Zero(R.rows()), mode.a};
      mode.a[j].setZero();
      mode.a[j].head(sizes[j]) = a / length;
    }
    const VectorXd g = products_of(mode, tables);
    const VectorXd F = R * g / std::max(g.squaredNorm(), 1e-300);
    const double new_size = F.norm() * g.norm();
    mode.F = F.normalized();
    const bool settled = std::abs(new_size - size) <= 1e-4 * new_size;
    size = new_size;
    if (settled || size == 0.0) {
      mode.F = F;
      return mode;
    }
    if (pass + 1 == settings.max_passes) mode.F = F;
  }
  return mode;
}

// A model to which modes are added one by one.
class Growing {
 public:
  Growing(const MatrixXd& values, Tables tables, const SparseSettings& settings)
      : values_(values), tables_(std::move(tables)), settings_(settings), left_(values) {
    for (const MatrixXd& table : tables_) coefficients_.emplace_back(table.rows(), 0);
    F_.resize(values.rows(), 0);
  }

  void add(const Mode& mode, const std::vector<Index>& sizes) {
    const Index m = F_.cols();
    F_.conservativeResize(Eigen::NoChange, m + 1);
    F_.col(m) = mode.F;
    for (std::size_t j = 0; j < tables_.size(); ++j) {
      coefficients_[j].conservativeResize(Eigen::NoChange, m + 1);
      coefficients_[j].col(m) = mode.a[j];
    }
    sizes_.push_back(sizes);
    for (std::size_t j = 0; j < tables_.size(); ++j) update_axis(j);
    update_space();
  }

  // (T' x m) products of the modes' functions at T' samples, whose basis functions are given.
  [[nodiscard]] MatrixXd functions(const Tables& tables, Index skip = -1) const {
    MatrixXd G = MatrixXd::Ones(tables[0].cols(), F_.cols());
    for (std::size_t j = 0; j < tables.size(); ++j) {
      if (static_cast<Index>(j) == skip) continue;
      G.array() *= (tables[j].transpose() * coefficients_[j]).array();
    }
    return G;
  }

  [[nodiscard]] const MatrixXd& left() const { return left_; }
  [[nodiscard]] const MatrixXd& F() const { return F_; }
  [[nodiscard]] const std::vector<MatrixXd>& coefficients() const { return coefficients_; }

 private:
  // Fits the coefficients of all modes on one axis together, those that each mode may use.
  void update_axis(std::size_t j) {
    const Index m = F_.cols(), T = values_.cols();
    const MatrixXd W = functions(tables_, static_cast<Index>(j));  // (T x m)
    const MatrixXd gram = F_.transpose() * F_;
    const MatrixXd t = transposed_times(F_, values_);  // (m x T)
    std::vector<std::pair<Index, Index>> unknowns;     // mode, basis function
    for (Index i = 0; i < m; ++i) {
      for (Index b = 0; b < sizes_[i][j]; ++b) unknowns.emplace_back(i, b);
    }
    const auto n = static_cast<Index>(unknowns.size());
    MatrixXd rows(n, T);
    VectorXd right(n);
    for (Index k = 0; k < n; ++k) {
      const auto [i, b] = unknowns[k];
      rows.row(k) = W.col(i).transpose().cwiseProduct(tables_[j].row(b));
      right[k] = rows.row(k).dot(t.row(i));
    }
    MatrixXd normal = times(rows, rows.transpose());
    for (Index k = 0; k < n; ++k) {
      for (Index l = 0; l < n; ++l) { normal(k, l) *= gram(unknowns[k].first, unknowns[l].first); }
    }
    const VectorXd a = solve_with_ridge(std::move(normal), right, settings_.ridge);
    coefficients_[j].setZero();
    for (Index k = 0; k < n; ++k) {
      const auto [i, b] = unknowns[k];
      coefficients_[j](b, i) = a[k];
    }
  }

  void update_space() {
    const MatrixXd G = functions(tables_);  // (T x m)
    // The functions are scaled to unit length first: the ridge is to act on all of them alike.
    const VectorXd lengths = G.colwise().norm().cwiseMax(1e-300);
    const MatrixXd unit = G * lengths.cwiseInverse().asDiagonal();
    MatrixXd normal = unit.transpose() * unit;
    normal.diagonal().array() += settings_.ridge;
    F_ = normal.ldlt().solve(times(values_, unit).transpose()).transpose() *
         lengths.cwiseInverse().asDiagonal();
    left_ = values_;
    subtract_product(F_, G, left_);
  }

  const MatrixXd& values_;
  Tables tables_;
  const SparseSettings& settings_;
  MatrixXd left_, F_;
  std::vector<MatrixXd> coefficients_;
  std::vector<std::vector<Index>> sizes_;
};

// Moves samples from `left_out` to `training` until each choice among the left-out samples also
// occurs among the training samples. A model cannot predict a choice that was not in its training
// samples, and the error of such samples would hide what further modes gain.
void train_on_every_choice(const std::vector<SparseAxis>& axes, const Tables& tables,
                           std::vector<Index>& training, std::vector<Index>& left_out) {
  for (std::size_t j = 0; j < axes.size(); ++j) {
    if (axes[j].basis != SparseAxis::Basis::kNodal) continue;
    VectorXd times_trained = tables[j](Eigen::all, training).rowwise().sum();
    std::vector<Index> left;
    for (const Index k : left_out) {
      const bool known = times_trained.dot(tables[j].col(k)) > 0.0;
      if (!known) times_trained += tables[j].col(k);
      (known ? left : training).push_back(k);
    }
    left_out = std::move(left);
  }
}

// The samples that a model is trained on, and the left-out ones that it is tested on.
struct Fold {
  MatrixXd training_values, left_out_values;
  Tables training, left_out;
};

// The folds that have left-out samples.
std::vector<Fold> make_folds(const MatrixXd& values, const Tables& tables,
                             const std::vector<SparseAxis>& axes, const SparseSettings& settings) {
  const Index T = values.cols();
  std::vector<Index> order(T);
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(settings.seed);
  for (Index k = T - 1; k > 0; --k) {
    std::swap(order[k], order[random() % static_cast<std::uint64_t>(k + 1)]);
  }
  std::vector<Fold> folds;
  for (int f = 0; f < settings.folds; ++f) {
    std::vector<Index> training, left_out;
    for (Index k = 0; k < T; ++k) {
      (k % settings.folds == f ? left_out : training).push_back(order[k]);
    }
    train_on_every_choice(axes, tables, training, left_out);
    if (left_out.empty()) continue;
    folds.push_back({values(Eigen::all, training), values(Eigen::all, left_out),
                     columns_of(tables, training), columns_of(tables, left_out)});
  }
  return folds;
}

}  // namespace

VectorXd basis_functions(const SparseAxis& axis, double mu) {
  VectorXd phi(basis_size(axis));
  if (axis.basis == SparseAxis::Basis::kNodal) {
    const auto choice = static_cast<Index>(mu);
    PALPABLE_EXPECT(static_cast<double>(choice) == mu && 0 <= choice && choice < axis.choices,
                    "a choice among those of the axis");
    return VectorXd::Unit(axis.choices, choice);
  }
  PALPABLE_EXPECT(axis.low < axis.high && axis.highest_degree >= 1, "a range and a degree");
  // (n + 1) P_{n+1} = (2 n + 1) x P_n - n P_{n-1}
  const double x = 2.0 * (mu - axis.low) / (axis.high - axis.low) - 1.0;
  phi[0] = 1.0;
  if (phi.size() > 1) phi[1] = x;
  for (Index n = 1; n + 1 < phi.size(); ++n) {
    const auto k = static_cast<double>(n);
    phi[n + 1] = ((2.0 * k + 1.0) * x * phi[n] - k * phi[n - 1]) / (k + 1.0);
  }
  if (axis.zero_at_low) phi *= 0.5 * (x + 1.0);
  return phi;
}

VectorXd SparsePgd::functions_of(Index j, double mu_j) const {
  PALPABLE_EXPECT(0 <= j && j < static_cast<Index>(axes.size()), "an axis of the model");
  return coefficients[j].transpose() * basis_functions(axes[j], mu_j);
}

VectorXd SparsePgd::functions(const VectorXd& mu) const {
  PALPABLE_EXPECT(mu.size() == static_cast<Index>(axes.size()), "a value for each parameter");
  VectorXd product = VectorXd::Ones(F.cols());
  for (Index j = 0; j < mu.size(); ++j) product.array() *= functions_of(j, mu[j]).array();
  return product;
}

namespace {

// One growing model for each fold, trained without the fold's own samples. Its error on those
// samples decides which degrees are used and when to stop.
class CrossValidation {
 public:
  CrossValidation(const MatrixXd& values, const Tables& tables, const std::vector<SparseAxis>& axes,
                  const SparseSettings& settings)
      : axes_(axes), settings_(settings), folds_(make_folds(values, tables, axes, settings)) {
    if (folds_.empty()) {
      throw Error("no sample can be left out to be predicted: each has a choice of its own");
    }
    for (const Fold& fold : folds_) left_out_squared_ += fold.left_out_values.squaredNorm();
    for (const SparseAxis& axis : axes) {
      starts_.emplace_back(axis.basis == SparseAxis::Basis::kNodal
                               ? VectorXd::Ones(basis_size(axis))
                               : VectorXd(VectorXd::Unit(basis_size(axis), 0)));
    }
    models_.reserve(folds_.size());
    for (const Fold& fold : folds_)
      models_.emplace_back(fold.training_values, fold.training, settings);
  }

  // Coefficients to begin with: the lowest polynomial of each axis; for choices, all values equal.
  [[nodiscard]] const std::vector<VectorXd>& starts() const { return starts_; }

  [[nodiscard]] std::vector<Index> sizes_of(const std::vector<int>& degrees) const {
    std::vector<Index> sizes;
    for (std::size_t j = 0; j < axes_.size(); ++j) sizes.push_back(used(axes_[j], degrees[j]));
    return sizes;
  }

  // Raises the degrees, one at a time, while a further mode of the raised degrees lowers the error
  // on the left-out samples.
  [[nodiscard]] std::vector<int> raised(std::vector<int> degrees) const {
    std::vector<MatrixXd> residuals_now;
    for (std::size_t f = 0; f < folds_.size(); ++f) residuals_now.push_back(left_out_residual(f));
    double best = predicted(degrees, residuals_now);
    for (bool raised = true; raised;) {
      raised = false;
      std::vector<int> best_degrees = degrees;
      for (std::size_t j = 0; j < axes_.size(); ++j) {
        if (axes_[j].basis == SparseAxis::Basis::kNodal) continue;
        std::vector<int> candidate = degrees;
        if (++candidate[j] > axes_[j].highest_degree) continue;
        const double lost = predicted(candidate, residuals_now);
        if (lost < (1.0 - settings_.least_gain) * best) {
          best = lost;
          best_degrees = candidate;
          raised = true;
        }
      }
      degrees = best_degrees;
    }
    return degrees;
  }

  // Adds a mode to each fold's model. @returns relative error over all left-out samples
  double add_mode(const std::vector<Index>& sizes) {
    for (std::size_t f = 0; f < folds_.size(); ++f) {
      models_[f].add(fit_mode(models_[f].left(), folds_[f].training, starts_, sizes, settings_),
                     sizes);
    }
    double lost = 0;
    for (std::size_t f = 0; f < folds_.size(); ++f) lost += left_out_residual(f).squaredNorm();
    return left_out_squared_ > 0.0 ? std::sqrt(lost / left_out_squared_) : 0.0;
  }

 private:
  // Residual of fold f's model on the samples left out for it.
  [[nodiscard]] MatrixXd left_out_residual(std::size_t f) const {
    MatrixXd left = folds_[f].left_out_values;
    subtract_product(models_[f].F(), models_[f].functions(folds_[f].left_out), left);
    return left;
  }

  // Squared norm of the residual on the left-out samples if a mode of these degrees is added to
  // each fold's model.
  [[nodiscard]] double predicted(const std::vector<int>& degrees,
                                 const std::vector<MatrixXd>& residuals_now) const {
    const std::vector<Index> sizes = sizes_of(degrees);
    double lost = 0;
    for (std::size_t f = 0; f < folds_.size(); ++f) {
      const Mode mode = fit_mode(models_[f].left(), folds_[f].training, starts_, sizes, settings_);
      lost += (residuals_now[f] - mode.F * products_of(mode, folds_[f].left_out).transpose())
                  .squaredNorm();
    }
    return lost;
  }

  const std::vector<SparseAxis>& axes_;
  const SparseSettings& settings_;
  std::vector<Fold> folds_;
  double left_out_squared_ = 0;  // squared norm of the left-out samples of all folds
  std::vector<VectorXd> starts_;
  std::vector<Growing> models_;
};

// The basis functions of each axis at the samples.
Tables tables_of(const std::vector<SparseAxis>& axes, const MatrixXd& points) {
  Tables tables;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    MatrixXd table(basis_size(axes[j]), points.cols());
    for (Index t = 0; t < points.cols(); ++t) {
      table.col(t) = basis_functions(axes[j], points(static_cast<Index>(j), t));
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace

SparsePgd sparse_pgd(const MatrixXd& values, const MatrixXd& points, std::vector<SparseAxis> axes,
                     const SparseSettings& settings, const Progress& progress) {
  const auto p = static_cast<Index>(axes.size());
  const Index T = values.cols();
  PALPABLE_EXPECT(p >= 1 && points.rows() == p && points.cols() == T, "a point for each sample");
  PALPABLE_EXPECT(settings.max_modes >= 1 && settings.max_passes >= 1, "at least one of each");
  PALPABLE_EXPECT(settings.folds >= 2 && T >= settings.folds, "samples for each fold");
  if (!values.allFinite()) throw Error("a sample holds values that are not numbers");
  const double whole = values.norm();
  if (!(whole > 0.0)) throw Error("all samples are zero: there is nothing to reduce");

  SparsePgd result{std::move(axes), {}, {}, {}, {}, {}};
  const Tables tables = tables_of(result.axes, points);
  CrossValidation folds(values, tables, result.axes, settings);
  Growing model(values, tables, settings);
  std::vector<int> degrees(result.axes.size(), 1);
  std::vector<double> training, validation;
  double before = 1.0;
  while (static_cast<int>(training.size()) < settings.max_modes) {
    degrees = folds.raised(std::move(degrees));
    const std::vector<Index> sizes = folds.sizes_of(degrees);
    const double now = folds.add_mode(sizes);
    if (!training.empty() && now > (1.0 - settings.least_gain) * before) break;
    before = now;
    model.add(fit_mode(model.left(), tables, folds.starts(), sizes, settings), sizes);
    result.degrees.push_back(degrees);
    training.push_back(model.left().norm() / whole);
    validation.push_back(now);
    report(progress, {"sparse PGD", static_cast<double>(training.size()),
                      static_cast<double>(settings.max_modes),
                      fmt::format("{} modes, cross-validated error {:.2g}", training.size(), now)});
  }
  result.F = model.F();
  result.coefficients = model.coefficients();
  const auto m = static_cast<Index>(training.size());
  result.training_errors = Eigen::Map<const VectorXd>(training.data(), m);
  result.validation_errors = Eigen::Map<const VectorXd>(validation.data(), m);
  return result;
}

}  // namespace palpable
