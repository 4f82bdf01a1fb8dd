#include "palpable/desk/script/disturbances.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/script/camera_motions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {

namespace {

constexpr std::array<std::string_view, 5> kNames = {"dark", "textureless", "exposure", "rolling",
                                                    "drift"};

double seconds(int frame) { return frame / kFramesPerSecond; }

double drifted_px(int frame) {
  const double t = seconds(frame);
  return (t >= 5.0 ? 0.5 : 0.0) + (t >= 12.0 ? 1.0 + 0.02 * (t - 12.0) : 0.0);
}

}  // namespace

bool is_disturbance(std::string_view name) {
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

void disturb(std::string_view name, Sequence& sequence) {
  PALPABLE_EXPECT(is_disturbance(name), "the disturbance is one of those listed");
  sequence.name = name;
  if (name == "dark") {
    sequence.faults.noise_grey_levels = 2.0;
    sequence.rig = [](int) { return RigState{.light = 1.0 / 30.0}; };
  } else if (name == "textureless") {
    sequence.look.bare = true;
  } else if (name == "exposure") {
    sequence.rig = [](int frame) {
      constexpr std::array<double, 6> kLight = {1.0, 0.5, 1.4, 0.7, 1.5, 0.45};
      return RigState{.light =
                          kLight[static_cast<std::size_t>(seconds(frame) / 3.0) % kLight.size()]};
    };
  } else if (name == "rolling") {
    sequence.camera_from_desk =
        held(swaying(sequence.seed), std::max(sequence.frames, 30), sequence.seed);
    sequence.rig = [](int) { return RigState{.readout = 0.016}; };
  } else {
    sequence.rig = [](int frame) {
      // 0.1 px is more than the ramp moves in one frame.
      const bool step = frame > 0 && drifted_px(frame) - drifted_px(frame - 1) > 0.1;
      return RigState{.row_offset_px = drifted_px(frame), .row_step = step};
    };
  }
}

}  // namespace palpable
