#include "palpable/live/capi/hands.h"

#include "palpable/common/geometry/tracked_hand.h"
#include "palpable/live/capi/guarded.h"

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

using palpable::Failure;
using palpable::HandLayout;

namespace {

HandLayout layout_of(int32_t layout) {
  switch (layout) {
    case PALPABLE_OPENXR_HAND:
      return HandLayout::kOpenXr;
    case PALPABLE_WEBXR_HAND:
      return HandLayout::kWebXr;
    case PALPABLE_MEDIAPIPE_HAND:
      return HandLayout::kMediaPipe;
    default:
      throw Failure(PALPABLE_WRONG_ARGUMENT,
                    fmt::format("layout {} is no palpable_hand_joints", layout));
  }
}

}  // namespace

palpable_status palpable_hand_capsules(int32_t layout, int32_t side, const double* joints,
                                       const double* radii, palpable_capsule* capsules) {
  return palpable::guarded([&] {
    const HandLayout wanted = layout_of(layout);
    palpable::require(side == PALPABLE_LEFT || side == PALPABLE_RIGHT, "side is no palpable_side");
    palpable::require(joints != nullptr, "joints is null");
    palpable::require(capsules != nullptr, "capsules is null");
    const auto count = static_cast<std::size_t>(palpable::joint_count(wanted));
    std::array<Eigen::Vector3d, 26> places;
    for (std::size_t k = 0; k < count; ++k) places[k] = Eigen::Vector3d(joints + 3 * k);
    std::span<const double> given;
    if (radii != nullptr) given = {radii, count};
    const auto hand = palpable::tracked_hand(
        wanted, side == PALPABLE_LEFT ? palpable::HandSide::kLeft : palpable::HandSide::kRight,
        std::span(places).first(count), given);
    if (!hand.ok()) throw Failure(PALPABLE_WRONG_ARGUMENT, hand.problem().message);
    static_assert(PALPABLE_HAND_CAPSULES == palpable::kTrackedHandCapsules);
    for (const palpable::Capsule& capsule : hand.value()) {
      palpable_capsule& to = *capsules++;
      Eigen::Vector3d::Map(to.a) = capsule.a;
      Eigen::Vector3d::Map(to.b) = capsule.b;
      to.radius_a = capsule.ra;
      to.radius_b = capsule.rb;
    }
  });
}
