/// @file
/// A deformable body as the contact solver sees it (contact_solver.h): contact points on its skin,
/// their positions, and the compliance with which they move under forces.
///
///          ContactSolver                         ContactBody
///     ┌──────────────────────┐   positions   ┌───────────────────────────────────────────┐
///     │ candidates, gaps     │ ◄──────────── │ shape and present displacement            │
///     │ W, q of one step     │ ◄──────────── │ tangent: n_i J n_j, free displacement     │
///     │ forces f             │ ────────────► │ displacement under f                      │
///     └──────────────────────┘               └───────────────────────────────────────────┘
///                                              TablesBody: tables of touch, float
///                                              ModalBody: energy in modes, double
///                                              PrescribedSkin: an obstacle, does not deform
///
/// A frame has steps, a step has iterations of Newton's method. Two displacements are
/// distinguished: the *shape* is the displacement of the whole skin, computed now and then, in
/// which candidates are searched; *positions* follow every iteration, of the few points that take
/// part.
///
///   C  contact points     F  vertices of the body's skin     P  places that take part in a step
#pragma once

#include "palpable/common/contact/moving_surface.h"
#include "palpable/common/contact/point_anchor.h"
#include "palpable/common/contact/point_forces.h"
#include "palpable/common/contact/skin_clusters.h"
#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// The points of a skin at which obstacles are searched.
struct SkinPointSet {
  std::span<const SkinPoint> points;  ///< (C)
  std::span<const float> levels;      ///< (C) point_levels.h
  const SkinClusters* clusters = nullptr;
  float coarsest = 0;  ///< m between the points that the flattest obstacle needs
  float finest = 0;    ///< m between those that the sharpest obstacle needs
  float between = 0;   ///< m between those that are searched on other bodies' skins
  float spacing = 0;   ///< m between neighbouring points of all of them, at most
  /// (3 x H) m, vertices that the support holds, which are no contact points and do not move; null:
  /// none.
  const Eigen::Matrix3Xf* held = nullptr;
};

/// How contact is solved on a body. Bodies that are solved together use the smallest lengths of all
/// of them, the largest band and the largest counts.
struct ContactLimits {
  double band = 0;            ///< m: points nearer than this to an obstacle may press
  double largest_step = 0;    ///< m that an obstacle advances in one step
  int most_steps = 1;         ///< of a frame; deeper obstacles are reached in later frames
  int iterations = 1;         ///< of Newton's method, in each step but the last
  int last_iterations = 1;    ///< in the last step
  double tolerance = 0;       ///< m: iterations end when no point that takes part moves more
  double entry = 0;           ///< m that a curved obstacle may enter between two contact points
  double largest_change = 0;  ///< m that one iteration may move a point
  /// Whether an iteration that moves points farther than the one before is shortened. Without it
  /// two sets of points may press in turn for ever.
  bool damped = true;
  /// Whether an iteration leaves out points whose gap exceeds what the iteration before moved,
  /// instead of a fixed share of largest_step: fewer unknowns, the same forces.
  bool narrows = false;
  /// Contact points near obstacles above which their spacing is made coarser; 0: never, the nearest
  /// ones are kept.
  int thins_above = 0;
};

/// The part of the limits that a kind of body's settings have by the same names; the rest is
/// default.
template <class Settings>
[[nodiscard]] ContactLimits limits_from(const Settings& s) {
  ContactLimits limits;
  limits.band = s.band;
  limits.largest_step = s.largest_step;
  limits.most_steps = s.most_steps;
  limits.iterations = s.iterations;
  limits.last_iterations = s.last_iterations;
  limits.tolerance = s.tolerance;
  limits.entry = s.entry;
  return limits;
}

/// A force of 1 N at a place that takes part.
struct UnitForce {
  std::size_t row = 0;                                  ///< of the system: which contact it is of
  std::size_t place = 0;                                ///< (P)
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< unit, body frame
};

/// The load of a place when a step begins.
struct PlaceLoad {
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N, body frame
  float entry = 0;                                  ///< m that the obstacle penetrates there
};

/// Largest number of places in a step: of a body alone, and of one that is solved with others.
inline constexpr int kMostPlaces = 256, kMostPlacesWithOthers = 512;

/// The functions are called in the order in which they are declared. Only the first frame of a
/// state allocates.
class ContactBody {
 public:
  virtual ~ContactBody() = default;

  [[nodiscard]] virtual SkinPointSet contact_points() const = 0;
  [[nodiscard]] virtual const ContactLimits& limits() const = 0;

  /// From now on the body is solved with others, which need places of their own. Allocates.
  virtual void make_room_for_others() = 0;

  /// The shape becomes that of the state.
  virtual void begin_frame() = 0;
  /// Whether the state is the unloaded body. @pre begin_frame()
  [[nodiscard]] virtual bool is_at_rest() const = 0;
  /// The forces of the state, in rising order of point, then of PointForce::by. The solver reads
  /// them when it begins a step and replaces them when it ends one.
  [[nodiscard]] virtual std::vector<PointForce>& forces() = 0;
  /// The anchors of the state, in rising order of point, then of PointAnchor::by; only with
  /// friction. The solver reads and replaces them as it does forces.
  [[nodiscard]] virtual std::vector<PointAnchor>& anchors() = 0;
  /// Coulomb's coefficient of friction of the skin; 0: none. Between two bodies the root of the
  /// product of both counts.
  [[nodiscard]] virtual double friction() const { return 0; }

  // --- time

  /// Number of equal steps into which a time (s) must be divided for a body with inertia, >= 1; 0:
  /// it has none.
  [[nodiscard]] virtual int steps_in(double time) const { return static_cast<void>(time), 0; }
  /// From now on time passes: this much (s) in each step that begins. 0: none; the step corrects
  /// the state, and what moves keeps its velocity. @pre steps_in() is not 0
  virtual void set_time_step(double h) { static_cast<void>(h); }
  /// The state rings on for this time (s) under the forces that it has. @pre set_time_step(0)
  virtual void ring_on(double time) { static_cast<void>(time); }
  /// From now on no time passes: steps lead to the static state under the forces. Until
  /// set_time_step() is called again nothing moves.
  virtual void forget_time() {}
  /// J, of the motion around the static state; 0 of a state that does not move.
  [[nodiscard]] virtual double ringing() const { return 0; }
  /// m, no vertex moves farther from its static position as long as forces do not change.
  [[nodiscard]] virtual double amplitude() const { return 0; }
  /// m, how far inertia has moved one of these vertices (shape_at_vertex()) at most since the shape
  /// was formed, or the frame began.
  [[nodiscard]] virtual double way_by_inertia(std::span<const int> vertices) {
    return static_cast<void>(vertices), 0;
  }
  /// m/s, no vertex is moved faster by inertia.
  [[nodiscard]] virtual double largest_speed() const { return 0; }

  // --- shape

  /// m, position of a contact point.
  [[nodiscard]] virtual Eigen::Vector3f shape_at(int point) = 0;
  /// m, position of a vertex that is the middle of a cluster of contact points (skin_clusters.h).
  [[nodiscard]] virtual Eigen::Vector3f shape_at_vertex(int vertex) = 0;
  /// m, position of a foot: the place on this skin, given by the F vertices, that is nearest to a
  /// contact point of another body and takes its reaction. Linear in the displacement, as
  /// position() is.
  [[nodiscard]] virtual Eigen::Vector3f shape_at(const SkinPoint& foot) = 0;
  /// The same at rest.
  [[nodiscard]] virtual Eigen::Vector3f rest_at(const SkinPoint& foot) const = 0;
  /// Unit, outwards, of the skin at a contact point; 0 where it is not known.
  [[nodiscard]] virtual Eigen::Vector3f normal_at(int point) = 0;
  /// A box around the skin.
  [[nodiscard]] virtual Eigen::AlignedBox3f bounds() = 0;
  /// Signed distances to the skin.
  [[nodiscard]] virtual const MovingSurface& surface() = 0;

  // --- a step

  /// These set the places of the next step: clear_places(), then one add_place() each. False: there
  /// is no room for one more. The number of a place is how many were added before it.
  virtual void clear_places() = 0;
  virtual bool add_place(int point) = 0;
  virtual bool add_place(const SkinPoint& foot) = 0;
  /// From now on the places that were added take part, under these forces.
  /// @param loads  (P)
  /// @param last   whether it is the frame's last step, which is computed with all terms
  virtual void begin_step(std::span<const PlaceLoad> loads, bool last) = 0;

  /// A further step with the same places, soon after the one before: what changes slowly may stay.
  /// Only where all bodies that are solved together have inertia. @param loads  (P)
  virtual void go_on(std::span<const PlaceLoad> loads) { begin_step(loads, false); }

  /// m, present position of a place.
  [[nodiscard]] virtual Eigen::Vector3f position(std::size_t place) const = 0;

  // --- an iteration

  enum class Tangent {
    kFull,
    kSafe  ///< positive definite for certain, where kFull may not be
  };
  /// Computes the tangent at the present displacement. False: there is none.
  virtual bool linearise() = 0;
  /// Adds the compliance among normal forces, and the free displacement (that without any force),
  /// by the tangent:
  ///
  ///     W_ij += d_i . J d_j  (m/N)        q_i += d_i . (u_free - u)  (m)
  ///
  /// @param forces  rising rows
  /// @param W       (rows x m), row by row; the lower triangle is written
  virtual void add_compliance(std::span<const UnitForce> forces, Tangent tangent,
                              std::span<double> W, std::size_t m, std::span<double> q) = 0;
  /// Adds the compliance between tangential forces and the normal forces of the last call, that
  /// among tangential forces, and their free displacement. Units as those of add_compliance().
  /// Contacts with curved obstacles use it, whose normals turn, and those with friction
  /// (contact_problem.h).
  /// @param forces   rising rows, of the t tangential ones
  /// @param tangent  kSafe: a simpler tangent will do; else that of the last add_compliance()
  /// @param W_nt     (m x wide) normal against tangential, rows padded to `wide` >= t
  /// @param W_tt     (t x t)
  /// @param q_t      (t)
  virtual void add_tangential(std::span<const UnitForce> forces, Tangent tangent,
                              std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                              std::span<double> q_t) = 0;
  /// m/N, the local compliance of the skin under a contact point, which the tangent lacks.
  /// @param area      m^2 that the point stands for
  /// @param softness  SurfaceGap::softness
  /// @param is_foot   the body is the one that is pressed by another body's point
  [[nodiscard]] virtual double skin_compliance(double area, float softness, bool is_foot) const = 0;
  /// The step of Newton's method under new forces, which move() then makes. A body whose
  /// displacement is a function of the forces does nothing here. @param forces  (P) N
  virtual void find_step(std::span<const Eigen::Vector3f> forces) = 0;
  /// Moves the places by a share of the step. May be called again with a smaller share.
  /// @param forces  (P) N, that share of the way from those before the iteration
  /// @return m, the largest displacement of a place since linearise()
  virtual double move(std::span<const Eigen::Vector3f> forces, double share) = 0;

  // --- end of a step

  /// The shape becomes that of the present forces.
  /// @param all  also of the inner nodes, which only the stress needs
  virtual void form_shape(bool all) = 0;
  /// Whether form_shape() moved a vertex by more than `way` (m) from the shape of the state.
  [[nodiscard]] virtual bool has_moved(double way) const = 0;
  /// The state takes over what was computed, the shape included if it was formed.
  /// @param is_free  no contact is near, and the iteration has converged: the state may be cleared
  ///                 of rounding errors
  virtual void keep(bool is_free) = 0;

  /// The state takes over the shape that was formed, and nothing else: it was kept already.
  virtual void keep_shape() {}

  // --- end of a frame

  /// Called after the last step. @param penetration  m, of obstacles at the deepest contact point
  virtual void end_frame(double penetration) = 0;
  /// m, the largest displacement of a vertex since begin_frame().
  [[nodiscard]] virtual double moved() const = 0;
  /// Reduces the change of the state, forces included, since begin_frame() to this share.
  virtual void limit_step(double share) = 0;
};

}  // namespace palpable
