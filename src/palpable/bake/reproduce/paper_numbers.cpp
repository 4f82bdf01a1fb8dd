#include "palpable/bake/reproduce/paper_numbers.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace palpable {
namespace {

namespace fs = std::filesystem;

Json read_json_file(const fs::path& file) {
  const Result<std::string> text = read_whole_file(file);
  if (!text.ok()) throw Error(fmt::format("{}: {}", file.string(), text.problem().message));
  return value_or_throw(Json::parse(text.value()));
}

std::string modes_of(const ReducedBody& body) {
  return body.provenance.displacement + "; " + body.provenance.stress;
}

std::string mesh_of(const ReducedBody& body) {
  const std::string& mesh = body.provenance.mesh;
  if (mesh.find("nodes") == std::string::npos) {
    return fmt::format("{} nodes and {} triangles on the skin", body.surface.vertices.cols(),
                       body.surface.triangles.cols());
  }
  return mesh.substr(0, mesh.find(';'));
}

// Frames a second and what took the longest, of a run whose film was written, too.
std::string speed_of(const PaperPlan& plan, const std::string& run) {
  const Json stats = read_json_file(plan.settings().out / "runs" / run / "live.json")["stats"];
  std::string stages;
  for (const auto& [stage, ms] : stats["stage_p50_ms"].items()) {
    const double value = ms.get<double>();
    if (value >= 0.5)
      stages += fmt::format("{}{} {:.1f}", stages.empty() ? "" : ", ", stage, value);
  }
  return fmt::format("{:.0f} frames/s, {:.0f} ms of CPU a frame; stages, ms: {}",
                     stats["frames_per_s"].get<double>(), stats["cpu_ms_per_frame"].get<double>(),
                     stages);
}

// The loop as `palpable bench live` counts it.
PaperNumber loop_of(const PaperPlan& plan, const std::string& name, const std::string& remark) {
  const fs::path file = plan.settings().out / "runs" / (name + "-bench.json");
  const Json run = read_json_file(file)["modes"]["source"];
  return {name + ": the loop", "30 frames/s",
          fmt::format("{:.0f} frames/s, {:.0f} ms of CPU a frame", run["fps"].get<double>(),
                      run["cpu_ms_per_frame"].get<double>()),
          remark};
}

void add_solid(const PaperPlan& plan, const StepList& list, const std::string& name,
               const PaperNumber& mesh, const PaperNumber& loads, const std::string& per_site,
               std::vector<PaperNumber>& numbers) {
  const ReducedBody body =
      value_or_throw(read_body_file(plan.settings().out / "bodies" / (name + "-pgd.palpable")));
  const double bake = list.seconds(plan.step(name + "/bake"));
  const auto sites = static_cast<double>(body.sites.size());
  numbers.push_back({mesh.what, mesh.paper, mesh_of(body), mesh.remark});
  numbers.push_back({loads.what, loads.paper,
                     fmt::format("{} x {}", body.sites.size(), body.levels().size() - 1),
                     loads.remark});
  numbers.push_back({name + ": offline, a contact point", per_site, duration_text(bake / sites),
                     "wall time of the whole bake, shared out"});
  numbers.push_back({name + ": offline, all", "-",
                     duration_text(bake + list.seconds(plan.step(name + "/reduce"))),
                     "mesh, finite elements, reductions"});
  numbers.push_back({name + ": modes of the paper's PGD and their relative L2 errors",
                     "in plots only (Figs. 14, 18)", modes_of(body), ""});
  numbers.push_back(
      loop_of(plan, name,
              "`palpable bench live`: 1280 x 720 as a camera sends it, shown; nothing "
              "is written"));
  numbers.push_back({name + ": with its film written", "30 frames/s",
                     speed_of(plan, name + "-live"), "`palpable live --out`, from PNG files"});
  numbers.push_back({name + ": the same, Algorithm 1", "30 frames/s",
                     speed_of(plan, name + "-paper"), "`--contact paper`"});
}

}  // namespace

std::vector<PaperNumber> paper_numbers(const PaperPlan& plan, const StepList& list) {
  std::vector<PaperNumber> numbers;
  numbers.push_back({"hardware", "Intel i7-8700K (six cores), Nvidia RTX 2070; bakes on an i5",
                     processor_name(), "no GPU: drawing is done in software, too"});
  if (plan.has(PaperExample::kBeams)) {
    const ReducedBody body =
        value_or_throw(read_body_file(plan.settings().out / "bodies" / "beam.palpable"));
    numbers.push_back({"beam: mesh", "3,381 nodes, 6,758 elements", mesh_of(body), ""});
    numbers.push_back({"beam: places of the load", "1,749", fmt::format("{}", body.sites.size()),
                       "and the load's size as a parameter"});
    numbers.push_back({"beam: offline", "-", duration_text(list.seconds(plan.step("beams/bake"))),
                       "intrusive PGD, all places at once"});
    numbers.push_back({"beam: modes and relative L2 errors", "not given", modes_of(body), ""});
    numbers.push_back(loop_of(plan, "beams", "both beams answered together"));
    numbers.push_back({"beams: with their film written", "30 frames/s",
                       speed_of(plan, "beams-live"), "`palpable live --out`, from PNG files"});
    numbers.push_back({"beams: the same, Algorithm 1", "30 frames/s", speed_of(plan, "beams-paper"),
                       "`--contact paper`"});
  }
  if (plan.has(PaperExample::kBunny)) {
    add_solid(plan, list, "bunny",
              {"bunny: mesh", "16,519 nodes, 87,916 elements; 3,733 nodes on the skin", "", ""},
              {"bunny: contact points x loads", "34 x 26", "", ""}, "more than 34 min (Abaqus)",
              numbers);
  }
  if (plan.has(PaperExample::kDragon)) {
    add_solid(plan, list, "dragon", {"dragon: mesh", "22,982 nodes, 46,540 elements", "", ""},
              {"dragon: contact points x loads", "32 x 16", "", ""}, "-", numbers);
  }
  return numbers;
}

}  // namespace palpable
