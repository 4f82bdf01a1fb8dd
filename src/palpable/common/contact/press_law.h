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
/// which is the smallest press that leaves no point inside. All points of the skin's triangles
/// (skin_points.h) are tested, because a pencil's tip passes between three vertices. sigma is the
/// standard deviation of the object's measured surface. The level is found by scanning the
/// tabulated paths from the deepest level down and bisecting. All lengths in metres, body frame.
#pragma once

#include "palpable/common/contact/body_field.h"
#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// The points that follow one site, and their positions when it is pressed: the table that the law
/// of sites looks up (design: "level over depth is strictly monotone and tabulated").
///
///   S  sites     L  levels of the body's level axis, level 0 included     n_s  points of site s
struct SitePath {
  /// (n_s) the vertices of the patch, and every point of the skin that moves at level 1 at least a
  /// given share of what the patch's most moved vertex moves, in rising order. Points that move
  /// less cannot measure the press: a displacement of 1 mm of such a point would demand a press of
  /// many mm.
  std::vector<int> points;
  /// (3 x n_s L) m, body frame; point j at level l is column j L + l.
  Eigen::Matrix3Xf positions;
  Eigen::AlignedBox3f box;  ///< of all of them
  /// (L) m, rising: how far the patch's most moved vertex has moved at each level. (The press depth
  /// is the patch's mean, which is less.)
  Eigen::VectorXd farthest;
};

/// The level at which the site's most moved vertex has moved by `depth` (m): 0 .. the last level;
/// linear between samples.
[[nodiscard]] double level_that_moves(const SitePath& path, const Eigen::VectorXd& levels,
                                      double depth);

/// Evaluates the reduced model at every sample of the level axis, for all sites.
/// @param skin         of this body (skin_points.h), without its fixed points
/// @param least_share  in (0, 1]
[[nodiscard]] std::vector<SitePath> press_paths(const ReducedBody& body,
                                                std::span<const SkinPoint> skin,
                                                double least_share);

struct PressSettings {
  /// m, spacing of the skin's points, at most; larger on a skin on which there would be more than
  /// some 60,000 points.
  double spacing = 0.002;
  /// Sigmas of the object's surface by which it must be inside the body to touch. Smaller: the
  /// noise of a hand that hovers presses; larger: touches begin late. At most half a ball's radius
  /// is required, however uncertain its surface is.
  double tolerance = 1.0;
  /// Share of `tolerance` by which the measurement may change without changing the press, and by
  /// which a touch that has begun may be less deep without ending. Smaller: the press trembles with
  /// the noise; larger: it lags.
  double hysteresis = 0.75;
  /// Share of a small change of the measurement that the press follows in one frame; changes of 4
  /// sigma and more are followed at once. Smaller is calmer and later.
  double least_follow = 0.4;
  /// Points that move less than this share of the patch's displacement do not set the level
  /// (SitePath).
  double least_share = 0.5;
  /// The site changes when the touched region is nearer to another one than this share of its
  /// distance to the present one.
  double site_keeping = 0.6;
  /// Levels per second by which a press may rise or fall while it lasts. A point of the skin that
  /// slides on or off a finger's edge changes the demanded level at once, and the press must not
  /// jump. 10 is a third of a full press per frame at 30 Hz; 5 mm per frame follows a hand at 0.15
  /// m/s.
  double fastest = 10.0;
};

/// All that the law carries from frame to frame. The default is "not touched".
struct PressState {
  std::optional<Touch> touch;
  bool leaving_site = false;   ///< the level falls because the hand is at another site
  std::optional<double> time;  ///< s, of the frame before; nothing before the first
};

/// A position on the object's surface, with the data that a touch needs.
struct TouchedPlace {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< m, on the seen front
  float sigma = 0;                                  ///< m, of the surface there
  float unseen_for = 0;                             ///< s since it was measured
};

/// Where the object reaches into the body at rest: the ball that reaches deepest, and the others
/// near it. The site is chosen by this region. (Balls are used, not points of the skin: no skin
/// point is deeper inside a pencil than its radius, however far the pencil has been pushed in.)
struct TouchedRegion {
  double depth = 0;  ///< m, of the deepest ball, beyond the tolerance
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< m, mean of the touched skin by depth
  TouchedPlace place;                                ///< of the deepest ball
  int ball_count = 0;
};

/// The law with its tables, which are made in the constructor; afterwards it allocates nothing.
class PressLaw {
 public:
  /// @param body  must outlive the law
  /// @throws ContractViolation for settings out of range
  explicit PressLaw(const ReducedBody& body, const PressSettings& settings = {});

  /// One frame. A pure function of its arguments: the same frames give the same touches.
  ///
  /// - If nothing is inside any more, the press is released at once.
  /// - The site is the one nearest to the touched region when a touch begins; it is kept while it
  ///   is pressed. When another site has become clearly nearer, the present one is released and
  ///   then the other one pressed, not faster than settings.fastest.
  /// - If the region demands more than the points that follow the site, the site's most moved
  ///   vertex is moved as far as the region is inside the body at rest.
  [[nodiscard]] PressState advance(const PressState& previous, const PressingSurface& seen,
                                   double time) const;

  /// The region in which the seen object reaches into the body at rest, except for skin that the
  /// support holds; nothing if there is none.
  [[nodiscard]] std::optional<TouchedRegion> touched_region(const PressingSurface& seen,
                                                            double tolerance_share = 1.0) const;

  /// The demanded level of one site (see the top), and where the point that demands it leaves the
  /// object.
  struct Demand {
    double level = 0;  ///< 0 if no point is inside anywhere on its path
    TouchedPlace place;
  };
  [[nodiscard]] Demand demanded_level(int site, const PressingSurface& seen,
                                      double tolerance_share = 1.0) const;

  [[nodiscard]] std::span<const SkinPoint> skin() const { return skin_; }

 private:
  // How deep x is inside the object beyond the tolerance, m, and in which ball; nothing outside.
  struct Inside {
    double depth = 0;
    int ball = 0;
  };
  [[nodiscard]] std::optional<Inside> inside(const Eigen::Vector3f& x, const PressingSurface& seen,
                                             double tolerance_share) const;
  // The last position on the path of one point, from the deepest level down, at which the object
  // pushes it forward.
  [[nodiscard]] Demand last_inside(const Eigen::Ref<const Eigen::Matrix3Xf>& path,
                                   const PressingSurface& seen, double tolerance_share,
                                   double least) const;

  // The press that one site needs in this frame.
  struct Need {
    double depth = 0;  // m, press depth; 0 when no point of the site is inside
    TouchedPlace place;
  };
  // @param region_of_site  the touched region, if the site is the nearest one to it
  [[nodiscard]] Need need_of(int site, const PressingSurface& seen,
                             const std::optional<TouchedRegion>& region_of_site,
                             double tolerance_share) const;
  // The level of a lasting touch in this frame, before settings.fastest limits it.
  [[nodiscard]] double followed_level(const Touch& before, const Need& need) const;
  [[nodiscard]] Touch touch_with(int site, double level, const Need& need) const;

  const ReducedBody* body_;
  PressSettings settings_;
  std::vector<SkinPoint> skin_;  // (P)
  BodyField field_;
  std::vector<SitePath> paths_;
};

}  // namespace palpable
