#include "palpable/desk/scorecard/folders.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/score/touch_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// A frame without a line between others has no touch.
std::vector<TrueContact> contacts_in(const fs::path& path) {
  std::vector<TrueContact> contacts;
  for (const ContactLine& line : read_contacts(path)) {
    contacts.resize(line.frame + 1);
    TrueContact& contact = contacts.back();
    contact = {line.touching, line.site, line.depth, line.gap, 1, line.point};
    if (line.touching) contact.gap = 0;
    if (line.seen_share) contact.seen_share = *line.seen_share;
  }
  return contacts;
}

// Sets the gap of frames without a hand to infinity.
void fill_gaps(TruthFolder& truth) {
  for (std::size_t f = 0; f < truth.contacts.size(); ++f) {
    TrueContact& contact = truth.contacts[f];
    if (contact.gap || truth.hands.contains(static_cast<int>(f))) continue;
    contact.gap = std::numeric_limits<double>::infinity();
  }
}

std::optional<TrueSkins> skins_in(const fs::path& folder, int frames) {
  TrueSkins skins;
  skins.lines = read_deformed_lines(folder);
  std::erase_if(skins.lines, [](const DeformedLine& line) { return line.body != 0; });
  if (skins.lines.empty()) return std::nullopt;
  if (skins.lines.back().frame >= frames) {
    throw Error(fmt::format("{}: frame {}, but the truth has {} frames (from 0 on)",
                            (folder / "deformed.jsonl").string(), skins.lines.back().frame,
                            frames));
  }
  skins.rest = value_or_throw(read_valued_ply(folder / "rest.ply", kVonMisesProperty)).surface;
  return skins;
}

// world_from_body from scene.toml; the world frame is the camera frame of the first picture.
std::optional<Rigid3> place_in(const fs::path& truth) {
  for (const fs::path& file : {truth / "scene.toml", truth / ".." / "frames" / "scene.toml"}) {
    if (const SceneFile scene = read_scene_file(file); scene.camera_from_body) {
      return scene.camera_from_body;
    }
  }
  return std::nullopt;
}

std::optional<TrueBody> body_in(const TruthFolder& truth) {
  const fs::path file = truth.part / kBodySkinFile;
  if (fs::exists(file)) {
    return TrueBody{value_or_throw(read_valued_ply(file, kVonMisesProperty)).surface, file};
  }
  if (!truth.deformed) return std::nullopt;
  return TrueBody{truth.deformed->rest, truth.part / "deformed" / "rest.ply"};
}

// A value of each line by the line's frame.
template <class Line, class Value>
std::map<int, Value> by_frame(const std::vector<Line>& lines, Value Line::*value) {
  std::map<int, Value> values;
  for (const Line& line : lines) values.emplace(line.frame, line.*value);
  return values;
}

std::vector<TrueRowOffset> rows_in(const fs::path& path) {
  std::vector<TrueRowOffset> rows;
  for (const RigLine& line : read_rig(path)) {
    rows.push_back({line.frame, line.row_offset_px, line.step});
  }
  return rows;
}

void read_live(const fs::path& path, ResultFolder& result) {
  const LiveFile live = read_live_file(path);
  result.camera_from_body = live.camera_from_body;
  result.speed = live.speed;
  if (!live.processed) return;
  std::vector<std::uint8_t> processed(result.processed.size(), 0);
  for (const int frame : *live.processed) {
    if (frame < std::ssize(processed)) processed[frame] = 1;
  }
  if (std::count(processed.begin(), processed.end(), 1) == 0) {
    throw Error(fmt::format("{}: processed names no frame of the truth", path.string()));
  }
  result.processed = std::move(processed);
}

std::map<int, std::vector<FoundTouch>> touches_in(const fs::path& path, const std::string& body) {
  std::map<int, std::vector<FoundTouch>> touches;
  for (const TouchesLine& line : read_touches(path, body)) {
    for (const FeltTouch& touch : line.touches) {
      touches[line.frame].push_back({touch.site, touch.level, touch.force, !touch.by.empty()});
    }
  }
  return touches;
}

std::vector<RowCorrection> corrections_in(const fs::path& path) {
  std::vector<RowCorrection> corrections;
  for (const CorrectionLine& line : read_corrections(path)) {
    corrections.push_back({line.frame, line.row_correction_px});
  }
  return corrections;
}

// Whether meshes/ holds one folder per body, as a run with several bodies writes it.
bool holds_folders(const fs::path& folder) {
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return entry.is_directory(); });
}

fs::path truth_in(const fs::path& folder) {
  return fs::exists(folder / "truth" / "camera.toml") ? folder / "truth" : folder;
}

// @throws Error unless a list with one line per frame is empty or as long as the truth
void expect_complete(const TruthFolder& truth, const char* name, std::size_t lines) {
  if (lines == 0 || lines == static_cast<std::size_t>(truth.frames)) return;
  throw Error(fmt::format("{}: {} frames, but the truth has {}", (truth.folder / name).string(),
                          lines, truth.frames));
}

}  // namespace

std::optional<Rigid3> TruthFolder::pose_at(int frame) const {
  if (!world_from_body || trajectory.empty()) return std::nullopt;
  return trajectory[frame].world_from_camera.inverse() * *world_from_body;
}

std::vector<Capsule> TruthFolder::hand_at_body(int frame) const {
  const auto hand = hands.find(frame);
  const std::optional<Rigid3> camera_from_body = pose_at(frame);
  if (hand == hands.end() || !camera_from_body) return {};
  return transformed(hand->second, camera_from_body->inverse());
}

bool TruthFolder::is_seen(int frame) const {
  return contacts.empty() || contacts[frame].seen_share >= kSeenFrom;
}

std::optional<Rigid3> ResultFolder::pose_at(int frame) const {
  if (!poses) return camera_from_body;
  const auto at = poses->find(frame);
  if (at == poses->end()) return std::nullopt;
  return at->second;
}

bool ResultFolder::every_frame_has_a_pose() const {
  for (std::size_t f = 0; f < processed.size(); ++f) {
    if (processed[f] != 0 && !pose_at(static_cast<int>(f))) return false;
  }
  return true;
}

TruthFolder read_truth_folder(const fs::path& folder, const std::string& body) {
  TruthFolder truth;
  truth.folder = truth_in(folder);
  truth.part = body.empty() ? truth.folder : truth.folder / "bodies" / body;
  if (!fs::is_directory(truth.folder)) {
    throw Error(fmt::format("{}: no such folder", truth.folder.string()));
  }
  if (!fs::exists(truth.folder / "camera.toml")) {
    throw Error(fmt::format("{}: is no truth: camera.toml is missing (docs/benchmark.md)",
                            truth.folder.string()));
  }
  const TruthCamera camera = read_truth_camera(truth.folder / "camera.toml");
  truth.film = camera.sequence;
  truth.depth_unit = camera.depth_unit;
  truth.frames_per_second = camera.frames_per_second;
  const auto path_of = [&](const char* name) { return truth.folder / name; };
  const auto there = [&](const char* name) { return fs::exists(path_of(name)); };
  const fs::path contacts = truth.part / "contact.jsonl";
  if (fs::exists(contacts)) truth.contacts = contacts_in(contacts);
  if (there("hand.jsonl")) {
    truth.hands = by_frame(read_hands(path_of("hand.jsonl")), &HandLine::capsules);
    std::erase_if(truth.hands, [](const auto& hand) { return hand.second.empty(); });
  }
  if (there("rig.jsonl")) truth.rows = rows_in(path_of("rig.jsonl"));
  if (there("trajectory.txt")) truth.trajectory = read_trajectory(path_of("trajectory.txt"));
  truth.frames = std::max(
      {static_cast<int>(truth.contacts.size()), static_cast<int>(truth.trajectory.size()),
       frames_in(truth.folder / "depth"), truth.rows.empty() ? 0 : truth.rows.back().frame + 1});
  if (truth.frames == 0) {
    throw Error(fmt::format(
        "{}: holds no frame: contact.jsonl, trajectory.txt, rig.jsonl and depth/ are empty or "
        "missing",
        truth.folder.string()));
  }
  expect_complete(truth, "contact.jsonl", truth.contacts.size());
  expect_complete(truth, "trajectory.txt", truth.trajectory.size());
  if (there("hand.jsonl")) fill_gaps(truth);
  truth.deformed = skins_in(truth.part / "deformed", truth.frames);
  truth.body = body_in(truth);
  truth.world_from_body = place_in(truth.part);
  return truth;
}

std::vector<std::string> bodies_of_truth(const fs::path& folder) {
  std::vector<std::string> names;
  const fs::path bodies = truth_in(folder) / "bodies";
  if (!fs::is_directory(bodies)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(bodies)) {
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

ResultFolder read_result_folder(const fs::path& folder, int frames, const std::string& body) {
  if (!fs::is_directory(folder)) throw Error(fmt::format("{}: no such folder", folder.string()));
  ResultFolder result;
  result.folder = folder;
  result.meshes = folder / "meshes" / body;
  result.processed.assign(static_cast<std::size_t>(frames), 1);
  const auto there = [&](const char* name) { return fs::exists(folder / name); };
  if (there("live.json")) read_live(folder / "live.json", result);
  if (there("touches.jsonl")) result.touches = touches_in(folder / "touches.jsonl", body);
  if (there("pose.jsonl")) {
    result.poses = by_frame(read_poses(folder / "pose.jsonl", body), &PoseLine::camera_from_body);
  }
  if (there("trajectory.txt")) result.trajectory = read_trajectory(folder / "trajectory.txt");
  if (there("rectification.jsonl")) {
    result.corrections = corrections_in(folder / "rectification.jsonl");
  }
  bool any = result.touches || result.poses || result.trajectory || result.corrections ||
             result.camera_from_body;
  for (const char* kind : {"depth", "moving", "visible", "body_depth"}) {
    if (!there(kind)) continue;
    expect_frames_in(folder / kind, ".png");
    any = true;
  }
  if (fs::is_directory(result.meshes) && !holds_folders(result.meshes)) {
    expect_frames_in(result.meshes, ".ply");
    any = true;
  }
  if (!any) {
    throw Error(fmt::format("{}: holds none of the files of a result (docs/benchmark.md)",
                            folder.string()));
  }
  return result;
}

}  // namespace palpable
