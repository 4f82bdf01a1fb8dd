#include "palpable/bake/pipeline/bake_counts.h"

#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/intrusive/travelling_load.h"
#include "palpable/bake/pipeline/bake_touch.h"
#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/solid/load_response.h"
#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/bake/touch_bake/shell_maker.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/symmetric_form.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <sys/resource.h>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using WantedTables = BodyDescription::Touch::Tables;

constexpr int kEnergyModes = 24 + 10;  // linear and curved ones of intrusive_bake.cpp

// CPU seconds of this process and of children that have ended: TetGen runs in one.
double cpu_seconds_with_children() {
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return process_cpu_seconds() + seconds(children.ru_utime) + seconds(children.ru_stime);
}

// CPU seconds of one of the `count` steps that `work` does: the median of several runs, since other
// programs slow some of them down.
template <class Work>
double cost_of(int count, const Work& work) {
  constexpr double kLongEnough = 0.15;  // s
  constexpr std::size_t kFewest = 3;
  std::vector<double> runs;
  double all = 0;
  while (runs.size() < kFewest || all < kLongEnough) {
    const double begin = thread_cpu_seconds();
    work();
    runs.push_back(thread_cpu_seconds() - begin);
    all += runs.back();
  }
  return upper_median(runs) / count;
}

double cost_of_flop() {
  constexpr Index kSize = 384;
  const MatrixXd A = MatrixXd::Constant(kSize, kSize, 0.5);
  double sum = 0;
  const double product = cost_of(1, [&] { sum += times(A, A)(0, 0); });
  return (sum > 0 ? product : 0) / (2.0 * kSize * kSize * kSize);
}

// @param factor  CPU seconds that making `body` took
MeshCosts costs_on(const LoadResponse& body, double factor) {
  constexpr Index kTogether = 48;
  MatrixXd loads(body.free_mask().size(), kTogether);
  for (Index k = 0; k < kTogether; ++k) {
    for (Index i = 0; i < loads.rows(); ++i)
      loads(i, k) = (i + k) % 7 == 0 ? body.free_mask()[i] : 0;
  }
  MatrixXd u;
  MeshCosts costs{.factor = factor};
  costs.solve = cost_of(kTogether, [&] { u = body.linear(loads); });
  Eigen::VectorXd small = 1e-6 / std::max(1e-300, u.col(0).cwiseAbs().maxCoeff()) * u.col(0);
  costs.pass = cost_of(1, [&] { small = 1e-6 * (small + body.second_force(small)); });
  return costs;
}

MeshCounts counts_of(const BodyProblem& problem) {
  const TetMesh& mesh = problem.model.mesh;
  FactorWorkspace workspace;
  const TetAssembly assembly(problem.model);
  return {.nodes = mesh.node_count(),
          .tets = mesh.tet_count(),
          .points = mesh.tet_count() * (mesh.is_quadratic() ? 4 : 1),
          .vertices = problem.mesh.boundary.surface.vertex_count(),
          .volume = problem.mesh.quality.volume,
          .area = vertex_areas(problem.mesh.boundary.surface).sum(),
          .factor_numbers = CholeskyAnalysis(assembly.pattern(), workspace).nonzeros()};
}

// Bytes of rows of 16-bit numbers with a factor each (RoundedRows).
double bytes_of_rows(double rows, double width) { return rows * (2 * width + sizeof(float)); }

double bytes_of_form(int variables, int degree) {
  return 2.0 * static_cast<double>(distinct_coefficients(variables, degree)) +
         static_cast<double>(sizeof(float)) * static_cast<double>(runs_of(variables, degree));
}

// Bytes of all regions, as bytes_of(TouchTables) counts them.
double bytes_of_regions(const SkinResponse& skin, const Compliance& compliance,
                        const std::vector<int>& middles, const RegionSettings& settings) {
  double bytes = 0;
  for (const int middle : middles) {
    const std::vector<int> nodes = region_nodes(skin, compliance, middle, settings);
    std::vector<char> own(static_cast<std::size_t>(compliance.clusters()), 0);
    for (const int n : nodes) own[static_cast<std::size_t>(compliance.cluster_of(n))] = 1;
    const auto far = static_cast<double>(std::count(own.begin(), own.end(), 0));
    const auto count = static_cast<double>(nodes.size());
    bytes += static_cast<double>(sizeof(int)) * count + bytes_of_rows(3 * count, settings.modes) +
             bytes_of_rows(far * static_cast<double>(compliance.rank()), settings.far_shapes) +
             bytes_of_rows(settings.far_shapes, settings.modes) + bytes_of_form(settings.modes, 3) +
             bytes_of_form(settings.leading, 4);
  }
  return bytes;
}

TouchCounts touch_counts(const BodyDescription& description, const MeshCounts& mesh, bool carries,
                         const SkinResponse& skin) {
  const BodyDescription::Touch& wanted = description.touch;
  TouchBakeSettings settings = touch_settings(description, 1);
  if (wanted.tables == WantedTables::kLinear) settings.regions.most = settings.cross.modes = 0;
  TouchTables tables;
  tables.shell = make_shell(skin);
  tables.compliance = compliance_without_numbers(skin, settings.compliance);
  if (carries) tables.coarse = {skin.skin(), skin.fixed()};
  const std::vector<int> middles =
      spread_vertices(skin, settings.regions.spacing, settings.regions.most);
  TouchCounts counts{.mesh = mesh,
                     .shell = skin.shell_count(),
                     .held = static_cast<int>(
                         std::count(skin.fixed().begin(), skin.fixed().end(), std::uint8_t{1})),
                     .regions = static_cast<int>(middles.size()),
                     .cross_modes = settings.cross.modes,
                     .held_out = wanted.held_out,
                     .vibration_modes = settings.inertia ? settings.inertia->modes : 0};
  counts.table_bytes =
      static_cast<double>(bytes_of(tables)) +
      bytes_of_regions(skin, Compliance(tables.compliance), middles, settings.regions);
  counts.table_bytes += 3.0 * sizeof(float) * counts.vibration_modes * counts.shell;
  if (settings.cross.modes > 0) {
    counts.table_bytes += bytes_of_rows(3.0 * counts.shell, settings.cross.modes) +
                          bytes_of_form(settings.cross.modes, 3);
  }
  return counts;
}

// The coarser mesh of the tables, if they need one. Sets `none` where there will be no tables,
// since it cannot be made and they were not asked for: as bake_touch() does.
std::optional<BodyProblem> coarser(const BodyDescription& description, const BodyProblem& problem,
                                   bool& none) {
  const BodyDescription::Touch& wanted = description.touch;
  const SurfaceMesh& skin = problem.mesh.boundary.surface;
  try {
    if (const auto edge = touch_edge(description, skin)) {
      return pose_coarser(description, skin, *edge);
    }
  } catch (const Error&) {
    if (!wanted.by_default || wanted.edge) throw;
    none = true;
  }
  return std::nullopt;
}

// Measures the costs on each mesh, and finds what the tables of touch will be.
void count_solids(const BodyDescription& description, const BodyProblem& problem,
                  const Progress& progress, CountedBake& counted) {
  bool none = description.touch.tables == WantedTables::kNone ||
              counted.counts.intrusive.has_value() || counted.counts.shards > 1;
  double begin = cpu_seconds_with_children();
  std::optional<BodyProblem> coarse;
  if (!none) coarse = coarser(description, problem, none);
  counted.costs.mesh += cpu_seconds_with_children() - begin;

  report(progress, {"measuring this machine", 0.0, 1.0, ""});
  counted.costs.flop = cost_of_flop();
  begin = thread_cpu_seconds();
  if (none || coarse) {
    const SkinResponse skin(problem.model, problem.mesh.boundary);
    counted.costs.body = costs_on(skin.body(), thread_cpu_seconds() - begin);
    if (counted.counts.intrusive && counted.counts.intrusive->energy_modes > 0) {
      TouchTables tables;
      tables.shell = make_shell(skin);
      counted.counts.intrusive->shell = skin.shell_count();
      counted.counts.intrusive->shell_bytes = static_cast<double>(bytes_of(tables));
    }
  }
  if (!none) {
    const BodyProblem& own = coarse ? *coarse : problem;
    begin = thread_cpu_seconds();
    const SkinResponse skin(own.model, own.mesh.boundary);
    counted.costs.touch = costs_on(skin.body(), thread_cpu_seconds() - begin);
    if (!coarse) counted.costs.body = counted.costs.touch;
    const MeshCounts mesh = coarse ? counts_of(*coarse) : counted.counts.body;
    counted.counts.touch = touch_counts(description, mesh, coarse.has_value(), skin);
  }
  report(progress, {"measuring this machine", 1.0, 1.0, ""});
}

void count_campaign(const BodyDescription& description, const BodyProblem& problem,
                    const BakeToFileSettings& settings, BakeCounts& counts) {
  counts.sites = static_cast<int>(problem.sites.size());
  counts.levels = description.press.levels;
  counts.linear = static_cast<int>(problem.linear_sites.size());
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    counts.points *= static_cast<int>(parameter.values.size());
  }
  counts.shards = settings.fill.shards;
  counts.held_out = settings.held_out;
  const ReductionSettings& reduction = description.reduction;
  const ExpectedModes a_site = expected_modes(reduction.tolerance, counts.levels);
  // Where the parameters stay free, a site's modes serve all their values.
  const double more = counts.points > 1 && settings.reduction.at.empty() ? 1.5 : 1.0;
  const bool per_site = reduction.method == ReductionMethod::kPerSite;
  const auto columns = [&](double modes) {
    return per_site ? counts.sites * std::min<double>(more * modes, reduction.max_modes)
                    : std::min<double>(0.85 * counts.sites * more * modes, reduction.max_modes);
  };
  counts.displacement_modes = columns(a_site.displacement);
  counts.stress_modes = columns(a_site.stress);
  counts.mode_nodes = counts.body.vertices + (settings.reduction.volume ? counts.body.nodes : 0);
}

}  // namespace

ExpectedModes expected_modes(double tolerance, int levels) {
  const double decades = std::log10(tolerance / 1e-4);
  const auto within = [&](double modes) {
    return std::clamp(modes - 1.5 * decades, 1.0, std::max(1.0, 1.0 * levels));
  };
  return {.displacement = within(3.8), .stress = within(4.8)};
}

CountedBake count_bake(const BodyDescription& description, const BakeToFileSettings& settings,
                       const Progress& progress) {
  CountedBake counted;
  report(progress, {"meshing", 0.0, 1.0, ""});
  const double begin = cpu_seconds_with_children();
  BodyProblem problem;
  if (settings.with_campaign) {
    problem = pose_body(description);
  } else {
    TravellingLoad travelling = travelling_load(description);
    const BodyDescription::Intrusive& wanted = *description.intrusive;
    const auto positions = static_cast<int>(travelling.load.cols());
    counted.counts.intrusive =
        IntrusiveCounts{.positions = positions,
                        .modes = std::min(wanted.modes, positions),
                        .stress_modes = wanted.stress_modes,
                        .energy_modes = travelling.reaction_sites.empty() ? 0 : kEnergyModes};
    problem = std::move(travelling.problem);
  }
  counted.costs.mesh = cpu_seconds_with_children() - begin;
  report(progress, {"meshing", 1.0, 1.0, ""});
  counted.counts.body = counts_of(problem);
  counted.counts.bytes_of_number = settings.storage == ModeStorage::kFloat16 ? 2 : 4;
  if (settings.with_campaign) count_campaign(description, problem, settings, counted.counts);
  count_solids(description, problem, progress, counted);
  return counted;
}

}  // namespace palpable
