#include "palpable/bake/truth/episodes.h"
#include "palpable/bake/truth/obstacle_way.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/scorecard/figures.h"
#include "palpable/desk/scorecard/scorecard.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/scratch_folder.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kFrames = 3, kWidth = 20, kHeight = 10;
const Rigid3 kHere = Rigid3::Identity();

// A ball with a dent at its top.
ValuedSurface skin(double depth) {
  ValuedSurface skin{sphere_surface({0, 0, 0.4}, 0.05, 2), {}};
  skin.values = Eigen::VectorXd::Zero(skin.surface.vertex_count());
  for (int v = 0; v < skin.surface.vertex_count(); ++v) {
    double& z = skin.surface.vertices(2, v);
    if (z <= 0.45 - depth) continue;
    skin.values[v] = 1e5 * (z - 0.45 + depth);
    z = 0.45 - depth;
  }
  return skin;
}

std::string lines_of(const auto& line) {
  std::string text;
  for (int frame = 0; frame < kFrames; ++frame) text += line(frame);
  return text;
}

DepthImage some_depth() {
  DepthImage depth(kWidth, kHeight);
  for (std::size_t i = 0; i < depth.size(); ++i) depth.data()[i] = 0.3F + 0.001F * float(i);
  return depth;
}

MaskImage some_mask() {
  MaskImage mask(kWidth, kHeight);
  for (int x = 5; x < 15; ++x) mask.row(4)[x] = 255;
  return mask;
}

// The hand of a clip.
std::vector<std::string> write_hands(const fs::path& truth) {
  test::write_bytes(truth / "contact.jsonl", lines_of([](int f) {
                      ContactLine line{f, f > 0, 0.005, 1, Vector3d(0, 0, 0.45)};
                      if (f == 0) line.gap = 0.01;
                      return contact_line(line);
                    }));
  test::write_bytes(truth / "hand.jsonl", lines_of([](int f) {
                      return hand_line({f, {{{0, 0, 0.455}, {0, 0, 0.6}, 0.01, 0.02}}});
                    }));
  test::write_bytes(truth / "trajectory.txt", lines_of([](int f) {
                      return trajectory_line({f / 30.0, kHere});
                    }));
  return {"contact.jsonl", "hand.jsonl", "trajectory.txt"};
}

void write_truth(const fs::path& truth) {
  (void)write_hands(truth);
  test::write_bytes(truth / "rig.jsonl", lines_of([](int f) {
                      return rig_line({f, 0.5 * f, f == 1});
                    }));
  TruthCamera camera;
  camera.frames_per_second = 30;
  camera.depth_unit = 0.00025;
  camera.camera = PinholeCamera{kWidth, kHeight, 15, 15, 10, 5};
  camera.baseline = 0.063;
  camera.seed = 5;
  camera.sequence = "press";
  camera.body = "ball.palpable";
  write_truth_camera(truth / "camera.toml", camera);
  test::write_bytes(truth / "deformed" / "deformed.jsonl",
                    deformed_line({1, 0, 0.005, {0, 0, -2}, Vector3d(0, 0, 0.45), true, ""}));
  write_valued_ply(truth / "deformed" / "rest.ply", skin(0), kVonMisesProperty);
  write_valued_ply(deformed_skin_file(truth / "deformed", 1), skin(0.005), kVonMisesProperty);
  for (const char* kind : {"depth", "labels"}) fs::create_directories(truth / kind);
  for (int f = 0; f < kFrames; ++f) {
    write_true_depth(truth / "depth" / frame_name(f, ".png"), some_depth());
    write_labels(truth / "labels" / frame_name(f, ".png"), some_mask());
  }
}

void write_result(const fs::path& result) {
  LiveSummary summary;
  LiveSummary::Body& body = summary.bodies.emplace_back();
  body.file = "ball.palpable";
  summary.source = "clip";
  body.camera_from_body = kHere;
  summary.processed = {0, 1, 2};
  fs::create_directories(result);
  write_live_summary(result / "live.json", summary);
  test::write_bytes(result / "touches.jsonl", lines_of([](int f) {
                      const Vector3d point(0, 0, 0.45);
                      return touches_line({f, {{2, 0.5, 0.004, -20 * point, point, f / 30.0}}});
                    }));
  test::write_bytes(result / "pose.jsonl", lines_of([](int f) { return pose_line({f, kHere}); }));
  test::write_bytes(result / "trajectory.txt", lines_of([](int f) {
                      return trajectory_line({f / 30.0, kHere});
                    }));
  test::write_bytes(result / "rectification.jsonl", lines_of([](int f) {
                      return correction_line({f, 0.25, 0.1 * f});
                    }));
  for (const char* kind : {"depth", "moving", "visible", "body_depth", "meshes"}) {
    fs::create_directories(result / kind);
  }
  write_valued_ply(result / "meshes" / "rest.ply", skin(0), kVonMisesProperty);
  for (int f = 0; f < kFrames; ++f) {
    const std::string name = frame_name(f, ".png");
    write_measured_depth(result / "depth" / name, some_depth(), {});
    write_mask(result / "moving" / name, some_mask());
    write_mask(result / "visible" / name, some_mask());
    write_true_depth(result / "body_depth" / name, some_depth());
    write_valued_ply(result / "meshes" / frame_name(f, ".ply"), skin(f > 0 ? 0.004 : 0),
                     kVonMisesProperty);
  }
}

std::vector<std::string> write_both(const fs::path& folder) {
  write_truth(folder / "truth");
  write_result(folder / "result");
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      names.push_back(entry.path().lexically_relative(folder).string());
    }
  }
  return names;
}

std::vector<std::string> write_clip(const fs::path& folder) {
  std::vector<std::string> names;
  for (const std::string& name : write_hands(folder / "truth")) names.push_back("truth/" + name);
  test::write_bytes(folder / "frames" / "scene.toml",
                    "camera_from_body = [1, 0, 0, 0.1, 0, 0, -1, 0, 0, 1, 0, 0.5, 0, 0, 0, 1]\n");
  names.emplace_back("frames/scene.toml");
  return names;
}

// A closed surface and its path.
std::string follow(const fs::path& folder, const fs::path& /*file*/) {
  const std::array<std::string, 2> texts{(folder / "cup.off").string(),
                                         "sphere 8mm at 0,0,0.16 to 0,0,0.14"};
  const ObstacleMotion way = read_obstacle_way(texts, folder / "poses.txt");
  for (const double t : {0.0, 0.3, 1.0}) {
    const ObstacleGaps gaps(way(t));
    for (int part = 0; part < gaps.part_count(); ++part) {
      (void)gaps.distance(part, {0.1, 0.2, 0.3});
    }
  }
  return {};
}

}  // namespace

void add_score_readers(std::vector<FuzzReader>& readers) {
  readers.push_back({.name = "score.folders",
                     .write = write_both,
                     .read =
                         [](const fs::path& folder, const fs::path& /*file*/) {
                           const Scorecard scores =
                               score_folders(folder / "truth", folder / "result", nullptr, {});
                           (void)json_of(scores);
                           (void)text_of(scores);
                           return std::string();
                         },
                     .names_folder = true});
  readers.push_back({.name = "clip.hands",
                     .write = write_clip,
                     .read =
                         [](const fs::path& folder, const fs::path& /*file*/) {
                           const ClipHands hands = read_clip_hands(folder);
                           (void)episodes_of(hands.contacts, 24, 0.01);
                           (void)capsules_at(hands, 0.5);
                           return std::string();
                         },
                     .names_folder = true});
  readers.push_back({.name = "skin.ply",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_valued_ply(folder / "skin.ply", skin(0.005), kVonMisesProperty);
                       return {"skin.ply"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           return said(read_valued_ply(file, kVonMisesProperty),
                                       [](const ValuedSurface&) {});
                         }});
  readers.push_back({.name = "obstacle.way",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       test::write_bytes(folder / "cup.off",
                                         "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                                         "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
                       test::write_bytes(folder / "poses.txt",
                                         "# there and back\n0 0 0 0.1 0 0 0 1\n"
                                         "0.5 0 0 0.05 0 0 0.6 0.8\n1 0 0 0.1 0 0 0 1\n");
                       return {"cup.off", "poses.txt"};
                     },
                     .read = follow});
}

}  // namespace palpable::fuzz
