#include "palpable/bake/reproduce/paper_plan.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace palpable {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

Words operator+(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

Words frame_words(std::initializer_list<int> frames) {
  Words words{"--frame-pictures"};
  for (const int frame : frames) words.push_back(std::to_string(frame));
  return words;
}

// Leaves out masks and depth: a run writes its film and its texts only.
const Words kFilmOnly{"--no-masks", "--no-depth"};

}  // namespace

PaperPlan::PaperPlan(PlanSettings settings, const std::vector<PaperExample>& examples)
    : settings_(std::move(settings)), examples_(examples) {
  const fs::path meshes = settings_.root / "build" / "meshes";
  if (!fs::exists(meshes / "beam.inp") || !fs::exists(meshes / "dragon.ply") ||
      !fs::exists(meshes / "bunny.off")) {
    add("meshes", {.what = "the meshes of bodies/",
                   .program = settings_.root / "tools" / "setup.sh",
                   .words = {"bodies"},
                   .product = meshes / "dragon.ply",
                   .seconds = 30});
  }
  if (has(PaperExample::kBeams)) add_beams();
  if (has(PaperExample::kBunny)) {
    add_solid("bunny", 260);
    add_room();
  }
  if (has(PaperExample::kDragon)) add_solid("dragon", 330);
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

void PaperPlan::add(const std::string& name, Step step) {
  if (step.program.empty()) step.program = settings_.program;
  steps_.emplace_back(name, std::move(step));
}

void PaperPlan::add_run(const std::string& name, const std::string& what, const Words& body,
                        const std::string& film, const Words& words, double seconds) {
  const fs::path out = settings_.out / "runs" / replaced(name, "/", "-");
  add(name, {.what = what,
             .words = Words{"live"} + body +
                      Words{"--source", (settings_.out / "films" / film / "frames").string(),
                            "--out", out.string()} +
                      kFilmOnly + words,
             .product = out / "live.json",
             .seconds = seconds,
             .own_folder = out});
}

// The loop alone, as a camera feeds it: its pictures are in memory, and nothing is written.
void PaperPlan::add_bench(const std::string& name, const Words& body, const Words& words) {
  const fs::path out = settings_.out / "runs" / (name + "-bench.json");
  add(name + "/bench",
      {.what = name + ": frames a second of the loop",
       .words = Words{"bench", "live"} + body +
                Words{"--source", (settings_.out / "films" / name / "frames").string(), "--film",
                      "120", "--frames", "150", "--json"} +
                words,
       .product = out,
       .seconds = 10,
       .prints_product = true});
}

void PaperPlan::write_inputs() const {
  if (!has(PaperExample::kBeams)) return;
  const fs::path scene = settings_.root / "scenes" / "crossed-beams.toml";
  std::string text = value_or_throw(read_whole_file(scene));
  text = replaced(text, "\"../out/bodies/", "\"../bodies/");
  text = replaced(text, "\"../bodies/beam.toml\"",
                  fmt::format("\"{}\"", (settings_.root / "bodies" / "beam.toml").string()));
  make_folder(settings_.out / "scenes");
  write_whole_file(settings_.out / "scenes" / "crossed-beams.toml", text);
}

void PaperPlan::add_beams() {
  using F = FigureFrames;
  const fs::path body = settings_.out / "bodies" / "beam.palpable";
  const fs::path film = settings_.out / "films" / "beams";
  const Words scene{"--scene", (settings_.out / "scenes" / "crossed-beams.toml").string()};
  add("beams/bake", {.what = "beam: intrusive PGD over all positions of the load",
                     .words = {"bake", (settings_.root / "bodies" / "beam.toml").string(),
                               "--method", "intrusive-pgd", "-o", body.string()},
                     .product = body,
                     .seconds = 150,
                     .is_bake = true});
  const fs::path page = settings_.out / "reports" / "beam.html";
  add("beams/report", {.what = "beam: its errors and functions",
                       .words = {"report", body.string(), "-o", page.string()},
                       .product = page,
                       .seconds = 10});
  const fs::path modes = settings_.out / "pictures" / "beam-modes";
  add("beams/modes", {.what = "beam: its modes",
                      .words = {"view", body.string(), "--modes", "6", "--size", "1280x800",
                                "--out", modes.string()},
                      .product = modes / "modes.png",
                      .seconds = 10});
  add("beams/film", {.what = "beams: a film of the synthetic desk",
                     .words = Words{"synth", "beams"} + scene +
                              Words{"--frames", "240", "--seed", "5", "-o", film.string()},
                     .product = film / "truth" / "script.toml",
                     .seconds = 45,
                     .own_folder = film});
  const Words frames = frame_words({F::kBeamsAtRest, F::kBeamsPressed, F::kBeamsBoth});
  add_run("beams/live", "beams: live", scene, "beams", frames, 20);
  add_run("beams/paper", "beams: live, by Algorithm 1 as printed", scene, "beams",
          Words{"--contact", "paper"} + frames, 20);
  add_bench("beams", scene, {});
}

void PaperPlan::add_solid(const std::string& name, double bake_seconds) {
  using F = FigureFrames;
  const fs::path bodies = settings_.out / "bodies";
  const std::string body = (bodies / (name + ".palpable")).string();
  const std::string pgd = (bodies / (name + "-pgd.palpable")).string();
  const fs::path film = settings_.out / "films" / name;
  Words bake{"bake", (settings_.root / "bodies" / (name + ".toml")).string(), "-o", body};
  if (!settings_.touch) bake.push_back("--no-touch");
  add(name + "/bake", {.what = name + ": finite elements at its sites",
                       .words = bake,
                       .product = body,
                       .seconds = settings_.touch ? 4 * bake_seconds : bake_seconds,
                       .is_bake = true});
  add(name + "/reduce",
      {.what = name + ": the paper's PGD",
       .words = {"reduce", (bodies / (name + ".snapshots")).string(), "--method", "pgd", "-o", pgd},
       .product = pgd,
       .seconds = 15,
       .is_bake = true});
  const fs::path page = settings_.out / "reports" / (name + ".html");
  add(name + "/report", {.what = name + ": errors against modes",
                         .words = {"report", pgd, "-o", page.string()},
                         .product = page,
                         .seconds = 10});
  const fs::path modes = settings_.out / "pictures" / (name + "-modes");
  add(name + "/modes",
      {.what = name + ": its modes",
       .words = {"view", pgd, "--modes", "4", "--size", "1280x800", "--out", modes.string()},
       .product = modes / "modes.png",
       .seconds = 10});
  const fs::path stress = settings_.out / "pictures" / (name + "-stress-modes");
  add(name + "/stress-modes", {.what = name + ": its modes of stress",
                               .words = {"view", pgd, "--modes", "4", "--modes-of", "stress",
                                         "--size", "1280x800", "--out", stress.string()},
                               .product = stress / "modes.png",
                               .seconds = 10});
  const fs::path sites = settings_.out / "pictures" / (name + "-sites");
  add(name + "/sites", {.what = name + ": contact points, and presses that grow",
                        .words = {"view", body, "--site", "7", "--out", sites.string()},
                        .product = sites / "contact_sheet.png",
                        .seconds = 10,
                        .own_folder = sites});
  add(name + "/film",
      {.what = name + ": a film of the synthetic desk",
       .words = {"synth", "demo", "--body", body, "--seed", "1", "-o", film.string()},
       .product = film / "truth" / "script.toml",
       .seconds = 55,
       .own_folder = film});
  const Words frames =
      frame_words({F::kFlank, F::kBack, F::kHandBefore, F::kEar, F::kHandBehind, F::kSqueeze});
  add_run(name + "/live", name + ": live", {body}, name, Words{"--contact", "site"} + frames, 20);
  add_run(name + "/paper", name + ": live, by Algorithm 1 as printed", {body}, name,
          Words{"--contact", "paper"} + frames, 20);
  add_bench(name, {body}, {"--contact", settings_.touch ? "anywhere" : "site"});
  if (settings_.touch) {
    add_run(name + "/anywhere", name + ": live, touched anywhere", {body}, name,
            Words{"--contact", "anywhere"} + frames, 20);
  }
  if (name != "bunny") return;
  add_run("bunny/hard", "bunny: live, hidden pixel by pixel", {body}, name,
          Words{"--contact", "site", "--occlusion", "hard"} + frames, 20);
  add_run("bunny/depth", "bunny: the depth that is measured", {body}, name,
          Words{"--view", "depth"} + frames, 20);
  add_run("bunny/surface", "bunny: the surface that touches it", {body}, name,
          Words{"--view", "surface"} + frames, 20);
}

void PaperPlan::add_room() {
  const std::string body = (settings_.out / "bodies" / "bunny.palpable").string();
  const fs::path film = settings_.out / "films" / "walk";
  add("room/film", {.what = "room: a film by a camera that walks",
                    .words = {"synth", "walk", "--body", body, "--frames", "450", "--seed", "1",
                              "-o", film.string()},
                    .product = film / "truth" / "script.toml",
                    .seconds = 75,
                    .own_folder = film});
  add_run("room/live", "room: trajectory and map", {body}, "walk",
          Words{"--view", "map"} + frame_words({449}), 35);
}

}  // namespace palpable
