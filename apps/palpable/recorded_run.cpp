#include "apps/palpable/recorded_run.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/live/sources/frame_format_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

namespace palpable::app {
namespace {

std::string hex(std::uint64_t checksum) { return fmt::format("{:016x}", checksum); }

std::uint64_t checksum_of(const std::string& text) {
  std::uint64_t checksum = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), checksum, 16);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw Error(fmt::format("'{}' is no checksum", text));
  }
  return checksum;
}

Json json_of_color(const std::optional<Rgb>& color) {
  if (!color) return nullptr;
  return Json::array({color->r, color->g, color->b});
}

std::optional<Rgb> color_of(const Json& json) {
  if (json.is_null()) return std::nullopt;
  const auto shade = [&](int k) { return static_cast<std::uint8_t>(json[k].get<int>() & 0xff); };
  return Rgb{shade(0), shade(1), shade(2)};
}

RecordedRun::Body body_of(const Json& json) {
  RecordedRun::Body body;
  body.body.file = json["file"].get<std::string>();
  body.checksum = checksum_of(json["checksum"].get<std::string>());
  body.body.name = json["name"].get<std::string>();
  body.body.scale = json["scale"].get<double>();
  for (const Json& value : json["set"]) body.body.set.push_back(value.get<std::string>());
  body.body.color = color_of(json["color"]);
  body.world_from_body = rigid_of(json["world_from_body"]);
  return body;
}

// Replaces defaults by their values, so that a replay does not change when a default changes.
PaperOptions written_out(PaperOptions paper) {
  const PaperSettings usual;
  if (paper.step == 0) paper.step = ObjectSurfaceSettings{}.step;
  if (!paper.press_mm) paper.press_mm = 1e3 * usual.press_distance;
  if (!paper.release_mm) paper.release_mm = 1e3 * usual.release_distance;
  if (paper.nodes.empty()) paper.nodes = "sites";
  if (paper.distance.empty()) paper.distance = "grid";
  return paper;
}

Json json_of_paper(const LiveOptions& options) {
  if (options.contact != "paper") return nullptr;
  const PaperOptions& paper = options.paper;
  return {{"step", paper.step},
          {"press_mm", paper.press_mm},
          {"release_mm", paper.release_mm},
          {"nodes", paper.nodes},
          {"distance", paper.distance}};
}

PaperOptions paper_of(const Json& json) {
  PaperOptions paper;
  paper.step = json["step"].get<int>();
  paper.press_mm = json["press_mm"].get<double>();
  paper.release_mm = json["release_mm"].get<double>();
  paper.nodes = json["nodes"].get<std::string>();
  paper.distance = json["distance"].get<std::string>();
  return paper;
}

bool has_checksum(const std::filesystem::path& file, std::uint64_t checksum) {
  const Result<std::uint64_t> found = file_checksum(file);
  return found.ok() && found.value() == checksum;
}

}  // namespace

RecordedRun recorded_run(const LiveOptions& options, const LiveSetUp& setup) {
  const Session& session = setup.run.loop.session;
  RecordedRun run;
  run.version = PALPABLE_VERSION;
  run.source = setup.run.images.string();
  if (!options.scene.empty()) run.scene = std::filesystem::absolute(options.scene);
  run.options.contact = options.contact;
  if (options.contact == "paper") run.options.paper = written_out(options.paper);
  run.options.matcher = options.matcher;
  run.options.input.depth = depth_size(options.input);
  run.options.input.farthest = options.input.farthest;
  run.options.fixed_camera = options.fixed_camera;
  run.options.refine = options.refine;
  run.options.press_static = session.settings().press_static;  // may be from scene.toml
  for (int k = 0; k < session.body_count(); ++k) {
    RecordedRun::Body& body = run.bodies.emplace_back();
    body.body = setup.bodies[static_cast<std::size_t>(k)];
    body.body.file = std::filesystem::absolute(body.body.file);
    body.body.name = session.body(k).name;
    body.world_from_body = session.body(k).world_from_body;
    const Result<std::uint64_t> checksum = file_checksum(body.body.file);
    if (!checksum.ok()) {
      throw Error(fmt::format("{}: {}", body.body.file.string(), checksum.problem().message));
    }
    body.checksum = checksum.value();
  }
  return run;
}

Json json_of_run(const RecordedRun& run) {
  Json bodies = Json::array();
  for (const RecordedRun::Body& body : run.bodies) {
    bodies.push_back(Json{{"file", body.body.file.string()},
                          {"checksum", hex(body.checksum)},
                          {"name", body.body.name},
                          {"scale", body.body.scale},
                          {"set", body.body.set},
                          {"color", json_of_color(body.body.color)},
                          {"world_from_body", json_of(body.world_from_body)}});
  }
  return {{"version", run.version},
          {"source", run.source},
          {"scene", run.scene.string()},
          {"contact", run.options.contact},
          {"paper", json_of_paper(run.options)},
          {"matcher", run.options.matcher},
          {"depth", run.options.input.depth},
          {"farthest", run.options.input.farthest},
          {"fixed_camera", run.options.fixed_camera},
          {"press_static", run.options.press_static},
          {"refine", run.options.refine.string()},
          {"bodies", bodies}};
}

RecordedRun recorded_run_of(const Json& json) {
  RecordedRun run;
  run.version = json["version"].get<std::string>();
  run.source = json["source"].get<std::string>();
  run.scene = json["scene"].get<std::string>();
  run.options.contact = json["contact"].get<std::string>();
  // Recordings of earlier versions do not have it: defaults apply.
  if (json.contains("paper") && !json["paper"].is_null()) {
    run.options.paper = paper_of(json["paper"]);
  }
  run.options.matcher = json["matcher"].get<std::string>();
  if (json.contains("depth")) {  // recordings without it used half resolution
    run.options.input.depth = json["depth"].get<std::string>();
    run.options.input.farthest = json["farthest"].get<double>();
  }
  run.options.fixed_camera = json["fixed_camera"].get<bool>();
  run.options.press_static = json["press_static"].get<bool>();
  run.options.refine = json["refine"].get<std::string>();
  for (const Json& body : json["bodies"]) run.bodies.push_back(body_of(body));
  if (run.bodies.empty()) throw Error("it says of no body where it stood");
  const auto is_one_of = [](const std::string& word, std::initializer_list<const char*> known) {
    return std::find(known.begin(), known.end(), word) != known.end();
  };
  if (!is_one_of(run.options.contact, {"", "anywhere", "site", "paper"})) {
    throw Error(
        fmt::format("its contact is '{}', which this program does not know", run.options.contact));
  }
  if (!is_one_of(run.options.matcher, {"census", "opencv"})) {
    throw Error(
        fmt::format("its matcher is '{}', which this program does not know", run.options.matcher));
  }
  if (!is_one_of(run.options.input.depth, {"", "half", "full", "auto"})) {
    throw Error(fmt::format("its depth is '{}', which this program does not know",
                            run.options.input.depth));
  }
  const PaperOptions& paper = run.options.paper;
  if (paper.step < 0 || !is_one_of(paper.nodes, {"", "sites", "all"}) ||
      !is_one_of(paper.distance, {"", "grid", "voxmap"})) {
    throw Error(fmt::format("its --contact paper has step {}, nodes '{}' and distance '{}'",
                            paper.step, paper.nodes, paper.distance));
  }
  paper.check(run.options.contact);
  for (const RecordedRun::Body& body : run.bodies) {
    if (!(body.body.scale > 0)) {
      throw Error(fmt::format("the body '{}' has the scale {}", body.body.name, body.body.scale));
    }
  }
  return run;
}

void find_body_files(RecordedRun& run, const std::vector<std::string>& elsewhere) {
  for (RecordedRun::Body& body : run.bodies) {
    std::filesystem::path& file = body.body.file;
    bool found = has_checksum(file, body.checksum);
    for (const std::string& other : elsewhere) {
      if (found) break;
      found = has_checksum(other, body.checksum);
      if (found) file = other;
    }
    if (found) continue;
    const char* why = !elsewhere.empty()         ? "and no file of --body is that one (checksum)"
                      : file_checksum(file).ok() ? "and that is another file now (checksum)"
                                                 : "which is not there";
    throw Error(fmt::format("the body '{}' was read from {}, {}; name that file with --body",
                            body.body.name, file.string(), why));
  }
}

}  // namespace palpable::app
