/// @file
/// The live response of a body to several loads at once: Newton's method on its energy in some
/// thirty modes.
///
///   V  surface vertices     n  modes     S  sites     R  reactions
///
///     u = sum_i q_i F_i
///     dW/dq_i = sum over the loads of  level * full load * sum_v w_v F_i(v) . d
///
/// with the weights w and the direction d of each load's patch (dead loads). Only displacements are
/// available: the file holds no stress under several loads.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/quartic_energy.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// One of the loads on a body.
struct PlacedLoad {
  int place = 0;     ///< 0 .. S-1: a site; S .. S+R-1: a reaction
  double level = 0;  ///< 0 .. 1, ratio to the full load there
};

/// The site or reaction with the number `place`. @pre it exists
[[nodiscard]] const Site& load_place(const ReducedBody& body, int place);

/// The load of `force` (N, >= 0) at a point of the skin. The point is assigned to the nearest site
/// or reaction whose load enters the skin there, and the load has that one's direction.
///
/// @param X  m, body frame, at rest
/// @returns a problem that says what is possible instead, in three cases: the point is off the skin
///          by more than a tenth of a patch; no load was baked for the point (none whose patch
///          reaches it and that would enter the skin there about as directly as at its own site,
///          within 60 degrees); the force is larger than the full load, negative or not a number.
///          Visits every triangle: not for the frame loop
[[nodiscard]] Result<PlacedLoad> load_at(const ReducedBody& body, const Eigen::Vector3d& X,
                                         double force);

/// Why there is no response to several loads.
enum class LoadsRefused {
  kNot,            ///< not refused
  kNoSuchPlace,    ///< a place is not in 0 .. S + R - 1
  kNoLevel,        ///< a level is below 0 or not a number
  kBeyondRange,    ///< the levels of the sites, or of the reactions, sum up to more than 1
  kNoEquilibrium,  ///< Newton's method did not converge
};

/// Solves for the response of a body to any of its loads together. Owns all working memory.
class LoadedBody {
 public:
  /// @param body  outlives this, and is not moved
  /// @returns a problem if the body has no energy for several loads
  [[nodiscard]] static Result<LoadedBody> make(const ReducedBody& body);

  struct Answer {
    LoadsRefused refused = LoadsRefused::kNot;
    int load = -1;        ///< number of the load that is refused, or -1
    double sum = 0;       ///< kBeyondRange: sum of the levels
    int steps = 0;        ///< of Newton's method
    double residual = 0;  ///< of the modal forces, ratio to the modal forces of the loads
    [[nodiscard]] bool ok() const { return refused == LoadsRefused::kNot; }
  };

  /// Solves for the equilibrium under all of `loads`, starting from the last one: 0.1 ms for each
  /// step with 34 modes, about five steps from rest. The energy is exact for any loads, but the
  /// modes were made for presses whose levels sum up to at most 1, and likewise for reactions:
  /// other loads are refused. If a load is refused, the body keeps its state; if there is no
  /// equilibrium, it goes to rest. Allocates nothing.
  Answer solve(std::span<const PlacedLoad> loads) noexcept;

  /// Writes the skin's present displacement, (3V) m. Allocates nothing.
  /// @throws ContractViolation for another size
  void displacement(std::span<float> u) const;

  /// m, displacement of a place's patch along its load, weighted mean. Allocates nothing.
  /// @pre the place exists
  [[nodiscard]] double press_depth(int place) const;

  [[nodiscard]] const Eigen::VectorXd& amplitudes() const { return q_; }  ///< (n)

 private:
  explicit LoadedBody(const ReducedBody& body);

  const ReducedBody* body_;
  QuarticEquilibrium newton_;
  Eigen::MatrixXd unit_;        // (n x S + R) N m: modal forces of each place's full load
  Eigen::VectorXd f_, q_;       // (n)
  std::vector<float> weights_;  // (n) q_ in single precision
};

/// A one-line message: which load was refused, and what is possible.
[[nodiscard]] std::string refusal_text(const ReducedBody& body, const LoadedBody::Answer& answer,
                                       std::span<const PlacedLoad> loads);

/// The response of a body to one load or several, computed offline for reports and other programs.
struct PressResponse {
  std::vector<double> depth;                ///< m, press depth of each load
  std::vector<float> displacement;          ///< (3V) m
  std::optional<double> largest_von_mises;  ///< Pa; not known under several loads
  double error = 0;  ///< relative L2 error of the displacement, the worst in the body file
};

/// The response to one load at a site comes from the separated fields, that to all other loads from
/// LoadedBody.
/// @param loads  at least one
/// @throws Error if the body has no response to these loads, with the loads that are possible
[[nodiscard]] PressResponse find_press_response(const ReducedBody& body,
                                                std::span<const PlacedLoad> loads);

}  // namespace palpable
