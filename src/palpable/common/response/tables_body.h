/// @file
/// A body with tables of touch as the contact solver sees it: the tables give its displacement as a
/// series in the forces.
///
///     u(f) = G f + regions' modes + interaction of patches + corrections by full-order solutions
///            + motion of the vibration modes
///
/// with G from compliance.h, regions and patches from nonlinear_response.h, corrections from
/// refinement.h, and the last term, if time passes, from inertia.h. The tangent is J = G + U H U^T,
/// with U the modes of the regions and H the derivative of their amplitudes by the modal
/// coordinates of the load.
///
///   V  vertices of the tables, of the skin or of a coarser one that carries it
///   F  vertices of the body's skin, V where it is not carried
///   W  nodes of the shell     C  contact points     P  places that take part in a step
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_state.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct TouchSettings {
  double band = 0.0025;           ///< m: points nearer than this may press
  double largest_step = 0.00125;  ///< m that an obstacle advances in one step
  int most_steps = 12;            ///< of a frame; deeper obstacles are reached in later frames
  int iterations = 3;             ///< of Newton's method, in each step but the last
  int last_iterations = 10;       ///< in the last step; the rest is made up in later frames
  double tolerance = 2e-5;        ///< m: iterations end when no touched vertex moves more
  /// m that a curved obstacle may enter between two contact points. Larger: fewer contact points
  /// are used on flat obstacles, and a frame is cheaper.
  double entry = 2e-5;
  /// Additional compliance of each contact point, as a ratio to the mean compliance of the contact
  /// points. Neighbours that move together then share a force; in return a penetration of force
  /// times the additional compliance remains.
  double softness = 0.01;
  bool nonlinear = true;  ///< false: linear displacements; gaps still in the present shape
  int blend_frames = 6;   ///< over which a full-order solution is blended in
  /// Coulomb's coefficient of friction of the skin; none: that of the tables
  std::optional<double> friction = {};
  /// Whether the body has inertia in frames with time, if the tables have vibration modes.
  bool inertia = true;
};

/// How the tables were used in a frame, and the error stated for its state.
struct TablesReport {
  int patches = 0;             ///< patches of load
  double last_share = 0;       ///< NonlinearResponse::last_share()
  ErrorIndicators indicators;  ///< 0 without force
  /// The error by these indicators; nothing without force, or where the tables' held-out touches
  /// give no factor.
  std::optional<StatedError> stated;
};

/// Allocates in its constructor, and when a state is used for the first time.
class TablesBody final : public ContactBody {
 public:
  static constexpr int kMostVertices = 192;  ///< of a step's contact points; as many again of feet

  /// @param skin    (F vertices) the body's, at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  TablesBody(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
             const TouchTables& tables, const TouchSettings& settings);
  ~TablesBody() override;

  /// From now on frames advance this state. It outlives its use.
  void use(TouchState& state);

  [[nodiscard]] std::span<const SkinPoint> points() const;       ///< (C) on the V vertices
  [[nodiscard]] const Eigen::Matrix3Xf& points_at_rest() const;  ///< (3 x C) m

  /// Of the frame advanced last.
  [[nodiscard]] const TablesReport& report() const;

  // For any state. These functions allocate nothing, and share memory: one thread at a time.

  /// Positions of the body's skin, (3 x F) m.
  void place(const TouchState& state, Eigen::Matrix3Xf& skin);
  /// Displacements of the points at which a state's forces act, m, force by force.
  void find_moved(const TouchState& state, std::vector<Eigen::Vector3f>& moved);
  /// The stress on the skin. @param von_mises  (F) Pa  @param cauchy  (6F) Pa, or empty
  /// @pre the tables have a shell
  void stress(const TouchState& state, std::span<float> von_mises, std::span<float> cauchy);
  /// As TouchSolver::request() and the functions that follow it there.
  bool request(const TouchState& state, RequestedLoad& load);
  bool refine(TouchState& state, const RequestedLoad& load, const Eigen::Matrix3Xf& exact) const;
  void probe(RequestedLoad& load);

  // ContactBody
  [[nodiscard]] SkinPointSet contact_points() const override;
  [[nodiscard]] const ContactLimits& limits() const override;
  void make_room_for_others() override;
  void begin_frame() override;
  [[nodiscard]] bool is_at_rest() const override;
  [[nodiscard]] std::vector<PointForce>& forces() override;
  [[nodiscard]] std::vector<PointAnchor>& anchors() override;
  [[nodiscard]] double friction() const override;
  [[nodiscard]] int steps_in(double time) const override;
  void set_time_step(double h) override;
  void ring_on(double time) override;
  void forget_time() override;
  [[nodiscard]] double ringing() const override;
  [[nodiscard]] double amplitude() const override;
  [[nodiscard]] double way_by_inertia(std::span<const int> vertices) override;
  [[nodiscard]] double largest_speed() const override;
  [[nodiscard]] Eigen::Vector3f shape_at(int point) override;
  [[nodiscard]] Eigen::Vector3f shape_at_vertex(int vertex) override;
  [[nodiscard]] Eigen::Vector3f shape_at(const SkinPoint& foot) override;
  [[nodiscard]] Eigen::Vector3f rest_at(const SkinPoint& foot) const override;
  [[nodiscard]] Eigen::Vector3f normal_at(int point) override;
  [[nodiscard]] Eigen::AlignedBox3f bounds() override;
  [[nodiscard]] const MovingSurface& surface() override;
  void clear_places() override;
  bool add_place(int point) override;
  bool add_place(const SkinPoint& foot) override;
  void begin_step(std::span<const PlaceLoad> loads, bool last) override;
  void go_on(std::span<const PlaceLoad> loads) override;
  [[nodiscard]] Eigen::Vector3f position(std::size_t place) const override;
  bool linearise() override;
  void add_compliance(std::span<const UnitForce> forces, Tangent tangent, std::span<double> W,
                      std::size_t m, std::span<double> q) override;
  void add_tangential(std::span<const UnitForce> forces, Tangent tangent, std::span<float> W_nt,
                      std::size_t wide, std::span<double> W_tt, std::span<double> q_t) override;
  [[nodiscard]] double skin_compliance(double area, float softness, bool is_foot) const override;
  void find_step(std::span<const Eigen::Vector3f>) override {}
  double move(std::span<const Eigen::Vector3f> forces, double share) override;
  void form_shape(bool all) override;
  [[nodiscard]] bool has_moved(double way) const override;
  void keep(bool is_free) override;
  void keep_shape() override;
  void end_frame(double penetration) override;
  [[nodiscard]] double moved() const override;
  void limit_step(double share) override;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
