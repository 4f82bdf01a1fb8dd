#include "apps/palpable/live_options.h"

#include "apps/common/command_line.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/geometry/body_scale.h"
#include "palpable/common/response/touch_tables.h"
#include "palpable/live/view/tiles.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

constexpr LengthRange kPaperDistances{0, 0.5};  // m; larger than most bodies

// The groups of files of --write.
constexpr std::array kFileGroups{
    std::pair{"film", &RunFiles::film},     std::pair{"data", &RunFiles::data},
    std::pair{"depth", &RunFiles::depth},   std::pair{"masks", &RunFiles::masks},
    std::pair{"meshes", &RunFiles::meshes}, std::pair{"stills", &RunFiles::stills}};

void add_source_option(Command command, LiveOptions& options) {
  command
      .add_option(
          "-s,--source", options.input.source,
          "What is seen: a camera (/dev/video0), a folder with pictures of a stereo or depth "
          "camera (left/ right/, side by side, colour + depth, EuRoC, KITTI, TUM, 7-Scenes, "
          "OpenLORIS, Stray Scanner, Record3D, Middlebury), images by name (\"cam0/*.png\"), a "
          "video "
          "file, a recording (*.palprec), or the word synthetic: the built-in desk, filmed here. "
          "Without a camera: a hands file (*.jsonl) of the capsules or joints that press "
          "(docs/hands.md), or the word socket: a client of --events sends such lines")
      .type_name("SOURCE")
      .show_default();
}

// Options for the body's pose and scale.
void add_place_options(Command command, LiveOptions& options) {
  command.begin_group("Placement");
  command
      .add_option(
          "--anchor",
          [&options](const std::vector<std::string>& words) -> std::string {
            options.anchor = words.front();
            if (options.anchor == "plane" || options.anchor == "board") return {};
            return fmt::format("'{}' is neither plane nor board{}", options.anchor,
                               options.anchor == "pose" ? ": write --place FILE" : "");
          },
          "Stand the body on what the first frames show. plane: the desk or floor, where "
          "nothing stands, near the middle of the picture or at --at-pixel; board: the "
          "middle of a chessboard (--board, --square)")
      .type_name("plane|board")
      .words(1, 1)
      .default_is("none: --place");
  command
      .add_option("--place", options.place,
                  "Where the body stands in the camera: \"x y z roll pitch yaw\" (m to the right, "
                  "down, forward; degrees), 16 numbers (camera_from_body row by row), or a file "
                  "with them. With a hands file in its world, turned about X, Y, Z; without "
                  "--place the origin, upright along Z")
      .type_name("POSE")
      .further_words([](const std::string& word) { return to_number(word).has_value(); })
      .default_is("the scene.toml beside the images")
      .excludes("--anchor");
  command
      .add_option("--at-pixel", options.at,
                  "With --anchor plane: the pixel of the first picture on whose surface the body "
                  "is to stand, counted from the top left corner")
      .type_name("X,Y")
      .default_is("a free place near the middle");
  command.add_option("--scale", options.scale, "Make the body this many times as large")
      .in_range(kLeastScale, kMostScale)
      .show_default();
}

// Options for parameters that Algorithm 1 leaves open.
void add_paper_options(Command command, PaperOptions& paper) {
  command.begin_expert_group("Algorithm 1 of the paper (--contact paper)");
  command
      .add_option("--paper-step", paper.step,
                  "N_step: every N-th pixel of every N-th row of the depth becomes a point")
      .type_name("N")
      .default_is(fmt::format("{}", ObjectSurfaceSettings{}.step))
      .in_range(1, 64);
  const PaperSettings usual;
  command
      .add_length("--paper-press", paper.press_distance,
                  "delta_Incr: a nearer point presses by a level more in each frame",
                  kPaperDistances)
      .default_is(length_text(usual.press_distance));
  command
      .add_length("--paper-release", paper.release_distance,
                  "delta_Decr: between the two it presses by a level less in each frame",
                  kPaperDistances)
      .default_is(length_text(usual.release_distance));
  command
      .add_option("--paper-nodes", paper.nodes,
                  "The nodes whose distance counts. sites: the middles of the sites; all: all of "
                  "the skin but those of the support, and the site nearest to the node is pressed")
      .one_of({"sites", "all"})
      .default_is("sites");
  command
      .add_option("--paper-distance", paper.distance,
                  "How the nearest seen point is found. grid: exactly; voxmap: in a distance field "
                  "with voxels of 4 mm, made anew in each frame, as in the paper")
      .one_of({"grid", "voxmap"})
      .default_is("grid");
}

// Options of the response to what is seen.
void add_contact_options(Command command, LiveOptions& options) {
  command.begin_group("Contact");
  add_set_option(command, options.set);
  command.begin_expert_group("Contact, more");
  command
      .add_option("--refine", options.run.refine,
                  "The description that the body was baked from: while something presses, a second "
                  "process computes the full solution, which is blended in. Squeezes and things "
                  "held still gain, the stress most")
      .type_name("FILE.toml");
  command
      .add_option("--refine-latency", options.refine_latency,
                  "Frames after which a full solution is used. A recording waits for it; with a "
                  "camera a late one is left out")
      .in_range(1, 600)
      .show_default();
  command
      .add_option(
          "--contact", options.run.contact,
          "How the body responds. anywhere: nothing that is seen may enter its skin, however "
          "many things there are; site: one touch at a time, at the nearest of its sites, by the "
          "measured depth; paper: at its sites by the paper's Algorithm 1")
      .one_of({"anywhere", "site", "paper"})
      .default_is("anywhere, or site where the body file has no tables of touch");
  command
      .add_option("--friction", options.run.friction,
                  "Coulomb's coefficient of friction of the skins, in place of that in the body "
                  "files; 0: none. A key of scenes, too")
      .in_range(0.0, kMostFriction)
      .default_is(
          "that of the body file; in recorded images what their scene.toml or the clip's "
          "truth/friction.txt states, else 0");
  command
      .add_option(
          "--dynamics",
          [&options](const std::vector<std::string>& words) -> std::string {
            if (words.front() != "on" && words.front() != "off") {
              return fmt::format("'{}' is neither on nor off", words.front());
            }
            options.run.dynamics = words.front() == "on";
            return {};
          },
          "Whether bodies whose files have vibration modes (the description gave a density) have "
          "inertia, so that what is let go rings. With a camera they tremble, as the motion that "
          "it measures does")
      .type_name("on|off")
      .words(1, 1)
      .default_is("on without a camera, off with one");
  command.add_flag("--press-static", options.run.press_static,
                   "Let also that press the body which is there from the first frame on, its desk "
                   "too. Without it only what comes later presses; a scene.toml may ask for it");
}

// Options for what the pictures show.
void add_view_options(Command command, PlayOptions& options) {
  command.begin_group("Display");
  command.add_flag(
      "-w,--window", options.window,
      "Show it in a window, with a panel that switches what is shown; H lists the "
      "keys, Escape or Q ends the run (docs/window.md). One opens by itself where there is a "
      "screen and nothing is written; --no-window prevents it");
  command
      .add_option("--view", options.view,
                  "What is shown: the camera's picture with the body in it, depth, moving (what "
                  "moves of it), surface (what touches the body, from outside), map (the room from "
                  "outside). Several names: side by side in one picture, for which there is also "
                  "mask (where bodies are visible) and truth (the mask by the true depth of a film "
                  "of palpable synth)")
      .type_name("VIEW")
      .further_words([](const std::string& word) {
        return std::find(kTileNames.begin(), kTileNames.end(), word) != kTileNames.end();
      })
      .split_at_commas()
      .one_of({"camera", "depth", "moving", "surface", "map", "mask", "truth"})
      .default_is("camera");
  add_paint_options(command, options.paint, options.colors);
  command.add_flag(
      "--forces", options.forces,
      "Draw where bodies are pressed, and an arrow with the force there. Needs a camera");
  command.begin_expert_group("Display, more");
  command.add_flag("--opaque", options.opaque,
                   "Paint all of a body, also where it is hardly stressed");
  command
      .add_option("--occlusion", options.occlusion,
                  "How real things hide bodies behind them. soft: along outlines that depth, "
                  "colour and motion decide together; hard: pixel by pixel by the measured depth, "
                  "as the paper does; none: not at all")
      .one_of({"soft", "hard", "none"})
      .show_default();
  command.add_flag("--paused", options.paused,
                   "With --window: stop at the first frame until the key Space or S. A recording "
                   "waits while it is paused, a camera goes on");
  command.add_flag("--stats", options.stats,
                   "Print each second and at the end how fast it runs: frames a second, how old a "
                   "frame is when it is shown, frames left out, processor time, ms of each stage. "
                   "live.json has it always");
}

// Reads the words of --write. Returns an error message, or an empty string.
std::string read_files(const std::string& text, RunFiles& files) {
  const bool changes = text.starts_with('+') || text.starts_with('-');
  RunFiles wanted;
  if (!changes) {
    for (const auto& [name, member] : kFileGroups) wanted.*member = false;
  }
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    std::string_view word = rest.substr(0, comma);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    const bool value = !word.starts_with('-');
    if (changes && !word.starts_with('+') && value) {
      return fmt::format("'{}': write a + or - before every word, or before none", text);
    }
    if (changes) word.remove_prefix(1);
    const auto* const group = std::find_if(kFileGroups.begin(), kFileGroups.end(),
                                           [&](const auto& known) { return known.first == word; });
    if (group == kFileGroups.end()) {
      return fmt::format("'{}' is none of film, data, depth, masks, meshes, stills", word);
    }
    wanted.*(group->second) = value;
  }
  files = wanted;
  return {};
}

// Options for what is written.
void add_file_options(Command command, PlayOptions& options) {
  command.begin_group("Files");
  command
      .add_option(
          "-o,--out",
          [&options](const std::vector<std::string>& words) -> std::string {
            options.out = words.front();
            return options.out.empty() ? "names no folder" : "";
          },
          "Folder for the results")
      .type_name("DIR")
      .words(1, 1)
      .default_is("none: nothing is written");
  command
      .add_option(
          "--write",
          [&options](const std::vector<std::string>& words) {
            return read_files(words.front(), options.files);
          },
          "What is written: film (touch.mp4), data (the text files), depth, masks (of bodies and "
          "of what moves), meshes (the deformed skin with its stress), stills (three pictures that "
          "best show a touch). Without a camera there are film, data and meshes. \"--write film\" "
          "writes the film and live.json alone; "
          "\"--write +meshes,-depth\" changes the default")
      .type_name("LIST")
      .words(1, 1)
      .default_is("film,data,depth,masks");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace an earlier run in --out, or an earlier file");
  command
      .add_option("--events", options.events,
                  "Send touches, forces and poses to other programs while the run goes on, a line "
                  "of JSON for each frame (docs/touch_events.md): unix:PATH, a socket that is the "
                  "user's alone, or a port of 127.0.0.1, 0: any free one")
      .type_name("ADDRESS")
      .show_default();
  command.begin_expert_group("Files, more");
  command
      .add_option(
          "--serve",
          [&options](const std::vector<std::string>& words) -> std::string {
            const auto port = to_whole_number(words.front());
            if (!port || *port < 0 || *port > 65535) {
              return fmt::format("'{}' is no port from 0 (any free one) to 65535", words.front());
            }
            options.serve = LivePageSettings{static_cast<int>(*port), shipped_page()};
            return {};
          },
          "Show the run on a page in a browser of this machine, at this port of 127.0.0.1, 0: any "
          "free one: picture, pressed body, touches and forces (docs/web.md). The address is "
          "printed; whoever has it sees your room")
      .type_name("PORT")
      .words(1, 1)
      .default_is("none");
  command
      .add_option("--frame-pictures", options.frame_pictures,
                  "Also write the pictures of these frames, or of all, as pictures/000098.png; the "
                  "first frame is 0")
      .type_name("N|all");
  command.add_flag("--every-frame", options.every_frame,
                   "With a camera or --paced: write all frames into all files, and wait for the "
                   "disk where it is slow; otherwise film, images and meshes leave out what there "
                   "is no time for. A recording that waits for the loop is always complete");
  command
      .add_option("--contact-rate", options.contact_rate,
                  "Compute contact also between frames, this many times a second, on a thread of "
                  "its own: the obstacle continues its measured motion. For haptic devices; "
                  "--events sends each result")
      .type_name("HZ")
      .default_is("none: once a frame")
      .in_range(30, 10'000);
}

// Options of the loop itself.
void add_loop_options(Command command, LiveOptions& options) {
  command.begin_expert_group("Loop");
  command.add_option("--frames", options.frames, "Stop after this many frames")
      .in_range(1, 100'000'000)
      .default_is("all");
  command.add_flag("--paced", options.paced,
                   "Play a recording at its own pace, leaving out what the loop has no time for; "
                   "otherwise it waits for the loop");
  command.add_flag("--fixed-camera", options.run.fixed_camera,
                   "Do not follow the camera: it stands where it stood in the first frame");
  command
      .add_option("--matcher", options.run.matcher,
                  "How stereo pairs are matched. census: this project's, which sees from touching "
                  "distance on and watches for rows out of line; opencv: OpenCV's semi-global "
                  "block matcher")
      .one_of({"census", "opencv"})
      .show_default();
  add_threads(command, options.threads,
              "Threads that the run may keep busy at a time; results do not depend on it");
}

}  // namespace

void add_live_options(Command command, LiveOptions& options) {
  command.begin_group("Input");
  command
      .add_option("body", options.body,
                  "Body file, the name of an installed one (post), or a scene file: a .toml with "
                  "one or several bodies, where they stand and any option of this command "
                  "(docs/scenes.md)")
      .default_is("the body that ships");
  add_source_option(command, options);
  add_source_options(command, options.input, SourceOptionsFor::kLive);
  add_place_options(command, options);
  add_board_options(command, options.board);
  add_contact_options(command, options);
  add_paper_options(command, options.run.paper);
  add_loop_options(command, options);
}

void add_play_options(const Command& command, PlayOptions& options) {
  add_view_options(command, options);
  add_file_options(command, options);
}

}  // namespace palpable::app
