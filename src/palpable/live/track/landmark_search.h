/// @file
/// Which landmarks should be seen from a pose, and where they are in the picture.
#pragma once

#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/patch.h"
#include "palpable/live/track/tracker.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

/// A landmark that should be seen.
struct Candidate {
  int landmark = 0;                                    ///< index
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();        ///< predicted, px
  double depth = 0;                                    ///< predicted, m
  Eigen::Vector2d smear = Eigen::Vector2d::Zero();     ///< px of level 0
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();  ///< image_from_anchor()
  double worth = 0;  ///< of two in one cell of the picture the one that is worth more is kept
  int turn = 0;      ///< order in which cells were filled; among equal worth the earlier goes first
};

/// What is known when a picture is searched. Everything must outlive it.
struct LandmarkSearch {
  static constexpr int kCellsAcross = 32;       ///< of the picture: one is looked for in each
  static constexpr double kFineLikeness = 0.7;  ///< correlation from which on a patch is found
  static constexpr double kSigma = 0.3;         ///< px of u and v at level 0; doubles with each
  /// The same where colour and depth have two sensors, which are calibrated to some pixels and read
  /// at different moments: the depths say more of a turn than the pixels do.
  static constexpr double kSigmaTwoSensors = 1.8;
  static constexpr double kSigmaStereo = 0.25;    ///< px of d
  static constexpr double kLeastDisparity = 0.3;  ///< px; below nothing is measured

  const TrackerSettings& settings;
  const Pyramid& pyramid;  ///< of the frame's left image
  const LandmarkMap& map;

  /// Where a landmark should be seen from a pose. Nothing when it lies outside of the picture, is
  /// hidden by a nearer measured surface or covered by what moves, or when the pose differs so much
  /// from the anchor's (by more than 53 degrees, or nearer or farther by more than 2.3 times) that
  /// its patch would not be found. Candidate::warp and smear stay as they are by default.
  [[nodiscard]] std::optional<Candidate> expected(const TrackerFrame& frame, int id,
                                                  const Rigid3& camera_from_world) const;

  /// Landmarks that should be seen from a pose: in each cell the one that is worth most, those of
  /// most worth first, at most TrackerSettings::most_landmarks. Worth is the share of frames in
  /// which a landmark agreed, more if it agreed just now or was seen in many keyframes. Takes no
  /// memory once the two lists have grown.
  /// @param previous_from_world  the pose one frame ago, for the smear
  /// @param exposure    share of the frame time that the shutter is open
  /// @param frame_count frames so far
  /// @param cells       room to work in
  /// @param candidates  overwritten
  void select(const TrackerFrame& frame, const Rigid3& camera_from_world,
              const Rigid3& previous_from_world, double exposure, int frame_count,
              std::vector<int>& cells, std::vector<Candidate>& candidates) const;

  /// Finds a candidate in the images of levels `coarsest` down to `finest`, each time from where
  /// the level before has found it.
  /// @param uv     out: where it was found, px of level 0
  /// @param level  out: the finest level at which it was found
  /// @return false when it was found at no level
  bool find(const Candidate& candidate, int coarsest, int finest, double least_likeness,
            Eigen::Vector2d& uv, int& level) const;

  /// What is measured of a candidate that was found at uv, at a level of the pyramid.
  [[nodiscard]] Sighting sighting_of(const TrackerFrame& frame, const Candidate& candidate,
                                     const Eigen::Vector2d& uv, int level) const;

  /// px; nothing where neither the right image nor the depth image can say it.
  [[nodiscard]] std::optional<double> disparity_at(const TrackerFrame& frame,
                                                   const Eigen::Vector2d& uv,
                                                   double expected) const;

  /// Standard deviation of u and v at level 0, px.
  [[nodiscard]] double sigma_of_pixel() const {
    return settings.two_sensors ? kSigmaTwoSensors : kSigma;
  }
  /// Standard deviation of a measured disparity d, px.
  [[nodiscard]] double sigma_of_disparity(const TrackerFrame& frame, double d) const;
};

}  // namespace palpable
