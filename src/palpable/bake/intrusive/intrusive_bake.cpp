#include "palpable/bake/intrusive/intrusive_bake.h"

#include "palpable/bake/describe/material_warnings.h"
#include "palpable/bake/intrusive/reduced_energy.h"
#include "palpable/bake/intrusive/table_terms.h"
#include "palpable/bake/intrusive/two_load_checks.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/bake/solid/displacement_range.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/bake/solid/stress_together.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Stress is smooth in the load: a cubic through 0 and these fractions of it.
const Eigen::Vector3d kStressLevels(1.0 / 3.0, 2.0 / 3.0, 1.0);

// (3 x J) weights of the values at kStressLevels in the value at each level, by the cubic that is 0
// at 0.
MatrixXd cubic_through_thirds(const VectorXd& levels) {
  MatrixXd weights(3, levels.size());
  for (Index j = 0; j < levels.size(); ++j) {
    for (Index k = 0; k < 3; ++k) {
      double value = levels[j] / kStressLevels[k];
      for (Index other = 0; other < 3; ++other) {
        if (other == k) continue;
        value *= (levels[j] - kStressLevels[other]) / (kStressLevels[k] - kStressLevels[other]);
      }
      weights(k, j) = value;
    }
  }
  return weights;
}

// The stress of all positions at kStressLevels, at the vertices of the skin.
class StressStates {
 public:
  StressStates(const SolidModel& model, const Boundary& boundary, Index positions)
      : stress_(model, boundary.node_of_vertex),
        waiting_(3 * Index{model.mesh.node_count()}, StressTogether::kStates),
        values(6 * Index{boundary.surface.vertex_count()}, 3 * positions) {}

  void add(Index state, const VectorXd& u) {
    waiting_.col(static_cast<Index>(states_.size())) = u;
    states_.push_back(state);
    if (states_.size() == StressTogether::kStates) flush();
  }

  void flush() {
    if (states_.empty()) return;
    for (Index k = static_cast<Index>(states_.size()); k < waiting_.cols(); ++k) {
      waiting_.col(k).setZero();
    }
    const MatrixXd stress = stress_(waiting_);
    for (std::size_t k = 0; k < states_.size(); ++k) {
      const VectorXd one = stress.col(static_cast<Index>(k));
      largest_von_mises =
          std::max(largest_von_mises, von_mises(one.reshaped(6, one.size() / 6)).maxCoeff());
      values.col(states_[k]) = one.cast<float>();
    }
    states_.clear();
  }

 private:
  StressTogether stress_;
  MatrixXd waiting_;
  std::vector<Index> states_;

 public:
  Eigen::MatrixXf values;  // (6V x 3S), the three states of a position side by side
  double largest_von_mises = 0;
};

// The sum of the products as a field over "site" and "level". Each product has its own copy of its
// column of F, whose rows are those of the skin.
SeparatedField field_of(const MatrixXd& F, const TableTerms& terms, const VectorXd& levels) {
  const Index count = terms.site.cols(), S = terms.site.rows();
  Eigen::MatrixXf modes(F.rows(), count);
  for (Index t = 0; t < count; ++t) { modes.col(t) = F.col(terms.mode[t]).cast<float>(); }
  VectorXd samples(levels.size() + 1);
  samples << 0.0, levels;
  MatrixXd of_level = MatrixXd::Zero(samples.size(), count);
  of_level.bottomRows(levels.size()) = terms.level;
  return {std::move(modes),
          {{"site", VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1)), terms.site,
            Between::kNothing},
           {"level", std::move(samples), std::move(of_level), Between::kSmooth}}};
}

// (S x J) the remainder of the table of mode i after its terms.
MatrixXd remainder(const MatrixXd& table, const TableTerms& terms, std::size_t i) {
  MatrixXd left = table;
  for (std::size_t t = 0; t < terms.mode.size(); ++t) {
    if (terms.mode[t] != static_cast<int>(i)) continue;
    left -=
        terms.site.col(static_cast<Index>(t)) * terms.level.col(static_cast<Index>(t)).transpose();
  }
  return left;
}

// The rows that belong to the vertices of the skin.
MatrixXd skin_rows(const MatrixXd& values, const Boundary& boundary) {
  MatrixXd rows(3 * static_cast<Index>(boundary.node_of_vertex.size()), values.cols());
  for (std::size_t v = 0; v < boundary.node_of_vertex.size(); ++v) {
    rows.middleRows<3>(3 * static_cast<Index>(v)) =
        values.middleRows<3>(3 * Index{boundary.node_of_vertex[v]});
  }
  return rows;
}

SeparatedField displacement_field(const SeriesPgd& pgd, const SeriesTable& table,
                                  const Boundary& boundary, IntrusiveReport& report) {
  const Index S = table.positions(), J = table.levels.size(), m = pgd.F.cols();
  std::vector<MatrixXd> tables(m, MatrixXd(S, J));
  VectorXd own(S);
  for (Index s = 0; s < S; ++s) {
    const auto at = static_cast<std::size_t>(s);
    const MatrixXd G = pgd.G[at] * table.at_level[at];
    for (Index i = 0; i < m; ++i) tables[i].row(s) = G.row(i);
    own[s] = table.area[s] / table.gram[at](0, 0);
  }
  // The products may add a tenth of the squared error of the modes, in the same weight.
  const VectorXd by_level = table.levels.cwiseAbs2().cwiseInverse();
  const double whole = static_cast<double>(J) * table.area.sum();
  const double lost = pgd.errors[m - 1] * pgd.errors[m - 1] * whole;
  const TableTerms terms = table_terms(tables, own, by_level, 0.1 * lost);

  SeriesErrors& errors = report.displacement;
  errors.worst_of_position = VectorXd::Zero(S);
  MatrixXd squares = MatrixXd::Zero(S, J);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    squares += remainder(tables[i], terms, i).cwiseAbs2();
  }
  double sum = 0.0, all = 0.0;
  for (Index s = 0; s < S; ++s) {
    const auto at = static_cast<std::size_t>(s);
    const MatrixXd left = table.gram[at] - pgd.G[at].transpose() * pgd.G[at];
    for (Index j = 0; j < J; ++j) {
      const VectorXd c = table.at_level[at].col(j);
      const double norm = c.dot(table.gram[at] * c);
      const double square = std::max(0.0, c.dot(left * c)) + squares(s, j);
      sum += table.area[s] * square;
      all += table.area[s] * norm;
      errors.worst_of_position[s] = std::max(errors.worst_of_position[s], std::sqrt(square / norm));
    }
  }
  errors.global = std::sqrt(sum / all);
  errors.worst = errors.worst_of_position.maxCoeff();
  report.modes = static_cast<int>(m);
  report.columns = static_cast<int>(terms.mode.size());
  return field_of(skin_rows(pgd.F, boundary), terms, table.levels);
}

SeparatedField stress_field(const StressStates& states, const Boundary& boundary, int modes,
                            const VectorXd& levels, IntrusiveReport& report) {
  const Index S = states.values.cols() / 3, rows = states.values.rows();
  // The integral over the skin; shear components stand twice in the tensor.
  const VectorXd areas = vertex_areas(boundary.surface);
  VectorXd weights(rows);
  for (Index v = 0; v < areas.size(); ++v) {
    weights.segment<6>(6 * v) << areas[v] * Eigen::Vector<double, 6>(1, 1, 1, 2, 2, 2);
  }
  const auto square = [&](Index state) {
    return states.values.col(state).cast<double>().cwiseAbs2().dot(weights);
  };
  VectorXd norms(3 * S), scale(3 * S);  // each position's stress at full load counts as one
  for (Index k = 0; k < 3 * S; ++k) norms[k] = square(k);
  for (Index k = 0; k < 3 * S; ++k) scale[k] = 1.0 / std::sqrt(norms[3 * (k / 3) + 2]);
  SnapshotRows snapshots{.values = rows,
                         .sizes = {static_cast<int>(S), 3},
                         .read = [&](Index first, Index count) -> MatrixXd {
                           return states.values.middleRows(first, count).cast<double>() *
                                  scale.asDiagonal();
                         },
                         .read_first = {}};
  modes = static_cast<int>(std::min<Index>(modes, std::min(rows, 3 * S)));
  const RandomisedPod pod = randomised_pod(snapshots, weights, {.rank = modes});

  const MatrixXd to_levels = cubic_through_thirds(levels);
  std::vector<MatrixXd> tables;
  for (Index i = 0; i < pod.C.rows(); ++i) {
    const MatrixXd at_thirds =
        pod.C.row(i).cwiseQuotient(scale.transpose()).reshaped(3, S).transpose();
    tables.emplace_back(at_thirds * to_levels);
  }
  double lost = static_cast<double>(S);
  VectorXd left = norms;  // squares
  for (Index k = 0; k < 3 * S; ++k) {
    left[k] = std::max(0.0, left[k] - pod.C.col(k).squaredNorm() / (scale[k] * scale[k]));
    if (k % 3 == 2) lost -= pod.C.col(k).squaredNorm();
  }
  VectorXd own(S);
  for (Index s = 0; s < S; ++s) own[s] = 1.0 / norms[3 * s + 2];
  const TableTerms terms =
      table_terms(tables, own, VectorXd::Ones(levels.size()),
                  0.1 * std::max(0.0, lost) * static_cast<double>(levels.size()));
  // Adds the error of the products at the full load, the only third that is always one of the
  // levels.
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const MatrixXd gone = remainder(tables[i], terms, i);
    for (Index s = 0; s < S; ++s) left[3 * s + 2] += std::pow(gone(s, levels.size() - 1), 2);
  }
  report.stress_pooled = std::sqrt(left.sum() / norms.sum());
  report.stress_worst = std::sqrt(left.cwiseQuotient(norms).maxCoeff());
  report.stress_modes = static_cast<int>(pod.C.rows());
  report.stress_columns = static_cast<int>(terms.mode.size());
  return field_of(pod.Q, terms, levels);
}

// Modes for the energy under several loads, from at most some hundred loads of each kind:
// neighbouring loads have similar responses.
MatrixXd modes_of_several(const LoadSeries& series, const TravellingLoad& travelling) {
  constexpr Index kLinear = 24, kCurved = 4, kEnough = 300;
  std::vector<Eigen::Triplet<double>> entries;
  int column = 0;
  for (const auto* loads : {&travelling.load, &travelling.reaction}) {
    const Index step = std::max<Index>(1, loads->cols() / kEnough);
    for (Index s = 0; s < loads->cols(); s += step, ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(*loads, s); entry; ++entry) {
        entries.emplace_back(static_cast<int>(entry.row()), column, entry.value());
      }
    }
  }
  Eigen::SparseMatrix<double> some(travelling.load.rows(), column);
  some.setFromTriplets(entries.begin(), entries.end());
  const auto linear = static_cast<int>(std::min<Index>(kLinear, column));
  return energy_modes(series, some, linear, std::min<int>(kCurved, linear));
}

// Computes the error of the body under pairs of loads, and states it in the body and the report.
void state_error_of_several(IntrusiveBake& made, const IntrusiveSettings& settings,
                            const Progress& progress) {
  SeveralLoads& several = *made.body.several;
  const double begin = process_cpu_seconds();
  std::string line = fmt::format("energy in {} modes", several.mode_count());
  try {
    made.two_loads = two_load_checks(made, settings.checks, settings.seed, progress);
    std::vector<double> errors;
    for (const TwoLoadCheck& check : made.two_loads) errors.push_back(check.error);
    if (!errors.empty()) {
      several.checked = static_cast<int>(errors.size());
      several.error_worst = *std::max_element(errors.begin(), errors.end());
      several.error_median = upper_median(errors);
    }
    line += fmt::format(
        "; a press and one of {} reactions together, {} pairs solved "
        "afresh: relative L2 error over the volume {:.3g} at the median, {:.3g} at the "
        "worst",
        several.reactions.size(), several.checked, several.error_median, several.error_worst);
  } catch (const Error& problem) {  // the body itself is none the worse for it
    line += fmt::format(" and {} reactions; its error is not known: {}", several.reactions.size(),
                        problem.what());
  }
  made.report.cpu.add("references", 1e3 * (process_cpu_seconds() - begin));
  made.report.provenance.several_loads = made.body.provenance.several_loads = line;
}

// Measures the CPU time of successive stages.
class Laps {
 public:
  explicit Laps(StageTimes& times) : times_(times) {}
  void end(const char* stage) {
    const double now = process_cpu_seconds();
    times_.add(stage, 1e3 * (now - begin_));
    begin_ = now;
  }
  // Excludes time since the last end() from the next stage: it belongs to "references".
  void leave_out(double seconds) { begin_ += seconds; }

 private:
  StageTimes& times_;
  double begin_ = process_cpu_seconds();
};

// Finds a fifth more modes than wanted, in own norms, and recompresses them to that number.
SeriesPgd separate_series(const LoadSeries& series, const SeriesTable& table, int modes,
                          IntrusiveReport& report, const Progress& progress) {
  const Index S = table.positions();
  const SeriesPgdGoal goal{.weight = SeriesWeight::kOwnNorm,
                           .modes = static_cast<int>(std::min<Index>(modes + modes / 5 + 2, S))};
  const SeriesPgd greedy = series_pgd(series, table, goal, progress);
  report.greedy_modes = static_cast<int>(greedy.F.cols());
  report.alternations = greedy.alternations;
  return recompressed(greedy, table, goal, std::min(modes, static_cast<int>(greedy.F.cols())));
}

// Refuses a load that leaves the range of the model. @param u  (3 x N) m, at the full load
void refuse_far_travel(const BodyDescription& description, const BodyProblem& problem,
                       Index position, const Eigen::Matrix3Xd& u) {
  const BodyDescription::Intrusive& wanted = *description.intrusive;
  const SolidModel& model = problem.model;
  const double farthest = largest_movement(held_components(model), u);
  if (farthest <= model.largest_displacement) return;
  throw Error(fmt::format(
      "{}: 'force' = {:.4g} N moves the body by {:.4g} mm at {}: {}. Young's modulus is {}",
      wanted.place, wanted.force, 1e3 * farthest, site_text(problem, static_cast<int>(position)),
      beyond_range_text(model.largest_displacement), young_words(description)));
}

// (J + 1 x S) the displacement conjugate to the force at each load size: f . u / |f|.
MatrixXd press_depths(const SeriesTable& table, double force) {
  const Index S = table.positions(), J = table.levels.size();
  MatrixXd depth = MatrixXd::Zero(J + 1, S);
  for (Index s = 0; s < S; ++s) {
    const auto at = static_cast<std::size_t>(s);
    depth.col(s).tail(J) = table.at_level[at].transpose() * table.work[at] / force;
  }
  return depth;
}

// How the body was made, and its errors.
Provenance provenance_of(const BodyDescription::Intrusive& wanted, const TravellingLoad& travelling,
                         const SeriesTable& table, const IntrusiveReport& made) {
  const Index S = travelling.load.cols();
  return {
      .loads = fmt::format(
          "{} positions of a travelling dead load of up to {:.4g} N ({} nearer than "
          "{:.3g} patch radii of {:.3g} m to what is held are left out)",
          S, wanted.force, travelling.left_out, wanted.clearance, travelling.patch_radius),
      .series =
          fmt::format("power series in the size of the load, {} orders at most, {:.1f} in the "
                      "mean; forces balance the full load to {:.2g} of it at the worst "
                      "position; Pade form and series differ by {:.2g} at most",
                      table.most_orders, static_cast<double>(table.orders) / static_cast<double>(S),
                      table.worst_residual.tail(1)[0], table.worst_pade_gap),
      .reduction =
          fmt::format("intrusive PGD over positions and load sizes, in own norms: {} modes "
                      "by {} alternations, recompressed to {}",
                      made.greedy_modes, made.alternations, made.modes),
      .displacement =
          fmt::format("{} modes in {} products, relative L2 error over the volume {:.3g} "
                      "pooled, {:.3g} at the worst position and load in its own norm",
                      made.modes, made.columns, made.displacement.global, made.displacement.worst),
      .stress = fmt::format(
          "nodal Cauchy stress of the skin at thirds of the load: {} modes by "
          "randomised POD in {} products, relative L2 error {:.3g} pooled, {:.3g} "
          "at the worst position and load in its own norm",
          made.stress_modes, made.stress_columns, made.stress_pooled, made.stress_worst),
  };
}

}  // namespace

IntrusiveBake bake_intrusive(const BodyDescription& description, const IntrusiveSettings& settings,
                             const Progress& progress) {
  IntrusiveReport made;
  Laps laps(made.cpu);
  TravellingLoad travelling = travelling_load(description);
  const BodyProblem& problem = travelling.problem;
  const Boundary& boundary = problem.mesh.boundary;
  const BodyDescription::Intrusive& wanted = *description.intrusive;
  LoadSeries series(problem.model);
  laps.end("pose");

  const auto J = static_cast<Index>(wanted.levels);
  const VectorXd levels = VectorXd::LinSpaced(J, 1.0 / static_cast<double>(J), 1.0);
  const Index S = travelling.load.cols();
  StressStates states(series.model(), boundary, S);
  SeriesTable table = solve_series(
      series, travelling.load, travelling.area, levels, kStressLevels,
      [&](Index s, const MatrixXd& fields) {
        refuse_far_travel(description, problem, s, fields.col(2).reshaped(3, fields.rows() / 3));
        for (Index k = 0; k < 3; ++k) states.add(3 * s + k, fields.col(k));
      },
      progress, settings.all_residuals ? ResidualsAt::kAllLevels : ResidualsAt::kFullLoad);
  states.flush();
  laps.leave_out(table.check_cpu_s);
  laps.end("series");
  if (table.check_cpu_s > 0.0) made.cpu.add("references", 1e3 * table.check_cpu_s);

  const int modes = static_cast<int>(std::min<Index>(wanted.modes, S));
  SeriesPgd pgd = separate_series(series, table, modes, made, progress);
  SeparatedField u = displacement_field(pgd, table, boundary, made);
  SeparatedField sigma = stress_field(states, boundary, wanted.stress_modes, levels, made);
  laps.end("separate");

  MatrixXd modes_of_energy;
  std::optional<SeveralLoads> several;
  if (!travelling.reaction_sites.empty()) {
    report(progress, {"energy of several loads", 0.0, 1.0, ""});
    modes_of_energy = modes_of_several(series, travelling);
    several =
        SeveralLoads{quartic_energy(series.model(), modes_of_energy),
                     skin_rows(modes_of_energy, boundary).cast<float>(), travelling.reaction_sites};
    report(progress, {"energy of several loads", 1.0, 1.0, ""});
    laps.end("several loads");
  }

  made.provenance = provenance_of(wanted, travelling, table, made);
  ReducedBody body{.name = description.name,
                   .surface = boundary.surface,
                   .fixed = fixed_vertices(problem.mesh),
                   .sites = problem.sites,
                   .displacement = std::move(u),
                   .stress = std::move(sigma),
                   .press_depth = press_depths(table, wanted.force),
                   .largest_von_mises = states.largest_von_mises,
                   .error = {made.displacement.global, made.displacement.worst, made.stress_pooled,
                             made.stress_worst},
                   .material = material_line(description.material),
                   .provenance = made.provenance,
                   .method = "intrusive",
                   .several = std::move(several)};
  body.provenance.description = description.source.string();
  body.provenance.mesh_source = problem.mesh.origin;
  body.provenance.credit = description.shape.credit;
  body.provenance.credit_url = description.shape.credit_url;
  body.provenance.terms = description.shape.terms;
  body.provenance.material = body.material;
  body.provenance.program = settings.version;
  body.provenance.command_line = settings.command_line;
  IntrusiveBake result{
      std::move(travelling), std::move(series), std::move(table),           std::move(pgd),
      std::move(body),       std::move(made),   std::move(modes_of_energy), {}};
  if (result.body.several) state_error_of_several(result, settings, progress);
  return result;
}

}  // namespace palpable
