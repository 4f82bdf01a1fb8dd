/// @file
/// Force devices: the forces of ticks (contact/contact_solver.h) beside those of whole frames, and
/// a simulated device that leans on a body.
///
///          hand ──spring, damper──► device, 50 g ──measured position, 1 kHz──► tick
///                                     ▲                                        │
///                                     └──────── force, held for 1 ms ◄─────────┘
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/response/touchable_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable::app {

/// A finger that presses a body somewhere: its end is a ball.
struct Fingertip {
  Eigen::Vector3d touching = Eigen::Vector3d::Zero();  ///< m, centre of the ball that just touches
  Eigen::Vector3d into = Eigen::Vector3d::UnitZ();     ///< unit, into the body
  Eigen::Vector3d aside = Eigen::Vector3d::UnitX();    ///< unit, along the skin
  double radius = 0.008;                               ///< m

  /// The finger with its ball at `centre`: a capsule 40 mm long that stands on the skin.
  [[nodiscard]] Capsule at(const Eigen::Vector3d& centre) const;
};

/// Fingertips at random vertices, above the lowest 15 % of the body's height and free of supports.
/// The same seed gives the same ones.
[[nodiscard]] std::vector<Fingertip> fingertips(const TouchableBody& body, int count,
                                                std::uint64_t seed);

/// Ticks beside whole frames: a finger presses 5 mm deep at `speed`, moves 5 mm aside at half of
/// it, and leaves.
struct TickFigures {
  std::vector<double> ms;        ///< of the processor, of each tick with a force
  std::vector<double> air_ms;    ///< the same without a force: before the finger comes, and after
  std::vector<double> frame_ms;  ///< of whole frames of 1 ms at the same times as `ms`
  std::vector<double> press_ms;  ///< of the same frames with skin, stress and touches
  std::vector<double> force;     ///< |F_tick - F_frame| / |F_frame|, of ticks above a tenth of the
                                 ///< largest force
  std::vector<double> faint;     ///< N, |F_tick - F_frame| of the others
  /// By how much of its force the answer differs from the tick's where each 33rd call is a frame.
  std::vector<double> jump;
};
[[nodiscard]] TickFigures tick_figures(const TouchableBody& body, const Fingertip& finger,
                                       double friction, double speed);

/// A force device with one point that moves in space, and the hand that holds it. The force that it
/// holds for a tick is that of the position it measured a tick before.
struct DeviceSettings {
  double mass = 0.05;      ///< kg
  double rate = 1000;      ///< Hz
  double workspace = 0.4;  ///< m, that 2^bits positions divide
  int bits = 16;
  double grip = 300;   ///< N/m, of the hand
  double damping = 3;  ///< N s/m, of the hand
  double gain = 1;     ///< times the body's force: as a body that is as many times stiffer
  double friction = 0.3;
};

/// How the device moved.
struct LeanFigures {
  double shake = 0;      ///< m/s, root mean square of its speed in the last second, at rest
  double force = 0;      ///< N, mean size of the body's force in that second
  double depth = 0;      ///< m, of the device beyond the skin at rest, along `into`
  double stiffness = 0;  ///< N/m, of the body there for a small further way, with the gain
  /// J, that the device has put into the body: at most, and in that cycle of the shaking in which
  /// it was least. A body that gives none of its own takes some in each cycle.
  double largest_energy = 0, least_in_cycle = 0;
  [[nodiscard]] bool is_stable() const;
};

/// The hand leads the device 5 mm deep in `lead` s and holds it there for the rest of `seconds`;
/// `fast`: it shakes it at 5 Hz by 3 mm meanwhile, and holds still in the last second.
[[nodiscard]] LeanFigures lean(const TouchableBody& body, const Fingertip& finger,
                               const DeviceSettings& device, double seconds, bool fast);

/// ms, how long after each of a second's ticks was due its force was there, with a tick due each
/// ms: waking up and computing. More than 1: the next tick was late. A finger rests 4 mm deep and
/// trembles.
[[nodiscard]] std::vector<double> lateness(const TouchableBody& body, const Fingertip& finger,
                                           double friction);

}  // namespace palpable::app
