/// @file
/// Selects the landmarks that should be visible from a pose, and finds them in the picture.
#pragma once

#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/patch.h"
#include "palpable/live/track/tracker.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

/// A landmark that should be visible.
struct Candidate {
  int landmark = 0;                                    ///< index
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();        ///< predicted, px
  double depth = 0;                                    ///< predicted, m
  Eigen::Vector2d smear = Eigen::Vector2d::Zero();     ///< px of level 0
  Eigen::Matrix2d warp = Eigen::Matrix2d::Identity();  ///< image_from_anchor()
  double worth = 0;  ///< priority: each cell of the picture keeps its candidate of largest worth
  int turn = 0;      ///< order in which cells were filled; breaks ties of equal worth
};

/// The input of a search in one picture. Everything that it refers to must outlive it.
struct LandmarkSearch {
  static constexpr int kCellsAcross = 32;       ///< cells across the picture: one landmark in each
  static constexpr double kFineLikeness = 0.7;  ///< correlation from which a patch counts as found
  static constexpr double kSigma = 0.3;         ///< px of u and v at level 0; doubles per level
  /// The same if colour and depth come from two sensors, which are only calibrated to some pixels
  /// and read out at different moments: depths then determine a rotation better than pixels do.
  static constexpr double kSigmaTwoSensors = 1.8;
  static constexpr double kSigmaStereo = 0.25;    ///< px of d
  static constexpr double kLeastDisparity = 0.3;  ///< px; smaller disparities are not used

  const TrackerSettings& settings;
  const Pyramid& pyramid;  ///< of the frame's left image
  const LandmarkMap& map;

  /// Predicts where a landmark should appear from a pose. Returns nothing if it lies outside the
  /// picture, is hidden by a nearer measured surface or covered by the moving mask, or if its patch
  /// would not be found because the view differs too much from the anchor's: by more than 53
  /// degrees, or in distance by a factor of more than 2.3. Candidate::warp and smear are not set.
  [[nodiscard]] std::optional<Candidate> expected(const TrackerFrame& frame, int id,
                                                  const Rigid3& camera_from_world) const;

  /// Selects landmarks that should be visible from a pose: in each cell the one of largest worth,
  /// in falling order of worth, at most TrackerSettings::most_landmarks. Worth is the share of
  /// frames in which a landmark agreed, and a bonus if it agreed recently or was seen in many
  /// keyframes. Allocates only until the two lists have grown.
  /// @param previous_from_world  the pose one frame ago, for the smear
  /// @param exposure    share of the frame time during which the shutter is open
  /// @param frame_count frames so far
  /// @param cells       work space
  /// @param candidates  overwritten
  void select(const TrackerFrame& frame, const Rigid3& camera_from_world,
              const Rigid3& previous_from_world, double exposure, int frame_count,
              std::vector<int>& cells, std::vector<Candidate>& candidates) const;

  /// Finds a candidate in the images of levels `coarsest` down to `finest`, starting each level at
  /// the result of the level before.
  /// @param uv     out: where it was found, px of level 0
  /// @param level  out: the finest level at which it was found
  /// @return false if it was found at no level
  bool find(const Candidate& candidate, int coarsest, int finest, double least_likeness,
            Eigen::Vector2d& uv, int& level) const;

  /// The measurement (a Sighting) of a candidate that was found in this frame.
  /// @param uv     px of level 0, whatever the level
  /// @param level  of the image pyramid: the finest one at which it was found
  [[nodiscard]] Sighting sighting_of(const TrackerFrame& frame, const Candidate& candidate,
                                     const Eigen::Vector2d& uv, int level) const;

  /// The disparity at a pixel of the left image, px: found in the right image if there is one, else
  /// computed from the depth image. Nothing if it cannot be measured there.
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
