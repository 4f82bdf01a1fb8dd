/// @file
/// A body whose energy is known in some modes, such as a beam that bends far, as the contact solver
/// sees it. The positions of the places that take part follow each iteration; the whole skin is
/// summed over its modes only where its shape is read.
///
///   V  vertices of the skin     W  nodes of its shell     n  modes
///   C  contact points           P  places that take part in a step
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/moving_surface.h"
#include "palpable/common/contact/point_anchor.h"
#include "palpable/common/contact/point_forces.h"
#include "palpable/common/contact/skin_clusters.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_stress.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/packed_energy.h"
#include "palpable/common/response/shell_stress.h"
#include "palpable/common/response/skin_normals.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// A body whose energy is known in modes.
struct ModalMember {
  const ReducedBody* body = nullptr;    ///< with SeveralLoads
  const ModalTables* tables = nullptr;  ///< of it
};

/// How contact is solved on a body in modes; beams move far in a frame, hence the large steps.
struct ModalSettings {
  double band = 0.004;          ///< m: points nearer than this may press
  double largest_step = 0.004;  ///< m that an obstacle advances in one step
  int most_steps = 8;           ///< of a frame; deeper obstacles are reached in later frames
  int iterations = 2;           ///< of Newton's method, in each step but the last
  int last_iterations = 10;     ///< in the last step, at most
  double tolerance = 2e-5;      ///< m: iterations end when no vertex moves more
  double entry = 4e-5;          ///< m that a curved obstacle may enter between contact points
  double largest_move = 0.03;   ///< m that an iteration moves a vertex, at most
  /// Coulomb's coefficient of friction of the skin; none: that of the tables
  std::optional<double> friction = {};
};

/// All that is remembered of a body from frame to frame. The default is the body at rest.
struct ModalState {
  Eigen::VectorXd q;                      ///< (n) amplitudes; none: at rest
  std::vector<PointForce> forces;         ///< rising by point
  std::vector<PointAnchor> anchors = {};  ///< of the points with friction; none without friction
};

/// Whether two bodies have the same shape, modes, energy and shell, as beams from one file have.
[[nodiscard]] bool are_twins(const ModalMember& one, const ModalMember& other);

/// A body in modes as the contact solver sees it: Newton's method on the energy,
///
///     minimise  W(q)  so that  g(q) >= 0         W'(q) = B^T f        B = dg / dq
///
/// The tangent is J = F H^-1 F^T with H = W''(q) and F the modes at the places; the free
/// displacement is F H^-1 (-W'), which is not 0 because q is not in equilibrium during iterations.
///
/// Allocates in its constructor, and when a state is used for the first time.
class ModalBody final : public ContactBody {
 public:
  /// @param member  what it points to outlives this. @pre trouble_of(tables, body) is empty
  /// @param twin    a body with the same numbers (are_twins()), or none: both then read one copy of
  ///                them, which saves memory traffic. Both must be used on the same thread
  explicit ModalBody(const ModalMember& member, const ModalBody* twin = nullptr,
                     const ModalSettings& settings = {});
  ~ModalBody() override;

  [[nodiscard]] const ModalMember& member() const { return member_; }
  [[nodiscard]] Eigen::Index modes() const { return n_; }                      ///< n
  [[nodiscard]] std::span<const SkinPoint> points() const { return points_; }  ///< (C)

  /// From now on frames advance this state. It outlives its use.
  void use(ModalState& state) { state_ = &state; }

  // Of any state:

  /// (3 x V) m, positions of the skin. Valid until another member function is called.
  [[nodiscard]] const Eigen::Matrix3Xf& place(const ModalState& state);
  /// @param normals  (3 x V) unit
  void find_normals(const ModalState& state, Eigen::Matrix3Xf& normals);
  /// The true stress on the skin, Pa. @param von_mises  (V)  @param cauchy  (6V) or empty
  /// @pre the tables have a shell
  void stress(const ModalState& state, std::span<float> von_mises, std::span<float> cauchy = {});

  // ContactBody
  [[nodiscard]] SkinPointSet contact_points() const override;
  [[nodiscard]] const ContactLimits& limits() const override { return limits_; }
  void make_room_for_others() override { make_room(kMostPlacesWithOthers); }
  void begin_frame() override;
  [[nodiscard]] bool is_at_rest() const override { return q_.isZero(0); }
  [[nodiscard]] std::vector<PointForce>& forces() override { return state_->forces; }
  [[nodiscard]] std::vector<PointAnchor>& anchors() override { return state_->anchors; }
  [[nodiscard]] double friction() const override { return friction_; }
  [[nodiscard]] Eigen::Vector3f shape_at(int point) override;
  [[nodiscard]] Eigen::Vector3f shape_at_vertex(int vertex) override { return skin().col(vertex); }
  [[nodiscard]] Eigen::Vector3f shape_at(const SkinPoint& foot) override { return foot.at(skin()); }
  [[nodiscard]] Eigen::Vector3f rest_at(const SkinPoint& foot) const override {
    return foot.at(rest_);
  }
  [[nodiscard]] Eigen::Vector3f normal_at(int point) override;
  [[nodiscard]] Eigen::AlignedBox3f bounds() override;
  [[nodiscard]] const MovingSurface& surface() override;
  void clear_places() override { next_.clear(); }
  bool add_place(int point) override { return add_place(points_[static_cast<std::size_t>(point)]); }
  bool add_place(const SkinPoint& place) override;
  void begin_step(std::span<const PlaceLoad> loads, bool last) override;
  [[nodiscard]] Eigen::Vector3f position(std::size_t place) const override;
  bool linearise() override;
  void add_compliance(std::span<const UnitForce> forces, Tangent tangent, std::span<double> W,
                      std::size_t m, std::span<double> q) override;
  void add_tangential(std::span<const UnitForce> forces, Tangent tangent, std::span<float> W_nt,
                      std::size_t wide, std::span<double> W_tt, std::span<double> q_t) override;
  [[nodiscard]] double skin_compliance(double area, float softness, bool is_foot) const override;
  void find_step(std::span<const Eigen::Vector3f> forces) override;
  double move(std::span<const Eigen::Vector3f> forces, double share) override;
  void form_shape(bool) override {}  // skin() forms it when it is read
  [[nodiscard]] bool has_moved(double way) const override;
  void keep(bool is_free) override;
  void end_frame(double) override {}
  [[nodiscard]] double moved() const override;
  void limit_step(double share) override;

 private:
  using Probes = Eigen::Matrix3Xf;
  void make_room(int places);
  void set_q(const Eigen::VectorXd& q);
  void show(const ModalState& state);
  const Eigen::Matrix3Xf& skin();
  void sum(const Eigen::MatrixXf& F, float* u) const;
  void find_rows(const SkinPoint& at, Eigen::Ref<Eigen::MatrixXf> rows) const;
  void find_column(const UnitForce& force, Eigen::Ref<Eigen::VectorXd> column) const;
  [[nodiscard]] double distance_to(const Probes& probes) const;

  ModalMember member_;
  ContactLimits limits_;
  double friction_;
  Eigen::Index n_, V_;
  Eigen::Matrix3Xf rest_;
  std::vector<SkinPoint> points_;
  Eigen::Matrix3Xf points_at_rest_;  // (3 x C) m
  Eigen::Matrix3Xf held_;            // (3 x H) m, vertices that the support holds
  float coarsest_, finest_, between_;
  std::vector<float> levels_;
  SkinClusters clusters_;
  std::vector<float> rows_;               // (V x 3 x n) of the modes: vertex, direction, mode
  const Eigen::MatrixXf* modes_;          // (3V x n)
  std::shared_ptr<PackedEnergy> energy_;  // shared with twins
  MovingSurface surface_;
  SkinNormals normals_;
  // At most one of the two, if there is a shell; the first is shared with twins.
  std::shared_ptr<ModalStress> stress_;
  std::optional<ShellStress> shell_;

  ModalState* state_ = nullptr;
  Eigen::VectorXd q_;
  Eigen::VectorXf narrow_q_;  // q_ in single precision
  Eigen::Matrix3Xf u_, x_;    // (3 x V) m: displacement and position of the skin
  Eigen::Matrix3Xf shell_u_;  // (3 x W) m
  // Probes are some vertices all over the skin: modes are smooth, so they show how far any vertex
  // moves.
  Eigen::MatrixXf probe_modes_;                            // (3 probes x n)
  Probes probes_;                                          // m, their displacements now,
  Probes probes_begun_, probes_kept_, probes_linearised_;  // and at earlier moments
  bool is_skin_old_ = false, is_surface_old_ = false, is_box_old_ = true;
  Eigen::AlignedBox3f box_;

  Eigen::VectorXd q_begun_, q_linearised_;  // (n) at the begin of the frame, of the iteration
  ForcesAtStart forces_begun_{2 * std::size_t{kMostPlacesWithOthers}};
  std::size_t most_places_ = 0;
  std::vector<SkinPoint> next_, now_;       // places of the next step, and those that take part
  Eigen::Matrix3Xf now_at_rest_;            // (3 x P) m
  Eigen::MatrixXf place_rows_;              // (n x 3P) the modes there
  Eigen::VectorXd gradient_, step_, free_;  // (n) W', the step, L^-1 (-W')
  Eigen::MatrixXd hessian_, factor_;        // (n x n) W'', L
  Eigen::MatrixXd columns_, tangents_;      // (n x P), (n x 2P) L^-1 B of unit forces
  std::vector<std::size_t> row_of_;         // of each normal unit force
};

}  // namespace palpable
