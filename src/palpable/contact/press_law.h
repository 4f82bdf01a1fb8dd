/// @file
/// The default contact law: the load level that puts the touched skin on the measured surface
/// (paper Sec. 4: "displacements are related to the module of the applied load").
///
/// Algorithm 1 counts levels up and down (paper_contact.h has it literally). It never uses the
/// measured displacement that Sec. 4 promises, needs as many frames as there are levels for a full
/// press, and freezes when the hand leaves between two frames. Here the level is read off the
/// measurement in every frame:
///
///     level = largest level at which a vertex that follows the site is still inside the object,
///             x_k(level) = X_k + u_k(site, level),   phi(x_k(level)) < -tolerance
///
/// which is the smallest press that leaves no vertex inside. Found by scanning the tabulated paths
/// from the deepest level down and bisecting. All lengths in metres, body frame.
#pragma once

#include "palpable/contact/press_paths.h"
#include "palpable/contact/seen_surface.h"
#include "palpable/contact/touch.h"
#include "palpable/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpable {

struct PressSettings {
  /// How far a seen surface is off at most times,
  ///     sigma(Z) = noise_constant + noise_linear Z + noise_quadratic Z^2    (m, 1, 1/m).
  /// Disparity has a constant error, so stereo has the square alone; the session fills in the noise
  /// of its camera. A vertex must be this deep inside to be touched. Smaller: the noise of a hand
  /// that hovers presses; larger: touches begin late.
  double noise_constant = 0;
  double noise_linear = 0;
  double noise_quadratic = 0.006;
  /// Share of the noise in which the press stays as it is when the measurement trembles (and by
  /// which a touch that has begun needs less depth to go on).
  double hysteresis = 0.75;
  /// A vertex counts as inside when so many seen points say so: a few flickering pixels do not
  /// press. A fingertip 1 mm inside, seen every 2.7 mm, has about 7.
  int least_support = 6;
  /// Share of the way to a new measurement that the press goes in one frame when the two differ by
  /// little; all of the way from 4 times the noise on. Smaller is calmer and later.
  double least_follow = 0.4;
  /// Vertices that move less than this share of the patch do not set the level (press_paths.h).
  double least_share = 0.5;
  /// The site changes when the touched region is nearer to another one than this share of its
  /// distance to the present one.
  double site_keeping = 0.6;
  /// Levels per second that a press may rise or fall while it lasts: a vertex of a coarse skin that
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

/// Where the body at rest is inside the object: the deepest vertex and the touched ones near it.
/// Chooses the site.
struct TouchedRegion {
  double depth = 0;  ///< m, of the deepest vertex, beyond the tolerance
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< m, mean of its vertices weighted by depth
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< m, seen, nearest to the deepest vertex
  float seen_at = 0;                                 ///< Z of that point in the camera, m
  int vertex_count = 0;
};

/// The law with the tables that it looks up; makes them once, then allocates nothing.
class PressLaw {
 public:
  /// @param body  must outlive the law
  /// @throws ContractViolation for settings out of range
  explicit PressLaw(const ReducedBody& body, const PressSettings& settings = {});

  /// One frame. A pure function of its arguments: the same frames give the same touches.
  ///
  /// - Nothing inside any more, or nothing seen: released at once.
  /// - The site is the one nearest to the touched region when a touch begins; it is kept while it
  ///   is pressed. When another has become clearly nearer the present one is let go and then the
  ///   other pressed, not faster than settings.fastest.
  /// - Where the region touches beside all vertices that follow the site, the press is at least as
  ///   deep as the region is inside at rest.
  [[nodiscard]] PressState advance(const PressState& previous, const SeenSurface& seen,
                                   double time) const;

  /// Where the undeformed body (fixed vertices left out) is inside what is seen: the deepest vertex
  /// and those near it. Nothing if it is nowhere.
  [[nodiscard]] std::optional<TouchedRegion> touched_region(const SeenSurface& seen,
                                                            double tolerance_share = 1.0) const;

  /// The level above for one site, and where the vertex that demands it leaves the object.
  struct Demand {
    double level = 0;  ///< 0 when no vertex is inside anywhere on its path
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< m, seen
    float seen_at = 0;                                ///< Z of that point in the camera, m
  };
  [[nodiscard]] Demand demanded_level(int site, const SeenSurface& seen,
                                      double tolerance_share = 1.0) const;

  [[nodiscard]] const PressSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] bool inside(const Eigen::Vector3f& x, const SeenSurface& seen,
                            double tolerance_share, NearestSeen& nearest) const;
  [[nodiscard]] double noise(float depth) const;

  // The press that one site needs now.
  struct Need {
    double depth = 0;  // m along its load; 0 when nothing of it is inside
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  // m, seen
    float seen_at = 0;                                // Z of that point in the camera, m
  };
  // @param region_of_site  the touched region, if the site is the nearest one to it
  [[nodiscard]] Need need_of(int site, const SeenSurface& seen,
                             const std::optional<TouchedRegion>& region_of_site,
                             double tolerance_share) const;
  // The level to which a lasting touch goes in this frame, before settings.fastest limits it.
  [[nodiscard]] double followed_level(const Touch& before, const Need& need) const;
  [[nodiscard]] Touch touch_with(int site, double level, const Need& need) const;

  const ReducedBody* body_;
  PressSettings settings_;
  Eigen::Matrix3Xf rest_;  // (3 x V)
  std::vector<SitePath> paths_;
};

}  // namespace palpable
