// palpable bench reduce: all methods on the bunny, the default body compared with full-order
// solutions, and sparse PGD on a part of the beam's samples.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/campaign/between_sites.h"
#include "palpable/bake/campaign/held_out.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/bake/pipeline/sparse_campaign.h"
#include "palpable/bake/separate/method_comparison.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/common/base/json.h"
#include "palpable/common/body_file/body_file.h"

#include "bench/bake/bench.h"
#include "bench/bake/recomputed_stress.h"
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
struct BenchReduceOptions {
  std::string description = "bodies/bunny.toml";
  std::string beam = "bodies/beam.toml";
  std::string folder = "build/bench-reduce";
  int threads = 0;
  bool json = false;
};

SnapshotStore solved(const std::string& file, const fs::path& folder,
                     const BenchReduceOptions& options,
                     const SnapshotStore* held_out_of = nullptr) {
  ProgressBar bar;
  LocalCrew crew;
  FillSettings settings;
  settings.threads = options.threads;
  settings.store = folder;
  settings.held_out_of = held_out_of;
  FilledStore filled = fill_store(read_body_description(file), settings, crew, bar.progress());
  bar.finish();
  return std::move(filled.store);
}

// Names used in the published results since the first version.
const char* short_name(ReductionMethod method) {
  switch (method) {
    case ReductionMethod::kPgd2:
      return "pgd2";
    case ReductionMethod::kPgd:
      return "pgd3";
    case ReductionMethod::kPod:
      return "pod";
    case ReductionMethod::kCp:
      return "cp";
    case ReductionMethod::kHosvd:
      return "hosvd";
    case ReductionMethod::kPerSite:
      return "per_site";
  }
  return "";
}

void compare(const SnapshotStore& store, Json& result) {
  const StoreContent& content = store.content();
  const auto V = static_cast<Eigen::Index>(content.fixed.size());
  for (const char* name : {"displacement", "stress"}) {
    const StoredField* field = find_field(content, name);
    if (field == nullptr) continue;
    const SnapshotRows rows = snapshot_rows(store, 0, *field);
    const Eigen::MatrixXd gram = gram_of(rows, value_weights(content.mesh, *field));
    const std::string prefix = std::string(name) == "displacement" ? "" : "stress_";
    for (const std::string& method_text : method_names()) {
      const ReductionMethod method = *method_named(method_text);
      const std::string key = short_name(method);
      const MethodFigures figures = try_method(
          gram, rows.sizes,
          {.method = method, .tolerance = 1e-3, .max_modes = 1000, .weight_snapshots = false});
      result[prefix + "modes_at_1e-3"][key] = figures.modes;
      result[prefix + "bytes_at_1e-3"][key] =
          static_cast<long long>(figures.bytes(field->components * V));
      result[prefix + "seconds_at_1e-3"][key] = figures.seconds;
      result[prefix + "worst_snapshot_at_1e-3"][key] = figures.worst;
      result[prefix + "median_snapshot_at_1e-3"][key] = figures.median;
      if (!figures.ranks.empty()) result[prefix + "hosvd_ranks"] = figures.ranks;
      if (method == ReductionMethod::kPerSite) {
        result[prefix + "per_site_modes_in_all_at_1e-3"] = figures.columns;
      }
      if (method == ReductionMethod::kPod) {
        for (const auto& [text, limit] :
             {std::pair{"1e-1", 1e-1}, {"1e-2", 1e-2}, {"1e-3", 1e-3}}) {
          const auto met = std::find_if(figures.errors.begin(), figures.errors.end(),
                                        [&, most = limit](double e) { return e <= most; });
          result[prefix + "pod_modes"][text] = met - figures.errors.begin() + 1;
        }
      }
    }
  }
}

// Errors of touches between sites, with the description's number of sites, and with four and
// sixteen times as many.
void compare_sites(const BenchReduceOptions& options, Json& result) {
  BodyDescription description = read_body_description(options.description);
  const int usual = description.sites.count;
  if (usual < 2 || !description.parameters.empty()) return;  // needs one body with chosen sites
  description.sites.count = 16 * usual;
  description.sites.linear = false;
  const BodyProblem problem = pose_body(description);
  const Boundary& boundary = problem.mesh.boundary;
  const EquilibriumSolver solver(problem.model, {.tolerance = kSnapshotTolerance});
  const SiteSolver presses(solver, boundary, problem.preload);
  const std::vector<Site>& places = problem.linear_sites;  // sites, then touches
  const auto n = static_cast<int>(places.size());
  Eigen::MatrixXf responses(3 * boundary.surface.vertices.cols(), n);
  constexpr int kRow = 16;
  int next = 0;
  LocalCrew crew;
  solve_linear(
      presses, places, kRow, crew.threads(options.threads),
      {[&]() -> std::optional<int> {
         const int first = next;
         next += kRow;
         return first < n ? std::optional(first) : std::nullopt;
       },
       [&](int first, const Eigen::MatrixXf& u) { responses.middleCols(first, u.cols()) = u; }});
  std::vector<int> sites, touches;
  for (const Site& place : places) {
    (static_cast<int>(sites.size()) < 16 * usual ? sites : touches).push_back(place.vertex);
  }
  for (const int count : {usual, 4 * usual, 16 * usual}) {
    const BetweenSites errors = between_sites(
        boundary.surface, std::vector<int>(sites.begin(), sites.begin() + count),
        responses.leftCols(count), touches, responses.rightCols(Eigen::Index(touches.size())));
    result["between_sites"].push_back({{"sites", count},
                                       {"touches", errors.touches},
                                       {"median", errors.median},
                                       {"nine_tenths", errors.nine_tenths},
                                       {"worst", errors.worst}});
  }
}

Json field_figures(const ReductionReport& report) {
  return {{"method", report.method},        {"modes", report.modes},
          {"modes_in_all", report.columns}, {"bytes", static_cast<long long>(report.bytes)},
          {"pooled", report.pooled},        {"median_snapshot", report.median},
          {"worst_snapshot", report.worst}, {"reached", report.reached}};
}

void bench_reduce(const BenchReduceOptions& options) {
  const fs::path folder = options.folder;
  fs::create_directories(folder);
  Json result;
  result["bench"] = "reduce";
  result["body"] = options.description;
  const SnapshotStore bunny = solved(options.description, folder / "body.snapshots", options);
  const SnapshotStore between =
      solved(options.description, folder / "body.held-out", options, &bunny);

  // Time from a folder of snapshots to a body file, in the paper's form and by default.
  const Clock::time_point begin = Clock::now();
  const SnapshotStore store = SnapshotStore::open(bunny.folder());
  ReduceSettings paper;
  paper.method = ReductionMethod::kPgd;
  paper.tolerance = 1e-3;
  const BakedBody pgd = reduce_store(store, paper);
  result["wall_pgd3_s"] = seconds_since(begin);
  const BakedBody body = reduce_store(store, {});
  write_body_file(folder / "body.palpable", body.body);
  result["wall_s"] = seconds_since(begin);
  result["pgd3"] = {{"displacement", field_figures(pgd.report.displacement)},
                    {"stress", field_figures(pgd.report.stress)}};
  result["default"] = {{"displacement", field_figures(body.report.displacement)},
                       {"stress", field_figures(body.report.stress)},
                       {"file_bytes", fs::file_size(folder / "body.palpable")}};

  compare(store, result);

  const auto held_out = [&](const ReducedBody& reduced, const std::string& prefix) {
    const HeldOutErrors errors = held_out_errors(reduced, between);
    result[prefix + "heldout_u_pooled"] = errors.displacement_pooled;
    result[prefix + "heldout_u_median"] = errors.displacement_median();
    result[prefix + "heldout_u_worst"] = errors.displacement.maxCoeff();
    result[prefix + "heldout_vm_median"] = errors.von_mises_median();
    result[prefix + "heldout_vm_worst"] = errors.von_mises.maxCoeff();
  };
  held_out(body.body, "");
  held_out(pgd.body, "pgd3_");
  result["recomputed_stress"] =
      recomputed_stress(read_body_description(options.description), store, between, body.body);
  compare_sites(options, result);

  const SnapshotStore beam = solved(options.beam, folder / "beam.snapshots", options);
  const Clock::time_point sparse_begin = Clock::now();
  const SparseCampaign sparse =
      sparse_campaign(beam, 0, *find_field(beam.content(), "displacement"), {});
  result["sparse_heldout"] = sparse.unseen.pooled;
  result["sparse_heldout_median"] = sparse.unseen.median;
  result["sparse_heldout_worst"] = sparse.unseen.worst;
  result["sparse_modes"] = sparse.model.F.cols();
  result["sparse_trained_on"] = sparse.trained_on;
  result["sparse_samples"] = sparse.all.count;
  result["sparse_validation"] = sparse.model.validation_errors.tail(1)[0];
  result["sparse_s"] = seconds_since(sparse_begin);

  print_figures(std::move(result), options.json);
}

}  // namespace

void add_bench_reduce(Command bench) {
  const auto options = std::make_shared<BenchReduceOptions>();
  Command command = bench.add_subcommand(
      "reduce",
      "All reductions of a campaign, the default body on levels between, sparse PGD on the beam");
  command.add_option("body", options->description, "What to reduce")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--beam", options->beam, "What sparse PGD learns from")
      .type_name("FILE.toml")
      .show_default();
  command
      .add_option("--folder", options->folder,
                  "Snapshots are kept there; what is valid is not solved again")
      .type_name("DIR")
      .show_default();
  add_threads(command, options->threads, "Cores for solves; results do not depend on it");
  command.add_json(options->json);
  command.footer("Example: palpable-bake bench reduce --json");
  command.callback([options] { bench_reduce(*options); });
}

}  // namespace palpable::app
