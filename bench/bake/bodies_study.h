/// @file
/// Bodies that press each other under the true hand of a filmed clip, against the full answer of
/// all of them together (palpable truth --scene).
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// A body of the scene, in its size.
struct StudiedBody {
  std::string name;
  TouchableBody body;
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// How the answer compares, frame by frame where there is a truth.
struct BodiesResult {
  std::vector<double> displacement;         ///< relative L2 over each body's skin
  std::vector<double> stress;               ///< von Mises, likewise
  std::vector<double> between_force;        ///< relative, on a body that no hand touches
  std::vector<double> between_penetration;  ///< m, of all frames in which they do
  std::vector<double> milliseconds;         ///< CPU, of all frames in which something presses
  std::vector<double> milliseconds_alone;   ///< likewise of the body that the hand presses, alone
  std::vector<double> milliseconds_three;   ///< and with two more that stand about
  int frames = 0;                           ///< with a truth
  /// Of these, in which bodies touch each other, here and truly, while no hand touches one of the
  /// two.
  int touching = 0, touching_true = 0;
  int disagree = 0;      ///< and in which one says so and the other does not
  double imbalance = 0;  ///< N, the largest
};

/// Plays all frames of the clip with the hand's own capsules.
/// @throws Error for a body with neither tables of touch nor an energy in modes, and
///         naming what of the clip is missing
[[nodiscard]] BodiesResult compare_bodies(const std::vector<StudiedBody>& bodies,
                                          const std::filesystem::path& clip);

}  // namespace palpable
