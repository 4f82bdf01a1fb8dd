/// @file
/// Compares bodies that press each other, pressed by the true hand of a synthetic clip, with the
/// full-order solution of all bodies together (palpable truth --scene).
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// A body of the scene with its scale applied.
struct StudiedBody {
  std::string name;
  TouchableBody body;
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// Differences and times, one entry per frame; differences only for frames with a truth.
struct BodiesResult {
  std::vector<double> displacement;         ///< relative L2 over each body's skin
  std::vector<double> stress;               ///< von Mises, relative L2 over each body's skin
  std::vector<double> between_force;        ///< relative, on a body that no hand touches
  std::vector<double> between_penetration;  ///< m, of all frames in which bodies touch
  std::vector<double> milliseconds;         ///< CPU, of all frames with a contact
  std::vector<double> milliseconds_alone;   ///< the same with only the body that the hand presses
  std::vector<double> milliseconds_three;   ///< the same with two more distant bodies
  int frames = 0;                           ///< frames with a truth
  /// Of the frames with a truth, those in which two bodies touch each other and no hand touches one
  /// of the two: according to the tables, and according to the full-order solution.
  int touching = 0, touching_true = 0;
  int disagree = 0;      ///< frames in which these two disagree
  double imbalance = 0;  ///< N, largest
};

/// Plays all frames of the clip with the hand's own capsules.
/// @throws Error for a body that has neither tables of touch nor an energy in modes, and for
/// missing files of the clip, which it names
[[nodiscard]] BodiesResult compare_bodies(const std::vector<StudiedBody>& bodies,
                                          const std::filesystem::path& clip);

}  // namespace palpable
