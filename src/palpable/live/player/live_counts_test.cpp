#include "palpable/live/player/live_counts.h"

#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/test.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("a run is told in frames, troubles and touches", "[player][text]") {
  const test::MisbehavingCamera camera({});
  const FrameLoop loop = std::move(
      FrameLoop::make(test::DentedSphere{}.body(), Rigid3::Identity(), camera.format()).value());
  LiveCounts counts;
  counts.processed = {0, 1, 2, 4};
  CHECK(text_of(counts, loop.session, 0.1) ==
        "4 frames in 0.1 s (25 ms each), 0 unreadable\n"
        "never touched\n");
  counts.troubles.unreadable = 1;
  counts.last_trouble = "the picture is cut off";
  counts.lost = {2, 4};
  counts.new_worlds = {4};
  counts.touching = 2;
  counts.first_touch = 1;
  counts.deepest = 0.01234;
  CHECK(text_of(counts, loop.session, 2.0) ==
        "4 frames in 2.0 s (500 ms each), 1 unreadable\n"
        "last unreadable: the picture is cut off\n"
        "the camera was lost in 2 frames, first in frame 2\n"
        "a new world began once, first in frame 4: where bodies stood before is not known in it\n"
        "touched in 2 frames, first in frame 1, at most 12.3 mm deep\n");
  Scene scene;
  scene.seen.trouble = DepthTrouble::kRowsOff;
  for (const double rows : {-0.8, 0.6, std::nan("")}) {
    scene.number = 7 + static_cast<int>(counts.rows_off.size());
    scene.seen.row_error_px = rows;
    counts.add(scene);
  }
  scene.seen.trouble = DepthTrouble::kFewDepths;
  scene.number = 12;
  counts.add(scene);
  const std::string text = text_of(counts, loop.session, 2.0);
  CHECK_THAT(text, Contains("\nthe eyes' rows were up to 0.8 px out of line in 3 frames, first in "
                            "frame 7: calibrate the camera again\n"));
  CHECK_THAT(text, Contains("\nhardly any depth was found in 1 frames, first in frame 12: dark"));
}

}  // namespace
}  // namespace palpable
