#include "palpable/bake/bake_body.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/campaign/between_sites.h"
#include "palpable/campaign/store_rows.h"
#include "palpable/describe/body_problem.h"
#include "palpable/separate/error_course.h"
#include "palpable/separate/reduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <future>
#include <limits>
#include <system_error>
#include <utility>
#include <variant>

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

// The body at rest is level 0 and no snapshot: there every level function is 0.
MatrixXd with_rest(const MatrixXd& G) {
  MatrixXd all = MatrixXd::Zero(G.rows() + 1, G.cols());
  all.bottomRows(G.rows()) = G;
  return all;
}

// Level and the parameters beyond it, with the functions of some modes.
std::vector<ParameterAxis> axes_from(const std::vector<MatrixXd>& G, std::size_t first,
                                     const StoreContent& content) {
  std::vector<ParameterAxis> axes{{"level", content.levels, with_rest(G[first]), Between::kSmooth}};
  for (std::size_t j = first + 1; j < G.size(); ++j) {
    const StoredParameter& parameter = content.parameters[j - first - 1];
    axes.push_back({parameter.name, parameter.values, G[j], Between::kSmooth});
  }
  return axes;
}

// As the live half evaluates it: on the boundary, or at all nodes.
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

// Shows each snapshot of the skin to `course` too, unless that is null.
double largest_evaluation_error(const SeparatedField& reduced, const SnapshotStore& store,
                                const Points& points, const StoredField& field,
                                const Boundary& boundary, VonMisesCourse* course) {
  const StoreContent& content = store.content();
  const int S = content.site_count(), L = content.level_count();
  const Index rows = Index{content.mesh.node_count()} * field.components;
  std::vector<float> values(static_cast<std::size_t>(reduced.value_count()));
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
  std::optional<SeparatedField> inside = {};  // at all nodes, if asked for
  std::optional<ErrorCourse> course = {}, von_mises_course = {};
};

double median(VectorXd values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

ReducedField reduce_field(const StoredField& field, const SnapshotStore& store,
                          const Points& points, const Boundary& boundary, bool volume,
                          const ReductionSettings& settings, const Progress& progress) {
  const Progress named = [&](const ProgressReport& r) {
    report(progress, {fmt::format("reducing {}", field.name), r.done, r.total, r.note});
  };
  const StoreContent& content = store.content();
  const int S = content.site_count();
  const VectorXd weights = value_weights(content.mesh, field);
  Reduction result = reduce(
      points.free() ? snapshot_rows(store, field) : snapshot_rows(store, points.first, field),
      weights, settings, named);
  ReductionReport report{.method = settings.method,
                         .modes = result.most_modes(),
                         .errors = result.errors,
                         .ranks = result.ranks,
                         .bound = result.bound,
                         .reached = result.reached,
                         .pooled = result.error,
                         .median = median(result.snapshot_errors),
                         .worst = result.snapshot_errors.maxCoeff()};
  if (result.blocks.size() == 1 && result.blocks[0].G.size() == 1) {
    // The live half has no table over site and level together; blocks of it are evaluated faster.
    result.blocks = as_blocks(result.blocks[0], S, weights, 0.1 * settings.tolerance);
  }
  report.columns = result.total_modes();
  ReducedField reduced{as_field(result.blocks, content, &boundary, field.components),
                       std::move(report), std::nullopt, course_of(result)};
  if (volume) reduced.inside = as_field(result.blocks, content, nullptr, field.components);
  reduced.report.bytes = 4.0 * static_cast<double>(reduced.field.value_count()) *
                         static_cast<double>(reduced.report.columns);
  std::optional<VonMisesCourse> von_mises;
  if (field.name == "stress") {
    von_mises.emplace(reduced.field, vertex_areas(boundary.surface), result.course.cols());
  }
  reduced.report.evaluated_worst = largest_evaluation_error(
      reduced.field, store, points, field, boundary, von_mises ? &*von_mises : nullptr);
  if (von_mises) reduced.von_mises_course = von_mises->result();
  return reduced;
}

// Loads point to the centre of mass: a site pressed beyond it would come out on the other side, and
// the solver, which knows no contact of a body with itself, would let it.
void refuse_press_through(const BodyDescription& description, const SurfaceMesh& skin,
                          const std::vector<Site>& sites, double press, double height) {
  const Eigen::Vector3d centre = enclosed_centroid(skin);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Site& site : sites) {
    nearest = std::min(nearest, (centre - skin.vertices.col(site.vertex)).norm());
  }
  if (press < nearest) return;
  throw Error(fmt::format(
      "{}: a press of {:.3g} m ({:.3g} of the height) would push a site past the centre of "
      "mass, {:.3g} "
      "m away: no load reaches that; ask for a depth below {:.2g}",
      description.source.string(), press, press / height, nearest, nearest / height));
}

std::string materials_line(const BodyDescription& description) {
  std::string line = material_line(description.material);
  for (const BodyDescription::MaterialPart& part : description.groups) {
    line += fmt::format("; a part of it {}", material_line(part.material));
  }
  return line;
}

std::string loads_line(const BodyDescription& description, const BodyMesh& mesh,
                       std::size_t site_count) {
  const BodyDescription::Sites& sites = description.sites;
  const std::string where =
      sites.at.empty() ? fmt::format("farthest points above {:.3g} of the height", sites.above)
                       : std::string("at the places given");
  std::string direction = "to the centre of mass";
  if (std::holds_alternative<BodyDescription::Sites::AlongNormal>(sites.direction)) {
    direction = "along the inward normal of the patch";
  } else if (const auto* given = std::get_if<Eigen::Vector3d>(&sites.direction)) {
    direction =
        fmt::format("along ({:.3g}, {:.3g}, {:.3g})", (*given)[0], (*given)[1], (*given)[2]);
  }
  const BodyDescription::Press& press = description.press;
  const std::string range =
      press.force
          ? fmt::format("a force of {:.4g} N", *press.force)
          : fmt::format("a press of {:.4g} m", press.length.value_or(press.depth * mesh.height));
  return fmt::format("{} sites, {}, patches of graph distance {}, dead loads {}, {} levels to {}",
                     site_count, where, sites.patch, direction, press.levels, range);
}

void vary(BodyDescription::MaterialLaw& law, const BodyDescription::Parameter& parameter,
          double value) {
  using What = BodyDescription::Parameter::What;
  if (parameter.what == What::kYoung) law.young = value;
  if (parameter.what == What::kPoisson) law.poisson = value;
  if (parameter.what != What::kStiffness) return;
  law.young *= value;
  for (std::size_t k = 0; k < law.constants.size(); ++k) {
    law.constants[k] *= law_constants(law.law)[k].per_pressure ? 1.0 / value : value;
  }
}

// Empty where nothing acts on the body but presses.
std::string preload_line(const BodyDescription& description) {
  std::string line;
  if (const auto& gravity = description.gravity) {
    const Eigen::Vector3d& g = gravity->acceleration;
    line += fmt::format("weight at {:.4g} kg/m^3 and ({:.4g}, {:.4g}, {:.4g}) m/s^2, ",
                        gravity->density, g[0], g[1], g[2]);
  }
  for (const BodyDescription::Pressure& pressure : description.pressures) {
    line += fmt::format("a pressure of {:.4g} Pa, ", pressure.pressure);
  }
  const bool moves =
      std::any_of(description.supports.begin(), description.supports.end(),
                  [](const BodyDescription::Support& s) { return !s.displacement.isZero(0.0); });
  if (line.empty() && !moves) return {};
  return line + "and what supports move, first and in full";
}

std::string reduction_line(const char* what, const ReductionReport& report,
                           const ReductionSettings& asked) {
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

// (P) what the body is made of at each combination of the parameters' values.
std::vector<PointMaterials> points_of(const BodyDescription& description) {
  std::size_t P = 1;
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    P *= parameter.values.size();
  }
  std::vector<PointMaterials> points;
  for (std::size_t p = 0; p < P; ++p) {
    BodyDescription here = description;
    std::size_t rest = p;
    for (std::size_t k = description.parameters.size(); k-- > 0;) {
      const BodyDescription::Parameter& parameter = description.parameters[k];
      BodyDescription::MaterialLaw& law =
          parameter.group < 0 ? here.material
                              : here.groups[static_cast<std::size_t>(parameter.group)].material;
      vary(law, parameter, parameter.values[rest % parameter.values.size()]);
      rest /= parameter.values.size();
    }
    try {
      PointMaterials point{material_of(here.material), {}};
      for (const auto& group : here.groups) point.groups.push_back(material_of(group.material));
      points.push_back(std::move(point));
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", description.parameters[0].place, error.what()));
    }
  }
  return points;
}

// Another method than the store's has other defaults, too.
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

// A field of nothing, for snapshots without stress.
SeparatedField zero_field(Index values, int sites, const VectorXd& levels) {
  return {Eigen::MatrixXf::Zero(values, 1),
          {{"site", VectorXd::LinSpaced(sites, 0.0, sites - 1.0), MatrixXd::Zero(sites, 1),
            Between::kNothing},
           {"level", levels, MatrixXd::Zero(levels.size(), 1), Between::kSmooth}}};
}

// A folder that goes when the bake ends.
class TemporaryStore {
 public:
  TemporaryStore() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "palpable-snapshots-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw Error(fmt::format("{}: cannot be made: {}", pattern, std::strerror(errno)));
    }
    path_ = pattern;
  }
  TemporaryStore(const TemporaryStore&) = delete;
  TemporaryStore& operator=(const TemporaryStore&) = delete;
  ~TemporaryStore() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

StoreContent content_of(const BodyDescription& description, const BodyProblem& problem) {
  const BodyMesh& mesh = problem.mesh;
  StoreContent content;
  content.name = description.name;
  content.material = materials_line(description);
  content.mesh = mesh.mesh;
  content.fixed = fixed_vertices(mesh);
  content.sites = problem.sites;
  for (const BodyDescription::Parameter& parameter : description.parameters) {
    content.parameters.push_back(
        {parameter.name, Eigen::Map<const VectorXd>(parameter.values.data(),
                                                    static_cast<Index>(parameter.values.size()))});
  }
  content.reduction = description.reduction;
  const auto add = [&](const char* key, std::string value) {
    content.provenance.emplace_back(key, std::move(value));
  };
  add("description", description.source.filename().string());
  add("mesh source", mesh.origin);
  add("mesh",
      fmt::format("{} nodes, {} {}-node tetrahedra, boundary {} vertices, {} triangles; "
                  "dihedral angles {:.1f} to {:.1f} degrees, volume {:.4g} m^3",
                  mesh.mesh.node_count(), mesh.mesh.tet_count(), mesh.mesh.is_quadratic() ? 10 : 4,
                  mesh.boundary.surface.vertex_count(), mesh.boundary.surface.triangle_count(),
                  mesh.quality.smallest_dihedral_degrees, mesh.quality.largest_dihedral_degrees,
                  mesh.quality.volume));
  add("material", content.material);
  add("support", fmt::format("{} nodes are held in all directions, {} in some or moved",
                             mesh.fixed_nodes.size(), mesh.supports.size()));
  const std::string preload = preload_line(description);
  if (!preload.empty()) add("preload", preload);
  return content;
}

// Turns the plan of a campaign into that of the levels between its own.
void hold_out(const SnapshotStore& campaign, CampaignPlan& plan, StoreContent& content) {
  if (campaign.content().keys != content.keys) {
    throw Error(fmt::format("{}: is of another campaign than this description's",
                            campaign.folder().string()));
  }
  for (int u = 0; u < campaign.content().unit_count(); ++u) {
    const std::string why = campaign.why_not(u);
    if (!why.empty()) throw Error(fmt::format("{}: {}", campaign.unit_file(u).string(), why));
    plan.full_loads.push_back(campaign.unit(u).full_load);
  }
  const int L = content.level_count();
  for (int m = 0; m < L; ++m) {
    plan.run.at.push_back((m + 0.5) / L);
    content.levels[m + 1] = plan.run.at.back();
  }
  plan.linear.clear();
  content.keys = unit_keys(plan);
}

FilledStore fill_store(const BodyDescription& description, const BakeSettings& settings, Crew& crew,
                       const Progress& progress) {
  PALPABLE_EXPECT(!settings.store.empty(), "snapshots have a place");
  StageTimes wall;
  report(progress, {"meshing", 0.0, 1.0, ""});
  BodyProblem problem = [&] {
    const StageTimer timer(wall, "mesh");
    return pose_body(description);
  }();
  const BodyMesh& mesh = problem.mesh;
  report(progress,
         {"meshing", 1.0, 1.0,
          fmt::format("{} nodes, {} tetrahedra", mesh.mesh.node_count(), mesh.mesh.tet_count())});
  if (std::holds_alternative<BodyDescription::Sites::ToCentre>(description.sites.direction)) {
    refuse_press_through(description, mesh.boundary.surface, problem.sites, problem.press,
                         mesh.height);
  }
  StoreContent content = content_of(description, problem);
  const int levels = description.press.levels, order = mesh.mesh.is_quadratic() ? 10 : 4;
  content.levels = VectorXd::LinSpaced(levels + 1, 0.0, 1.0);
  content.provenance.emplace_back("loads", loads_line(description, mesh, content.sites.size()));
  content.provenance.emplace_back(
      "solver",
      settings.solver == "calculix"
          ? fmt::format("CalculiX (ccx), {}-node tetrahedra; loads found by the own solver", order)
          : fmt::format("total Lagrangian {}-node tetrahedra, Newton with conjugate gradients "
                        "preconditioned by a sparse Cholesky factor",
                        order));
  CampaignPlan plan{.model = std::move(problem.model),
                    .boundary = mesh.boundary,
                    .sites = std::move(problem.sites),
                    .linear = std::move(problem.linear_sites),
                    .run = {.press = problem.press, .force = problem.force, .levels = levels},
                    .preload = std::move(problem.preload),
                    .points = points_of(description),
                    .solver = settings.solver};
  content.keys = unit_keys(plan);
  if (settings.held_out_of != nullptr) hold_out(*settings.held_out_of, plan, content);
  for (const Site& site : plan.linear) content.linear.push_back(site.vertex);
  if (!plan.linear.empty()) content.linear_key = linear_key(plan);
  std::optional<StageTimer> timer(std::in_place, wall, "campaign");
  SnapshotStore store = crew.leads() ? SnapshotStore::create(settings.store, std::move(content))
                                     : SnapshotStore::attach(settings.store, std::move(content));
  try {
    CampaignReport campaign = run_campaign(
        plan, store, crew,
        {.threads = settings.threads, .shard = settings.shard, .shards = settings.shards},
        progress);
    timer.reset();
    return {std::move(store), std::move(campaign), wall};
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", description.source.string(), error.what()));
  }
}

int point_of(const StoreContent& content, const std::map<std::string, double>& at) {
  for (const auto& [name, value] : at) {
    const auto known = std::find_if(content.parameters.begin(), content.parameters.end(),
                                    [&](const StoredParameter& p) { return p.name == name; });
    if (known != content.parameters.end()) continue;
    std::string names;
    for (const StoredParameter& p : content.parameters) names += fmt::format(" '{}'", p.name);
    throw Error(fmt::format(
        "these snapshots have no parameter '{}';{}", name,
        names.empty() ? " there is none beside site and level" : " there are:" + names));
  }
  int point = 0;
  for (const StoredParameter& parameter : content.parameters) {
    const auto n = static_cast<int>(parameter.values.size());
    int k = n / 2;
    if (const auto wanted = at.find(parameter.name); wanted != at.end()) {
      const auto distance = (parameter.values.array() - wanted->second).abs();
      if (!(distance.minCoeff(&k) <= 1e-9 * std::abs(wanted->second))) {
        throw Error(fmt::format("'{}' has no value {:.6g}; there are: {:.6g}", parameter.name,
                                wanted->second,
                                fmt::join(parameter.values.begin(), parameter.values.end(), " ")));
      }
    }
    point = point * n + k;
  }
  return point;
}

namespace {

// The parameters that stay free, and what the presses are at their values.
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

}  // namespace

BakedBody reduce_store(const SnapshotStore& store, const ReduceSettings& settings,
                       const Progress& progress) {
  StageTimes wall;
  std::optional<StageTimer> timer(std::in_place, wall, "reduce");
  const StoreContent& content = store.content();
  const int point = point_of(content, settings.at);
  const Points points = settings.at.empty() && content.point_count() > 1
                            ? Points{0, content.point_count()}
                            : Points{point, 1};
  require_complete(store, points, progress);
  const ReductionSettings wanted = wanted_of(settings, content.reduction);
  if (points.free() && wanted.method != ReductionMethod::kPerSite &&
      wanted.method != ReductionMethod::kPgd && wanted.method != ReductionMethod::kCp) {
    throw Error(
        fmt::format("{}: '{}' has no functions of '{}' alone; take per-site, pgd or cp, or one "
                    "value: --at {}=...",
                    store.folder().string(), method_name(wanted.method), content.parameters[0].name,
                    content.parameters[0].name));
  }
  const Boundary boundary = split_boundary_of(content.mesh);
  const StoredField* moved = find_field(content, "displacement");
  const StoredField* stressed = find_field(content, "stress");
  if (moved == nullptr) {
    throw Error(fmt::format("{}: has no displacement", store.folder().string()));
  }
  // Both at a time, and the bar shows the larger.
  std::future<ReducedField> beside = std::async(std::launch::async, [&] {
    return reduce_field(*moved, store, points, boundary, settings.volume, wanted,
                        stressed == nullptr ? progress : Progress{});
  });
  ReducedField sigma =
      stressed != nullptr
          ? reduce_field(*stressed, store, points, boundary, settings.volume, wanted, progress)
          : ReducedField{zero_field(6 * boundary.surface.vertices.cols(), content.site_count(),
                                    content.levels),
                         {}};
  ReducedField u = beside.get();

  BakedBody baked{ReducedBody{.name = content.name,
                              .surface = boundary.surface,
                              .fixed = content.fixed,
                              .sites = content.sites,
                              .displacement = std::move(u.field),
                              .stress = std::move(sigma.field),
                              .press_depth = MatrixXd(content.levels.size(), content.site_count()),
                              .error = {u.report.pooled, u.report.worst, sigma.report.pooled,
                                        sigma.report.worst},
                              .material = content.material,
                              .provenance = {}},
                  {}};
  ReducedBody& body = baked.body;
  body.error.displacement_course = std::move(u.course);
  body.error.stress_course = std::move(sigma.course);
  body.error.von_mises_course = std::move(sigma.von_mises_course);
  BakeReport& made = baked.report;
  if (settings.volume) {
    const TetMesh& mesh = content.mesh;
    body.volume = BodyVolume{mesh.nodes, mesh.tets, std::move(*u.inside), std::move(sigma.inside)};
    if (mesh.is_quadratic()) {
      body.volume->tets.resize(10, mesh.tets.cols());
      body.volume->tets << mesh.tets, mesh.edge_nodes;
    }
  }
  double farthest_rest = 0;
  for (int s = 0; s < content.site_count(); ++s) {
    StoredUnit unit = store.unit(point * content.site_count() + s);
    body.sites[static_cast<std::size_t>(s)].full_load = unit.full_load;
    body.press_depth.col(s) = unit.press_depth;
    body.largest_von_mises = std::max(body.largest_von_mises, unit.largest_von_mises);
    made.outcomes.push_back(std::move(unit.outcome));
    if (s > 0 || unit.rest.cols() == 0) continue;
    // The body at rest lies there as its preload leaves it; the same for all sites.
    body.surface.vertices += unit.rest(Eigen::all, boundary.node_of_vertex);
    if (body.volume) body.volume->nodes += unit.rest;
    farthest_rest = unit.rest.colwise().norm().maxCoeff();
  }
  if (points.free()) add_further(store, point, body);
  made.displacement = std::move(u.report);
  made.stress = std::move(sigma.report);
  made.nodes = content.mesh.node_count();
  made.tets = content.mesh.tet_count();
  made.vertices = boundary.surface.vertex_count();
  made.triangles = boundary.surface.triangle_count();

  const std::vector<double> values =
      points.free() ? std::vector<double>{} : content.values_at(point);
  for (std::size_t k = 0; k < values.size(); ++k) {
    body.material += fmt::format("; {} {:.6g}", content.parameters[k].name, values[k]);
  }
  const auto reached = std::count_if(made.outcomes.begin(), made.outcomes.end(),
                                     [](const SiteOutcome& o) { return o.reached_press; });
  for (auto [key, value] : content.provenance) {
    if (key == "material") value = body.material;
    if (key == "loads") value += fmt::format("; {} sites reach it", reached);
    if (key == "preload") {
      value += fmt::format(
          ": nodes move by up to {:.4g} m. The surface is that of the body so loaded; displacement "
          "and stress are what a press adds",
          farthest_rest);
    }
    body.provenance.emplace_back(key, value);
  }
  const auto add = [&](const char* key, std::string value) {
    body.provenance.emplace_back(key, std::move(value));
  };
  add("reduction", fmt::format("{} ({}), space weighted by nodal volume",
                               method_name(wanted.method), method_line(wanted.method)));
  add("displacement", reduction_line("displacement", made.displacement, wanted));
  add("stress", stressed != nullptr ? reduction_line("nodal Cauchy stress", made.stress, wanted)
                                    : "none: the snapshots have no stress, it is taken as zero");
  if (const std::optional<BetweenSites> between = between_sites(store)) {
    body.error.between_sites = between->median;
    add("between sites",
        fmt::format(
            "the field of the nearest site, for {} touches between sites, against their "
            "own linear responses of equal depth, on the skin: {:.2g} at the median, {:.2g} "
            "at nine tenths, {:.2g} at the worst",
            between->touches, between->median, between->nine_tenths, between->worst));
    made.between_sites = body.provenance.back().second;
  }
  if (!settings.version.empty()) add("program", settings.version);
  if (!settings.command_line.empty()) add("command line", settings.command_line);
  timer.reset();
  made.wall = wall;
  return baked;
}

BakedBody bake_body(const BodyDescription& description, const BakeSettings& settings,
                    const Progress& progress) {
  std::optional<TemporaryStore> temporary;
  BakeSettings with_store = settings;
  if (with_store.store.empty()) with_store.store = temporary.emplace().path();
  LocalCrew crew;
  const FilledStore filled = fill_store(description, with_store, crew, progress);
  BakedBody baked = reduce_store(
      filled.store, {.version = settings.version, .command_line = settings.command_line}, progress);
  StageTimes wall = filled.wall;
  wall.add(baked.report.wall);
  baked.report.wall = wall;
  baked.report.threads = filled.campaign.times;
  return baked;
}

}  // namespace palpable
