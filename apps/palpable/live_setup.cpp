#include "apps/palpable/live_setup.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/place.h"
#include "palpable/base/error.h"
#include "palpable/base/fnv1a.h"
#include "palpable/clip_writer/sequence_folder.h"
#include "palpable/geometry/median_pose.h"
#include "palpable/map/plane_fit.h"
#include "palpable/reduced/body_file.h"
#include "palpable/reduced/scaled_body.h"
#include "palpable/slam/slam.h"
#include "palpable/sources/open_source.h"
#include "palpable/sources/paced_source.h"
#include "palpable/sources/source_guard.h"

#include <fmt/core.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kClipFrames = 300;
constexpr std::uint64_t kClipSeed = 1;

// Names the body that a clip was made for.
std::uint64_t hash_of_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return fnv1a(std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()));
}

// The clip is filmed once for a body and kept; the label, written last, says that it is whole.
fs::path synthetic_clip(const LiveOptions& options, const ReducedBody& body) {
  const std::string label =
      fmt::format("palpable {} demo {} frames seed {} body {:016x}\n", PALPABLE_VERSION,
                  kClipFrames, kClipSeed, hash_of_file(options.body));
  const fs::path label_file = options.clip / "made_for.txt";
  std::string found;
  if (std::ifstream in(label_file); in) {
    found.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  if (found != label) {
    std::error_code error;
    if (fs::exists(options.clip) && !fs::is_empty(options.clip) && found.empty()) {
      throw Error(fmt::format("{}: is in the way of the synthetic clip; move it away or remove it",
                              options.clip.string()));
    }
    fs::remove_all(options.clip, error);
    ProgressBar bar;
    write_sequence(body, {"demo", kClipFrames, kClipSeed, options.body.filename().string()},
                   options.clip, bar.progress());
    bar.finish();
    std::ofstream(label_file) << label;
  }
  return options.clip / "frames";
}

Rigid3 place_of(const LiveOptions& options, const SceneFile& scene, const fs::path& images) {
  if (!options.place.empty()) {
    std::string text;
    for (const std::string& word : options.place) text += (text.empty() ? "" : " ") + word;
    return read_pose(text, options.anchor == "pose" ? "--anchor pose" : "--place");
  }
  if (scene.camera_from_body) return *scene.camera_from_body;
  throw Error(fmt::format(
      "{}: has no scene.toml beside it that says where the body stands; give --anchor plane "
      "(it stands on the desk that is seen), or --place \"x y z roll pitch yaw\"",
      images.string()));
}

// Reads what follows --anchor. Returns why it is refused, else nothing.
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

// m from the body's origin at which its pose has to be right: half of a hand-sized body.
constexpr double kBodyReach = 0.1;

// What the first frames say about where the body is to stand.
template <class Found>
struct FirstFrames {
  struct Sighting {
    Rigid3 start_from_camera;
    Found found;
  };
  std::vector<Sighting> sightings;  // at least one
  bool live = false;
  // The one that is nearest to where the session begins.
  [[nodiscard]] const Sighting& nearest() const {
    return live ? sightings.back() : sightings.front();
  }
};

// The camera is opened, followed through its first second and closed again. The session begins
// with a recording's first frame, and where a camera of one's own was seen last.
// @param find_in  (frame, camera) -> optional Found, in the frame's camera
template <class FindIn>
auto look_at_first_frames(const CameraRequest& request, const DepthSettings& settings,
                          const FindIn& find_in, const std::string& missing) {
  constexpr int kFrames = 30;
  using Found =
      typename std::invoke_result_t<FindIn, const SeenFrame&, const DepthCamera&>::value_type;
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(request));
  DepthCamera camera = value_or_throw(DepthCamera::make(source->format(), settings));
  Slam slam(camera, source->format(), {.map = false});
  FirstFrames<Found> result;
  result.live = source->is_live();
  Rigid3 world_from_start = Rigid3::Identity();
  StageTimes unused;
  SourceGuard guard(*source);
  Frame frame;
  SeenFrame seen;
  int looked = 0;
  // A camera may take its time for the first picture, but not for ever.
  constexpr int kMostFailures = 100;  // of them those that wait take 0.1 s each
  for (int failures = 0; looked < kFrames && failures < kMostFailures;) {
    const FrameStatus status = guard.next(frame);
    if (status == FrameStatus::kEnd) break;
    if (status != FrameStatus::kFrame) {
      ++failures;
      continue;
    }
    ++looked;
    camera.see(frame, seen);
    if (seen.misfit) throw Error(fmt::format("{}: {}", request.device, seen.misfit->message()));
    const TrackedPose pose = slam.advance(seen, unused).camera;
    if (pose.new_world) result.sightings.clear();
    if (pose.state == TrackState::kLost) continue;
    if (result.live) world_from_start = pose.world_from_camera;
    if (const std::optional<Found> found = find_in(seen, camera)) {
      result.sightings.push_back({pose.world_from_camera, *found});
    }
  }
  if (looked == 0) {
    throw Error(fmt::format("{}: gives no picture that can be used{}{}", request.device,
                            guard.last_trouble().empty() ? "" : ": ", guard.last_trouble()));
  }
  if (result.sightings.empty()) {
    throw Error(fmt::format("{}: its first {} frames show no {}, or give --place", request.device,
                            looked, missing));
  }
  for (auto& sighting : result.sightings) {
    sighting.start_from_camera = world_from_start.inverse() * sighting.start_from_camera;
  }
  return result;
}

Rigid3 pose_on_plane(const CameraRequest& request, const DepthSettings& settings) {
  const auto plane_in = [](const SeenFrame& seen, const DepthCamera& camera) {
    return fit_standing_plane(seen.depth, seen.depth_camera, camera.noise());
  };
  const auto frames =
      look_at_first_frames(request, settings, plane_in,
                           "plane to stand on (within 1.5 m, a tenth of what is seen there, "
                           "facing up in the picture); turn the camera to the desk");
  const auto& nearest = frames.nearest();
  const Eigen::Vector3d middle = nearest.start_from_camera * nearest.found.middle;
  std::vector<Rigid3> poses;
  for (const auto& [start_from_camera, found] : frames.sightings) {
    Plane plane = moved_by(start_from_camera, found);
    // Every frame's plane at the same place: the middle of its own picture moves.
    plane.middle = middle - (plane.normal.dot(middle) - plane.offset) * plane.normal;
    poses.push_back(camera_from_body_on(plane));
  }
  return median_pose(poses, kBodyReach);
}

Rigid3 pose_on_board(const CameraRequest& request, const DepthSettings& settings,
                     const BoardOptions& options) {
  const BoardPattern pattern = pattern_of(options);
  const auto board_in = [&](const SeenFrame& seen, const DepthCamera&) {
    return find_board_pose(seen.color, seen.camera, pattern);
  };
  const auto frames = look_at_first_frames(
      request, settings, board_in,
      fmt::format("chessboard of {} inner corners (--board); show it whole, flat and sharp",
                  options.corners));
  std::vector<Rigid3> poses;
  for (const auto& [start_from_camera, found] : frames.sightings) {
    poses.push_back(start_from_camera * found);
  }
  return median_pose(poses, kBodyReach);
}

}  // namespace

void add_live_options(Command command, LiveOptions& options) {
  command.add_option("body", options.body, "Body file").required();
  command
      .add_option(
          "--source", options.input.source,
          "A folder (left/ right/, side by side, colour + depth, EuRoC, KITTI, TUM, "
          "7-Scenes), images by name (\"cam0/*.png\"), a video file, a camera (/dev/video0), "
          "or: synthetic")
      .required();
  add_source_options(command, options.input);
  command.add_flag("--paced", options.paced,
                   "Play a recording at its own pace, leaving out what the loop has no time for; "
                   "otherwise it waits for the loop");
  command
      .add_option("--place", options.place,
                  "Where the body stands in the camera: \"x y z roll pitch yaw\" (m right, down, "
                  "forward; degrees), 16 numbers (camera_from_body row by row), or a file with "
                  "them. Default: scene.toml beside the images")
      .words(1, 16);
  command
      .add_option(
          "--anchor",
          [&options](const std::vector<std::string>& words) { return read_anchor(words, options); },
          "Instead of --place. plane: on the desk or floor that the first frames show, in the "
          "middle of the picture; board: on the middle of the chessboard that they show (--board, "
          "--square); pose FILE: at the pose in a file, as --place FILE")
      .type_name("plane|board|pose FILE")
      .words(1, 2)
      .excludes("--place");
  add_board_options(command, options.board);
  command.add_option("--scale", options.scale, "Makes the body so many times as large")
      .in_range(1e-3, 1e3)
      .show_default();
  command.add_flag("--ignore-static", options.ignore_static,
                   "What the first 15 frames show does not press (scene.toml may ask for it too)");
  command.add_flag("--fixed-camera", options.fixed_camera,
                   "Do not follow the camera: it stands where it stood in the first frame");
  command
      .add_option("--contact", options.contact,
                  "press: the level from the measured depth; paper: Algorithm 1 as printed")
      .one_of({"press", "paper"})
      .show_default();
  command
      .add_option(
          "--matcher", options.matcher,
          "How stereo pairs are matched. census: this project's, from touching distance on, "
          "rows watched; opencv: its semi-global block matcher")
      .one_of({"census", "opencv"})
      .show_default();
  add_set_option(command, options.set);
  command.add_option("--frames", options.frames, "Stop after so many frames")
      .in_range(1, 100'000'000);
}

LiveRun set_up_live(const LiveOptions& options) {
  ReducedBody body = value_or_throw(read_pressable_body(options.body, parse_settings(options.set)));
  CameraRequest request = request_of(options.input);
  if (request.device == "synthetic") request.device = synthetic_clip(options, body).string();
  const fs::path images = request.device;
  if (options.scale != 1) body = scaled(body, options.scale);
  SessionSettings settings;
  if (options.matcher == "opencv") settings.depth.matcher = DepthSettings::Matcher::kOpenCv;
  std::optional<Rigid3> anchored;
  if (options.anchor == "plane") anchored = pose_on_plane(request, settings.depth);
  if (options.anchor == "board") anchored = pose_on_board(request, settings.depth, options.board);
  std::unique_ptr<FrameSource> source = value_or_throw(open_source(request));
  if (options.paced && !source->is_live()) source = paced(std::move(source));
  std::error_code ignored;
  const fs::path folder = fs::is_directory(images, ignored) ? images : images.parent_path();
  const SceneFile scene = read_scene_file(folder / "scene.toml");

  const Rigid3 pose = anchored ? *anchored : place_of(options, scene, images);
  settings.contact = options.contact == "paper" ? ContactKind::kPaper : ContactKind::kPress;
  settings.track = !options.fixed_camera;
  settings.map = true;
  const int static_frames = scene.ignore_static_frames.value_or(0);
  settings.ignore_static = options.ignore_static || static_frames > 0;
  if (static_frames > 0) settings.static_frames = static_frames;
  Session session =
      value_or_throw(Session::make(std::move(body), pose, source->format(), settings));
  return {std::move(source), std::move(session), images};
}

}  // namespace palpable::app
