/// @file
/// Full-order solutions along the motion of a clip's hand. Each touch is followed twice, in steps
/// of a frame and in steps of half a frame: where the two differ, the solution depends on the path.
/// With friction a step is also one of kFrictionStep at most, in the other walk one of half of it;
/// where the two differ, a third walk in a quarter of these steps takes the place of the coarser
/// one, as far as it comes.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/truth/episodes.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpable {

/// Largest change of a skin's displacement (relative L2) between the two walks. Frames with a
/// larger one are not scored.
inline constexpr double kPathMatters = 0.01;

/// m, longest step of the hand with friction in the coarsest walk: what slips within a step slides
/// in one direction, and a point that begins to press does not change when others touch.
inline constexpr double kFrictionStep = 1e-3;

/// With friction a touch goes on, and the walk with it, until this many frames in succession have
/// none. Skin that was dragged may stay in contact where the undeformed body has none, which is
/// what a clip states.
inline constexpr int kFramesBetweenTouches = 30;

/// Why a frame is not scored; empty if it is.
/// @param path_change   change of its displacement between the two walks
/// @param began_before  with friction: its touch began before the clip
/// @param held_entry    m, WalkedFrame::held_entry
[[nodiscard]] std::string why_not_scored(double path_change, bool began_before, double held_entry);

/// The solution of one walk at one frame. N: nodes.
struct WalkedFrame {
  Eigen::Matrix3Xd displacement;                     ///< (3 x N) m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N, of the hand
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, its centre
  double entry = 0;                                  ///< m, see ContactState::entry_between
  double held_entry = 0;  ///< m, see ContactState; with friction the largest since the walk began
  Eigen::Matrix3Xd hand_forces, other_forces;  ///< (3 x N) N; with ContactSettings::mutual
};

/// The solutions of one walk by frame; frames that it did not reach are missing.
struct Walked {
  std::map<int, WalkedFrame> frames;
  std::string why_stopped;
};

/// Settings of follow_hand().
struct HandWalkSettings {
  ContactSettings contact = {};
  const Preloaded* preloaded = nullptr;  ///< see PathOptions
  int threads = 2;                       ///< walks at a time
};

/// Follows each touch from its first frame to the last one that is wanted.
/// @param keep  called once for each touch, as soon as both its walks are done, by one thread at a
///              time
void follow_hand(const EquilibriumSolver& solver, const ClipHands& hands,
                 const std::vector<Episode>& episodes, const HandWalkSettings& settings,
                 const Progress& progress,
                 const std::function<void(const Episode&, const Walked& by_half_steps,
                                          const Walked& by_steps)>& keep);

/// Difference of two displacements, relative to the larger of the two: L2 over some nodes, measured
/// from `rest`. 0 if both are 0.
/// @param nodes  empty: all
/// @param rest  (3 x N) m; no columns: zero
[[nodiscard]] double relative_change(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b,
                                     const std::vector<int>& nodes,
                                     const Eigen::Matrix3Xd& rest = {});

}  // namespace palpable
