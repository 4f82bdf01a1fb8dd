// palpable scan: reconstructs what a camera saw as one surface.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/shared_options.h"
#include "apps/palpable/terminal.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/live/play/run_options.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/picture_file.h"
#include "palpable/live/slam/room_scan.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/view/map_picture.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

// A mesh with fewer triangles is not a surface: a single voxel on a wall already gives two.
constexpr int kLeastTriangles = 100;

constexpr LengthRange kVoxels{0.005, 0.1};  // m

struct ScanOptions {
  SourceOptions input;
  fs::path out;
  fs::path trajectory;
  fs::path picture;
  double voxel = 0.01;      // m
  double fuse_every = 0.1;  // s
  int frames = -1;
  bool json = false;
};

void write_room_picture(const fs::path& file, const RoomScan& scanned) {
  CameraPath path;
  for (const TrackedPose& frame : scanned.frames) path.add(frame);
  const GlContext context = value_or_throw(GlContext::offscreen());
  MapRenderer renderer = value_or_throw(MapRenderer::make());
  write_png(file, picture_of_scan(renderer, mesh_of(*scanned.slam->map()), path, scanned.keyframes,
                                  scanned.camera));
}

// Fails before the scan if the file cannot be written or is an input.
void expect_output(const fs::path& file, const ScanOptions& options) {
  std::vector<fs::path> inputs = inputs_of(options.input);
  inputs.push_back(options.trajectory);
  guard_output_file(file, inputs);
}

// Whether there are images in the folder beside this one.
bool holds_images_but(const fs::path& folder, const fs::path& picture) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path name = entry.path().filename();
    if (is_image_name(name) && name != picture.filename()) return true;
  }
  return false;
}

void check_outputs(const ScanOptions& options) {
  require_ending(options.out, {".ply"}, "a surface");
  expect_output(options.out, options);
  if (options.picture.empty()) return;
  require_ending(options.picture, {".png"}, "a picture");
  expect_output(options.picture, options);
  // Among the camera's pictures the next scan would take it for one of them.
  const fs::path folder = fs::absolute(options.picture).parent_path();
  if (holds_images_but(folder, options.picture)) {
    refuse_among_inputs(folder, named_inputs(options.input));
  }
}

std::vector<StampedPose> given_poses(const fs::path& file) {
  if (file.empty()) return {};
  std::vector<StampedPose> poses = read_trajectory(file);
  if (poses.empty()) throw Error(fmt::format("{}: holds no pose", file.string()));
  return poses;
}

// Plays the source with a progress bar until the source or the user ends.
RoomScan scan_source(const ScanOptions& options, const std::vector<StampedPose>& given) {
  RoomScanSettings settings;
  settings.slam.fuse_every = options.fuse_every;
  settings.slam.surface.voxel = options.voxel;
  settings.slam.surface.truncation = 4 * settings.slam.surface.voxel;
  set_depth(options.input.stereo_size, options.input.farthest, settings.depth);
  if (options.input.farthest > 0) set_farthest(options.input.farthest, settings);
  settings.most_frames = options.frames;
  if (!given.empty())
    settings.pose_at = [&](double time) {
      return pose_nearest(given, given.front().time + time, 1.0 / 60);
    };
  settings.name = options.input.source;
  const auto open = [&] {
    std::unique_ptr<FrameSource> source = value_or_throw(open_source(request_of(options.input)));
    listen_for_ctrl_c();
    return source;
  };
  ProgressBar bar;
  RoomScan scanned = scan_room(open, settings, [&](const RoomScanStep& step) {
    for (const std::string& line : step.reports) bar.say(line);
    if (step.total > 0) {
      bar.show({step.again ? "scan, along the way as corrected" : "scan",
                static_cast<double>(step.read), static_cast<double>(step.total),
                fmt::format("{} blocks", step.blocks)});
    }
    return !asked_to_end();
  });
  bar.finish();
  return scanned;
}

Json json_of_depth(const DepthFigures& depth) {
  const bool any = depth.median > 0;
  return {{"median_measured", depth.measured},
          {"median_kept", depth.kept},
          {"median_m", any ? Json(depth.median) : Json()},
          {"range_m", any ? Json::array({depth.low, depth.high}) : Json()},
          {"unit_m", depth.unit > 0 ? Json(depth.unit) : Json()},
          {"unit_assumed", depth.unit_assumed}};
}

Json json_of_scan(const ScanOptions& options, const RoomScan& scanned, const SurfaceMesh& mesh) {
  const SlamCounts& counts = scanned.slam->counts();
  Json result = {{"file", options.out.string()},
                 {"vertices", mesh.vertex_count()},
                 {"triangles", mesh.triangle_count()},
                 {"frames", scanned.frames.size()},
                 {"fused", counts.fused},
                 {"without_pose", counts.lost},
                 {"unreadable", scanned.troubles.unreadable},
                 {"new_worlds", scanned.new_worlds},
                 {"loops", scanned.loops},
                 {"fused_again", scanned.again},
                 {"refused_blocks", scanned.slam->map()->refused()},
                 {"depth", json_of_depth(scanned.depth)}};
  if (!options.picture.empty()) result["picture"] = options.picture.string();
  return result;
}

void print(const ScanOptions& options, const RoomScan& scanned, const SurfaceMesh& mesh) {
  if (options.json) {
    print_json(json_of_scan(options, scanned, mesh));
    return;
  }
  const SurfaceMap& map = *scanned.slam->map();
  print_text("{}", text_of(scanned));
  if (map.refused() > 0) {
    print_text("the map was full ({} blocks): parts are missing; a larger --voxel needs fewer\n",
               map.blocks());
  }
  print_text("{}: {} vertices, {} triangles\n", options.out.string(), mesh.vertex_count(),
             mesh.triangle_count());
  if (!options.picture.empty()) print_text("{}\n", options.picture.string());
}

void scan(const ScanOptions& options) {
  const std::vector<StampedPose> given = given_poses(options.trajectory);
  check_outputs(options);
  const RoomScan scanned = scan_source(options, given);
  const std::size_t frames = scanned.frames.size();
  if (frames == 0) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable{}{})", options.input.source,
                            scanned.troubles.unreadable, scanned.last_trouble.empty() ? "" : "; ",
                            scanned.last_trouble));
  }
  const SurfaceMap& map = *scanned.slam->map();
  const ColoredSurface mesh = surface_of(scanned);
  if (mesh.surface.triangle_count() < kLeastTriangles) {
    throw Error(fmt::format(
        "{}: no surface within {} m was seen in {} frames ({} without a pose, {} triangles); {}",
        options.input.source, map.settings().farthest, frames, scanned.slam->counts().lost,
        mesh.surface.triangle_count(), text_of(scanned.depth)));
  }
  write_colored_ply(
      options.out, mesh.surface, mesh.colors,
      fmt::format("palpable scan: metres, {}",
                  given.empty() ? "the first frame's camera" : "the world of the given poses"));
  if (!options.picture.empty()) write_room_picture(options.picture, scanned);
  print(options, scanned, mesh.surface);
}

void add_surface_options(Command command, ScanOptions& options) {
  command.begin_group("Surface");
  command.add_option("-o,--out", options.out, "Surface to write, a .ply with colours").required();
  command.add_option("--picture", options.picture,
                     "Also write a .png: the room from outside, the camera's path in blue");
  command.add_length("--voxel", options.voxel,
                     "Side of a voxel; smaller ones than 5 mm would leave gaps between the rays",
                     kVoxels);
  command
      .add_option("--fuse-every", options.fuse_every,
                  "Seconds of the recording between two frames that are used; 0: all frames are")
      .type_name("SECONDS")
      .in_range(0.0, 3600.0)
      .show_default();
  command
      .add_option("--trajectory", options.trajectory,
                  "File with poses to use instead of tracking: a line 'time tx ty tz qx qy qz qw' "
                  "(world_from_camera) each, the first one for the first frame")
      .default_is("none: the camera is tracked");
  command.add_option("--frames", options.frames, "Stop after this many frames")
      .in_range(1, 100'000'000)
      .default_is("all");
  command.add_json(options.json);
}

}  // namespace

void add_scan(Command app) {
  auto options = std::make_shared<ScanOptions>();
  Command command = app.add_subcommand("scan", "Make a surface of what a camera saw of a room");
  add_source_argument(command, options->input,
                      "A folder, images by name, one image (with --right), a video file, a "
                      "recording (*.palprec) or a camera (/dev/video0), as for palpable live");
  add_source_options(command, options->input, SourceOptionsFor::kScan);
  add_surface_options(command, *options);
  command.footer(
      "What moves is left out. Depths up to 3 m are taken, or up to where they scatter by 50 mm;\n"
      "--farthest 12m takes those up to 12 m, which may scatter four times as much.\n"
      "Ctrl-C ends the scan and writes what was seen; a camera has no end of its own.\n"
      "Example: palpable scan room -o room.ply\n"
      "Example: palpable scan /dev/video0 --voxel 5mm -o room.ply");
  command.callback([options] { scan(*options); });
}

}  // namespace palpable::app
