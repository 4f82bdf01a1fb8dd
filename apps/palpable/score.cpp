// palpable score: what a live run did against the truth of its clip.
//
//   TRUTH/hand.jsonl contact.jsonl depth/%06d.png      as palpable synth writes them
//   RESULT/touches.jsonl live.json visible/ body_depth/ as palpable live writes them

#include "apps/palpable/commands.h"
#include "palpable/base/error.h"
#include "palpable/geometry/rigid.h"
#include "palpable/reduced/body_file.h"
#include "palpable/render/picture_file.h"
#include "palpable/score/occlusion.h"
#include "palpable/score/penetration.h"
#include "palpable/score/percentile.h"
#include "palpable/score/touch_score.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kDepthUnit = 1e-4;  // m per count in depth PNGs

struct Options {
  fs::path truth;
  fs::path result;
  fs::path body;
  bool json = false;
};

std::ifstream open_text(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw Error(fmt::format("{}: cannot be read", path.string()));
  return in;
}

// One object per line; `take` may throw json errors, which then name file and line.
template <class Take>
void for_each_line(const fs::path& path, Take take) {
  std::ifstream in = open_text(path);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty()) continue;
    try {
      take(json::parse(line));
    } catch (const json::exception& error) {
      throw Error(fmt::format("{}: line {}: {}", path.string(), number, error.what()));
    }
  }
}

struct FoundTouch {
  int site = 0;
  double level = 0;
};

struct Run {
  int frames = 0;  // of the truth
  std::vector<std::uint8_t> truly_touching;
  std::map<int, std::vector<TrueCapsule>> hands;
  std::vector<std::uint8_t> processed;
  std::map<int, FoundTouch> touches;
  Rigid3 camera_from_body = Rigid3::Identity();
};

Run read_run(const fs::path& truth, const fs::path& result) {
  Run run;
  for_each_line(truth / "contact.jsonl", [&](const json& line) {
    const auto frame = line.at("frame").get<std::size_t>();
    if (frame >= 10'000'000) throw Error(fmt::format("contact.jsonl: frame {}", frame));
    if (run.truly_touching.size() <= frame) run.truly_touching.resize(frame + 1, 0);
    run.truly_touching[frame] = line.at("touching").get<bool>() ? 1 : 0;
  });
  run.frames = static_cast<int>(run.truly_touching.size());
  for_each_line(truth / "hand.jsonl", [&](const json& line) {
    std::vector<TrueCapsule>& hand = run.hands[line.at("frame").get<int>()];
    for (const json& c : line.at("capsules")) {
      const auto v = c.get<std::array<double, 8>>();
      hand.push_back({{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
    }
  });
  const fs::path live_file = result / "live.json";
  std::ifstream in = open_text(live_file);
  try {
    const json live = json::parse(in);
    const auto matrix = live.at("camera_from_body").get<std::array<double, 16>>();
    for (std::size_t i = 0; i < 16; ++i) {
      run.camera_from_body.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) = matrix[i];
    }
    run.processed.assign(static_cast<std::size_t>(run.frames), 0);
    for (const int frame : live.at("processed").get<std::vector<int>>()) {
      if (frame >= 0 && frame < run.frames) run.processed[static_cast<std::size_t>(frame)] = 1;
    }
  } catch (const json::exception& error) {
    throw Error(fmt::format("{}: {}", live_file.string(), error.what()));
  }
  for_each_line(result / "touches.jsonl", [&](const json& line) {
    run.touches[line.at("frame").get<int>()] = {line.at("site").get<int>(),
                                                line.at("level").get<double>()};
  });
  return run;
}

// Deepest penetration per truly touching frame that was processed, m.
std::vector<double> penetrations(const Run& run, const ReducedBody& body) {
  std::vector<double> deepest;
  Eigen::Matrix3Xf u(3, body.surface.vertices.cols());
  for (int frame = 0; frame < run.frames; ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    if (run.truly_touching[f] == 0 || run.processed[f] == 0) continue;
    const auto hand = run.hands.find(frame);
    if (hand == run.hands.end()) continue;
    u.setZero();
    if (const auto touch = run.touches.find(frame); touch != run.touches.end()) {
      if (touch->second.site < 0 ||
          static_cast<std::size_t>(touch->second.site) >= body.sites.size()) {
        throw Error(fmt::format("touches.jsonl: frame {} presses site {}, but {} has {}", frame,
                                touch->second.site, body.name, body.sites.size()));
      }
      body.displacement.evaluate(
          std::array{static_cast<double>(touch->second.site), touch->second.level},
          std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
    }
    const Eigen::Matrix3Xd in_body = body.surface.vertices + u.cast<double>();
    const Eigen::Matrix3Xd in_camera =
        (run.camera_from_body.linear() * in_body).colwise() + run.camera_from_body.translation();
    deepest.push_back(deepest_penetration(in_camera, hand->second));
  }
  return deepest;
}

struct OcclusionFigures {
  int frames = 0;
  double mean = 0;                      // over all frames
  double worst = 1;                     // one frame
  std::optional<double> mean_hidden{};  // over the frames in which the body is partly hidden
};

std::optional<OcclusionFigures> occlusions(const Run& run, const Options& options) {
  OcclusionFigures figures;
  double sum = 0;
  double sum_hidden = 0;
  int hidden_frames = 0;
  for (int frame = 0; frame < run.frames; ++frame) {
    const std::string name = fmt::format("{:06d}.png", frame);
    const fs::path mask_file = options.result / "visible" / name;
    if (run.processed[static_cast<std::size_t>(frame)] == 0 || !fs::exists(mask_file)) continue;
    const ColorImage mask = value_or_throw(read_png(mask_file));
    const DepthImage body =
        value_or_throw(read_depth_png(options.result / "body_depth" / name, kDepthUnit));
    const DepthImage real =
        value_or_throw(read_depth_png(options.truth / "depth" / name, kDepthUnit));
    MaskImage visible(mask.width(), mask.height());
    for (std::size_t i = 0; i < mask.size(); ++i)
      visible.data()[i] = mask.data()[i].r > 127 ? 255 : 0;
    const bool fits = real.width() == body.width() && real.height() == body.height() &&
                      (visible.width() == body.width() || visible.width() == 2 * body.width());
    if (!fits) {
      throw Error(fmt::format(
          "{}: mask {} x {}, body depth {} x {}, true depth {} x {} do not belong together", name,
          visible.width(), visible.height(), body.width(), body.height(), real.width(),
          real.height()));
    }
    const MaskOverlap overlap = compare_visible(visible, body, real);
    ++figures.frames;
    sum += overlap.iou();
    figures.worst = std::min(figures.worst, overlap.iou());
    if (overlap.hidden * 50 >= overlap.body && overlap.body > 0) {  // 2 % of the body
      ++hidden_frames;
      sum_hidden += overlap.iou();
    }
  }
  if (figures.frames == 0) return std::nullopt;
  figures.mean = sum / figures.frames;
  if (hidden_frames > 0) figures.mean_hidden = sum_hidden / hidden_frames;
  return figures;
}

template <class T>
json or_null(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

void score(const Options& options) {
  fs::path truth = options.truth;
  if (!fs::exists(truth / "contact.jsonl") && fs::exists(truth / "truth")) truth /= "truth";
  Options found = options;
  found.truth = truth;
  const Run run = read_run(truth, options.result);
  if (run.frames == 0)
    throw Error(fmt::format("{}: holds no frame", (truth / "contact.jsonl").string()));

  std::vector<std::uint8_t> felt(static_cast<std::size_t>(run.frames), 0);
  for (const auto& [frame, touch] : run.touches) {
    if (frame >= 0 && frame < run.frames) felt[static_cast<std::size_t>(frame)] = 1;
  }
  const TouchScore touches = score_touches(run.truly_touching, felt);

  nlohmann::ordered_json result;
  result["frames"] = run.frames;
  result["frames_touching"] = touches.truly_touching;
  result["first_touch_delay_frames"] = or_null(touches.first_touch_delay_frames);
  result["touch_precision"] = or_null(touches.precision);
  result["touch_recall"] = or_null(touches.recall);
  result["penetration_median_mm"] = nullptr;
  result["penetration_p99_mm"] = nullptr;
  if (!options.body.empty()) {
    const ReducedBody body = value_or_throw(read_body_file(options.body));
    if (const auto deepest = penetrations(run, body); !deepest.empty()) {
      result["penetration_median_mm"] = percentile(deepest, 0.5) * 1e3;
      result["penetration_p99_mm"] = percentile(deepest, 0.99) * 1e3;
    }
    result["reduction_error"] = body.error.displacement_pooled;
    result["reduction_error_worst"] = body.error.displacement_worst;
  }
  const auto occlusion = occlusions(run, found);
  result["occlusion_iou"] = occlusion ? json(occlusion->mean) : json(nullptr);
  result["occlusion_iou_worst_frame"] = occlusion ? json(occlusion->worst) : json(nullptr);
  result["occlusion_iou_where_hidden"] =
      occlusion ? or_null(occlusion->mean_hidden) : json(nullptr);

  if (options.json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  const auto line = [&](const char* text, const char* key, const char* unit, int digits) {
    const json& value = result[key];
    fmt::print("{:<44}{}{}\n", text,
               value.is_null()             ? std::string("-")
               : value.is_number_integer() ? fmt::format("{}", value.get<int>())
                                           : fmt::format("{:.{}f}", value.get<double>(), digits),
               value.is_null() ? "" : unit);
  };
  line("frames", "frames", "", 0);
  line("frames with a true touch", "frames_touching", "", 0);
  line("first touch felt after the true one by", "first_touch_delay_frames", " frames", 0);
  line("felt touches that are true", "touch_precision", "", 3);
  line("true touches that are felt", "touch_recall", "", 3);
  if (!options.body.empty()) {
    line("penetration left, median", "penetration_median_mm", " mm", 2);
    line("penetration left, 99 of 100", "penetration_p99_mm", " mm", 2);
    fmt::print("{:<44}{:.2e}\n", "error of the reduced model, pooled",
               result["reduction_error"].get<double>());
  }
  line("visible body, intersection over union", "occlusion_iou", "", 3);
  line("  where a hand hides part of it", "occlusion_iou_where_hidden", "", 3);
  line("  in the worst frame", "occlusion_iou_worst_frame", "", 3);
}

}  // namespace

void add_score(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("score", "Compare a live run with the truth of its clip");
  command->add_option("truth", options->truth, "Folder with hand.jsonl, contact.jsonl and depth/")
      ->required();
  command->add_option("result", options->result, "The --out folder of palpable live")->required();
  command->add_option("--body", options->body, "The body of the run: adds the penetration left");
  command->add_flag("--json", options->json, "One JSON object on stdout");
  command->footer("Example: palpable score clip/truth out --body bunny.palpable");
  command->callback([options] { score(*options); });
}

}  // namespace palpable::app
