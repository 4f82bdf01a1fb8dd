/// @file
/// One step of Newton's method for unilateral contact: from the present gaps, forces and compliance
/// to new forces.
///
///   m  candidates, points that may press     r  modes of a region
///   n  slots of the compliance: vertices, some of them the candidates'
///   N  (m x 3n) normals times the points' weights
///
/// The displacement changes by J dF with J = G + U H U^T, and the gap by its component along the
/// normal. Another body that presses gives way by its own compliance, which is added to W
/// (obstacles.h). Where a point slides along a round object, by t = T du, its normal turns by D
/// t with D = force times curvature, in the two tangential directions T. Put into the balance this
/// gives
///
///     W = N J N^T + G_nt M G_nt^T,     M = D (1 - G_tt D)^-1,     G_nt = N G T^T, G_tt = T G T^T
#pragma once

#include "palpable/common/contact/complementarity.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/surface_gap.h"
#include "palpable/common/response/nonlinear_answer.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A contact point that may press.
struct ContactCandidate {
  int point = 0;                                      ///< of the skin
  std::array<int, 3> vertices{};                      ///< its corners, of the skin,
  std::array<int, 3> local{-1, -1, -1};               ///< among the vertices that take part,
  std::array<int, 3> slots{};                         ///< and in the compliance
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< of the corners
  float distance = 0;                                 ///< m, its gap now
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();  ///< 1/m
  double pressing = 0;                                  ///< N, along the normal
  float softness = 0;                                   ///< see SurfaceGap
  Eigen::Vector3f force = Eigen::Vector3f::Zero();      ///< N, all of it
  OtherSkin on;                                         ///< what it may press, if that is a body
};

struct ContactStep {
  double shift = 0;            ///< m, added to the gaps: the object is taken back by it
  double softness = 0;         ///< see TouchSettings
  bool turning = true;         ///< false: normals stay as they are
  std::size_t given = 0;       ///< so many candidates, the first, have forces that are no unknowns
  const Obstacles& obstacles;  ///< what presses: its compliance is added to W
};

/// Holds the memory of its solves, which allocate nothing.
class ContactProblem {
 public:
  /// @param compliance  (3n x 3n) G, m/N, symmetric; outlives this. 3n is a multiple of 16
  /// @param most_points of one problem
  /// @param most_modes  of a region
  ContactProblem(const Eigen::MatrixXf& compliance, int most_points, int most_modes);

  /// New forces of all candidates.
  /// @param field   (3n) m: G times the loads now, from which `answer` was evaluated
  /// @return false if the problem has no answer: the forces are as before
  bool solve(std::span<ContactCandidate> candidates, std::span<const float> field,
             const NonlinearAnswer* answer, const ContactStep& step);

 private:
  struct Turning {  // a candidate that presses a round object
    int candidate = 0;
    Eigen::Vector3f t1 = Eigen::Vector3f::Zero(), t2 = Eigen::Vector3f::Zero();
  };
  // The candidates of one blob, rising, and where their mode rows begin.
  struct BlobRows {
    std::size_t first = 0, last = 0;  // in order_
    std::size_t at = 0;               // in mode_rows_ and turned_
  };
  void add_row(const ContactCandidate& candidate, const Eigen::Vector3f& direction,
               std::span<float> row) const;
  void find_mode_rows(std::span<const ContactCandidate> candidates, const NonlinearAnswer& answer);
  void find_expected_gaps(std::span<const ContactCandidate> candidates,
                          std::span<const float> field, const NonlinearAnswer* answer,
                          double shift);
  void assemble(std::span<const ContactCandidate> candidates, const NonlinearAnswer* answer);
  void find_turning(std::span<const ContactCandidate> candidates);
  bool add_turning(std::span<const ContactCandidate> candidates, std::span<const float> field);
  void bound_turning(std::size_t t);
  void add_yielding(std::span<const ContactCandidate> candidates, const Obstacles& obstacles);
  void take_out_given(std::span<const ContactCandidate> candidates, std::size_t given);

  const Eigen::MatrixXf& G_;
  Complementarity complementarity_;
  std::size_t width_, most_modes_;         // 3n, r
  std::vector<float> rows_;                // (m x width) G N^T
  std::vector<float> mode_rows_, turned_;  // (m x r) N U, (m x r) N U H, blob by blob
  std::vector<std::size_t> order_;         // (m) candidates, blob by blob
  std::vector<BlobRows> blobs_;
  std::vector<int> blob_;                  // (m) whose modes a candidate's row is of; -1: none
  std::vector<float> turned_code_, sums_;  // (r), (m)
  std::vector<double> W_, q_, f_;          // (m x m), (m)
  std::vector<YieldingPoint> yielding_;    // y of the candidates, before other bodies,
  std::vector<std::size_t> of_yielding_;   // and which
  std::vector<double> yield_;              // (y x y)
  std::vector<Turning> turning_;           // t of them
  std::vector<float> tangent_row_;         // (width) G T^T
  std::vector<float> Gnt_, M_;             // (m x 2t), (2t x 2t), rows padded to 16
  std::vector<double> Gtt_, D_, scratch_, solved_;  // (2t x 2t)
  std::vector<double> tu_, x_, y_;                  // (2t)
};

}  // namespace palpable
