/// @file
/// The error budget of a seen surface: by how much the displacement of a touched body would be
/// less off if one part of what the camera says were perfect.
///
/// Each part has a surface and a body of its own. In every frame its surface is built from the
/// measured depth and mask with that part replaced by the truth, and contact is solved. All are
/// compared with the response of the same tables to the true hand, so that the model has no
/// influence.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/live/session/session.h"

#include <memory>
#include <string_view>
#include <vector>

namespace palpable::app {

/// What the truth replaces.
enum class Perfect {
  kNothing,    ///< the surface as it is measured
  kNoise,      ///< the depth of single pixels: what remains is its error averaged over 15 px
  kBias,       ///< that average: what remains is the difference of single pixels from it
  kDepth,      ///< both
  kOutline,    ///< which pixels show the thing
  kFront,      ///< depth and outline: all that a perfect depth camera sees
  kEnds,       ///< depth and outline around the ends of things, such as fingertips
  kOtherSide,  ///< the whole shape, which stands where the measured depth says
  kPose        ///< the pose of the camera
};

struct BudgetLine {
  Perfect perfect;
  std::string_view key, words;
};
/// All parts, in the order in which they are listed.
[[nodiscard]] const std::vector<BudgetLine>& budget_lines();

class SurfaceBudget {
 public:
  /// @param session  of one body with tables of touch; outlives this
  explicit SurfaceBudget(const Session& session);
  ~SurfaceBudget();

  /// Call it after each frame of the session.
  /// @param truth  what a perfect depth camera sees in this frame
  /// @param true_body_from_camera  the true pose
  void add(const Scene& scene, const HandLine& hand, const ContactLine& contact,
           const TrueView& truth, const Rigid3& true_body_from_camera);

  /// For each part (its key) "median" and "p90" of the displacement error, relative to the true
  /// displacement over the skin, and of the error of the force's size, relative to it; and
  /// "frames", the number that was compared: those in which the hand is at least 4 mm deep and the
  /// camera sees at least half of what touches.
  [[nodiscard]] Json json() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable::app
