#include "palpable/live/play/live_set_up.h"

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/geometry/body_scale.h"
#include "palpable/live/sources/frame_format_json.h"
#include "palpable/live/sources/paced_source.h"
#include "palpable/live/sources/recording_file.h"
#include "palpable/live/sources/wall_clock.h"

#include <fmt/core.h>

#include <charconv>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

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

Json json_of_body(const DescribedBody& body, const SessionBody& placed) {
  const fs::path file = fs::absolute(body.file);
  const Result<std::uint64_t> checksum = file_checksum(file);
  if (!checksum.ok()) {
    throw Error(fmt::format("{}: {}", file.string(), checksum.problem().message));
  }
  return {{"file", file.string()},
          {"checksum", fmt::format("{:016x}", checksum.value())},
          {"name", placed.name},
          {"scale", body.scale},
          {"set", body.set},
          {"color", json_of_color(body.color)},
          {"friction", body.friction ? Json(*body.friction) : Json()},
          {"world_from_body", json_of(placed.world_from_body)}};
}

RecordedRun::Body body_of(const Json& json) {
  RecordedRun::Body body;
  body.body.file = json["file"].get<std::string>();
  body.checksum = checksum_of(json["checksum"].get<std::string>());
  body.body.name = json["name"].get<std::string>();
  body.body.scale = json["scale"].get<double>();
  for (const Json& value : json["set"]) body.body.set.push_back(value.get<std::string>());
  body.body.color = color_of(json["color"]);
  if (json.contains("friction") && !json["friction"].is_null()) {
    body.body.friction = json["friction"].get<double>();
  }
  body.world_from_body = rigid_of(json["world_from_body"]);
  return body;
}

bool has_checksum(const fs::path& file, std::uint64_t checksum) {
  const Result<std::uint64_t> found = file_checksum(file);
  return found.ok() && found.value() == checksum;
}

// Repeats the recorded behaviour of the live run's refiner, without starting a process.
Refiner recorded_refiner(const fs::path& file) {
  // Shared, because std::function must be copyable; there is no other owner.
  const auto recorded =
      std::make_shared<RecordedRefinements>(value_or_throw(RecordedRefinements::open(file)));
  return Refiner::repeating([recorded](int n, RefinerStep& step) {
    RecordedRefinement refinement;
    recorded->read(n, refinement);
    step.asked = refinement.asked;
    step.exact.swap(refinement.exact);
  });
}

}  // namespace

TouchableBody read_live_body(const DescribedBody& wanted, const std::string& contact,
                             std::optional<double> friction) {
  const std::map<std::string, double> values = parse_settings(wanted.set);
  // The contact laws at sites do not need the body's tables.
  const bool at_sites = contact == "site" || contact == "paper";
  TouchableBody body = at_sites
                           ? TouchableBody(value_or_throw(read_pressable_body(wanted.file, values)))
                           : value_or_throw(read_pressable_touchable_body(wanted.file, values));
  if (contact == "anywhere" && !body.touch && !body.modal) {
    throw Error(fmt::format(
        "{}: has no tables of touch for --contact anywhere; bake it with [touch] tables = \"full\" "
        "in its description, without [[parameter]], or leave --contact out",
        wanted.file.string()));
  }
  const std::optional<double> mu = friction ? friction : wanted.friction;
  if (mu) set_friction(body, *mu);
  return wanted.scale == 1 ? std::move(body) : scaled(body, wanted.scale);
}

Json json_of_run(const LiveSetUp& setup) {
  const Session& session = setup.run.loop.session;
  RunOptions options = setup.options;
  options.press_static = session.settings().press_static;  // may be from scene.toml
  Json run{{"version", setup.version},
           {"source", setup.run.images.string()},
           {"scene", setup.scene.empty() ? "" : fs::absolute(setup.scene).string()}};
  add_run_options(options, run);
  Json bodies = Json::array();
  for (int k = 0; k < session.body_count(); ++k) {
    bodies.push_back(json_of_body(setup.bodies[static_cast<std::size_t>(k)], session.body(k)));
  }
  run["bodies"] = std::move(bodies);
  return run;
}

RecordedRun recorded_run_of(const Json& json) {
  RecordedRun run;
  run.version = json["version"].get<std::string>();
  run.source = json["source"].get<std::string>();
  run.scene = json["scene"].get<std::string>();
  for (const Json& body : json["bodies"]) run.bodies.push_back(body_of(body));
  if (run.bodies.empty()) throw Error("it says of no body where it stood");
  run.options = run_options_of(json);
  for (const RecordedRun::Body& body : run.bodies) {
    if (body.body.friction && !is_friction(*body.body.friction)) {
      throw Error(fmt::format("the body '{}' has the coefficient of friction {}", body.body.name,
                              *body.body.friction));
    }
    if (!is_scale(body.body.scale)) {
      throw Error(fmt::format("the body '{}' has the scale {}, not within {} and {}",
                              body.body.name, body.body.scale, kLeastScale, kMostScale));
    }
  }
  return run;
}

void find_body_files(RecordedRun& run, const std::vector<std::string>& elsewhere) {
  for (RecordedRun::Body& body : run.bodies) {
    fs::path& file = body.body.file;
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

LiveSetUp set_up_replay(const RecordedRun& run, const fs::path& file, int threads, bool at_pace) {
  std::vector<PlacedBody> standing;
  std::vector<DescribedBody> bodies;
  for (const auto& [body, checksum, world_from_body] : run.bodies) {
    standing.push_back({read_live_body(body, run.options.contact, run.options.friction),
                        world_from_body, body.name, body.color});
    bodies.push_back(body);
  }
  std::unique_ptr<FrameSource> source = value_or_throw(open_recording(file));
  if (at_pace) source = paced(std::move(source), system_clock(), Late::kKept);
  SessionSettings settings = session_settings(run.options);
  share_threads(threads, settings);
  LiveSetUp setup{.run = run_of(std::move(standing), std::move(source), settings, file),
                  .bodies = std::move(bodies),
                  .options = run.options,
                  .scene = run.scene};
  if (!run.options.refine.empty()) setup.run.loop.session.refine_with(recorded_refiner(file));
  return setup;
}

}  // namespace palpable
