// palpable-bake bench bodies: compares bodies that press each other with full-order solutions.

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/desk/clip_files/scene_files.h"

#include "bench/bake/bench.h"
#include "bench/bake/bodies_study.h"
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct BenchBodiesOptions {
  std::filesystem::path scene;
  std::string clip;
  bool json = false;
};

Json at(const std::vector<double>& values, double share, double factor = 1) {
  return values.empty() ? Json(nullptr) : Json(factor * percentile(values, share));
}

void bench_bodies(const BenchBodiesOptions& options) {
  const std::vector<DescribedBody> described = read_scene_description(options.scene);
  const std::vector<Rigid3> poses = scene_from_bodies(described);
  std::vector<StudiedBody> bodies;
  for (std::size_t k = 0; k < described.size(); ++k) {
    expect_baked(described[k], options.scene);
    TouchableBody body = value_or_throw(
        read_pressable_touchable_body(described[k].file, parse_settings(described[k].set)));
    if (described[k].scale != 1) body = scaled(body, described[k].scale);
    bodies.push_back({described[k].name, std::move(body), poses[k]});
  }
  const BodiesResult compared = compare_bodies(bodies, options.clip);
  Json figures{{"frames", compared.frames},
               {"u_error_median", at(compared.displacement, 0.5)},
               {"u_error_p90", at(compared.displacement, 0.9)},
               {"stress_error_median", at(compared.stress, 0.5)},
               {"stress_error_p90", at(compared.stress, 0.9)},
               {"between_force_error", at(compared.between_force, 0.5)},
               {"between_force_error_p90", at(compared.between_force, 0.9)},
               {"between_frames", compared.touching},
               {"between_frames_true", compared.touching_true},
               {"between_frames_disagree", compared.disagree},
               {"between_penetration_median_mm", at(compared.between_penetration, 0.5, 1e3)},
               {"between_imbalance_n", compared.imbalance},
               {"ms_two_beams", at(compared.milliseconds, 0.5)},
               {"ms_two_beams_p99", at(compared.milliseconds, 0.99)},
               {"ms_three_bodies_ratio", nullptr}};
  if (!compared.milliseconds_alone.empty()) {
    figures["ms_three_bodies_ratio"] =
        percentile(compared.milliseconds_three, 0.5) / percentile(compared.milliseconds_alone, 0.5);
  }
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_bodies(Command bench) {
  const auto options = std::make_shared<BenchBodiesOptions>();
  Command command = bench.add_subcommand(
      "bodies", "Bodies that press each other under a filmed hand, against full finite elements");
  command.add_option("scene", options->scene, "The scene that was filmed (docs/scenes.md)")
      .required()
      .type_name("FILE.toml");
  command.add_option("clip", options->clip, "What synth filmed and palpable truth --scene solved")
      .required()
      .type_name("DIR");
  command.add_json(options->json);
  command.footer(
      "No camera: the hand's own capsules press, in every frame. ms are of one thread: contact of\n"
      "all bodies, shape, normals and stress of those that moved.\n"
      "Example: palpable bench bodies scenes/beams.toml out/beams --json");
  command.callback([options] { bench_bodies(*options); });
}

}  // namespace palpable::app
