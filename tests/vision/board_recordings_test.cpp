// Chessboard pictures of other groups. The case is skipped with a message if they are missing.
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/folder_source.h"
#include "tests/support/test.h"

#include <filesystem>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Published with the pictures (intrinsics.yml): f = 534.80 px; |T| = 3.327 squares is OpenCV's own
// result (data README).
TEST_CASE("OpenCV's thirteen pairs give the published calibration", "[calibrate][real]") {
  const fs::path data = "../shared/data/calib_opencv";
  if (!fs::exists(data)) PALPABLE_SKIP("no folder " + data.string());
  const auto source = value_or_throw(open_folder(data, {.without_calibration = true}));
  const BoardPattern pattern{9, 6, 0.025};
  std::vector<BoardView> views;
  Frame frame;
  while (source->next(frame) == FrameStatus::kFrame) {
    if (auto seen = find_board(frame.left, frame.right, pattern)) {
      seen->number = frame.number;
      views.push_back(std::move(*seen));
    }
  }
  CHECK(source->frame_count() == 13);
  const auto found = value_or_throw(
      calibrate_boards(views, pattern, source->format().width, source->format().height));
  const StereoRig& rig = found.calibration.rig;
  INFO("f " << rig.left.pinhole.fx_px << " " << rig.left.pinhole.fy_px << " "
            << rig.right.pinhole.fx_px << " " << rig.right.pinhole.fy_px << " |T| "
            << rig.right_from_left.translation().norm() / pattern.square << " squares, rms "
            << found.reprojection_px << ", rows " << found.row_error_px << ", sigma "
            << found.focal_sigma << ", tilt " << found.tilt << ", views " << views.size());
  for (const DistortedCamera* eye : {&rig.left, &rig.right}) {
    CHECK(eye->pinhole.fx_px == Approx(534.8).epsilon(0.01));
    CHECK(eye->pinhole.fy_px == Approx(534.8).epsilon(0.01));
  }
  CHECK(rig.right_from_left.translation().norm() / pattern.square == Approx(3.327).epsilon(0.01));
  CHECK(found.row_error_px <= 0.2);
  CHECK(found.reprojection_px <= 0.4);
}

}  // namespace
}  // namespace palpable
