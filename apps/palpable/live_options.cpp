#include "apps/palpable/live_options.h"

#include "apps/common/command_line.h"

#include <fmt/core.h>

#include <string>
#include <vector>

namespace palpable::app {
namespace {

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
  command.add_flag("--press-static", options.run.press_static,
                   "What is there when the body is anchored, its desk too, presses it (scene.toml "
                   "may ask for it, too); otherwise only what comes later does");
  command.add_flag("--fixed-camera", options.run.fixed_camera,
                   "Do not follow the camera: it stands where it stood in the first frame");
  command
      .add_option(
          "--contact", options.run.contact,
          "How the body responds. anywhere: nothing that is seen may enter its skin, however "
          "many things there are; site: one touch at a time, at the nearest of its sites, "
          "by the measured depth; paper: at its sites by the paper's Algorithm 1, as "
          "printed. Default: anywhere if the body file has tables of touch, else site")
      .one_of({"anywhere", "site", "paper"});
  add_paper_options(command, options.run.paper);
  command
      .add_option(
          "--matcher", options.run.matcher,
          "How stereo pairs are matched. census: this project's, which sees from touching distance "
          "on and watches for rows out of line; opencv: OpenCV's semi-global block matcher")
      .one_of({"census", "opencv"})
      .show_default();
  command
      .add_option("--refine", options.run.refine,
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

// Options for the output folder and what its pictures show.
void add_view_options(Command command, PlayOptions& options) {
  command
      .add_option(
          "--out",
          [&options](const std::vector<std::string>& words) -> std::string {
            options.out = words.front();
            return options.out.empty() ? "names no folder" : "";
          },
          "Folder to write the results into; without it nothing is written")
      .type_name("DIR")
      .words(1, 1);
  command
      .add_option(
          "--view", options.view,
          "What the pictures show. camera: what the camera sees, with the body in it; map: "
          "the room from outside as it has been seen so far, the way through it, the body; "
          "surface: what touches the body, with the other side that is assumed, and the "
          "pressed skin, from outside; depth: how far away everything is; moving: what of it "
          "moves")
      .one_of({"camera", "depth", "moving", "surface", "map"})
      .show_default();
  command
      .add_option("--views", options.views,
                  "Several of these side by side in one picture, at half their size, instead of "
                  "--view. mask: where the picture shows a body; truth: where it would with the "
                  "true depth, of a film of palpable synth, red where mask says otherwise")
      .type_name("VIEW...")
      .words(2, 7)
      .excludes("--view")
      .one_of({"camera", "depth", "moving", "surface", "map", "mask", "truth"});
  add_paint_option(command, options.paint);
  command.add_flag("--opaque", options.opaque,
                   "Paint all of a body, also where it bears next to nothing");
  command
      .add_option(
          "--occlusion", options.occlusion,
          "How what is real hides bodies behind it. soft: along outlines that depth, colour "
          "and motion decide together; hard: pixel by pixel by the measured depth alone, as "
          "the paper does; none: not at all")
      .one_of({"soft", "hard", "none"})
      .show_default();
  command.add_flag("--forces", options.forces,
                   "Draw where bodies are pressed, and an arrow with the force there");
}

// Options for other programs, the window and messages.
void add_user_options(Command command, PlayOptions& options) {
  command.add_option(
      "--events", options.events,
      "Tell other programs of touches, forces and poses while the run goes on, a line "
      "of JSON for each frame (docs/touch_events.md): unix:PATH, a socket in the file "
      "system that is the user's alone, or a port of 127.0.0.1, 0: any free one");
  command
      .add_option("--contact-rate", options.contact_rate,
                  "Compute contact also between frames, HZ times a second, on a thread of its own: "
                  "the obstacle continues its measured motion. For haptic devices; --events sends "
                  "each result")
      .type_name("HZ")
      .in_range(30, 10'000);
  command.add_flag("--window", options.window,
                   "Show it in a window too, with a panel that switches what is shown; H lists the "
                   "keys that do the same, Escape or Q ends the run. There bodies are placed by a "
                   "click, the run begins anew, recordings begin and end, and parameters of bodies "
                   "have sliders (docs/window.md). With --view map or surface, "
                   "dragging turns it, the wheel comes nearer, R takes both back. Files get the "
                   "pictures as they are switched to, without the panel");
  command.add_flag("--paused", options.paused,
                   "With --window: stop at the first frame until the key Space or S. A recording "
                   "waits while it is paused, a camera goes on unseen");
  command.add_flag("--stats", options.stats,
                   "Say each second and at the end how fast it goes: frames a second, how old a "
                   "frame is when its picture is shown, frames dropped and left out of the files, "
                   "processor time a frame, ms by stage. live.json has it always");
}

// Options for what is written into the output folder.
void add_file_options(Command command, PlayOptions& options) {
  command.add_flag("--pictures", options.pictures,
                   "Also write the three pictures that best show the hand before the body, the "
                   "body before the hand, and a touch (of a clip with a truth: at least 4 mm "
                   "deep in truth)");
  command
      .add_option("--frame-pictures", options.frame_pictures,
                  "Also write the pictures of these frames, or of all, as pictures/000098.png; the "
                  "first frame is 0")
      .type_name("N ...|all");
  command.add_flag("--no-masks", options.no_masks,
                   "Leave out visible/, body_depth/ and moving/, which palpable score compares");
  command.add_flag("--no-depth", options.no_depth, "Leave out depth/, the measured depth");
  command.add_flag("--meshes", options.meshes,
                   "Also write meshes/, the body as it is drawn in each frame, with its stress: "
                   "palpable score asks for them where the body was touched anywhere");
  command.add_flag("--every-frame", options.every_frame,
                   "Of a camera or with --paced: write all frames into all files, and wait for the "
                   "disk where it is slow; otherwise film, images and meshes leave out what there "
                   "is no time for. A recording that waits for the loop is always complete");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace an earlier run in --out, or an earlier file");
}

}  // namespace

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

void add_play_options(Command command, PlayOptions& options) {
  add_view_options(command, options);
  add_user_options(command, options);
  add_file_options(command, options);
}

}  // namespace palpable::app
