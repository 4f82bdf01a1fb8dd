#include "palpable/live/live_writer/live_output.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/live/render/picture_file.h"
#include "tests/support/allocations.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sys/stat.h>
#include <thread>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64;  // px of the picture
constexpr int kHeight = 48;

// Fills in frame `number` of a run at 20 frames per second.
void fill(DrawnFrame& drawn, int number) {
  Scene& scene = drawn.scene;
  scene = Scene();
  scene.number = number;
  scene.time = 0.05 * number;
  scene.bodies.resize(1);
  scene.bodies[0].camera_from_body.translation() = Eigen::Vector3d(0.1 * number, 0, 0.5);
  scene.seen.depth = DepthImage(kWidth / 2, kHeight / 2, 0.25F);
  scene.seen.row_correction_px = number < 2 ? 0.5 : 0.75;
  scene.moving = MaskImage(kWidth / 2, kHeight / 2, 255);
  scene.times.add("read", 2);
  scene.times.add("contact", 3);
  drawn.picture = ColorImage(kWidth, kHeight, Rgb{200, 100, 50});
  drawn.visible = MaskImage(kWidth, kHeight, 255);
  drawn.body_depth = DepthImage(kWidth, kHeight, 0.5F);
  drawn.scores = {};
}

TEST_CASE("every file of a run can be read by its reader", "[live_writer]") {
  const test::ScratchFolder folder("live_output");
  LiveOutput output(
      {.folder = folder / "out", .files = {.stills = true}, .starts_at = 1305031098.25});
  for (int number = 0; number < 3; ++number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    fill(*drawn, number);
    if (number == 1) {
      drawn->scene.touches.push_back({4, 0.5, 1.25, 0.003, {0.01, 0.02, 0.03}, {0, -1, 0}});
      drawn->scores.touch = 10;
    }
    if (number == 2) drawn->scene.camera.state = TrackState::kLost;
    output.write(std::move(drawn));
  }
  output.finish();
  const fs::path out = folder / "out";
  CHECK(fs::file_size(out / "touch.mp4") > 500);
  CHECK_FALSE(output.codec().empty());
  CHECK(output.figures() == std::vector<std::string>{"touch.png"});
  CHECK(fs::exists(out / "touch.png"));

  const TimingTable times = read_timing(out / "timing.csv");
  REQUIRE(times.ms.size() == 3);
  CHECK(times.stages.back() == "total");
  CHECK(times.ms[2].front() == 2);
  CHECK(times.ms[2].back() >= 5);  // the stage "write" is included
  REQUIRE(output.times().size() == times.stages.size());
  CHECK(output.times().front().second == std::vector<double>{2, 2, 2});

  const std::vector<TouchesLine> felt = read_touches(out / "touches.jsonl");
  REQUIRE(felt.size() == 1);
  CHECK(felt[0].frame == 1);
  REQUIRE(felt[0].touches.size() == 1);
  CHECK(felt[0].touches[0].site == 4);
  CHECK(felt[0].touches[0].press_depth == 0.003);
  CHECK(felt[0].touches[0].force == Eigen::Vector3d(0, -1.25, 0));
  CHECK(felt[0].touches[0].time == 0.05);
  const std::vector<PoseLine> poses = read_poses(out / "pose.jsonl");
  REQUIRE(poses.size() == 3);
  CHECK(poses[2].camera_from_body.translation().x() == Approx(0.2));
  const std::vector<StampedPose> path = read_trajectory(out / "trajectory.txt");
  REQUIRE(path.size() == 2);  // frames with a lost camera are skipped
  CHECK(path[1].time == Approx(1305031098.25 + felt[0].touches[0].time.value()).margin(1e-6));
  const std::vector<CorrectionLine> corrections = read_corrections(out / "rectification.jsonl");
  REQUIRE(corrections.size() == 2);  // only changes are written
  CHECK(corrections[1].frame == 2);
  CHECK(corrections[1].row_correction_px == 0.75);

  CHECK(read_depth_counts(out / "depth/000002.png").value()(3, 3) == 1000);
  CHECK(read_depth_counts(out / "body_depth/000002.png").value()(3, 3) == 5000);
  CHECK(read_mask(out / "visible/000000.png").value().width() == kWidth);
  CHECK(read_mask(out / "moving/000000.png").value().width() == kWidth / 2);
}

TEST_CASE("touches anywhere are written with what is known of them, and the body as it is drawn",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_meshes");
  SurfaceMesh rest;
  rest.vertices = Eigen::Matrix3Xd::Identity(3, 3);
  rest.triangles.resize(3, 1);
  rest.triangles << 0, 1, 2;
  const fs::path out = folder / "out";
  LiveOutput output({.folder = out, .meshes_of = {rest}});
  for (int number = 0; number < 2; ++number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    fill(*drawn, number);
    Scene& scene = drawn->scene;
    scene.bodies[0].vertices = rest.vertices.cast<float>();
    scene.bodies[0].vertices(2, 0) -= 0.25f * static_cast<float>(number);
    scene.bodies[0].von_mises = {0, 10, 20.0f * static_cast<float>(number)};
    if (number == 1) {
      Touch one;
      one.force = 2;
      one.direction = -Eigen::Vector3d::UnitZ();
      one.area = 4e-5;
      one.assumed = 0.75;
      scene.touches = {one, one};
      scene.bodies[0].stated_error = StatedError{.displacement = 0.025, .von_mises = 0.0625};
    }
    output.write(std::move(drawn));
  }
  output.finish();
  const std::vector<TouchesLine> felt = read_touches(out / "touches.jsonl");
  REQUIRE(felt.size() == 1);
  REQUIRE(felt[0].touches.size() == 2);
  CHECK(felt[0].touches[1].site == -1);
  CHECK_FALSE(felt[0].touches[1].level.has_value());
  CHECK(felt[0].touches[1].force == Eigen::Vector3d(0, 0, -2));
  CHECK(felt[0].touches[1].area == 4e-5);
  CHECK(felt[0].touches[1].assumed == 0.75);
  CHECK(felt[0].displacement_error == 0.025);
  CHECK(felt[0].stress_error == 0.0625);
  const ValuedSurface at_rest =
      value_or_throw(read_valued_ply(out / "meshes/rest.ply", kVonMisesProperty));
  CHECK(at_rest.surface.vertices == rest.vertices);
  const ValuedSurface pressed =
      value_or_throw(read_valued_ply(out / "meshes/000001.ply", kVonMisesProperty));
  CHECK(pressed.surface.vertices(2, 0) == -0.25);
  CHECK(pressed.values == Eigen::Vector3d(0, 10, 20));
}

TEST_CASE("the picture of a touch is one of a frame that truly touches", "[live_writer]") {
  const test::ScratchFolder folder("live_output_touch");
  const fs::path clip = folder / "clip";
  fs::create_directories(clip / "truth");
  fs::create_directories(clip / "frames");
  CHECK_FALSE(truly_touching_frames(clip / "frames").has_value());
  const Eigen::Vector3d place(0.01, 0.02, 0.03);
  std::ofstream(clip / "truth" / "contact.jsonl")
      << contact_line({.frame = 0, .touching = true, .depth = 0.0039, .point = place})
      << contact_line({.frame = 1, .touching = false})
      << contact_line({.frame = 2, .touching = true, .depth = 0.004, .point = place})
      << contact_line({.frame = 3, .touching = true, .depth = 0.004, .point = place});
  const auto frames = truly_touching_frames(clip / "frames/");
  REQUIRE(frames.has_value());
  CHECK(*frames == std::vector<int>{2, 3});

  // Frame 1 has the strongest touch, but in truth nothing touches there.
  LiveOutput output({.folder = folder / "out", .files = {.stills = true}, .touch_frames = frames});
  for (int number = 0; number < 4; ++number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    fill(*drawn, number);
    drawn->picture = ColorImage(kWidth, kHeight, Rgb{static_cast<std::uint8_t>(50 * number), 0, 0});
    drawn->scores.touch = std::array{5.0, 9.0, 4.0, 1.0}[number];
    output.write(std::move(drawn));
  }
  output.finish();
  write_png(folder / "expected.png", ColorImage(kWidth, kHeight, Rgb{100, 0, 0}));
  CHECK(test::file_bytes(folder / "out" / "touch.png") ==
        test::file_bytes(folder / "expected.png"));
}

TEST_CASE("pictures of the frames that are asked for are written as they were shown",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_pictures");
  for (const bool all : {false, true}) {
    const fs::path out = folder / (all ? "all" : "some");
    LiveOutput output({.folder = out, .all_pictures = all, .kept_pictures = {1, 3}});
    for (int number = 0; number < 4; ++number) {
      std::unique_ptr<DrawnFrame> drawn = output.blank();
      fill(*drawn, number);
      drawn->picture =
          ColorImage(kWidth, kHeight, Rgb{static_cast<std::uint8_t>(50 * number), 0, 0});
      output.write(std::move(drawn));
    }
    output.finish();
    for (int number = 0; number < 4; ++number) {
      const fs::path file = out / "pictures" / fmt::format("{:06}.png", number);
      INFO(file);
      REQUIRE(fs::exists(file) == (all || number % 2 == 1));
      if (!fs::exists(file)) continue;
      write_png(folder / "expected.png",
                ColorImage(kWidth, kHeight, Rgb{static_cast<std::uint8_t>(50 * number), 0, 0}));
      CHECK(test::file_bytes(file) == test::file_bytes(folder / "expected.png"));
    }
    CHECK(holds_earlier_run(out, true, {}));
    remove_earlier_run(out);
    CHECK_FALSE(fs::exists(out / "pictures"));  // removed together with the run
  }
}

TEST_CASE("a run of one frame has a video, one without depth and masks no folders of them",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_one");
  LiveOutput output({.folder = folder.path(), .files = {.depth = false, .masks = false}});
  std::unique_ptr<DrawnFrame> drawn = output.blank();
  fill(*drawn, 7);
  output.write(std::move(drawn));
  output.finish();
  CHECK(fs::exists(folder / "touch.mp4"));
  for (const char* name : {"depth", "visible", "body_depth", "moving", "touch.png"}) {
    INFO(name);
    CHECK_FALSE(fs::exists(folder / name));
  }
}

TEST_CASE("a run without a camera has no files about one, and its touches name what pressed",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_things");
  LiveOutput output({.folder = folder.path(),
                     .files = {.film = false, .depth = false, .masks = false},
                     .has_camera = false});
  std::unique_ptr<DrawnFrame> drawn = output.blank();
  fill(*drawn, 7);
  drawn->scene.things = {5, -9'000'000'000'000'000'001};
  drawn->scene.touches.resize(2);
  drawn->scene.touches[0].thing = 1;
  drawn->scene.touches[1].thing = -1;
  output.write(std::move(drawn));
  output.finish();
  const std::vector<TouchesLine> touches = read_touches(folder / "touches.jsonl");
  REQUIRE(touches.size() == 1);
  CHECK(touches[0].touches[0].thing == -9'000'000'000'000'000'001);
  CHECK_FALSE(touches[0].touches[1].thing);
  for (const char* name : {"trajectory.txt", "pose.jsonl", "rectification.jsonl"}) {
    INFO(name);
    CHECK_FALSE(fs::exists(folder / name));
  }
}

TEST_CASE("what cannot be written is said by the next frame or at the end, not lost",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_fails");
  LiveOutput output({.folder = folder.path()});
  fs::remove_all(folder / "depth");
  std::ofstream(folder / "depth") << "a file in the way";
  const auto play = [&] {
    for (int number = 0; number < 20; ++number) {
      std::unique_ptr<DrawnFrame> drawn = output.blank();
      fill(*drawn, number);
      output.write(std::move(drawn));
    }
    output.finish();
  };
  CHECK_THROWS_WITH(play(), Catch::Contains("depth/000000.png"));
}

TEST_CASE("what was written is on the disk soon, also while no frame comes", "[live_writer]") {
  const test::ScratchFolder folder("live_output_flushed");
  LiveOutput output({.folder = folder.path()});
  const auto write = [&](int number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    fill(*drawn, number);
    output.write(std::move(drawn));
  };
  for (int number = 0; number < 3; ++number) write(number);
  // The source stalls: no further frame comes. If nothing is flushed, this loop never ends.
  while (read_poses(folder / "pose.jsonl").size() < 3) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  CHECK(read_timing(folder / "timing.csv").ms.size() == 3);
  CHECK(read_trajectory(folder / "trajectory.txt").size() == 3);
  CHECK(fs::file_size(folder / "touch.mp4") > 0);
}

TEST_CASE("a full disk ends the run, and what was written before can be read",
          "[live_writer][refusal]") {
  const test::ScratchFolder folder("live_output_full");
  {
    const test::FileSizeLimit limit(4000);
    LiveOutput output({.folder = folder.path()});
    const auto play = [&] {
      for (int number = 0; number < 100; ++number) {
        std::unique_ptr<DrawnFrame> drawn = output.blank();
        fill(*drawn, number);
        if (number == 5) {  // noise, which does not compress to so few bytes
          drawn->visible.resize(400, 400);
          auto random = test::random_case(5);
          for (std::uint8_t& value : drawn->visible) value = static_cast<std::uint8_t>(random());
        }
        output.write(std::move(drawn));
      }
    };
    CHECK_THROWS_WITH(play(),
                      Catch::EndsWith("visible/000005.png: cannot be written: File too large"));
  }
  CHECK(read_poses(folder / "pose.jsonl").size() == 5);
  CHECK(read_timing(folder / "timing.csv").ms.size() == 5);
  CHECK(read_mask(folder / "visible/000004.png").value().width() == kWidth);
  CHECK_FALSE(fs::exists(folder / "visible/000005.png"));
  cv::VideoCapture film((folder / "touch.mp4").string(), cv::CAP_FFMPEG);
  int pictures = 0;
  for (cv::Mat picture; film.read(picture);) ++pictures;
  CHECK(pictures == 5);
}

TEST_CASE("an earlier run is replaced only when that is asked for, and only what is a run's",
          "[live_writer][refusal]") {
  const test::ScratchFolder folder("earlier_run");
  const fs::path out = folder / "out";
  CHECK_FALSE(holds_earlier_run(out, false, {}));
  test::write_bytes(out / "notes.txt", "mine");
  CHECK_FALSE(holds_earlier_run(out, false, {folder / "notes.txt"}));
  CHECK_THROWS_WITH(holds_earlier_run(out, false, {out}), Catch::Contains("is read by this run"));
  // Writing to a dangling link would create its target.
  fs::create_symlink(folder / "nowhere", out / "touch.mp4");
  CHECK_THROWS_WITH(holds_earlier_run(out, true, {}), Catch::Contains("touch.mp4: is in the way"));
  fs::remove(out / "touch.mp4");
  // A folder called depth alone may be a user's data.
  fs::create_directories(out / "depth");
  CHECK_THROWS_WITH(holds_earlier_run(out, true, {}), Catch::Contains("not of an earlier run"));

  test::write_bytes(out / "timing.csv", "lap,seconds\n");  // this timing.csv is not a run's
  CHECK_THROWS_WITH(holds_earlier_run(out, true, {}), Catch::Contains("timing.csv: is in the way"));
  test::write_bytes(out / "timing.csv", "");  // left by a run killed before its first line
  CHECK(holds_earlier_run(out, true, {}));
  test::write_bytes(out / "timing.csv", "frame,total_ms\n");
  CHECK_THROWS_WITH(holds_earlier_run(out, false, {}), Catch::Contains("--overwrite"));
  CHECK(holds_earlier_run(out, true, {folder / "body.palpable"}));
  CHECK(fs::exists(out / "timing.csv"));  // nothing was removed
  // A path that this run reads must not be removed: neither a file inside the output nor the folder
  // itself, however it is named.
  CHECK_THROWS_WITH(holds_earlier_run(out, true, {out / "depth" / "000000.png"}),
                    Catch::Contains("is needed by this run"));
  for (const fs::path& needed : {out, out / "depth" / ".."}) {
    INFO(needed);
    CHECK_THROWS_WITH(holds_earlier_run(out, true, {needed}),
                      Catch::Contains("is read by this run"));
  }
  CHECK_NOTHROW(holds_earlier_run(out, true, {out / "notes.txt", {}}));

  // Files with these names in depth/ are a run's, others are somebody's.
  test::write_bytes(out / "depth" / "000000.png", "");
  test::write_bytes(out / "depth" / "mine.png", "mine");
  test::write_bytes(out / "visible" / "000000.png", "");
  remove_earlier_run(out);
  CHECK_FALSE(fs::exists(out / "timing.csv"));
  CHECK_FALSE(fs::exists(out / "depth" / "000000.png"));
  CHECK(test::file_bytes(out / "depth" / "mine.png") == "mine");
  CHECK_FALSE(fs::exists(out / "visible"));
  CHECK(test::file_bytes(out / "notes.txt") == "mine");
}

TEST_CASE("results are not written among what a run reads", "[live_writer][refusal]") {
  const test::ScratchFolder folder("among_images");
  const fs::path clip = folder / "clip";
  test::write_bytes(clip / "left" / "000000.png", "");
  for (const char* inside : {"", "left", "left/out", "out"}) {
    INFO(inside);
    CHECK_THROWS_WITH(holds_earlier_run(clip / inside, true, {folder / "a.palpable", clip}),
                      Catch::Contains("is read by this run; write into another folder"));
  }
  CHECK_FALSE(holds_earlier_run(folder / "clip2", true, {clip}));
  CHECK_FALSE(holds_earlier_run(folder.path(), true, {clip}));
  // Files by name are read from their folder, but not from those within it.
  CHECK_THROWS_WITH(holds_earlier_run(clip / "left", true, {clip / "left" / "*.png"}),
                    Catch::Contains("is read by this run"));
  CHECK_FALSE(holds_earlier_run(clip / "left" / "out", true, {clip / "left" / "*.png"}));
  // A folder in the place of a file, which the end of the run could not write.
  test::write_bytes(folder / "out" / "timing.csv", "");
  fs::create_directories(folder / "out" / "touch.mp4");
  CHECK_THROWS_WITH(holds_earlier_run(folder / "out", true, {}),
                    Catch::Contains("touch.mp4: is a folder and in the way"));
}

TEST_CASE("of several bodies each has its lines and its meshes", "[live_writer]") {
  const test::ScratchFolder folder("live_output_bodies");
  SurfaceMesh rest;
  rest.vertices = Eigen::Matrix3Xd::Identity(3, 3);
  rest.triangles.resize(3, 1);
  rest.triangles << 0, 1, 2;
  const fs::path out = folder / "out";
  LiveOutput output({.folder = out, .bodies = {"lower", "upper"}, .meshes_of = {rest, rest}});
  for (int number = 0; number < 2; ++number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    fill(*drawn, number);
    Scene& scene = drawn->scene;
    scene.bodies.resize(2);
    for (std::size_t k = 0; k < 2; ++k) {
      scene.bodies[k].camera_from_body.translation().x() = static_cast<double>(k);
      scene.bodies[k].vertices = rest.vertices.cast<float>();
      scene.bodies[k].vertices(2, 0) -= 0.25f * static_cast<float>(k);
      scene.bodies[k].von_mises = {0, 0, 0};
    }
    Touch touch;
    touch.force = 2;
    touch.body = number;
    scene.touches = {touch};
    output.write(std::move(drawn));
  }
  output.finish();
  CHECK(read_touches(out / "touches.jsonl", "lower").at(0).frame == 0);
  CHECK(read_touches(out / "touches.jsonl", "upper").at(0).frame == 1);
  CHECK(read_touches(out / "touches.jsonl", "upper").size() == 1);
  CHECK(read_touches(out / "touches.jsonl").empty());  // without a name: lines of a single body
  REQUIRE(read_poses(out / "pose.jsonl", "upper").size() == 2);
  CHECK(read_poses(out / "pose.jsonl", "upper")[1].camera_from_body.translation().x() == 1);
  CHECK(read_poses(out / "pose.jsonl", "lower")[1].camera_from_body.translation().x() == 0);
  const ValuedSurface upper =
      value_or_throw(read_valued_ply(out / "meshes/upper/000001.ply", kVonMisesProperty));
  CHECK(upper.surface.vertices(2, 0) == -0.25);
  CHECK(fs::exists(out / "meshes/lower/rest.ply"));
}

// A disk that blocks while the depth of frame 0 is written, until go_on() reads it.
class StuckDisk {
 public:
  explicit StuckDisk(const fs::path& folder) : fifo_(folder / "depth" / "000000.png") {
    fs::create_directories(folder / "depth");
    REQUIRE(::mkfifo(fifo_.c_str(), 0600) == 0);
  }
  void go_on() {
    reader_ = std::thread([fifo = fifo_] { (void)test::file_bytes(fifo); });
  }
  StuckDisk(const StuckDisk&) = delete;
  StuckDisk& operator=(const StuckDisk&) = delete;
  ~StuckDisk() {
    if (reader_.joinable()) reader_.join();
  }

 private:
  fs::path fifo_;
  std::thread reader_;
};

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_CASE("no frame of the pool is lost where lines are left out", "[live_writer]") {
  const test::ScratchFolder folder("live_output_pool");
  const fs::path out = folder / "out";
  StuckDisk disk(out);
  LiveOutput output({.folder = out, .complete = false});
  int number = 0;
  const auto write = [&](std::unique_ptr<DrawnFrame> drawn) {
    fill(*drawn, number++);
    output.write(std::move(drawn));
  };
  // The fourth frame is still being drawn when all lines are in use.
  for (int k = 0; k < 3; ++k) write(output.blank());
  std::unique_ptr<DrawnFrame> drawn = output.blank();
  REQUIRE(drawn->in_files);
  while (output.lines_left_out() == 0) write(output.blank());
  write(std::move(drawn));
  CHECK(output.lines_left_out() == 2);
  CHECK(output.left_out() == number - 3);
  disk.go_on();
  while (read_timing(out / "timing.csv").ms.size() < LiveOutput::kLines) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::array<std::unique_ptr<DrawnFrame>, 4> frames;
  for (auto& frame : frames) {
    frame = output.blank();
    CHECK(frame->in_files);
  }
  for (auto& frame : frames) write(std::move(frame));
  output.finish();
  CHECK(output.lines_left_out() == 2);
  CHECK(files_in(out / "depth") == 7);
}

TEST_CASE("a slow disk holds nothing up: texts have every frame, what is large has gaps",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_gaps");
  const fs::path out = folder / "out";
  StuckDisk disk(out);
  LiveOutput output({.folder = out, .complete = false});
  constexpr int kFrames = 40;
  std::vector<int> in_files;
  for (int number = 0; number < kFrames; ++number) {  // ends although nothing can be written
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    if (drawn->in_files) in_files.push_back(number);
    fill(*drawn, number);
    drawn->scene.touches.push_back({4, 0.5, 1.25, 0.003, {0.01, 0.02, 0.03}, {0, -1, 0}});
    output.write(std::move(drawn));
  }
  CHECK(in_files == std::vector<int>{0, 1, 2, 3});
  CHECK(output.left_out() == kFrames - 4);
  disk.go_on();
  output.finish();
  CHECK(output.lines_left_out() == 0);
  const TimingTable times = read_timing(out / "timing.csv");
  REQUIRE(times.ms.size() == kFrames);
  CHECK(times.ms.back().front() == 2);
  REQUIRE(read_touches(out / "touches.jsonl").size() == kFrames);
  CHECK(read_touches(out / "touches.jsonl").back().touches.at(0).press_depth == 0.003);
  CHECK(read_poses(out / "pose.jsonl").size() == kFrames);
  CHECK(read_trajectory(out / "trajectory.txt").size() == kFrames);
  CHECK(read_corrections(out / "rectification.jsonl").size() == 2);
  for (const char* name : {"depth", "visible", "body_depth", "moving"}) {
    INFO(name);
    CHECK(files_in(out / name) == 4);
  }
}

TEST_CASE("once the disk goes on, frames are written again, and the film keeps its pace",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_again");
  const fs::path out = folder / "out";
  StuckDisk disk(out);
  LiveOutput output({.folder = out, .complete = false});
  std::vector<int> written;  // numbers of the frames in the large files
  int number = 0;
  const auto play = [&] {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    const bool in_files = drawn->in_files;
    if (in_files) written.push_back(number);
    fill(*drawn, number++);
    output.write(std::move(drawn));
    return in_files;
  };
  for (int i = 0; i < 10; ++i) play();
  CHECK(written.size() == 4);
  disk.go_on();
  while (written.size() < 12) {
    if (!play()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  output.finish();
  CHECK(output.left_out() == number - 12);
  cv::VideoCapture film((out / "touch.mp4").string(), cv::CAP_FFMPEG);
  std::vector<double> shown;  // s
  for (cv::Mat picture; film.read(picture);) {
    shown.push_back(1e-3 * film.get(cv::CAP_PROP_POS_MSEC));
  }
  REQUIRE(shown.size() == written.size());
  for (std::size_t i = 0; i < 6; ++i) {  // OpenCV does not report the times of the last few
    INFO("picture " << i);
    CHECK(shown[i] - shown[0] == Approx(0.05 * written[i]).margin(1e-3));  // 20 a second
  }
}

TEST_CASE("of a disk that stands still for long even lines are left out, and counted",
          "[live_writer]") {
  const test::ScratchFolder folder("live_output_stuck");
  const fs::path out = folder / "out";
  StuckDisk disk(out);
  LiveOutput output({.folder = out, .complete = false});
  constexpr int kLines = static_cast<int>(LiveOutput::kLines);
  constexpr int kFrames = kLines + 7;
  const auto play = [&](int number) {
    std::unique_ptr<DrawnFrame> drawn = output.blank();
    if (number < 10) {
      fill(*drawn, number);
      drawn->scene.touches.resize(3);
    }
    drawn->scene.number = number;
    output.write(std::move(drawn));
  };
  for (int number = 0; number < 10; ++number) play(number);
  // Wait until the output's thread blocks, so that only allocations of this thread are counted.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(test::allocations_during([&] {
          for (int number = 10; number < kFrames; ++number) play(number);
        }) == 0);
  CHECK(output.lines_left_out() == 7);
  CHECK(output.left_out() == kFrames - 4);
  disk.go_on();
  output.finish();
  CHECK(read_timing(out / "timing.csv").ms.size() == kLines);
}

TEST_CASE("a run that is to be complete waits for a slow disk", "[live_writer]") {
  const test::ScratchFolder folder("live_output_complete");
  const fs::path out = folder / "out";
  StuckDisk disk(out);
  LiveOutput output({.folder = out});
  constexpr int kFrames = 12;
  std::atomic<int> played = 0;
  std::thread loop([&] {
    for (int number = 0; number < kFrames; ++number) {
      std::unique_ptr<DrawnFrame> drawn = output.blank();
      fill(*drawn, number);
      output.write(std::move(drawn));
      ++played;
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  CHECK(played <= 4);
  disk.go_on();
  loop.join();
  output.finish();
  CHECK(output.left_out() == 0);
  for (const char* name : {"depth", "visible", "body_depth", "moving"}) {
    INFO(name);
    CHECK(files_in(out / name) == kFrames);
  }
}

TEST_CASE("what cannot be written ends a run that does not wait, too", "[live_writer]") {
  const test::ScratchFolder folder("live_output_fails_live");
  LiveOutput output({.folder = folder.path(), .complete = false});
  fs::remove_all(folder / "depth");
  std::ofstream(folder / "depth") << "a file in the way";
  const auto play = [&] {
    for (int number = 0;; ++number) {  // ends with an exception
      std::unique_ptr<DrawnFrame> drawn = output.blank();
      fill(*drawn, number);
      output.write(std::move(drawn));
    }
  };
  CHECK_THROWS_WITH(play(), Catch::Contains("depth/000000.png"));
}

}  // namespace
}  // namespace palpable
