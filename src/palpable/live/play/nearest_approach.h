/// @file
/// How near things came to bodies, for a run without a camera in which nothing was touched.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/live/session/session_body.h"
#include "palpable/live/session/things_line.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace palpable {

/// Measures from the things to the vertices of the bodies' skins at rest; world frame, m. The skin
/// between two vertices may be nearer, by less than the longest edge.
///
/// A capsule is measured only where its nearest approach may have become nearer by kNoticed: not if
/// the bodies' boxes are farther away, and not if it has moved too little since it was measured
/// last. The first kMostToldApart things are told apart, all further ones count as one.
class NearestApproach {
 public:
  /// @param standing  the bodies; their skins are copied
  explicit NearestApproach(const std::vector<PlacedBody>& standing);

  static constexpr std::size_t kMostToldApart = 64;
  static constexpr double kNoticed = 1e-3;  ///< m

  /// Measures one line. Allocates for a thing that was not there before, or has more capsules.
  void add(const ThingsLine& line);

  /// A line for each thing (the nearest ones of many), and one that says what to try.
  [[nodiscard]] std::string text() const;
  /// How often a capsule was measured to a body's vertices; for tests.
  [[nodiscard]] std::int64_t measured() const { return measured_; }

 private:
  struct Body {
    std::string name;
    Eigen::Matrix3Xd vertices;
    Eigen::AlignedBox3d box;
  };
  // A capsule where it was measured last, and how near all bodies were at least.
  struct Measured {
    Capsule capsule;
    double at_least = 0;  // m
  };
  struct Approach {
    std::int64_t id = 0;
    double distance = std::numeric_limits<double>::infinity();  // m, negative: inside the skin
    double time = 0;                                            // s
    std::size_t body = 0;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // m, from the vertex to the thing
    std::vector<Measured> capsules = {};            // as many as the thing had at most
  };

  Approach& approach_of(std::int64_t id);
  // @return m, a lower bound of the distance to all bodies
  double measure(const Capsule& capsule, double time, Approach& nearest);
  void measure_turned(const Capsule& capsule);

  std::vector<Body> bodies_;
  std::vector<Approach> things_;
  Approach others_;  // of the things for which there was no room
  std::int64_t measured_ = 0;
  // m, between boxes, if the axis that points up were the other one: (x, -z, y) and (x, z, -y) in
  // place of (x, y, z).
  double y_was_up_ = std::numeric_limits<double>::infinity();
  double z_was_up_ = std::numeric_limits<double>::infinity();
};

}  // namespace palpable
