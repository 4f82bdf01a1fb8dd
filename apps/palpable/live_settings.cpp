#include "apps/palpable/live_settings.h"

#include "apps/common/progress_bar.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/checksum.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/clip_writer/kept_clip.h"
#include "palpable/live/player/thread_shares.h"
#include "palpable/live/render/gl_context.h"

#include <fmt/core.h>

#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::app {

namespace fs = std::filesystem;

namespace {

Anchor anchor_of(const LiveOptions& options) {
  if (options.anchor == "plane") return Anchor::kPlane;
  return options.anchor == "board" ? Anchor::kBoard : Anchor::kPlace;
}

// The pixel of --at-pixel; empty without it.
std::optional<Eigen::Vector2d> given_pixel(const LiveOptions& options) {
  if (options.at.empty()) return std::nullopt;
  const auto numbers = to_numbers(options.at);
  if (!numbers || numbers->size() != 2) {
    throw Error(fmt::format("--at-pixel {}: should be a pixel like 320,200", options.at));
  }
  if (options.anchor != "plane") {
    throw Error("--at-pixel says where on the plane that is seen: give --anchor plane, too");
  }
  return Eigen::Vector2d((*numbers)[0], (*numbers)[1]);
}

// Advice on other options if the body's pose cannot be determined.
std::string_view other_places(Anchor anchor) {
  switch (anchor) {
    case Anchor::kPlane:
      return "or say where with --at-pixel X,Y or --place";
    case Anchor::kBoard:
      return "--board says how many corners it has; or give --place";
    case Anchor::kPlace:
      break;
  }
  return "give --anchor plane (it stands on the desk that is seen), or --place \"x y z roll pitch "
         "yaw\"";
}

// The settings of the refiner; empty if none is wanted.
std::optional<RefinerSettings> refinement(const LiveOptions& options, bool has_tables,
                                          double scale) {
  if (options.run.refine.empty()) return std::nullopt;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(options.run.refine, ignored)) {
    throw Error(fmt::format("--refine {}: no file is there", options.run.refine.string()));
  }
  if (!has_tables) {
    throw Error(fmt::format("--refine {}: only what is touched anywhere is refined; {} {}",
                            options.run.refine.string(), options.body.string(),
                            options.run.contact.empty()
                                ? "has no tables of touch"
                                : "is pressed by --contact " + options.run.contact));
  }
  if (scale != 1) throw Error("--refine knows the body in its own size: leave out the scale");
  RefinerSettings settings;
  settings.program = sibling_program(kBakeProgram);
  settings.description = options.run.refine;
  settings.body = options.body;
  settings.latency = options.refine_latency;
  if (const std::string trouble = Refiner::trouble_of_description(settings); !trouble.empty()) {
    throw Error(fmt::format("--refine {}", trouble));
  }
  return settings;
}

// Films the synthetic desk with the body in its own size. Returns the folder of the images.
// @param body  at its scale
std::filesystem::path film_clip(const LiveOptions& options,
                                const std::vector<DescribedBody>& wanted,
                                const TouchableBody& body) {
  if (wanted.size() > 1) {
    throw Error(
        "the built-in desk has one body: film several with palpable synth --scene, and give that "
        "film as --source");
  }
  const CameraRequest images = request_of(options.input);
  if (images.depth_unit || !images.depth.empty() || !images.right.empty() ||
      !images.calibration.empty()) {
    throw Error(
        "the built-in desk is a pair of eyes with its calibration: leave out --depth-unit, "
        "--depth-source, --right and --calibration, or name another --source");
  }
  DescribedBody own_size = wanted.front();
  own_size.scale = 1;
  std::optional<TouchableBody> read;
  if (wanted.front().scale != 1) read = read_live_body(own_size, options.run.contact);
  ProgressBar bar;
  return kept_clip(read ? read->body : body.body,
                   {.folder = options.clip.empty() ? clip_cache(own_size.file) : options.clip,
                    .body_file = own_size.file,
                    .version = PALPABLE_VERSION,
                    .frames = options.clip_frames},
                   bar.progress());
}

// Gives the friction of the images to the bodies of which the scene states none.
void take_friction(std::optional<double> of_images, std::vector<DescribedBody>& wanted,
                   std::vector<LiveBody>& bodies) {
  if (!of_images) return;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (wanted[k].friction) continue;
    wanted[k].friction = of_images;
    set_friction(bodies[k].body, *of_images);
  }
}

}  // namespace

std::optional<Rigid3> given_place(const LiveOptions& options) {
  if (options.place.empty()) return std::nullopt;
  std::string text;
  for (const std::string& word : options.place) text += (text.empty() ? "" : " ") + word;
  return read_pose(text, "--place");
}

std::vector<DescribedBody> wanted_bodies(const LiveOptions& options) {
  if (options.scene.empty()) {
    return {{.file = options.body, .scale = options.scale, .set = options.set}};
  }
  std::vector<DescribedBody> bodies = read_scene_description(options.scene);
  if (bodies.size() > 1) {
    if (options.scale != 1 || !options.set.empty()) {
      throw Error(fmt::format("--scale and --set are of one body: write scale and set into {}",
                              options.scene.string()));
    }
    if (!options.run.refine.empty()) {
      throw Error(fmt::format("--refine is of one body, and {} has {}", options.scene.string(),
                              bodies.size()));
    }
    return bodies;
  }
  if (options.scale != 1) bodies.front().scale = options.scale;
  if (!options.set.empty()) bodies.front().set = options.set;
  return bodies;
}

fs::path clip_cache(const fs::path& body_file) {
  const std::optional<fs::path> folder = user_folder("XDG_CACHE_HOME", ".cache");
  if (!folder) {
    throw Error(
        "the built-in desk is filmed into a folder for caches, and neither HOME nor "
        "XDG_CACHE_HOME is set: give --out DIR");
  }
  const Result<std::uint64_t> checksum = file_checksum(body_file);
  if (!checksum.ok()) {
    throw Error(fmt::format("{}: {}", body_file.string(), checksum.problem().message));
  }
  return *folder / "palpable" / fmt::format("desk-{:016x}", checksum.value());
}

void share_drawing_threads(int threads) {
  use_drawing_threads(thread_shares(threads > 0 ? threads : usual_threads()).drawing);
}

std::vector<std::filesystem::path> inputs_of(const LiveOptions& options) {
  SourceOptions input = options.input;
  if (input.source == kSynthetic || input.source == kSocketSource) {
    input.source.clear();  // not a path
  }
  std::vector<std::filesystem::path> inputs = named_inputs(input);
  for (const auto& file : {options.body, options.scene}) {
    if (!file.empty()) inputs.push_back(file);
  }
  if (!options.run.refine.empty()) inputs.push_back(options.run.refine);
  if (options.place.size() == 1) inputs.emplace_back(options.place.front());  // a file, or numbers
  return inputs;
}

LiveSetUp set_up_live(const LiveOptions& options, std::unique_ptr<FrameSource> images) {
  RunOptions run = options.run;
  run.paper.check(run.contact);
  run.depth = options.input.stereo_size;
  run.farthest = options.input.farthest;
  LiveSettings settings;
  settings.images = request_of(options.input);
  settings.place = given_place(options);
  settings.anchor = anchor_of(options);
  settings.at_px = given_pixel(options);
  settings.paced = options.paced;
  settings.threads = options.threads;
  settings.session = session_settings(run);
  std::vector<DescribedBody> wanted = wanted_bodies(options);
  std::vector<LiveBody> bodies;
  for (const DescribedBody& body : wanted) {
    if (!options.scene.empty()) expect_baked(body, options.scene);
    if (body.place.anchor.value_or(settings.anchor) == Anchor::kBoard) {
      settings.board = pattern_of(options.board);
    }
    bodies.push_back({read_live_body(body, run.contact, run.friction),
                      options.scene.empty() ? "" : body.name, body.place, body.color});
  }
  settings.refine =
      refinement(options, bodies.front().body.touch.has_value(), wanted.front().scale);
  if (settings.images.device == kSynthetic) {
    settings.images.device = film_clip(options, wanted, bodies.front().body).string();
  }
  if (!run.friction) take_friction(friction_of_images(settings.images.device), wanted, bodies);
  try {
    return {.run = open_live(std::move(bodies), settings, std::move(images)),
            .bodies = std::move(wanted),
            .settings = settings,
            .options = std::move(run),
            .scene = options.scene,
            .version = PALPABLE_VERSION};
  } catch (const NoPlaceError& error) {
    throw Error(fmt::format("{}; {}", error.what(), other_places(settings.anchor)));
  }
}

PreviewSettings preview_settings(const LiveOptions& options, const PlayOptions& play) {
  if (options.input.source == kSynthetic) {
    throw Error("--preview shows what a camera delivers: give it as --source /dev/video0");
  }
  if (play.serve) {
    throw Error("--serve: a preview has no body to show on a page; --window shows what it sees");
  }
  RunOptions run = options.run;
  run.depth = options.input.stereo_size;
  run.farthest = options.input.farthest;
  return {.images = request_of(options.input),
          .depth = session_settings(run).depth,
          .track = !run.fixed_camera,
          .window = play.window,
          .out = play.out,
          .overwrite = play.overwrite,
          .inputs = named_inputs(options.input),
          .frames = options.frames};
}

}  // namespace palpable::app
