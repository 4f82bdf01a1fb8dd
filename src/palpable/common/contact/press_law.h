/// @file
/// The law of sites, for a body without tables: the load level that puts the touched skin on the
/// measured surface (paper Sec. 4: "displacements are related to the module of the applied load").
///
/// Algorithm 1 counts levels up and down (paper_contact.h has it literally). It never uses the
/// measured displacement that Sec. 4 promises, needs as many frames as there are levels for a full
/// press, and freezes when the hand leaves between two frames. Here the level is read off the
/// measurement in every frame:
///
///     level = largest level at which a point that follows the site is still inside the object,
///             x_k(level) = X_k + u_k(site, level),   phi(x_k(level)) < -sigma
///
/// which is the smallest press that leaves no point inside. Points are asked all over the skin's
/// triangles (skin_points.h), because a pencil's tip passes between three vertices. sigma is what
/// the object's surface says of itself. Found by scanning the tabulated paths from the deepest
/// level down and bisecting. All lengths in metres, body frame.
#pragma once

#include "palpable/common/contact/body_field.h"
#include "palpable/common/contact/press_paths.h"
#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct PressSettings {
  /// m, between the points of the skin that are asked, at most; more on a skin on which there would
  /// be more than some 60,000.
  double spacing = 0.002;
  /// The object must be so many sigma of its surface inside to touch. Smaller: the noise of a hand
  /// that hovers presses; larger: touches begin late. A point need not be deeper inside a thing
  /// than half its radius, however uncertain the thing is.
  double tolerance = 1.0;
  /// Share of that in which the press stays as it is when the measurement trembles (and by which a
  /// touch that has begun needs less depth to go on).
  double hysteresis = 0.75;
  /// Share of the way to a new measurement that the press goes in one frame when the two differ by
  /// little; all of the way from 4 sigma on. Smaller is calmer and later.
  double least_follow = 0.4;
  /// Points that move less than this share of the patch do not set the level (press_paths.h).
  double least_share = 0.5;
  /// The site changes when the touched region is nearer to another one than this share of its
  /// distance to the present one.
  double site_keeping = 0.6;
  /// Levels per second that a press may rise or fall while it lasts: a point of the skin that
  /// slides on or off a finger's edge changes the demand at once, and nothing may pop. A third of
  /// a full press per frame at 30 Hz; 5 mm per frame follows a hand at 0.15 m/s.
  double fastest = 10.0;
};

/// All that the law remembers from frame to frame. The default is "not touched".
struct PressState {
  std::optional<Touch> touch;
  bool leaving_site = false;   ///< the level goes down because the hand is at another site
  std::optional<double> time;  ///< s, of the frame before; nothing before the first
};

/// A place of the object's surface, as far as a touch needs it.
struct TouchedPlace {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< m, on the seen front
  float sigma = 0;                                  ///< m, of the surface there
  float unseen_for = 0;                             ///< s since it was measured
};

/// Where the object reaches into the body at rest: the ball that reaches deepest, and those that do
/// so near it. Chooses the site. (Balls are asked, not points of the skin: inside a pencil's lead
/// no point is deeper than the lead is thick, however far it has been pushed in.)
struct TouchedRegion {
  double depth = 0;  ///< m, of the deepest ball, beyond the tolerance
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< m, mean of the touched skin by depth
  TouchedPlace place;                                ///< of the deepest ball
  int ball_count = 0;
};

/// The law with the tables that it looks up; makes them once, then allocates nothing.
class PressLaw {
 public:
  /// @param body  must outlive the law
  /// @throws ContractViolation for settings out of range
  explicit PressLaw(const ReducedBody& body, const PressSettings& settings = {});

  /// One frame. A pure function of its arguments: the same frames give the same touches.
  ///
  /// - Nothing inside any more: released at once.
  /// - The site is the one nearest to the touched region when a touch begins; it is kept while it
  ///   is pressed. When another has become clearly nearer the present one is let go and then the
  ///   other pressed, not faster than settings.fastest.
  /// - Where the region touches beside all points that follow the site, the site's most moved
  ///   vertex is moved at least as far as the region is inside at rest.
  [[nodiscard]] PressState advance(const PressState& previous, const PressingSurface& seen,
                                   double time) const;

  /// Where what is seen reaches into the undeformed body (but for the skin that the support holds).
  /// Nothing if it does nowhere.
  [[nodiscard]] std::optional<TouchedRegion> touched_region(const PressingSurface& seen,
                                                            double tolerance_share = 1.0) const;

  /// The level above for one site, and where the point that demands it leaves the object.
  struct Demand {
    double level = 0;  ///< 0 when no point is inside anywhere on its path
    TouchedPlace place;
  };
  [[nodiscard]] Demand demanded_level(int site, const PressingSurface& seen,
                                      double tolerance_share = 1.0) const;

  [[nodiscard]] std::span<const SkinPoint> skin() const { return skin_; }

 private:
  // How deep x is inside the object beyond the tolerance, m, and where; nothing outside.
  struct Inside {
    double depth = 0;
    int ball = 0;
  };
  [[nodiscard]] std::optional<Inside> inside(const Eigen::Vector3f& x, const PressingSurface& seen,
                                             double tolerance_share) const;
  // The last place on the path of one point, from the deepest level down, at which the object
  // pushes it on.
  [[nodiscard]] Demand last_inside(const Eigen::Ref<const Eigen::Matrix3Xf>& path,
                                   const PressingSurface& seen, double tolerance_share,
                                   double least) const;

  // The press that one site needs now.
  struct Need {
    double depth = 0;  // m along its load; 0 when nothing of it is inside
    TouchedPlace place;
  };
  // @param region_of_site  the touched region, if the site is the nearest one to it
  [[nodiscard]] Need need_of(int site, const PressingSurface& seen,
                             const std::optional<TouchedRegion>& region_of_site,
                             double tolerance_share) const;
  // The level to which a lasting touch goes in this frame, before settings.fastest limits it.
  [[nodiscard]] double followed_level(const Touch& before, const Need& need) const;
  [[nodiscard]] Touch touch_with(int site, double level, const Need& need) const;

  const ReducedBody* body_;
  PressSettings settings_;
  std::vector<SkinPoint> skin_;  // (P)
  BodyField field_;
  std::vector<SitePath> paths_;
};

}  // namespace palpable
