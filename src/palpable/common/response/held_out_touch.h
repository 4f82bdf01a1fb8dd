/// @file
/// The accuracy of a body's tables of touch, stored with them: touches that the tables were not
/// made from, each solved by the tables and by full finite elements with contact on the same mesh.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// The obstacle of a touch. The enumerators' values are stored in body files.
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

/// One touch. Its differences are those of the tables' solution from the full-order solution.
struct HeldOutTouch {
  PressingThing thing = PressingThing::kFinger;
  double depth = 0;         ///< m that the obstacle has advanced since first contact
  double displacement = 0;  ///< relative L2 over the skin's vertices
  double force = 0;         ///< relative, of the resultant; of a squeeze: of the sum of norms
  double von_mises = 0;     ///< largest over the vertices, ratio to the largest stress
  /// The state's error indicators, added up (stated_error.h); none in older body files.
  std::optional<double> unscaled_error = {};
};

/// The numbers of a touch, in the order of files.
inline constexpr std::array<double HeldOutTouch::*, 4> kHeldOutValues{
    &HeldOutTouch::depth, &HeldOutTouch::displacement, &HeldOutTouch::force,
    &HeldOutTouch::von_mises};

/// The differences of a touch, with their names in reports.
inline constexpr std::array<std::pair<const char*, double HeldOutTouch::*>, 3> kHeldOutDifferences{
    {{"displacement", &HeldOutTouch::displacement},
     {"force", &HeldOutTouch::force},
     {"von_mises", &HeldOutTouch::von_mises}}};

/// The median and the largest of one difference over several touches.
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

/// What is invalid in the touches: an unknown obstacle, a depth or a difference that is negative or
/// not finite; empty if nothing is.
[[nodiscard]] std::string trouble_of(const std::vector<HeldOutTouch>& touches);

}  // namespace palpable
