#include "palpable/bake/reproduce/paper_numbers.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string_view>

namespace palpable {
namespace {

namespace fs = std::filesystem;

Json read_json_file(const fs::path& file) {
  return value_or_throw(Json::parse(value_or_throw(read_bounded_text(file, Notation::kJson))));
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
std::string loop_of(const PaperPlan& plan, const std::string& example) {
  const fs::path file = plan.settings().out / "runs" / (example + "-bench.json");
  const Json run = read_json_file(file)["modes"]["source"];
  return fmt::format("{:.0f} frames/s, {:.0f} ms of CPU a frame", run["fps"].get<double>(),
                     run["cpu_ms_per_frame"].get<double>());
}

// Our number of a name in paper.toml.
std::string measured(const std::string& name, const std::string& example, const ReducedBody& body,
                     const PaperPlan& plan, const StepList& list) {
  const auto seconds = [&](const char* step) {
    return list.seconds(plan.step(example + "/" + step));
  };
  const std::size_t sites = body.sites.size();
  if (name == "mesh") return mesh_of(body);
  if (name == "modes") return modes_of(body);
  if (name == "sites") return fmt::format("{}", sites);
  if (name == "sites x loads") return fmt::format("{} x {}", sites, body.levels().size() - 1);
  if (name == "bake") return duration_text(seconds("bake"));
  if (name == "bake per site") return duration_text(seconds("bake") / static_cast<double>(sites));
  if (name == "bake and reduction") return duration_text(seconds("bake") + seconds("reduce"));
  if (name == "loop") return loop_of(plan, example);
  PALPABLE_EXPECT(name == "live run" || name == "paper run", "paper.toml names a number of ours");
  return speed_of(plan, example + (name == "live run" ? "-live" : "-paper"));
}

}  // namespace

std::vector<PaperNumber> paper_numbers(const PaperPlan& plan, const StepList& list) {
  std::vector<PaperNumber> numbers;
  numbers.push_back({"hardware", "Intel i7-8700K (six cores), Nvidia RTX 2070; bakes on an i5",
                     processor_name(), "no GPU: drawing is done in software, too"});
  std::map<std::string, ReducedBody> bodies;  // by example
  for (PaperEntry& entry : plan.entries("number")) {
    const std::string& example = entry.example;
    if (!bodies.contains(example)) {
      const std::string name = example == "beams" ? "beam" : example + "-pgd";
      bodies.emplace(example, value_or_throw(read_body_file(plan.settings().out / "bodies" /
                                                            (name + ".palpable"))));
    }
    numbers.push_back({entry.text("what"), entry.text("paper"),
                       measured(entry.text("here"), example, bodies.at(example), plan, list),
                       entry.text_or_empty("remark")});
    entry.section.refuse_unknown();
  }
  return numbers;
}

}  // namespace palpable
