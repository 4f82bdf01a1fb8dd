/// @file
/// One frame of touch: unilateral, frictionless contact of a body's skin with whatever is near it,
/// by the body's tables.
///
///     g_i = gap of contact point i in the present shape, f_i its force along the object's normal
///     g_i >= 0,   f_i >= 0,   g_i f_i = 0,      u = u(f) from compliance and regions
///
/// Newton's method, each step a linear complementarity problem (complementarity.h) with the body's
/// compliance in its present state,
///
///     W = N (G + U H U^T) N^T  +  what the object's curvature adds
///
/// Gaps and normals are those of the *present* shape; a force turns as its point slides along a
/// round object, which without the curvature makes the iteration stall or end in a slipped state.
/// An object that has moved far since the last frame is taken on in steps of at most 1.25 mm.
///
///   V  vertices that the tables know, of the skin or of a coarser one that carries it
///   F  vertices of the body's skin, V where it is not carried
///   W  nodes of the shell     C  contact points
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/touch_state.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/refinement.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct TouchSettings {
  double band = 0.0025;           ///< m: points nearer than this may press
  double largest_step = 0.00125;  ///< m an object goes on in one step
  int most_steps = 12;            ///< of a frame; what is deeper is reached in later frames
  int iterations = 3;             ///< of Newton's method, of each step
  int last_iterations = 10;       ///< of the last one, in all its rounds; then it is held back
  double tolerance = 2e-5;        ///< m: the last iteration moved no touched vertex by more
  /// m a round object may enter between two contact points: flat ones are given fewer points.
  double entry = 2e-5;
  /// Of a point's own compliance, added to it: neighbours that move together share a force. What is
  /// left of it as penetration is force times that.
  double softness = 0.01;
  bool nonlinear = true;  ///< false: the linear answer, in the present shape
  int blend_frames = 6;   ///< over which an exact answer is taken up
};

/// How one frame went.
struct TouchReport {
  int candidates = 0;      ///< points near the object
  int dropped = 0;         ///< more of them than there is room for
  int blobs = 0;           ///< patches of load that regions answered for
  int steps = 0;           ///< in which the object was taken on
  int iterations = 0;      ///< of Newton's method in all
  double last_change = 0;  ///< m, of a touched vertex in the last iteration
  double penetration = 0;  ///< m, left at the deepest contact point; of bodies that give way: 0
  double last_share = 0;   ///< of the series' last order, see NonlinearAnswer
  /// m, that a vertex has yet to go: beyond advance()'s largest move, or by the last iteration of
  /// an answer that is not there yet.
  double held_back = 0;
  ErrorSigns signs;  ///< of the state's own error; 0 without force
  /// What they say; nothing without force, of a state that is held back, or where the tables'
  /// held-out touches give no scale.
  std::optional<StatedError> stated;
};

/// A body that is touched. Advancing allocates nothing once a state has had its room.
class TouchSolver {
 public:
  static constexpr int kMostPoints = 256;    ///< that may press at a time
  static constexpr int kMostVertices = 192;  ///< of their triangles, and of given forces
  static constexpr int kMostGiven = 96;      ///< forces that are given

  /// @param skin    (F vertices) the body's, at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  TouchSolver(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
              const TouchTables& tables, const TouchSettings& settings = {});
  ~TouchSolver();
  TouchSolver(TouchSolver&&) noexcept;

  /// (C) on the V vertices.
  [[nodiscard]] std::span<const SkinPoint> points() const;
  [[nodiscard]] const Eigen::Matrix3Xf& places() const;  ///< (3 x C) m, of the points at rest

  /// The state in which nothing enters the body. Pure: the same state and gaps give the same bytes.
  /// @param largest_move  m: no vertex goes on by more, whatever came near; what is left to go is
  ///                      gone in the frames after
  /// @param given   forces of other bodies on this one, N, its frame: no unknowns. At vertices that
  ///                the tables know, each at most once; kMostGiven at most
  TouchReport advance(TouchState& state, const Obstacles& obstacles,
                      double largest_move = std::numeric_limits<double>::infinity(),
                      std::span<const VertexForce> given = {});

  /// The load that a state bears, to be answered exactly. False: there is none, or an answer is
  /// still being blended in. Allocates nothing once `asked` has had its room.
  /// @pre the state was not held back
  [[nodiscard]] bool ask(const TouchState& state, AskedLoad& asked);
  /// Takes up the exact answer to a load, over the frames to come. False: it is so far from the
  /// tables' that the load was more than the body bears; nothing is changed.
  /// @param exact  (3 x W) m
  bool refine(TouchState& state, const AskedLoad& asked, const Eigen::Matrix3Xf& exact) const;

  /// A load all over the skin, so small that its answer is the linear one; what the exact answer is
  /// to agree with, if it is this body's.
  void probe(AskedLoad& asked);
  [[nodiscard]] static bool agrees(const AskedLoad& probe, const Eigen::Matrix3Xf& exact);

  /// The stress on the skin in a state, as ShellStress::evaluate(). Allocates nothing; not while
  /// another thread asks or advances.
  /// @param von_mises  (F) Pa  @param cauchy  (6F) Pa, empty: not wanted
  /// @pre the tables have a shell
  void stress(const TouchState& state, std::span<float> von_mises,
              std::span<float> cauchy = {}) const;

  /// Where the body's skin is in a state, (3 x F) m. As stress() about threads and allocations.
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const;
  /// How far the points of a state's forces have moved in it, m, force by force. Likewise.
  void find_moved(const TouchState& state, std::vector<Eigen::Vector3f>& moved) const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
