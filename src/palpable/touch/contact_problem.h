/// @file
/// One step of Newton's method for unilateral contact: from the present gaps, forces and compliance
/// to new forces.
///
///   m  candidates, points that may press     n  their vertices     r  modes of a region
///   N  (m x 3n) normals times the points' weights
///
/// The displacement changes by J dF with J = G + U H U^T, and the gap by its component along the
/// normal. Where a point slides along a round object, by t = T du, its normal turns by D t with D =
/// force times curvature, in the two tangential directions T. Put into the balance this gives
///
///     W = N J N^T + G_nt M G_nt^T,     M = D (1 - G_tt D)^-1,     G_nt = N G T^T, G_tt = T G T^T
#pragma once

#include "palpable/touch/complementarity.h"
#include "palpable/touch/nonlinear_answer.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A contact point that may press.
struct ContactCandidate {
  int point = 0;                                      ///< of the skin
  std::array<int, 3> local{};                         ///< its corners among the problem's vertices
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< of the corners
  float distance = 0;                                 ///< m, its gap now
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();  ///< 1/m
  double pressing = 0;                                  ///< N, along the normal
  float softness = 0;                                   ///< see SurfaceGap
  Eigen::Vector3f force = Eigen::Vector3f::Zero();      ///< N, all of it
};

struct ContactStep {
  double shift = 0;     ///< m, added to the gaps: the object is taken back by it
  double softness = 0;  ///< see TouchSettings
  bool turning = true;  ///< false: normals stay as they are
};

/// Holds the memory of its solves, which allocate nothing.
class ContactProblem {
 public:
  /// @param most_points, most_vertices  of one problem
  /// @param most_modes                  of a region
  ContactProblem(int most_points, int most_vertices, int most_modes);

  /// The compliance among the vertices that follow.
  /// @param G  (3n x 3n) m/N, symmetric
  void set_vertices(int count);
  [[nodiscard]] std::span<float> compliance_row(int row);

  /// New forces of all candidates.
  /// @param loads       (n) forces at the vertices now, from which `answer` was evaluated
  /// @return false if the problem has no answer: the forces are as before
  bool solve(std::span<ContactCandidate> candidates, std::span<const VertexForce> loads,
             const NonlinearAnswer* answer, const ContactStep& step);

 private:
  struct Turning {  // a candidate that presses a round object
    int candidate = 0;
    Eigen::Vector3f t1 = Eigen::Vector3f::Zero(), t2 = Eigen::Vector3f::Zero();
  };
  void find_rows(std::span<const ContactCandidate> candidates);
  void find_mode_rows(std::span<const ContactCandidate> candidates,
                      std::span<const VertexForce> loads, const NonlinearAnswer& answer);
  void find_expected_gaps(std::span<const ContactCandidate> candidates,
                          std::span<const VertexForce> loads, const NonlinearAnswer* answer,
                          double shift);
  void assemble(std::span<const ContactCandidate> candidates, const NonlinearAnswer* answer);
  void find_turning(std::span<const ContactCandidate> candidates);
  bool add_turning(std::span<const ContactCandidate> candidates);
  [[nodiscard]] float along(const ContactCandidate& candidate, const Eigen::Vector3f& direction,
                            const float* field) const;

  Complementarity complementarity_;
  std::size_t width_ = 0;  // 3n, padded to 16
  int n_ = 0;
  std::vector<float> G_, rows_, field_;    // (3n x width), (m x width) G N^T, (width)
  std::vector<float> mode_rows_, turned_;  // (m x r) N U, (m x r) N U H
  std::vector<int> blob_;                  // (m) whose modes a candidate's row is of; -1: none
  std::vector<float> code_, turned_code_;  // (r)
  std::vector<double> W_, q_, f_;          // (m x m), (m)
  std::vector<Turning> turning_;
  std::vector<float> tangent_rows_;  // (2t x width) G T^T
  std::vector<double> Gnt_, Gtt_, D_, M_, tu_, force_t_, scratch_;
};

}  // namespace palpable
