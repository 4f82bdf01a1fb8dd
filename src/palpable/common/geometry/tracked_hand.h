/// @file
/// The capsules of a hand whose joints a hand tracker has found.
///
/// World frame, m.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace palpable {

/// The joints that a tracker gives, in its order.
///
///     kOpenXr     26: palm, wrist, thumb metacarpal proximal distal tip, then index, middle, ring,
///                 little: metacarpal proximal intermediate distal tip. XrHandJointEXT
///     kWebXr      25: the same without the palm. XRHandJoint
///     kMediaPipe  21: wrist, thumb CMC MCP IP tip, then index, middle, ring, little: MCP PIP DIP
///                 tip. Its tips lie on the skin, those of the others inside
enum class HandLayout { kOpenXr, kWebXr, kMediaPipe };

[[nodiscard]] int joint_count(HandLayout layout);

/// "openxr", "webxr", "mediapipe".
[[nodiscard]] std::string_view name_of(HandLayout layout);
/// Nothing for another text.
[[nodiscard]] std::optional<HandLayout> hand_layout_named(std::string_view name);

enum class HandSide { kLeft, kRight };

/// "left", "right"; nothing for another text.
[[nodiscard]] std::optional<HandSide> hand_side_named(std::string_view name);

/// Radii of the synthetic desk's hand, m. Its length, from the wrist along the bones of the middle
/// finger to the centre of its tip, is kMeanHandLength.
inline constexpr double kMeanHandLength = 0.1866;
/// Of the thumb: metacarpal, proximal, distal joint, tip.
inline constexpr std::array<double, 4> kMeanThumbRadii = {0.0155, 0.0120, 0.0098, 0.0083};
/// Of index, middle, ring and little finger: root of the bone in the palm, knuckle, middle joint,
/// last joint, tip.
inline constexpr std::array<std::array<double, 5>, 4> kMeanFingerRadii = {{
    {0.0145, 0.0112, 0.0094, 0.0083, 0.0070},
    {0.0150, 0.0114, 0.0095, 0.0084, 0.0071},
    {0.0150, 0.0108, 0.0090, 0.0079, 0.0067},
    {0.0140, 0.0098, 0.0079, 0.0069, 0.0059},
}};

/// Three for each finger and the thumb, then the palm: four bones, three webs, three pads, and the
/// wrist.
inline constexpr int kTrackedHandCapsules = 26;
using TrackedHand = std::array<Capsule, kTrackedHandCapsules>;

/// The hand around these joints. Each bone of a finger is a capsule whose radii are those of its
/// two joints. The palm's radii, and all where the tracker gives none, are those of the synthetic
/// desk's hand (desk/script/hand.h), which is 187 mm long, times the length of this one: 185 mm is
/// the mean of 267 men, 168 mm that of 331 women (Binvignat et al., Int. J. Morphol. 30, 2012).
/// A problem names what is wrong: a joint that is no number, or a hand that is not 80 to 300 mm
/// long, as when its joints are in mm.
/// @param joints  (joint_count()) m
/// @param radii   (joint_count()) m, distance of the skin from each joint; empty: not known
[[nodiscard]] Result<TrackedHand> tracked_hand(HandLayout layout, HandSide side,
                                               std::span<const Eigen::Vector3d> joints,
                                               std::span<const double> radii = {});

}  // namespace palpable
