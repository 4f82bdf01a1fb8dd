#include "palpable/live/play/run_options.h"

#include "palpable/common/base/error.h"
#include "palpable/common/response/touch_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>

namespace palpable {
namespace {

constexpr double kMm = 1e3;  // mm per m

PaperSettings paper_settings(const PaperOptions& options) {
  PaperSettings settings;
  if (options.press_distance) settings.press_distance = *options.press_distance;
  if (options.release_distance) settings.release_distance = *options.release_distance;
  if (options.nodes == "all") settings.nodes = QueriedNodes::kAll;
  if (options.distance == "voxmap") settings.distance = DistanceQuery::kVoxmap;
  return settings;
}

Json json_of_paper(const RunOptions& options) {
  if (options.contact != "paper") return nullptr;
  const PaperOptions& paper = options.paper;
  const PaperSettings usual;
  return {{"step", paper.step != 0 ? paper.step : ObjectSurfaceSettings{}.step},
          {"press_m", paper.press_distance.value_or(usual.press_distance)},
          {"release_m", paper.release_distance.value_or(usual.release_distance)},
          {"nodes", paper.nodes.empty() ? "sites" : paper.nodes},
          {"distance", paper.distance.empty() ? "grid" : paper.distance}};
}

PaperOptions paper_of(const Json& json) {
  PaperOptions paper;
  paper.step = json["step"].get<int>();
  if (json.contains("press_mm")) {  // recordings of 0.1
    paper.press_distance = json["press_mm"].get<double>() / kMm;
    paper.release_distance = json["release_mm"].get<double>() / kMm;
  } else {
    paper.press_distance = json["press_m"].get<double>();
    paper.release_distance = json["release_m"].get<double>();
  }
  paper.nodes = json["nodes"].get<std::string>();
  paper.distance = json["distance"].get<std::string>();
  return paper;
}

bool is_one_of(const std::string& word, std::initializer_list<const char*> known) {
  return std::find(known.begin(), known.end(), word) != known.end();
}

// @throws Error for words and numbers that this program does not know
void expect_known(const RunOptions& options) {
  const auto expect = [](const char* what, const std::string& word,
                         std::initializer_list<const char*> known) {
    if (is_one_of(word, known)) return;
    throw Error(fmt::format("its {} is '{}', which this program does not know", what, word));
  };
  expect("contact", options.contact, {"", "anywhere", "site", "paper"});
  expect("matcher", options.matcher, {"census", "opencv"});
  expect("depth", options.depth, {"", "half", "full", "auto"});
  if (options.friction && !is_friction(*options.friction)) {
    throw Error(fmt::format("its coefficient of friction is {}", *options.friction));
  }
  const PaperOptions& paper = options.paper;
  if (paper.step < 0 || !is_one_of(paper.nodes, {"", "sites", "all"}) ||
      !is_one_of(paper.distance, {"", "grid", "voxmap"})) {
    throw Error(fmt::format("its --contact paper has step {}, nodes '{}' and distance '{}'",
                            paper.step, paper.nodes, paper.distance));
  }
  paper.check(options.contact);
}

}  // namespace

void PaperOptions::check(const std::string& contact) const {
  const char* given = step != 0           ? "--paper-step"
                      : press_distance    ? "--paper-press"
                      : release_distance  ? "--paper-release"
                      : !nodes.empty()    ? "--paper-nodes"
                      : !distance.empty() ? "--paper-distance"
                                          : nullptr;
  if (given == nullptr) return;
  if (contact != "paper")
    throw Error(fmt::format("{} is of --contact paper: give that, too", given));
  const PaperSettings settings = paper_settings(*this);
  if (!(settings.press_distance > 0 && settings.press_distance < settings.release_distance)) {
    throw Error(
        fmt::format("--paper-press {:g} mm must be above 0 and below --paper-release {:g} mm",
                    kMm * settings.press_distance, kMm * settings.release_distance));
  }
}

void set_depth(std::string_view size, double farthest, DepthSettings& depth) {
  constexpr int kSmall = 640;  // px; "auto" matches pictures up to this width at full resolution
  depth.full_resolution = size == "full";
  depth.full_up_to_px = size == "auto" ? kSmall : 0;
  if (farthest > 0) depth.farthest = farthest;
}

SessionSettings session_settings(const RunOptions& options) {
  SessionSettings settings;
  if (options.matcher == "opencv") settings.depth.matcher = DepthSettings::Matcher::kOpenCv;
  set_depth(options.depth, options.farthest, settings.depth);
  settings.contact = options.contact == "paper"  ? ContactKind::kPaper
                     : options.contact == "site" ? ContactKind::kSite
                                                 : ContactKind::kAnywhere;
  settings.paper = paper_settings(options.paper);
  if (options.paper.step != 0) settings.surface.step = options.paper.step;
  settings.track = !options.fixed_camera;
  settings.map = true;
  settings.press_static = options.press_static;
  settings.dynamics = options.dynamics.value_or(false);
  return settings;
}

void add_run_options(const RunOptions& options, Json& run) {
  run["contact"] = options.contact;
  run["paper"] = json_of_paper(options);
  run["matcher"] = options.matcher;
  run["depth"] = options.depth;
  run["farthest"] = options.farthest;
  run["fixed_camera"] = options.fixed_camera;
  run["press_static"] = options.press_static;
  run["friction"] = options.friction ? Json(*options.friction) : Json();
  run["dynamics"] = options.dynamics.value_or(false);
  run["refine"] = options.refine.string();
}

RunOptions run_options_of(const Json& run) {
  RunOptions options;
  options.contact = run["contact"].get<std::string>();
  // Recordings of earlier versions do not have it: defaults apply.
  if (run.contains("paper") && !run["paper"].is_null()) options.paper = paper_of(run["paper"]);
  options.matcher = run["matcher"].get<std::string>();
  if (run.contains("depth")) {  // recordings without it used half resolution
    options.depth = run["depth"].get<std::string>();
    options.farthest = run["farthest"].get<double>();
  }
  options.fixed_camera = run["fixed_camera"].get<bool>();
  options.press_static = run["press_static"].get<bool>();
  // Recordings of earlier versions do not have it: they were made without friction.
  if (!run.contains("friction")) {
    options.friction = 0;
  } else if (!run["friction"].is_null()) {
    options.friction = run["friction"].get<double>();
  }
  // Likewise: they were made without inertia.
  options.dynamics = run.contains("dynamics") && run["dynamics"].get<bool>();
  options.refine = run["refine"].get<std::string>();
  expect_known(options);
  return options;
}

}  // namespace palpable
