/// @file
/// Which landmarks should be seen from a pose, and where they are in the picture.
#pragma once

#include "palpable/track/landmark_map.h"
#include "palpable/track/patch.h"
#include "palpable/track/tracker.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

/// A landmark that should be seen.
struct Candidate {
  int landmark = 0;
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();     ///< predicted, px
  double depth = 0;                                 ///< predicted, m
  Eigen::Vector2d smear = Eigen::Vector2d::Zero();  ///< px of level 0
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();
  double worth = 0;
  int turn = 0;  ///< in which its cell was first taken: of equal worth the earlier goes first
};

/// What is known when a picture is searched. Everything must outlive it.
struct LandmarkSearch {
  static constexpr int kCellsAcross = 32;       ///< of the picture: one is looked for in each
  static constexpr double kNearest = 0.03;      ///< m
  static constexpr double kSigma = 0.3;         ///< px of u and v at level 0; doubles with each
  static constexpr double kSigmaStereo = 0.25;  ///< px of d

  const TrackerSettings& settings;
  const Pyramid& pyramid;  ///< of the frame's left image
  const std::vector<Keyframe>& keyframes;
  const std::vector<Landmark>& landmarks;

  /// Where a landmark should be seen from `pose` (camera_from_world); nothing where it cannot be:
  /// outside, hidden, too different from what was first seen of it. Its warp and smear are left
  /// open.
  [[nodiscard]] std::optional<Candidate> expected(const TrackerFrame& frame, int id,
                                                  const Rigid3& pose) const;

  /// Landmarks that should be seen from `pose`, the best of each cell, the best first, at most
  /// TrackerSettings::most_landmarks. Takes no memory once the two lists have grown.
  /// @param before    the pose from which the image moved here, for the smear
  /// @param exposure  share of the frame time that the shutter is open
  /// @param number    of frames so far: what agreed just now is worth more
  /// @param cells     room to work in
  void select(const TrackerFrame& frame, const Rigid3& pose, const Rigid3& before, double exposure,
              int number, std::vector<int>& cells, std::vector<Candidate>& candidates) const;

  /// Where a candidate is, from the coarsest to the finest level; uv and level of the finest at
  /// which it was found. False: at none.
  bool find(const Candidate& candidate, int coarsest, int finest, double least_likeness,
            Eigen::Vector2d& uv, int& level) const;

  /// What is measured of a candidate that was found at uv, at a level of the pyramid.
  [[nodiscard]] Sighting sighting_of(const TrackerFrame& frame, const Candidate& candidate,
                                     const Eigen::Vector2d& uv, int level) const;

  /// px; nothing where neither the right image nor the depth says it.
  [[nodiscard]] std::optional<double> disparity_at(const TrackerFrame& frame,
                                                   const Eigen::Vector2d& uv,
                                                   double expected) const;

  /// Standard deviation of a disparity d that was measured, px.
  [[nodiscard]] double sigma_of_disparity(const TrackerFrame& frame, double d) const;
};

}  // namespace palpable
