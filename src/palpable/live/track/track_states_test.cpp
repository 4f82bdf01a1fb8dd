#include "palpable/live/track/track_states.h"

#include "tests/support/test.h"

#include <array>
#include <utility>

namespace palpable {
namespace {

using enum TrackState;
using enum FrameEvidence;

constexpr std::array kStates{kStarting, kFixed, kTracking, kLost};

TEST_CASE("whatever the camera did before, most evidence alone says its state", "[track][states]") {
  constexpr std::array<std::pair<FrameEvidence, TrackState>, 8> kAlone{{{kUnreadable, kLost},
                                                                        {kStartView, kStarting},
                                                                        {kOtherView, kLost},
                                                                        {kFirstKeyframe, kFixed},
                                                                        {kPatchesAtRest, kFixed},
                                                                        {kPoseFound, kTracking},
                                                                        {kCameToRest, kFixed},
                                                                        {kNoPose, kLost}}};
  for (const TrackState before : kStates) {
    for (const auto& [evidence, after] : kAlone) {
      INFO("state " << static_cast<int>(before) << ", evidence " << static_cast<int>(evidence));
      CHECK(next_state(before, evidence) == after);
    }
  }
}

TEST_CASE("only a camera that stood goes on standing by a pose at rest or while it is hidden",
          "[track][states]") {
  for (const TrackState before : kStates) {
    INFO("state " << static_cast<int>(before));
    CHECK(next_state(before, kPoseAtRest) == (before == kFixed ? kFixed : kTracking));
    CHECK(next_state(before, kHidden) == (before == kFixed ? kFixed : kLost));
  }
}

}  // namespace
}  // namespace palpable
