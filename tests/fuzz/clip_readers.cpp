#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/player/things_file.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/scratch_folder.h"

#include <fmt/format.h>

#include <filesystem>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

Rigid3 pose_of(int frame) {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = Eigen::Vector3d(0.01 * frame, 0.02, 0.5);
  return pose;
}

// A text of three lines, written by the format's own writer.
template <class Line>
std::string three(const Line& line) {
  return line(0) + line(1) + line(2);
}

LiveSummary some_summary() {
  LiveSummary summary;
  LiveSummary::Body& body = summary.bodies.emplace_back();
  body.file = "ball.palpable";
  summary.source = "clip";
  body.camera_from_body = pose_of(1);
  summary.processed = {0, 1, 2};
  summary.source_troubles.reports = {"a camera"};
  summary.median_ms = {{"read", 1.5}};
  return summary;
}

TruthCamera some_camera() {
  TruthCamera camera;
  camera.frames_per_second = 30;
  camera.depth_unit = 0.00025;
  camera.camera = PinholeCamera{64, 36, 50, 50, 32, 18};
  camera.baseline = 0.063;
  camera.seed = 5;
  camera.sequence = "press";
  camera.body = "bunny.palpable";
  return camera;
}

DepthImage some_depth() {
  DepthImage depth(32, 18);
  for (std::size_t i = 0; i < depth.size(); ++i) depth.data()[i] = 0.3F + 0.001F * float(i);
  return depth;
}

}  // namespace

void add_clip_readers(std::vector<FuzzReader>& readers) {
  // A reader of one file of text.
  const auto text = [&](const char* name, const char* file, std::string content, auto read) {
    readers.push_back({.name = name,
                       .write = [=](const fs::path& folder) -> std::vector<std::string> {
                         test::write_bytes(folder / file, content);
                         return {file};
                       },
                       .read =
                           [read](const fs::path& /*folder*/, const fs::path& path) {
                             (void)read(path);
                             return std::string();
                           }});
  };
  text("clip.touches", "touches.jsonl", three([](int f) {
         const Eigen::Vector3d point(0.01, 0.02, 0.03);
         return touches_line({f, {{2, 0.5, 0.004, -20 * point, point, f / 30.0}, {.site = 1}}});
       }),
       [](const fs::path& path) { return read_touches(path); });
  text("clip.contact", "contact.jsonl", three([](int f) {
         ContactLine line{f, f > 0, 0.002, 1, Eigen::Vector3d(0.01, 0.02, 0.03)};
         if (f == 0) line.gap = 0.01;
         if (f == 1) line.seen_share = 0.5;
         return contact_line(line);
       }),
       read_contacts);
  text("clip.deformed", "deformed.jsonl", three([](int f) {
         const Eigen::Vector3d point(0.01, 0.02, 0.03);
         return deformed_line({f, 0, 0.004, -20 * point, point, f != 1, f == 1 ? "slips" : ""});
       }),
       [](const fs::path& path) { return read_deformed_lines(path.parent_path()); });
  text("clip.hand", "hand.jsonl", three([](int f) {
         return hand_line({f, {{{0, 0, 0.1}, {0, 0, 0.2}, 0.01, 0.02}, {}}});
       }),
       read_hands);
  text("clip.poses", "pose.jsonl", three([](int f) {
         return pose_line({f, pose_of(f)});
       }),
       [](const fs::path& path) { return read_poses(path); });
  text("clip.rectification", "rectification.jsonl", three([](int f) {
         return correction_line({f, 0.25, 0.1 * f});
       }),
       read_corrections);
  text("clip.rig", "rig.jsonl", three([](int f) {
         return rig_line({f, 0.5 * f, f == 1});
       }),
       read_rig);
  const std::vector<std::string> stages{"read", "depth"};
  text("clip.timing", "timing.csv", timing_header(stages) + three([](int f) {
                                      const std::vector<double> ms{1.5, 2.25};
                                      return timing_line(f, ms);
                                    }),
       read_timing);
  text("clip.trajectory", "trajectory.txt", std::string(kTrajectoryRemark) + three([](int f) {
                                              return trajectory_line({f / 30.0, pose_of(f)});
                                            }),
       read_trajectory);
  text("hands.lines", "hands.jsonl", three([](int f) {
         std::string joints = "[0,0.05,0]";
         for (int k = 1; k < 26; ++k) joints += fmt::format(",[{},{},0]", 0.001 * k, 0.0075 * k);
         return fmt::format(
             "{{\"time\":{},\"want\":[\"vertices\"],\"things\":[{{\"id\":1,\"capsules\":"
             "[[0,0,0.1,0,0,0.2,0.01,0.02]]}},{{\"id\":-2,\"hand\":\"openxr\",\"side\":\"left\","
             "\"joints\":[{}]}}]}}\n",
             0.25 * f, joints);
       }),
       [](const fs::path& path) {
         ThingsFile file(path);
         ThingsLine line;
         while (file.next(line)) {}
         return line;
       });
  text("place.toml", "scene.toml",
       "camera_from_body = [1, 0, 0, 0.1, 0, 0, -1, 0, 0, 1, 0, 0.5, 0, 0, 0, 1]\n"
       "press_static = true\n",
       [](const fs::path& path) { return read_scene_file(path); });
  text("place.txt", "place.txt", "# x y z\n0 0 0.5\n10 20 30 # degrees\n",
       [](const fs::path& path) { return read_pose(path.string()); });
  readers.push_back({.name = "clip.live",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_live_summary(folder / "live.json", some_summary());
                       return {"live.json"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           (void)read_live_file(file);
                           return std::string();
                         }});
  readers.push_back({.name = "clip.camera",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_truth_camera(folder / "camera.toml", some_camera());
                       return {"camera.toml"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           (void)read_truth_camera(file);
                           return std::string();
                         }});
  readers.push_back({.name = "clip.depth",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_measured_depth(folder / "measured.png", some_depth(), {});
                       write_true_depth(folder / "true.png", some_depth());
                       return {"measured.png", "true.png"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           (void)read_depth_counts(file);
                           return std::string();
                         }});
  readers.push_back({.name = "clip.masks",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       MaskImage mask(32, 18);
                       for (int x = 5; x < 20; ++x) mask.row(9)[x] = 255;
                       write_mask(folder / "mask.png", mask);
                       write_labels(folder / "labels.png", mask);
                       return {"mask.png", "labels.png"};
                     },
                     .read =
                         [](const fs::path& /*folder*/, const fs::path& file) {
                           (void)read_mask(file);
                           return std::string();
                         }});
}

}  // namespace palpable::fuzz
