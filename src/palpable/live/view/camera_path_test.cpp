#include "palpable/live/view/camera_path.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

TrackedPose at(double x, TrackState state = TrackState::kTracking) {
  TrackedPose camera{.state = state};
  camera.world_from_camera.translation().x() = x;
  return camera;
}

TEST_CASE("the path of a camera has a point every centimetre and ends where the camera is",
          "[view][camera_path]") {
  CameraPath path;
  for (int n = 0; n <= 25; ++n) path.add(at(0.004 * n));  // 0.1 m
  CHECK(path.poses().size() == 9);                        // 0, 12, 24 .. 96 mm
  std::vector<MapLine> lines;
  path.draw(lines);
  REQUIRE(lines.size() == 9);
  CHECK(lines.front().from.x() == 0);
  for (std::size_t i = 1; i < lines.size(); ++i) CHECK(lines[i].from == lines[i - 1].to);
  CHECK(lines.back().to.x() == Approx(0.1));
}

TEST_CASE("a camera that stands adds nothing to its path", "[view][camera_path]") {
  CameraPath path;
  for (int n = 0; n < 100; ++n) path.add(at(1, TrackState::kFixed));
  CHECK(path.poses().size() == 1);
}

TEST_CASE("the path has a gap where the camera was lost", "[view][camera_path]") {
  CameraPath path;
  path.add(at(0));
  path.add(at(0.1));
  path.add(at(0.1, TrackState::kLost));
  std::vector<MapLine> lines;
  path.draw(lines);
  CHECK(lines.size() == 1);  // no line leads to an unknown position
  path.add(at(0.5));
  path.add(at(0.6));
  lines.clear();
  path.draw(lines);
  double length = 0;
  for (const MapLine& line : lines) length += static_cast<double>((line.to - line.from).norm());
  CHECK(length == Approx(0.2));
}

TEST_CASE("the path has a gap where a loop was closed: the camera did not move there",
          "[view][camera_path]") {
  CameraPath path;
  path.add(at(0));
  path.add(at(0.1));
  TrackedPose corrected = at(0.3);
  corrected.closed_loop = true;
  path.add(corrected);
  path.add(at(0.4));
  std::vector<MapLine> lines;
  path.draw(lines);
  double length = 0;
  for (const MapLine& line : lines) length += static_cast<double>((line.to - line.from).norm());
  CHECK(length == Approx(0.2));
}

TEST_CASE("a path of hours keeps its length and its gaps, and takes no more memory",
          "[view][camera_path]") {
  CameraPath path;
  // Two straight paths of 100 m, 50 m apart.
  for (int i = 0; i <= 10000; ++i) path.add(at(0.01001 * i));
  path.add(at(0, TrackState::kLost));
  for (int i = 0; i <= 10000; ++i) path.add(at(150 + 0.01001 * i));
  CHECK(path.poses().size() <= 4096);
  CHECK(path.poses().size() > 1000);
  std::vector<MapLine> lines;
  path.draw(lines);
  double length = 0;
  for (const MapLine& line : lines) length += static_cast<double>((line.to - line.from).norm());
  CHECK(length == Approx(200.2).margin(test::tolerance(
                      0.16, "the last step before the gap: 1 cm, doubled four times")));
}

TEST_CASE("a camera that was never known has no path", "[view][camera_path]") {
  CameraPath path;
  path.add(at(0, TrackState::kStarting));
  std::vector<MapLine> lines;
  path.draw(lines);
  CHECK(lines.empty());
  CHECK(path.poses().empty());
}

}  // namespace
}  // namespace palpable
