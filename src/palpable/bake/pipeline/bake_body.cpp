#include "palpable/bake/pipeline/bake_body.h"

#include "palpable/bake/campaign/between_sites.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/pipeline/error_course.h"
#include "palpable/bake/separate/reduction.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/temporary_folder.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The rows of the boundary's nodes, `components` per node.
template <class Matrix>
Matrix boundary_rows(const Matrix& values, const Boundary& boundary, int components) {
  Matrix rows(static_cast<Index>(boundary.node_of_vertex.size()) * components, values.cols());
  Index row = 0;
  for (const int node : boundary.node_of_vertex) {
    rows.middleRows(row, components) = values.middleRows(Index{node} * components, components);
    row += components;
  }
  return rows;
}

// Adds level 0, the body at rest, which is not a snapshot: every level function is 0 there.
MatrixXd with_rest(const MatrixXd& G) {
  MatrixXd all = MatrixXd::Zero(G.rows() + 1, G.cols());
  all.bottomRows(G.rows()) = G;
  return all;
}

// The axes of the level and of further parameters, with their functions.
std::vector<ParameterAxis> axes_from(const std::vector<MatrixXd>& G, std::size_t first,
                                     const StoreContent& content) {
  std::vector<ParameterAxis> axes{{"level", content.levels, with_rest(G[first]), Between::kSmooth}};
  for (std::size_t j = first + 1; j < G.size(); ++j) {
    const StoredParameter& parameter = content.parameters[j - first - 1];
    axes.push_back({parameter.name, parameter.values, G[j], Between::kSmooth});
  }
  return axes;
}

// The field as the live half evaluates it: on the boundary, or at all nodes if `boundary` is null.
SeparatedField as_field(const std::vector<SeparatedTensor>& blocks, const StoreContent& content,
                        const Boundary* boundary, int components) {
  const auto kept = [&](const MatrixXd& F) -> Eigen::MatrixXf {
    if (boundary == nullptr) return F.cast<float>();
    return boundary_rows(F, *boundary, components).cast<float>();
  };
  const int S = content.site_count();
  if (static_cast<int>(blocks.size()) == S && (S > 1 || blocks[0].G[0].rows() != S)) {
    std::vector<SeparatedField> fields;
    for (const SeparatedTensor& block : blocks) {
      fields.emplace_back(kept(block.F), axes_from(block.G, 0, content));
    }
    return one_block_per_choice("site", fields);
  }
  std::vector<ParameterAxis> axes = axes_from(blocks[0].G, 1, content);
  axes.insert(axes.begin(),
              {"site", VectorXd::LinSpaced(S, 0.0, S - 1.0), blocks[0].G[0], Between::kNothing});
  return {kept(blocks[0].F), std::move(axes)};
}

// The points that a body is made of: one, or all where their parameters stay free.
struct Points {
  int first = 0, count = 1;
  [[nodiscard]] bool free() const { return count > 1; }
};

// Largest difference between the reduced field and the snapshots on the skin, relative to the
// largest value of all snapshots. Adds each snapshot to `course` as well, unless that is null.
double largest_evaluation_error(const SeparatedField& reduced, const SnapshotStore& store,
                                const Points& points, const StoredField& field,
                                const Boundary& boundary, VonMisesCourse* course) {
  const StoreContent& content = store.content();
  const int S = content.site_count(), L = content.level_count();
  const Index rows = Index{content.mesh.node_count()} * field.components;
  std::vector<float> values(reduced.value_count());
  const Eigen::Map<const Eigen::VectorXf> evaluated(values.data(), reduced.value_count());
  float largest = 0, whole = 0;
  for (int p = points.first; p < points.first + points.count; ++p) {
    std::vector<double> mu{0.0, 0.0};
    if (points.free()) {
      for (const double value : content.values_at(p)) mu.push_back(value);
    }
    for (int s = 0; s < S; ++s) {
      const Eigen::MatrixXf truth =
          boundary_rows(store.rows(p * S + s, field, 0, rows), boundary, field.components);
      whole = std::max(whole, truth.cwiseAbs().maxCoeff());
      mu[0] = s;
      for (int l = 0; l < L; ++l) {
        mu[1] = content.levels[l + 1];
        reduced.evaluate(mu, values);
        largest = std::max(largest, (evaluated - truth.col(l)).cwiseAbs().maxCoeff());
        const Index k = (Index{s} * L + l) * points.count + p - points.first;
        if (course != nullptr) course->add(k, mu, truth.col(l));
      }
    }
  }
  return static_cast<double>(largest) / static_cast<double>(whole);
}

struct ReducedField {
  SeparatedField field;
  ReductionReport report;
  std::optional<SeparatedField> inside = {};  // at all nodes, if requested
  std::optional<ErrorCourse> course = {}, von_mises_course = {};
};

double median(VectorXd values) {
  return upper_median(std::span(values.data(), static_cast<std::size_t>(values.size())));
}

// The input of a field's reduction.
struct Reducing {
  const SnapshotStore& store;
  const Points& points;
  const Boundary& boundary;
  bool volume;
};

// The modes as the live half evaluates them, with their errors against the snapshots.
ReducedField kept(const std::vector<SeparatedTensor>& blocks, const StoredField& field,
                  const Reducing& what, ReductionReport report, ErrorCourse course) {
  const StoreContent& content = what.store.content();
  const Index snapshots = course.snapshots.rows();
  ReducedField reduced{as_field(blocks, content, &what.boundary, field.components),
                       std::move(report), std::nullopt, std::move(course)};
  if (what.volume) reduced.inside = as_field(blocks, content, nullptr, field.components);
  reduced.report.bytes = 4.0 * static_cast<double>(reduced.field.value_count()) *
                         static_cast<double>(reduced.report.columns);
  std::optional<VonMisesCourse> von_mises;
  if (field.name == "stress") {
    von_mises.emplace(reduced.field, vertex_areas(what.boundary.surface), snapshots);
  }
  reduced.report.evaluated_worst =
      largest_evaluation_error(reduced.field, what.store, what.points, field, what.boundary,
                               von_mises ? &*von_mises : nullptr);
  if (von_mises) reduced.von_mises_course = von_mises->result();
  return reduced;
}

// Progress reports that name the field.
Progress named(const StoredField& field, const Progress& progress) {
  return [&field, &progress](const ProgressReport& r) {
    report(progress, {fmt::format("reducing {}", field.name), r.done, r.total, r.note});
  };
}

ReducedField reduce_field(const StoredField& field, const Reducing& what,
                          const ReductionSettings& settings, const Progress& progress) {
  const Points& points = what.points;
  const int S = what.store.content().site_count();
  const VectorXd weights = value_weights(what.store.content().mesh, field);
  Reduction result = reduce(points.free() ? snapshot_rows(what.store, field)
                                          : snapshot_rows(what.store, points.first, field),
                            weights, settings, named(field, progress));
  ReductionReport report{.method = std::string(method_name(settings.method)),
                         .modes = result.most_modes(),
                         .errors = result.errors,
                         .ranks = result.ranks,
                         .bound = result.bound,
                         .reached = result.reached,
                         .pooled = result.error,
                         .median = median(result.snapshot_errors),
                         .worst = result.snapshot_errors.maxCoeff()};
  if (result.blocks.size() == 1 && result.blocks[0].G.size() == 1) {
    // The live half has no functions of site and level together; blocks of sites are evaluated
    // faster.
    result.blocks = as_blocks(result.blocks[0], S, weights, 0.1 * settings.tolerance);
  }
  report.columns = result.total_modes();
  return kept(result.blocks, field, what, std::move(report), course_of(result));
}

// "x and y"; nothing where sites are choices.
std::string place_text(const SitePlaces& places) {
  if (!places.quantities) return {};
  std::string text = places.axes[0].name;
  if (places.axes.size() > 1) text += " and " + places.axes[1].name;
  return text;
}

// Reduces a field by sparse PGD: a model that is learnt from a part of the snapshots, evaluated at
// all sites and levels, with the same modes for all sites. Only the error with all modes is known,
// since each mode changes the functions of those before it.
ReducedField learn_field(const StoredField& field, const Reducing& what,
                         const SparseCampaignSettings& settings, const Progress& progress) {
  SparseCampaign found =
      sparse_campaign(what.store, what.points.first, field, settings, named(field, progress));
  SeparatedTensor table{std::move(found.model.F),
                        {std::move(found.site_functions), std::move(found.level_functions)}};
  for (MatrixXd& G : table.G) normalise(table.F, G);
  const auto m = static_cast<int>(table.F.cols());
  ErrorCourse course{.modes = Eigen::VectorXi::Constant(1, m),
                     .pooled = VectorXd::Constant(1, found.all.pooled),
                     .snapshots = found.errors.cast<float>()};
  return kept(
      {std::move(table)}, field, what,
      {.method = std::string(kSparsePgdName),
       .modes = m,
       .columns = m,
       .pooled = found.all.pooled,
       .median = found.all.median,
       .worst = found.all.worst,
       .learning = LearningReport{found.trained_on, place_text(found.places), found.unseen}},
      std::move(course));
}

std::string learning_line(const char* what, const ReductionReport& report) {
  const LearningReport& learning = *report.learning;
  return fmt::format(
      "{}: {} modes, relative L2 error over the volume {:.3g} pooled, {:.3g} at the median "
      "snapshot and {:.3g} at the worst, in their own norms; of the {} snapshots that it was not "
      "learnt from {:.3g} pooled, {:.3g} at the median and {:.3g} at the worst",
      what, report.modes, report.pooled, report.median, report.worst, learning.unseen.count,
      learning.unseen.pooled, learning.unseen.median, learning.unseen.worst);
}

std::string reduction_line(const char* what, const ReductionReport& report,
                           const ReductionSettings& asked) {
  if (report.learning) return learning_line(what, report);
  const std::string modes =
      asked.method == ReductionMethod::kPerSite
          ? fmt::format("blocks of up to {} modes, {} in all", report.modes, report.columns)
          : fmt::format("{} modes", report.modes);
  return fmt::format(
      "{}: {}, relative L2 error over the volume {:.3g} pooled (asked {:.3g}{}{}), {:.3g} at the "
      "median snapshot and {:.3g} at the worst, in their own norms",
      what, modes, report.pooled, asked.tolerance,
      asked.weight_snapshots ? " in the mean of own norms" : "",
      report.reached ? "" : ", not reached", report.median, report.worst);
}

const char* method_line(ReductionMethod method) {
  switch (method) {
    case ReductionMethod::kPerSite:
      return "a POD of each site's levels, in blocks";
    case ReductionMethod::kPgd:
      return "non-intrusive PGD over site and level, all functions updated after each mode";
    case ReductionMethod::kPgd2:
      return "non-intrusive PGD, site and level together, all functions updated after each mode; "
             "stored in blocks of sites";
    case ReductionMethod::kPod:
      return "POD, site and level together; stored in blocks of sites";
    case ReductionMethod::kCp:
      return "CP-ALS over site and level";
    case ReductionMethod::kHosvd:
      return "ST-HOSVD; stored in blocks of sites";
  }
  return "";
}

// Provenance::reduction, but for the weights.
std::string reduction_text(const ReductionSettings& wanted,
                           const std::optional<SparseCampaignSettings>& sparse,
                           const ReductionReport& displacement) {
  if (!sparse) {
    return fmt::format("{} ({})", method_name(wanted.method), method_line(wanted.method));
  }
  const LearningReport& learning = *displacement.learning;
  return fmt::format(
      "{} (learnt from {} snapshots of {}, drawn at random with seed {}; {}; degrees and number of "
      "modes by cross-validation)",
      kSparsePgdName, learning.trained_on, learning.trained_on + learning.unseen.count,
      sparse->seed,
      learning.place.empty()
          ? "sites are choices"
          : fmt::format("where it is pressed is a quantity, {}", learning.place));
}

// The settings of a reduction. A method other than the store's comes with its own defaults.
ReductionSettings wanted_of(const ReduceSettings& settings, const ReductionSettings& stored) {
  ReductionSettings wanted = stored;
  if (settings.method && *settings.method != stored.method) {
    wanted.method = *settings.method;
    wanted.tolerance = default_tolerance(wanted.method);
    wanted.weight_snapshots = wanted.method == ReductionMethod::kPerSite;
  }
  if (settings.tolerance) wanted.tolerance = *settings.tolerance;
  if (settings.max_modes) wanted.max_modes = *settings.max_modes;
  if (settings.own_norms) wanted.weight_snapshots = *settings.own_norms;
  return wanted;
}

void require_complete(const SnapshotStore& store, const Points& points, const Progress& progress) {
  const int S = points.count * store.content().site_count();
  const int first = points.first * store.content().site_count();
  for (int s = 0; s < S; ++s) {
    const int unit = first + s;
    const std::string why = store.why_not(unit);
    report(progress, {"looking for snapshots", s + 1.0, static_cast<double>(S), ""});
    if (why.empty()) continue;
    throw Error(
        fmt::format("{}: {}; the bake that made these snapshots, run again, adds what is "
                    "missing",
                    store.unit_file(unit).string(), why));
  }
}

// A zero field of the same parameters, for snapshots without stress.
SeparatedField zero_field(Index values, const SeparatedField& displacement) {
  std::vector<ParameterAxis> axes = displacement.axes();
  for (ParameterAxis& axis : axes) axis.functions = MatrixXd::Zero(axis.samples.size(), 1);
  return {Eigen::MatrixXf::Zero(values, 1), std::move(axes)};
}

// Adds the parameters that stay free, and the presses at all their values.
void add_further(const SnapshotStore& store, int usual, ReducedBody& body) {
  const StoreContent& content = store.content();
  const int S = content.site_count(), P = content.point_count();
  const std::vector<double> values = content.values_at(usual);
  for (std::size_t k = 0; k < content.parameters.size(); ++k) {
    body.further.push_back({content.parameters[k].name, content.parameters[k].values, values[k]});
  }
  body.further_press_depth.resize(content.levels.size(), S * P);
  body.further_full_load.resize(S, P);
  for (int p = 0; p < P; ++p) {
    for (int s = 0; s < S; ++s) {
      const StoredUnit unit = store.unit(p * S + s);
      body.further_press_depth.col(s + S * p) = unit.press_depth;
      body.further_full_load(s, p) = unit.full_load;
      body.largest_von_mises = std::max(body.largest_von_mises, unit.largest_von_mises);
    }
  }
}

// Throws where a method cannot keep the parameters of several points free.
void require_free_functions(const SnapshotStore& store, const Points& points,
                            std::string_view method) {
  if (!points.free() || method == "per-site" || method == "pgd" || method == "cp") return;
  const std::string& parameter = store.content().parameters[0].name;
  throw Error(
      fmt::format("{}: '{}' has no functions of '{}' alone; take per-site, pgd or cp, or one "
                  "value: --set {}=...",
                  store.folder().string(), method, parameter, parameter));
}

struct ReducedFields {
  ReducedField displacement, stress;
  bool has_stress = false;  // otherwise `stress` is zero
};

using FieldReduction = std::function<ReducedField(const StoredField&, const Progress&)>;

// Reduces both fields concurrently. The progress is that of the larger field: stress, if there is
// one.
ReducedFields reduce_fields(const SnapshotStore& store, const Boundary& boundary,
                            const FieldReduction& reduce_one, const Progress& progress) {
  const StoreContent& content = store.content();
  const StoredField* moved = find_field(content, "displacement");
  const StoredField* stressed = find_field(content, "stress");
  if (moved == nullptr) {
    throw Error(fmt::format("{}: has no displacement", store.folder().string()));
  }
  std::future<ReducedField> beside = std::async(std::launch::async, [&] {
    return reduce_one(*moved, stressed == nullptr ? progress : Progress{});
  });
  if (stressed != nullptr) {
    ReducedField sigma = reduce_one(*stressed, progress);
    return {beside.get(), std::move(sigma), true};
  }
  ReducedField u = beside.get();
  ReducedField none{zero_field(6 * boundary.surface.vertices.cols(), u.field), {}};
  return {std::move(u), std::move(none), false};
}

// The body without its presses, with the store's provenance. Moves the fields, but not their
// reports.
ReducedBody body_of(const StoreContent& content, const Boundary& boundary, ReducedFields& fields,
                    bool volume) {
  ReducedField& u = fields.displacement;
  ReducedField& sigma = fields.stress;
  ReducedBody body{
      .name = content.name,
      .surface = boundary.surface,
      .fixed = content.fixed,
      .sites = content.sites,
      .displacement = std::move(u.field),
      .stress = std::move(sigma.field),
      .press_depth = MatrixXd(content.levels.size(), content.site_count()),
      .error = {u.report.pooled, u.report.worst, sigma.report.pooled, sigma.report.worst},
      .material = content.material,
      .provenance = content.provenance};
  body.error.displacement_course = std::move(u.course);
  body.error.stress_course = std::move(sigma.course);
  body.error.von_mises_course = std::move(sigma.von_mises_course);
  if (!volume) return body;
  const TetMesh& mesh = content.mesh;
  body.volume = BodyVolume{mesh.nodes, mesh.tets, std::move(*u.inside), std::move(sigma.inside)};
  if (mesh.is_quadratic()) {
    body.volume->tets.resize(10, mesh.tets.cols());
    body.volume->tets << mesh.tets, mesh.edge_nodes;
  }
  return body;
}

// Adds the presses of all sites at one point, and moves the nodes to the body at rest.
// @returns the largest displacement of a node at rest, m
double add_presses(const SnapshotStore& store, int point, const Boundary& boundary,
                   ReducedBody& body, std::vector<SiteOutcome>& outcomes) {
  const int S = store.content().site_count();
  double farthest_rest = 0;
  for (int s = 0; s < S; ++s) {
    StoredUnit unit = store.unit(point * S + s);
    body.sites[s].full_load = unit.full_load;
    body.press_depth.col(s) = unit.press_depth;
    body.largest_von_mises = std::max(body.largest_von_mises, unit.largest_von_mises);
    outcomes.push_back(std::move(unit.outcome));
    if (s > 0 || unit.rest.cols() == 0) continue;
    // The body at rest is the preloaded one, which is the same for all sites.
    body.surface.vertices += unit.rest(Eigen::all, boundary.node_of_vertex);
    if (body.volume) body.volume->nodes += unit.rest;
    farthest_rest = unit.rest.colwise().norm().maxCoeff();
  }
  return farthest_rest;
}

// Snapshots of parts of a campaign (--shard) come here without that the campaign saw all of them.
void refuse_if_none_reached(const SnapshotStore& store, const std::vector<SiteOutcome>& outcomes) {
  const auto reached = [](const SiteOutcome& outcome) { return outcome.reached_press; };
  if (std::any_of(outcomes.begin(), outcomes.end(), reached)) return;
  throw Error(fmt::format(
      "{}: none of the {} sites reaches the press that was asked for: {}; ask for a smaller one",
      store.folder().string(), outcomes.size(), outcomes.front().shortfall));
}

// Completes the store's provenance by the outcome of the campaign and by the reduction.
void complete_provenance(const ReductionSettings& wanted,
                         const std::optional<SparseCampaignSettings>& sparse, bool has_stress,
                         double farthest_rest, BakedBody& baked) {
  Provenance& provenance = baked.body.provenance;
  const BakeReport& made = baked.report;
  provenance.material = baked.body.material;
  provenance.sites_reached =
      static_cast<int>(std::count_if(made.outcomes.begin(), made.outcomes.end(),
                                     [](const SiteOutcome& o) { return o.reached_press; }));
  if (!provenance.preload.empty()) provenance.preload_moves = farthest_rest;
  provenance.reduction = fmt::format("{}, space weighted by nodal volume",
                                     reduction_text(wanted, sparse, made.displacement));
  provenance.displacement = reduction_line("displacement", made.displacement, wanted);
  provenance.stress = has_stress ? reduction_line("nodal Cauchy stress", made.stress, wanted)
                                 : "none: the snapshots have no stress, it is taken as zero";
}

// States the error of touches between sites, where the store has linear responses.
void state_between_sites(const SnapshotStore& store, BakedBody& baked) {
  const std::optional<BetweenSites> between = between_sites(store);
  if (!between) return;
  baked.body.error.between_sites = between->median;
  baked.report.between_sites = fmt::format(
      "the field of the nearest site, for {} touches between sites, against their "
      "own linear responses of equal depth, on the skin: {:.2g} at the median, {:.2g} "
      "at nine tenths, {:.2g} at the worst",
      between->touches, between->median, between->nine_tenths, between->worst);
  baked.body.provenance.between_sites = baked.report.between_sites;
}

}  // namespace

BakedBody reduce_store(const SnapshotStore& store, const ReduceSettings& settings,
                       const Progress& progress) {
  PALPABLE_EXPECT(
      !settings.sparse || (!settings.method && !settings.tolerance && !settings.own_norms),
      "sparse PGD is a method of its own, and stops by itself");
  StageTimes wall;
  std::optional<StageTimer> timer(std::in_place, wall, "reduce");
  const StoreContent& content = store.content();
  const int point = point_of(content, settings.at);
  const Points points = settings.at.empty() && content.point_count() > 1
                            ? Points{0, content.point_count()}
                            : Points{point, 1};
  require_complete(store, points, progress);
  const ReductionSettings wanted = wanted_of(settings, content.reduction);
  std::optional<SparseCampaignSettings> sparse = settings.sparse;
  if (sparse && settings.max_modes) sparse->sparse.max_modes = *settings.max_modes;
  const std::string method(sparse ? kSparsePgdName : method_name(wanted.method));
  require_free_functions(store, points, method);
  const Boundary boundary = split_boundary_of(content.mesh);
  const Reducing what{store, points, boundary, settings.volume};
  ReducedFields fields = reduce_fields(
      store, boundary,
      [&](const StoredField& field, const Progress& bar) {
        return sparse ? learn_field(field, what, *sparse, bar)
                      : reduce_field(field, what, wanted, bar);
      },
      progress);

  BakedBody baked{body_of(content, boundary, fields, settings.volume), {}};
  ReducedBody& body = baked.body;
  body.method = method;
  BakeReport& made = baked.report;
  const double farthest_rest = add_presses(store, point, boundary, body, made.outcomes);
  refuse_if_none_reached(store, made.outcomes);
  if (points.free()) add_further(store, point, body);
  made.displacement = std::move(fields.displacement.report);
  made.stress = std::move(fields.stress.report);
  made.nodes = content.mesh.node_count();
  made.tets = content.mesh.tet_count();
  made.vertices = boundary.surface.vertex_count();
  made.triangles = boundary.surface.triangle_count();

  const std::vector<double> values =
      points.free() ? std::vector<double>{} : content.values_at(point);
  for (std::size_t k = 0; k < values.size(); ++k) {
    body.material += fmt::format("; {} {}", content.parameters[k].name, number_text(values[k]));
  }
  complete_provenance(wanted, sparse, fields.has_stress, farthest_rest, baked);
  state_between_sites(store, baked);
  body.provenance.program = settings.version;
  body.provenance.command_line = settings.command_line;
  timer.reset();
  made.wall = wall;
  return baked;
}

BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                    const Progress& progress) {
  const TemporaryFolder temporary("palpable-snapshots");
  LocalCrew crew;
  const FilledStore filled = fill_store(
      description, {.threads = settings.threads, .store = temporary.path()}, crew, progress);
  BakedBody baked = reduce_store(
      filled.store, {.version = settings.version, .command_line = settings.command_line}, progress);
  StageTimes wall = filled.wall;
  wall.add(baked.report.wall);
  baked.report.wall = wall;
  baked.report.threads = filled.campaign.times;
  return baked;
}

}  // namespace palpable
