#include "palpable/bake/reproduce/paper_plan.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr Range kAnyTime{0, 1e6};  // s

constexpr std::array kExamples{std::pair{PaperExample::kBeams, "beams"},
                               std::pair{PaperExample::kBunny, "bunny"},
                               std::pair{PaperExample::kDragon, "dragon"}};

Step step_of(PaperEntry entry, const PlanSettings& settings) {
  TomlSection& section = entry.section;
  Step step;
  step.what = entry.text("what");
  step.program = settings.program;
  step.own_folder = entry.text_or_empty("folder");
  entry.values.emplace_back("{folder}", step.own_folder.string());
  step.product = entry.text("product");
  entry.values.emplace_back("{product}", step.product.string());
  std::istringstream command(section.text("command"));
  for (std::string word; command >> word;) step.words.push_back(entry.filled(word));
  const std::string without_touch = entry.text_or_empty("without_touch");
  if (!settings.touch && !without_touch.empty()) step.words.push_back(without_touch);
  if (section.has("frames")) {
    step.words.emplace_back("--frame-pictures");
    for (const int frame : film_frames(section.text("frames"))) {
      step.words.push_back(std::to_string(frame));
    }
  }
  step.seconds = section.number("seconds", kAnyTime);
  const double touch_seconds = section.number("touch_seconds", kAnyTime, step.seconds);
  if (settings.touch) step.seconds = touch_seconds;
  step.is_bake = section.flag("is_bake", false);
  step.prints_product = section.flag("prints_product", false);
  section.refuse_unknown();
  return step;
}

}  // namespace

PaperPlan::PaperPlan(PlanSettings settings, const std::vector<PaperExample>& examples)
    : settings_(std::move(settings)), examples_(examples) {
  const fs::path meshes = settings_.root / "build" / "meshes";
  if (!fs::exists(meshes / "beam.inp") || !fs::exists(meshes / "dragon.ply") ||
      !fs::exists(meshes / "bunny.off")) {
    steps_.emplace_back("meshes", Step{.what = "the meshes of bodies/",
                                       .program = settings_.root / "tools" / "setup.sh",
                                       .words = {"bodies"},
                                       .product = meshes / "dragon.ply",
                                       .seconds = 30});
  }
  for (PaperEntry& entry : entries("step")) {
    const std::string name = entry.text("name");
    const bool needs_touch = entry.section.flag("needs_touch", false);
    if (needs_touch && !settings_.touch) continue;
    steps_.emplace_back(name, step_of(std::move(entry), settings_));
  }
}

bool PaperPlan::has(PaperExample example) const {
  return std::find(examples_.begin(), examples_.end(), example) != examples_.end();
}

std::vector<Step> PaperPlan::steps() const {
  std::vector<Step> all;
  std::transform(steps_.begin(), steps_.end(), std::back_inserter(all),
                 [](const auto& named) { return named.second; });
  return all;
}

const Step& PaperPlan::step(std::string_view name) const {
  const auto found = std::find_if(steps_.begin(), steps_.end(),
                                  [&](const auto& named) { return named.first == name; });
  PALPABLE_EXPECT(found != steps_.end(), "a step of that name is planned");
  return found->second;
}

std::vector<PaperEntry> PaperPlan::entries(const char* list) const {
  std::vector<PaperEntry> all;
  for (const auto& [example, name] : kExamples) {
    if (!has(example)) continue;
    const std::vector<PaperEntry> its_own =
        paper_entries(list, name,
                      {{"{example}", name},
                       {"{contact}", settings_.touch ? "anywhere" : "site"},
                       {"{live}", settings_.touch ? "anywhere" : "live"},
                       {"{root}", settings_.root.string()},
                       {"{out}", settings_.out.string()}});
    all.insert(all.end(), its_own.begin(), its_own.end());
  }
  return all;
}

void PaperPlan::write_inputs() const {
  if (!has(PaperExample::kBeams)) return;
  const fs::path scene = settings_.root / "scenes" / "crossed-beams.toml";
  std::string text = value_or_throw(read_bounded_text(scene, Notation::kToml));
  text = replaced(text, "\"../out/bodies/", "\"../bodies/");
  text = replaced(text, "\"../bodies/beam.toml\"",
                  fmt::format("\"{}\"", (settings_.root / "bodies" / "beam.toml").string()));
  make_folder(settings_.out / "scenes");
  write_whole_file(settings_.out / "scenes" / "crossed-beams.toml", text);
}

}  // namespace palpable
