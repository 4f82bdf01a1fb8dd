#include "palpable/desk/clip_writer/sequence_folder.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/own_files.h"
#include "palpable/common/base/whole_file.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/clip_files/text_file.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/desk/script/beams.h"
#include "palpable/desk/script/contact_truth.h"
#include "palpable/desk/script/seen_share.h"
#include "palpable/live/calibrate/calibration_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesForTwo = 30;  // for shorter films, starting a second renderer does not pay
constexpr double kTruthSpacing = 0.0015;  // m, spacing of the sample points on a surface
constexpr int kMostSeen = 500;            // sample points of the touching part, at most
constexpr double kAtSite = 0.010;  // m; a touch farther than this from every site has site -1

HandLine hand_in_camera(int frame, const Movers& movers, const Rigid3& camera_from_desk) {
  HandLine hand;
  hand.frame = frame;
  for (const HandCapsule& capsule : movers.capsules) {
    hand.capsules.push_back(transformed(capsule.shape, camera_from_desk));
  }
  return hand;
}

/// The properties of a body that are the same in all frames and that determine whether and where
/// something touches it.
struct TruthBody {
  fs::path part;  ///< subfolder of truth/ for this body; empty: truth/ itself
  DeskBody body;
  SurfaceDistance distance;  ///< body frame
  SurfacePoints in_desk;
  Rigid3 desk_from_body;
  RectifiedStereo eyes;
};

double seen_share_of(const std::vector<Capsule>& movers_in_desk, const TruthBody& truth,
                     const Rigid3& camera_from_desk) {
  const Rigid3 body_from_desk = truth.desk_from_body.inverse();
  Eigen::Matrix3Xd part = touching_part(transformed(movers_in_desk, body_from_desk), truth.distance,
                                        kTruthSpacing, kMostSeen);
  part = camera_from_desk * truth.desk_from_body * part;
  return seen_share(part, transformed(movers_in_desk, camera_from_desk), truth.eyes);
}

ContactLine contact_of(int frame, const Movers& movers, const Rigid3& camera_from_desk,
                       const TruthBody& truth) {
  ContactLine contact;
  contact.frame = frame;
  const std::vector<Capsule> capsules = shapes_of(movers.capsules);
  const DeskBody& body = truth.body;
  const PressTruth press = press_truth(capsules, truth.in_desk);
  if (!press.touching) {
    if (!capsules.empty()) contact.gap = contact_truth(capsules, truth.in_desk.points).clearance;
    return contact;
  }
  const Eigen::Vector3d point =
      truth.desk_from_body.inverse() * truth.in_desk.points.col(press.point);
  contact.touching = true;
  contact.depth = press.depth;
  contact.site = nearest_site(body, point);
  if (contact.site >= 0) {
    const int vertex = body.site_vertices[contact.site];
    if ((body.surface.vertices.col(vertex) - point).norm() > kAtSite) contact.site = -1;
  }
  contact.point = point;
  contact.seen_share = seen_share_of(capsules, truth, camera_from_desk);
  return contact;
}

// Writes scene.toml, with the pose of the scene in the first frame, and script.toml.
void write_texts(const fs::path& out, const Sequence& sequence, const Rigid3& desk_from_scene,
                 bool several) {
  const Rigid3 camera_from_scene = sequence.camera_from_desk(0.0) * desk_from_scene;
  // The truth gets a copy, so that it is complete without frames/.
  for (const char* folder : {"frames", "truth"}) {
    write_scene_file(out / folder, several ? "scene" : "body", camera_from_scene, kFramesPerSecond);
  }

  TextFile script(out / "truth" / "script.toml");
  script.write(fmt::format("frames = {}\nframes_without_hand = {}\n", sequence.frames,
                           std::min(sequence.frames, kFramesWithoutHand)));
  for (const NamedSpan& span : sequence.spans)
    script.write(fmt::format("\n[[span]]\nwhat = \"{}\"\nframes = [{}, {}]\n", span.name,
                             span.frames.first, span.frames.last));
  for (const PlannedTouch& touch : sequence.touches)
    script.write(fmt::format(
        "\n[[touch]]\nwhat = \"{}\"\nsite = {}\nbetween_sites = {}\n"
        "depth = {:.6f}  # m from the first touch on\nseconds_to_depth = {:.3f}\nframes = [{}, "
        "{}]\n"
        "view_angle = {:.1f}  # degrees between the touching surface's normal and the ray\n",
        touch.what, touch.site, touch.between, touch.depth, touch.seconds_to_depth,
        touch.frames.first, touch.frames.last, touch.view_angle * 57.29578));
  script.close();
}

TruthCamera truth_camera(const Sequence& sequence, const SequenceOrder& order,
                         const PinholeCamera& view, double baseline) {
  TruthCamera camera;
  camera.frames_per_second = kFramesPerSecond;
  camera.depth_unit = kDepthUnit;
  camera.camera = view;
  camera.baseline = baseline;
  camera.sequence = sequence.name;
  camera.seed = sequence.seed;
  camera.body = order.body_name;
  return camera;
}

// A file in the folder during filming, so that the remains of an interrupted film are recognised.
constexpr const char* kUnfinished = "unfinished-film.txt";
constexpr std::string_view kUnfinishedText =
    "Palpable is filming here, or was interrupted; the same command films it again.\n";

// @throws Error for a file of this name that this program did not write
bool is_unfinished(const fs::path& out) {
  const fs::path label = out / kUnfinished;
  std::error_code error;
  if (!fs::exists(fs::symlink_status(label, error))) return false;
  const Result<std::string> text = read_whole_file(label, {.most = kUnfinishedText.size()});
  if (text && text.value() == kUnfinishedText) return true;
  throw Error(fmt::format("{}: is in the way of the film", label.string()));
}

// All files of a film (base/own_files.h), with those that palpable truth adds.
constexpr std::array<std::string_view, 26> kFilmFiles{"frames/left/#.jpg",
                                                      "frames/right/#.jpg",
                                                      "frames/calibration.yml",
                                                      "frames/scene.toml",
                                                      "truth/bodies/*/deformed/#.ply",
                                                      "truth/bodies/*/deformed/rest.ply",
                                                      "truth/bodies/*/deformed/deformed.jsonl",
                                                      "truth/bodies/*/deformed/problem.txt",
                                                      "truth/bodies/*/body.ply",
                                                      "truth/bodies/*/contact.jsonl",
                                                      "truth/bodies/*/scene.toml",
                                                      "truth/deformed/#.ply",
                                                      "truth/deformed/rest.ply",
                                                      "truth/deformed/deformed.jsonl",
                                                      "truth/deformed/problem.txt",
                                                      "truth/friction.txt",
                                                      "truth/depth/#.png",
                                                      "truth/labels/#.png",
                                                      "truth/body.ply",
                                                      "truth/contact.jsonl",
                                                      "truth/hand.jsonl",
                                                      "truth/rig.jsonl",
                                                      "truth/scene.toml",
                                                      "truth/script.toml",
                                                      "truth/trajectory.txt",
                                                      "truth/camera.toml"};

// @param replaces  a film in the folder is replaced even if it is complete
void make_folders(const fs::path& out, bool replaces) {
  replaces = is_unfinished(out) || replaces;
  if (replaces) remove_own_files(out, kFilmFiles);
  for (const char* part : {"frames", "truth"}) {
    if (!replaces && fs::exists(out / part)) {
      throw Error(fmt::format("{}: exists; give another folder, or remove it first",
                              (out / part).string()));
    }
  }
  write_whole_file(out / kUnfinished, kUnfinishedText);
  for (const char* folder : {"frames/left", "frames/right", "truth/depth", "truth/labels"}) {
    make_folder(out / folder);
  }
}

void check_gl(const DeskRenderer& renderer) {
  if (renderer.gl_error_count() > 0)
    throw Error(fmt::format("OpenGL reported {} errors on {}; the pictures may be wrong",
                            renderer.gl_error_count(), renderer.gl_description()));
}

/// The lines of one frame in the text files of the truth.
struct FrameLines {
  std::string hand, trajectory, rig;
  std::vector<std::string> contacts;  ///< one per body
};

/// Films single frames. Several threads may use one object, each with its own renderer.
struct FrameWriter {
  const fs::path& folder;
  const Sequence& sequence;
  const std::vector<TruthBody>& bodies;

  /// Writes the images of the frame and returns its lines.
  [[nodiscard]] FrameLines write(DeskRenderer& renderer, int frame) const {
    const DeskMoment moment = moment_of(sequence, frame);
    RawPair pair;
    DeskTruth truth;
    renderer.draw(moment, pair);
    const RectifiedStereo& eyes = bodies.front().eyes;
    renderer.draw_truth(moment, eyes.camera, eyes.baseline, truth);
    write_jpeg(folder / "frames" / "left" / frame_name(frame, ".jpg"), pair.left);
    write_jpeg(folder / "frames" / "right" / frame_name(frame, ".jpg"), pair.right);
    write_true_depth(folder / "truth" / "depth" / frame_name(frame, ".png"), truth.depth);
    write_labels(folder / "truth" / "labels" / frame_name(frame, ".png"), truth.labels);

    const Movers movers = moment.movers(frame);
    const Rigid3 camera_from_desk = moment.camera_from_desk(frame);
    FrameLines lines;
    lines.hand = hand_line(hand_in_camera(frame, movers, camera_from_desk));
    for (const TruthBody& body : bodies) {
      lines.contacts.push_back(contact_line(contact_of(frame, movers, camera_from_desk, body)));
    }
    lines.trajectory =
        trajectory_line({frame / kFramesPerSecond, world_from_camera(sequence, frame)});
    lines.rig = rig_line(
        {frame, sequence.faults.row_error_px + moment.rig.row_offset_px, moment.rig.row_step});
    return lines;
  }
};

/// Films all frames with `threads` threads, each with its own renderer; a free thread takes the
/// next frame. While one thread waits for the GPU, or for the threads of a software renderer, the
/// other makes meshes and encodes images.
/// @param begin  called once, after the first renderer exists and before the first frame is written
std::vector<FrameLines> film_frames(const FrameWriter& writer, int threads,
                                    const std::function<void()>& begin, const Progress& progress) {
  const Sequence& sequence = writer.sequence;
  std::vector<FrameLines> lines(sequence.frames);
  std::once_flag begun;
  std::atomic<int> next = 0, written = 0;
  std::atomic<bool> stop = false;
  const auto film = [&](const Progress& show) {
    try {
      DeskRenderer renderer = film_of(sequence).renderer;
      std::call_once(begun, [&] {
        if (!stop) begin();
      });
      for (int frame = next++; frame < sequence.frames && !stop; frame = next++) {
        lines[frame] = writer.write(renderer, frame);
        report(show, {"writing the sequence", static_cast<double>(++written),
                      static_cast<double>(sequence.frames), ""});
      }
      check_gl(renderer);
    } catch (...) {
      stop = true;
      throw;
    }
  };
  std::future<void> other = std::async(std::launch::async, [&] {
    if (threads > 1) film({});
  });
  film(progress);
  other.get();
  report(progress, {"writing the sequence", static_cast<double>(sequence.frames),
                    static_cast<double>(sequence.frames), ""});
  return lines;
}

template <class LineOf>
void write_lines(const fs::path& path, const std::vector<FrameLines>& frames,
                 const LineOf& line_of) {
  TextFile file(path);
  for (const FrameLines& frame : frames) file.write(line_of(frame));
  file.close();
}

Sequence sequence_of(const std::vector<PlacedDeskBody>& bodies, const SequenceOrder& order) {
  if (order.name == "beams") return plan_beams(bodies, order.frames, order.seed);
  return plan_sequence(order.name, bodies.front().body, order.frames, order.seed);
}

}  // namespace

void write_sequence(const ReducedBody& reduced, const SequenceOrder& order, const fs::path& folder,
                    const Progress& progress) {
  const SequenceBody one{.body = &reduced};
  write_sequence({&one, 1}, order, folder, progress);
}

void write_sequence(std::span<const SequenceBody> bodies, const SequenceOrder& order,
                    const fs::path& folder, const Progress& progress) {
  PALPABLE_EXPECT(!bodies.empty(), "a film has a body");
  const bool several = bodies.size() > 1;
  std::vector<PlacedDeskBody> placed;
  for (const SequenceBody& body : bodies) {
    placed.push_back({desk_body(*body.body), body.scene_from_body});
  }
  const Sequence sequence = sequence_of(placed, order);
  const Rigid3 desk_from_scene =
      several ? sequence.desk_from_body * placed.front().scene_from_body.inverse()
              : sequence.desk_from_body;
  const StereoRig rig = zed_mini_rig();
  const RectifiedGeometry geometry = rectified_geometry(rig);
  const PinholeCamera view = geometry.stereo.camera.scaled_down(2);
  std::vector<TruthBody> truths;
  for (std::size_t k = 0; k < placed.size(); ++k) {
    const Rigid3 desk_from_body =
        several ? desk_from_scene * placed[k].scene_from_body : desk_from_scene;
    truths.push_back(
        {several ? fs::path("bodies") / bodies[k].name : fs::path(), placed[k].body,
         SurfaceDistance(placed[k].body.surface),
         transformed(sample_surface(placed[k].body.surface, kTruthSpacing), desk_from_body),
         desk_from_body, RectifiedStereo{view, geometry.stereo.baseline}});
  }
  const FrameWriter writer{folder, sequence, truths};
  const int threads = order.threads > 0 ? order.threads : sequence.frames < kFramesForTwo ? 1 : 2;
  const fs::path truth = folder / "truth";
  std::optional<FolderLock> lock;
  const auto begin = [&] {
    if (!order.replaces) lock.emplace(folder);
    make_folders(folder, order.replaces);
    write_stereo_calibration(folder / "frames" / "calibration.yml", {rig, kFramesPerSecond});
    write_texts(folder, sequence, desk_from_scene, several);
    for (const TruthBody& body : truths) {
      make_folder(truth / body.part);
      write_ply(truth / body.part / kBodySkinFile, body.body.surface);
      if (several) {
        write_scene_file(truth / body.part, "body",
                         sequence.camera_from_desk(0.0) * body.desk_from_body, kFramesPerSecond);
      }
    }
  };
  const std::vector<FrameLines> lines = film_frames(writer, threads, begin, progress);
  write_lines(truth / "hand.jsonl", lines, [](const FrameLines& l) { return l.hand; });
  for (std::size_t k = 0; k < truths.size(); ++k) {
    write_lines(truth / truths[k].part / "contact.jsonl", lines,
                [k](const FrameLines& l) { return l.contacts[k]; });
  }
  write_lines(truth / "trajectory.txt", lines, [](const FrameLines& l) { return l.trajectory; });
  write_lines(truth / "rig.jsonl", lines, [](const FrameLines& l) { return l.rig; });
  // A folder without camera.toml is no truth. It is written last, so that an incomplete film cannot
  // be scored.
  write_truth_camera(truth / "camera.toml",
                     truth_camera(sequence, order, view, geometry.stereo.baseline));
  fs::remove(folder / kUnfinished);
}

}  // namespace palpable
