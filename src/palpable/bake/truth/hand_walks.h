/// @file
/// The full solver on the way of a clip's hand: each touch once frame by frame and once by half
/// frames, for where the two differ the answer depends on the way that was taken.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/truth/clip_hands.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpable {

/// Of a skin's displacement: where half the step changes it by more, a frame is not scored.
inline constexpr double kPathMatters = 0.01;

/// What one walk found at one frame. N: nodes.
struct WalkedFrame {
  Eigen::Matrix3Xd displacement;                     ///< (3 x N) m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N, of the hand
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, where it acts
  double entry = 0;                                  ///< m, see ContactState::entry_between
  Eigen::Matrix3Xd hand_forces, other_forces;        ///< (3 x N) N; with ContactSettings::mutual
};

/// One walk; frames that it did not reach are not there.
struct Walked {
  std::map<int, WalkedFrame> answers;
  std::string why_stopped;
};

/// What is solved, and how.
struct HandWalkSettings {
  ContactSettings contact = {};
  const Preloaded* preloaded = nullptr;  ///< see PathOptions
  int threads = 2;                       ///< walks at a time
};

/// Follows each touch from its first frame to the last that is wanted.
/// @param keep  is called once for each touch, as soon as both its walks are there, by one thread
///              at a time
void follow_hand(const EquilibriumSolver& solver, const ClipHands& hands,
                 const std::vector<Episode>& episodes, const HandWalkSettings& settings,
                 const Progress& progress,
                 const std::function<void(const Episode&, const Walked& by_half_frames,
                                          const Walked& by_frames)>& keep);

/// How far two displacements differ, over the larger of the two: relative L2 over some nodes, from
/// `rest`. 0 where neither moves.
/// @param rest  (3 x N) m; no columns: 0
[[nodiscard]] double relative_change(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b,
                                     const std::vector<int>& nodes,
                                     const Eigen::Matrix3Xd& rest = {});

}  // namespace palpable
