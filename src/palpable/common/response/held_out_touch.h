/// @file
/// How good a body's tables of touch are, told with them: touches that no table is made from, each
/// answered by the tables and by full finite elements with contact on the same mesh.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// What presses. The numbers stand in body files.
enum class PressingThing {
  kFinger,  ///< a tip of radius 8 mm
  kPencil,  ///< a tip of radius 3.5 mm
  kPalm,    ///< part of a ball of radius 150 mm
  kHand,    ///< four fingers lying side by side, radius 9 mm, 18 mm apart
  kRim,     ///< of a cup: half a ring of radius 40 mm, 3 mm thick
  kSqueeze  ///< two fingers from opposite sides
};
inline constexpr int kPressingThings = 6;
[[nodiscard]] std::string name_of(PressingThing thing);

/// One touch. Differences are those of the tables' answer from the full one.
struct HeldOutTouch {
  PressingThing thing = PressingThing::kFinger;
  double depth = 0;         ///< m that the thing has gone on since it just touched
  double displacement = 0;  ///< relative L2 over the skin's vertices
  double force = 0;         ///< of the resultant, relative; of a squeeze, of the norms' sum
  double von_mises = 0;     ///< of the stress at the worst vertex, against the largest on the skin
  /// What the state tells of its own error (stated_error.h); nothing in files made before it was.
  std::optional<double> unscaled_error = {};
};

/// The numbers of a touch, in the order of files.
inline constexpr std::array<double HeldOutTouch::*, 4> kHeldOutValues{
    &HeldOutTouch::depth, &HeldOutTouch::displacement, &HeldOutTouch::force,
    &HeldOutTouch::von_mises};

/// Its differences, as they are named in reports.
inline constexpr std::array<std::pair<const char*, double HeldOutTouch::*>, 3> kHeldOutDifferences{
    {{"displacement", &HeldOutTouch::displacement},
     {"force", &HeldOutTouch::force},
     {"von_mises", &HeldOutTouch::von_mises}}};

/// Of several touches.
struct TouchErrors {
  double median = 0, worst = 0;
};

/// @pre at least one touch
[[nodiscard]] TouchErrors errors_of(const std::vector<HeldOutTouch>& touches,
                                    double HeldOutTouch::*difference);

/// "20 touches (7 finger, 7 palm, 6 rim; 2.1 to 7.8 mm deep) against full finite elements:
/// displacement 1.6 % off (median; worst 9 %), force 1.1 % (8 %), stress 4 % (30 %)"; empty for no
/// touches.
[[nodiscard]] std::string held_out_text(const std::vector<HeldOutTouch>& touches);

/// Why touches cannot be: a thing of no such number, a difference that is none; empty if they can.
[[nodiscard]] std::string trouble_of(const std::vector<HeldOutTouch>& touches);

}  // namespace palpable
