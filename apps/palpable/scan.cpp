// palpable scan: what a camera saw, as one surface.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/ctrl_c.h"
#include "apps/palpable/map_picture.h"
#include "apps/palpable/score_files.h"
#include "apps/palpable/source_options.h"
#include "palpable/base/error.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/picture_file.h"
#include "palpable/slam/room_scan.h"
#include "palpable/sources/open_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ScanOptions {
  SourceOptions input;
  fs::path out;
  fs::path trajectory;
  fs::path picture;
  double voxel_mm = 10;
  double fuse_every = 0.1;  // s
  int frames = -1;
};

// The pose nearest in time, if it is less than 1/60 s away. Frames count from the first pose's.
std::optional<Rigid3> pose_at(const std::vector<StampedPose>& poses, double time) {
  const double wanted = poses.front().time + time;
  const auto after = std::lower_bound(poses.begin(), poses.end(), wanted,
                                      [](const StampedPose& p, double t) { return p.time < t; });
  const StampedPose* nearest = after == poses.end() ? &poses.back() : &*after;
  if (after != poses.begin() && wanted - (after - 1)->time < std::abs(nearest->time - wanted)) {
    nearest = &*(after - 1);
  }
  if (std::abs(nearest->time - wanted) > 1.0 / 60) return std::nullopt;
  return nearest->world_from_camera;
}

// Binary little-endian PLY with a colour per vertex. @param frame  says whose coordinates they are
void write_colored_ply(const fs::path& path, const ColoredSurface& mesh, const char* frame) {
  std::ofstream file(path, std::ios::binary);
  file << fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment palpable scan: metres, {}\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      frame, mesh.surface.vertex_count(), mesh.surface.triangle_count());
  for (int i = 0; i < mesh.surface.vertex_count(); ++i) {
    const Eigen::Vector3f p = mesh.surface.vertices.col(i).cast<float>();
    file.write(reinterpret_cast<const char*>(p.data()), 12);
    const Rgb c = mesh.colors[static_cast<std::size_t>(i)];
    const char rgb[3] = {static_cast<char>(c.r), static_cast<char>(c.g), static_cast<char>(c.b)};
    file.write(rgb, 3);
  }
  for (int i = 0; i < mesh.surface.triangle_count(); ++i) {
    const Eigen::Vector3i t = mesh.surface.triangles.col(i);
    file.put(3);
    file.write(reinterpret_cast<const char*>(t.data()), 12);
  }
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written", path.string()));
}

void write_picture(const fs::path& file, const SurfaceMap& map, const CameraPath& path,
                   const std::vector<KeyframePose>& keyframes, const PinholeCamera& camera) {
  const GlContext context = value_or_throw(GlContext::offscreen());
  MapRenderer renderer = value_or_throw(MapRenderer::make());
  write_png(file, picture_of_scan(renderer, mesh_of(map), path, keyframes, camera));
}

// Leaves what is there as it is. @throws Error when it could not be written
void expect_writable(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) {
    throw Error(fmt::format("{}: there is no folder {}", file.string(), folder.string()));
  }
  if (fs::is_directory(file)) throw Error(fmt::format("{}: is a folder", file.string()));
  const bool was_there = fs::exists(file);
  if (!std::ofstream(file, std::ios::app)) {
    throw Error(fmt::format("{}: cannot be written", file.string()));
  }
  if (!was_there) fs::remove(file);
}

void scan(const ScanOptions& options) {
  const std::vector<StampedPose> given =
      options.trajectory.empty() ? std::vector<StampedPose>{} : read_trajectory(options.trajectory);
  if (!options.trajectory.empty() && given.empty()) {
    throw Error(fmt::format("{}: holds no pose", options.trajectory.string()));
  }
  if (options.out.extension() != ".ply") {
    throw Error(fmt::format("-o {}: should end in .ply", options.out.string()));
  }
  if (!options.picture.empty() && options.picture.extension() != ".png") {
    throw Error(fmt::format("--picture {}: should end in .png", options.picture.string()));
  }
  for (const fs::path& file : {options.out, options.picture}) {  // not after an hour's scan
    if (!file.empty()) expect_writable(file);
  }
  const std::string& name = options.input.source;
  RoomScanSettings settings;
  settings.slam.fuse_every = options.fuse_every;
  settings.slam.surface.voxel = 1e-3 * options.voxel_mm;
  settings.slam.surface.truncation = 4 * settings.slam.surface.voxel;
  settings.most_frames = options.frames;
  if (!given.empty()) settings.pose_at = [&](double time) { return pose_at(given, time); };
  settings.name = name;
  const auto open = [&] {
    std::unique_ptr<FrameSource> source = value_or_throw(open_source(request_of(options.input)));
    listen_for_ctrl_c();
    return source;
  };
  ProgressBar bar;
  const RoomScan scanned = scan_room(open, settings, [&](const RoomScanStep& step) {
    for (const std::string& line : step.reports) {
      bar.finish();
      fmt::print(stderr, "{}\n", line);
    }
    if (step.total > 0) {
      bar.show({step.again ? "scan, along the way as corrected" : "scan",
                static_cast<double>(step.read), static_cast<double>(step.total),
                fmt::format("{} blocks", step.blocks)});
    }
    return !asked_to_end();
  });
  bar.finish();
  const SourceTroubles& troubles = scanned.troubles;
  const std::size_t frames = scanned.frames.size();
  if (frames == 0) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable{}{})", name,
                            troubles.unreadable, scanned.last_trouble.empty() ? "" : "; ",
                            scanned.last_trouble));
  }

  const SurfaceMap& map = *scanned.slam->map();
  const SlamCounts& counts = scanned.slam->counts();
  const ColoredSurface mesh = map.mesh();
  if (mesh.surface.triangle_count() == 0) {
    throw Error(fmt::format("{}: no surface within {} m was seen in {} frames ({} without a pose)",
                            name, map.settings().farthest, frames, counts.lost));
  }
  write_colored_ply(options.out, mesh,
                    given.empty() ? "the first frame's camera" : "the world of the given poses");
  CameraPath path;
  for (const TrackedPose& frame : scanned.frames) path.add(frame);
  if (!options.picture.empty()) {
    write_picture(options.picture, map, path, scanned.keyframes, scanned.camera);
  }
  fmt::print("{} frames, {} fused, {} without a pose\n", frames, counts.fused, counts.lost);
  if (troubles.unreadable > 0) {
    fmt::print("{} unreadable, the last: {}\n", troubles.unreadable, scanned.last_trouble);
  }
  if (scanned.loops > 0) {
    fmt::print("{} loop{} closed: {}\n", scanned.loops, scanned.loops == 1 ? "" : "s",
               scanned.again ? "fused once more along the corrected way"
                             : "the surface holds what was seen since the last");
  }
  if (map.refused() > 0) {
    fmt::print("the map was full ({} blocks): parts are missing; --voxel makes them larger\n",
               map.blocks());
  }
  fmt::print("{}: {} vertices, {} triangles\n", options.out.string(), mesh.surface.vertex_count(),
             mesh.surface.triangle_count());
  if (!options.picture.empty()) fmt::print("{}\n", options.picture.string());
}

}  // namespace

void add_scan(Command app) {
  auto options = std::make_shared<ScanOptions>();
  Command command = app.add_subcommand("scan", "Make a surface of what a camera saw of a room");
  command
      .add_option("source", options->input.source,
                  "A folder, images by name, a video file or a camera, as for live")
      .required();
  add_source_options(command, options->input);
  command.add_option("-o,--out", options->out, "The surface, a .ply with colours").required();
  command.add_option("--trajectory", options->trajectory,
                     "Poses to use instead of tracking: lines time tx ty tz qx qy qz qw "
                     "(world_from_camera), the first one the first frame's");
  command.add_option("--picture", options->picture,
                     "Also a .png of it: the room from outside, the way through it in blue");
  command
      .add_option("--voxel", options->voxel_mm,
                  "Side of a voxel, mm; smaller ones than 5 would leave gaps between the rays")
      .in_range(5.0, 100.0)
      .show_default();
  command
      .add_option("--fuse-every", options->fuse_every,
                  "Fuse a frame every so many seconds of the recording; 0: all of them")
      .in_range(0.0, 3600.0)
      .show_default();
  command.add_option("--frames", options->frames, "Stop after so many frames")
      .in_range(1, 100'000'000);
  command.footer(
      "What moves is left out. Depths up to 3 m are taken, or up to where they scatter by 50 mm.\n"
      "Ctrl-C ends it and writes what was seen: so does a camera, which has no end of its own.\n"
      "Example: palpable scan room -o room.ply");
  command.callback([options] { scan(*options); });
}

}  // namespace palpable::app
