/// @file
/// A body under several loads at once, live: Newton's method on its energy in some thirty modes.
///
///   V  surface vertices     n  modes     S  sites     R  reactions
///
///     u = sum_i q_i F_i,     dW/dq_i = sum over the loads of  level * full load * sum_v w_v F_i(v)
///     . d
///
/// with the weights w and the direction d of each load's patch (dead loads). Displacements only:
/// the file holds no stress of several loads.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/reduced/quartic_energy.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

namespace palpable {

/// One of the loads on a body.
struct PlacedLoad {
  int place = 0;     ///< 0 .. S-1: the body's sites; S .. S+R-1: where something may push back
  double level = 0;  ///< 0 .. 1 of the full load there
};

/// The site or reaction that `place` numbers. @pre it exists
[[nodiscard]] const Site& load_place(const ReducedBody& body, int place);

/// The load of `force` (N, >= 0) at a point of the skin, along the direction in which the body was
/// loaded there. A point is that of the nearest site or reaction, as a touch is.
///
/// @param X  m, body frame, at rest
/// @returns a problem that says what is possible instead, for a point off the skin by more than a
///          tenth of a patch; on a face that no load was baked for (none whose patch reaches the
///          point and that would go into the skin there about as directly as at its own place:
///          within 60 degrees); for a force beyond what the body was baked for there, below 0, or
///          not a number. Looks at every triangle: not for the frame loop
[[nodiscard]] Result<PlacedLoad> load_at(const ReducedBody& body, const Eigen::Vector3d& X,
                                         double force);

/// Why several loads were not answered.
enum class LoadsRefused {
  kNot,            ///< they were
  kNoSuchPlace,    ///< a place is none of S + R
  kNoLevel,        ///< a level is below 0 or not a number
  kBeyondRange,    ///< the levels of the sites, or of the reactions, sum up to more than 1
  kNoEquilibrium,  ///< Newton's method ended elsewhere
};

/// A body that any of its loads may act on together. Holds all that solving needs.
class LoadedBody {
 public:
  /// @param body  outlives this, and stays where it is
  /// @returns a problem if the body answers one load at a time
  [[nodiscard]] static Result<LoadedBody> make(const ReducedBody& body);

  struct Answer {
    LoadsRefused refused = LoadsRefused::kNot;
    int load = -1;        ///< number of the load that is refused, or -1
    double sum = 0;       ///< of the levels that are beyond the range
    int steps = 0;        ///< of Newton's method
    double residual = 0;  ///< of the modal forces, relative to the loads'
    [[nodiscard]] bool ok() const { return refused == LoadsRefused::kNot; }
  };

  /// The equilibrium under all of `loads`, from the last one on: 0.1 ms a step with 34 modes, some
  /// five steps from rest. The energy is exact for any loads; the modes were made for presses whose
  /// levels sum up to 1 and reactions that do, and only those are answered. Where a load is
  /// refused, the body stays as it was; without equilibrium it is at rest. Allocates nothing.
  Answer solve(std::span<const PlacedLoad> loads) noexcept;

  /// (3V) m, the skin's displacement now, overwritten. Allocates nothing.
  /// @throws ContractViolation for another size
  void displacement(std::span<float> u) const;

  /// m: how far the patch of a place has moved along its load, weighted mean. Allocates nothing.
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

/// One line for a person: which load, and what is possible.
[[nodiscard]] std::string refusal_text(const ReducedBody& body, const LoadedBody::Answer& answer,
                                       std::span<const PlacedLoad> loads);

}  // namespace palpable
