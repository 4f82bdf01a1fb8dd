#include "apps/palpable/live_setup.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/sibling_program.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/clip_writer/kept_clip.h"
#include "palpable/live/player/thread_shares.h"
#include "palpable/live/render/gl_context.h"

#include <fmt/core.h>

#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

constexpr const char* kSynthetic = "synthetic";  // the source that is rendered here

constexpr double kMm = 1e3;      // mm per m
constexpr double kMostMm = 500;  // limit of distances: larger than most bodies

// Parses the words after --anchor. Returns an error message, or an empty string.
std::string read_anchor(const std::vector<std::string>& words, LiveOptions& options) {
  const std::string& how = words.front();
  const bool looks = how == "plane" || how == "board";
  if (!looks && how != "pose") { return how + " not in {plane,board,pose FILE}"; }
  if (looks && words.size() > 1) {
    return fmt::format("{} takes no file, and {} follows; the body comes before the options", how,
                       words[1]);
  }
  if (!looks && words.size() == 1) { return "pose is to be followed by a file"; }
  options.anchor = how;
  if (!looks) options.place = {words[1]};
  return {};
}

// The body's pose from --place or --anchor pose; empty without either.
std::optional<Rigid3> given_place(const LiveOptions& options) {
  if (options.place.empty()) return std::nullopt;
  std::string text;
  for (const std::string& word : options.place) text += (text.empty() ? "" : " ") + word;
  return read_pose(text, options.anchor == "pose" ? "--anchor pose" : "--place");
}

Anchor anchor_of(const LiveOptions& options) {
  if (options.anchor == "plane") return Anchor::kPlane;
  return options.anchor == "board" ? Anchor::kBoard : Anchor::kPlace;
}

// The pixel of --at; empty without it.
std::optional<Eigen::Vector2d> given_pixel(const LiveOptions& options) {
  if (options.at.empty()) return std::nullopt;
  const auto numbers = to_numbers(options.at);
  if (!numbers || numbers->size() != 2) {
    throw Error(fmt::format("--at {}: should be a pixel like 320,200", options.at));
  }
  if (options.anchor != "plane") {
    throw Error("--at says where on the plane that is seen: give --anchor plane, too");
  }
  return Eigen::Vector2d((*numbers)[0], (*numbers)[1]);
}

// Advice on other options if the body's pose cannot be determined.
std::string_view other_places(Anchor anchor) {
  switch (anchor) {
    case Anchor::kPlane:
      return "or say where with --at X,Y (a pixel) or --place";
    case Anchor::kBoard:
      return "--board says how many corners it has; or give --place";
    case Anchor::kPlace:
      break;
  }
  return "give --anchor plane (it stands on the desk that is seen), or --place \"x y z roll pitch "
         "yaw\"";
}

// The settings of the refiner; empty if none is wanted.
std::optional<RefinerSettings> refinement(const LiveOptions& options, bool has_tables) {
  if (options.refine.empty()) return std::nullopt;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(options.refine, ignored)) {
    throw Error(fmt::format("--refine {}: no file is there", options.refine.string()));
  }
  if (!has_tables) {
    throw Error(fmt::format("--refine {}: only what is touched anywhere is refined; {} {}",
                            options.refine.string(), options.body.string(),
                            options.contact.empty()
                                ? "has no tables of touch"
                                : "is pressed by --contact " + options.contact));
  }
  if (options.scale != 1) {
    throw Error("--refine knows the body in its own size: leave out --scale");
  }
  RefinerSettings settings;
  settings.program = sibling_program(kBakeProgram);
  settings.description = options.refine;
  settings.latency = options.refine_latency;
  return settings;
}

// The body of the command line, or those of the scene.
std::vector<DescribedBody> wanted_bodies(const LiveOptions& options) {
  if (options.scene.empty()) {
    if (options.body.empty()) throw Error("give a body file, or --scene with several");
    return {{.file = options.body, .scale = options.scale, .set = options.set}};
  }
  if (!options.body.empty()) {
    throw Error(fmt::format("{} and --scene: the scene says which bodies there are",
                            options.body.string()));
  }
  if (options.scale != 1 || !options.set.empty()) {
    throw Error("--scale and --set are of one body: write scale and set into the scene");
  }
  if (!options.refine.empty()) {
    throw Error("--refine answers for one body: leave it out with --scene");
  }
  return read_scene_description(options.scene);
}

// Options for the source of frames and for depth.
void add_input_options(Command command, LiveOptions& options) {
  command
      .add_option(
          "--source", options.input.source,
          "A folder (left/ right/, side by side, colour + depth, EuRoC, KITTI, TUM, "
          "7-Scenes, Middlebury), images by name (\"cam0/*.png\"), one image (with --right), a "
          "video file, what --record has "
          "kept (*.palprec), a camera (/dev/video0), or the word synthetic: the built-in "
          "desk")
      .required();
  add_source_options(command, options.input);
  command.add_flag("--paced", options.paced,
                   "Play a recording at its own pace, leaving out what the loop has no time for; "
                   "otherwise it waits for the loop");
}

// Options for the body's pose and scale.
void add_place_options(Command command, LiveOptions& options) {
  command
      .add_option("--place", options.place,
                  "Where the body stands in the camera: \"x y z roll pitch yaw\" (m right, down, "
                  "forward; degrees), 16 numbers (camera_from_body row by row), or a file with "
                  "them. Default: scene.toml beside the images")
      .type_name("POSE")
      .words(1, 16);
  command
      .add_option(
          "--anchor",
          [&options](const std::vector<std::string>& words) { return read_anchor(words, options); },
          "Instead of --place. plane: on the desk or floor that the first frames show, where "
          "nothing "
          "stands, as near to the middle of the picture as can be, or --at a pixel; board: on the "
          "middle of the chessboard that they show (--board, "
          "--square); pose FILE: at the pose in a file, as --place FILE")
      .type_name("plane|board|pose FILE")
      .words(1, 2)
      .excludes("--place");
  command
      .add_option("--at", options.at,
                  "With --anchor plane: the pixel of the first picture's surface on which the body "
                  "is to stand, from its top left corner")
      .type_name("X,Y");
  add_board_options(command, options.board);
  command.add_option("--scale", options.scale, "Make the body this many times as large")
      .in_range(1e-3, 1e3)
      .show_default();
}

// Options for parameters that Algorithm 1 leaves open.
void add_paper_options(Command command, PaperOptions& paper) {
  const PaperSettings usual;
  command
      .add_option("--paper-step", paper.step,
                  fmt::format("With --contact paper, N_step: every N-th pixel of every N-th row of "
                              "the depth becomes a point. Default: {}",
                              ObjectSurfaceSettings{}.step))
      .type_name("N")
      .in_range(1, 64);
  command
      .add_option("--paper-press", paper.press_mm,
                  fmt::format("With --contact paper, delta_Incr: a nearer point presses by a level "
                              "more in each frame. Default: {}",
                              kMm * usual.press_distance))
      .type_name("MM")
      .in_range(0.0, kMostMm);
  command
      .add_option("--paper-release", paper.release_mm,
                  fmt::format("With --contact paper, delta_Decr: between the two it presses by a "
                              "level less in each frame. Default: {}",
                              kMm * usual.release_distance))
      .type_name("MM")
      .in_range(0.0, kMostMm);
  command
      .add_option("--paper-nodes", paper.nodes,
                  "With --contact paper, the nodes whose distance counts. sites: the middles of "
                  "the sites; all: all of the skin but those of the support, and the site nearest "
                  "to the node is pressed. Default: sites")
      .one_of({"sites", "all"});
  command
      .add_option("--distance", paper.distance,
                  "With --contact paper, how the nearest seen point is found. grid: exactly; "
                  "voxmap: in a distance field with voxels of 4 mm, made anew in each frame, as in "
                  "the paper. Default: grid")
      .one_of({"grid", "voxmap"});
}

// Options of the frame loop.
void add_loop_options(Command command, LiveOptions& options) {
  command.add_flag("--press-static", options.press_static,
                   "What is there when the body is anchored, its desk too, presses it (scene.toml "
                   "may ask for it, too); otherwise only what comes later does");
  command.add_flag("--fixed-camera", options.fixed_camera,
                   "Do not follow the camera: it stands where it stood in the first frame");
  command
      .add_option(
          "--contact", options.contact,
          "How the body responds. anywhere: nothing that is seen may enter its skin, however "
          "many things there are; site: one touch at a time, at the nearest of its sites, "
          "by the measured depth; paper: at its sites by the paper's Algorithm 1, as "
          "printed. Default: anywhere if the body file has tables of touch, else site")
      .one_of({"anywhere", "site", "paper"});
  add_paper_options(command, options.paper);
  command
      .add_option(
          "--matcher", options.matcher,
          "How stereo pairs are matched. census: this project's, which sees from touching distance "
          "on and watches for rows out of line; opencv: OpenCV's semi-global block matcher")
      .one_of({"census", "opencv"})
      .show_default();
  command
      .add_option("--refine", options.refine,
                  "The description that the body was baked from: while something presses, a second "
                  "process computes the full-order solution, which is blended in over 6 frames. "
                  "Squeezes and things held still gain, the stress most")
      .type_name("BODY.toml");
  command
      .add_option("--refine-latency", options.refine_latency,
                  "Frames after which a full-order solution is adopted. A recording waits for it; "
                  "with a camera a late one is discarded")
      .in_range(1, 600)
      .show_default();
  add_set_option(command, options.set);
  command
      .add_option("--threads", options.threads,
                  "How many threads the run may keep busy at a time: matcher, conversions and the "
                  "renderer in software share them. Results do not depend on it. Default: as many "
                  "as there are processors")
      .in_range(1, 64);
  command.add_option("--frames", options.frames, "Stop after this many frames")
      .in_range(1, 100'000'000);
}

PaperSettings paper_settings(const PaperOptions& options) {
  PaperSettings settings;
  if (options.press_mm) settings.press_distance = *options.press_mm / kMm;
  if (options.release_mm) settings.release_distance = *options.release_mm / kMm;
  if (options.nodes == "all") settings.nodes = QueriedNodes::kAll;
  if (options.distance == "voxmap") settings.distance = DistanceQuery::kVoxmap;
  return settings;
}

}  // namespace

void PaperOptions::check(const std::string& contact) const {
  const char* given = step != 0           ? "--paper-step"
                      : press_mm          ? "--paper-press"
                      : release_mm        ? "--paper-release"
                      : !nodes.empty()    ? "--paper-nodes"
                      : !distance.empty() ? "--distance"
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

SessionSettings session_settings(const LiveOptions& options) {
  SessionSettings settings;
  if (options.matcher == "opencv") settings.depth.matcher = DepthSettings::Matcher::kOpenCv;
  set_depth(options.input, settings.depth);
  settings.contact = options.contact == "paper"  ? ContactKind::kPaper
                     : options.contact == "site" ? ContactKind::kSite
                                                 : ContactKind::kAnywhere;
  settings.paper = paper_settings(options.paper);
  if (options.paper.step != 0) settings.surface.step = options.paper.step;
  settings.track = !options.fixed_camera;
  settings.map = true;
  settings.press_static = options.press_static;
  return settings;
}

TouchableBody read_live_body(const DescribedBody& wanted, const std::string& contact) {
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
  return body;
}

void add_live_options(Command command, LiveOptions& options) {
  command.add_option("body", options.body,
                     "Body file, or the name of an installed one (post); or --scene");
  command
      .add_option("--scene", options.scene,
                  "Several bodies on one desk: a text that says which and where "
                  "(docs/scenes.md). --place, --anchor or the folder's scene.toml say where the "
                  "scene stands")
      .type_name("SCENE.toml");
  add_input_options(command, options);
  add_place_options(command, options);
  add_loop_options(command, options);
}

void share_drawing_threads(int threads) {
  use_drawing_threads(thread_shares(threads > 0 ? threads : usual_threads()).drawing);
}

std::vector<std::filesystem::path> inputs_of(const LiveOptions& options) {
  SourceOptions input = options.input;
  if (input.source == kSynthetic) input.source.clear();  // not a path
  std::vector<std::filesystem::path> inputs = inputs_of(input);
  for (const auto& file : {options.body, options.scene}) {
    if (!file.empty()) inputs.push_back(file);
  }
  if (!options.refine.empty()) inputs.push_back(options.refine);
  if (options.place.size() == 1) inputs.emplace_back(options.place.front());  // a file, or numbers
  return inputs;
}

LiveSetUp set_up_live(const LiveOptions& options) { return set_up_live(options, nullptr); }

LiveSetUp set_up_live(const LiveOptions& options, std::unique_ptr<FrameSource> images) {
  options.paper.check(options.contact);
  LiveSettings settings;
  settings.images = request_of(options.input);
  settings.place = given_place(options);
  settings.anchor = anchor_of(options);
  settings.at_px = given_pixel(options);
  settings.paced = options.paced;
  settings.threads = options.threads;
  settings.session = session_settings(options);
  std::vector<DescribedBody> wanted = wanted_bodies(options);
  std::vector<LiveBody> bodies;
  for (const DescribedBody& body : wanted) {
    if (!options.scene.empty()) expect_baked(body, options.scene);
    if (body.place.anchor.value_or(settings.anchor) == Anchor::kBoard) {
      settings.board = pattern_of(options.board);
    }
    bodies.push_back({read_live_body(body, options.contact), options.scene.empty() ? "" : body.name,
                      body.place, body.color});
  }
  settings.refine = refinement(options, bodies.front().body.touch.has_value());
  if (settings.images.device == kSynthetic) {
    if (bodies.size() > 1) {
      throw Error("--source synthetic films one body: film a sequence with palpable synth");
    }
    if (options.clip.empty()) {
      throw Error("--source synthetic films a clip into --out: name that folder, too");
    }
    ProgressBar bar;
    settings.images.device =
        kept_clip(
            bodies.front().body.body,
            {.folder = options.clip, .body_file = wanted.front().file, .version = PALPABLE_VERSION},
            bar.progress())
            .string();
    bar.finish();
  }
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (wanted[k].scale != 1) bodies[k].body = scaled(bodies[k].body, wanted[k].scale);
  }
  try {
    return {open_live(std::move(bodies), settings, std::move(images)), std::move(wanted), settings};
  } catch (const NoPlaceError& error) {
    throw Error(fmt::format("{}; {}", error.what(), other_places(settings.anchor)));
  }
}

}  // namespace palpable::app
