/// @file
/// How near things came to bodies, for a run without a camera in which nothing was touched.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/live/session/session_body.h"
#include "palpable/live/session/things_line.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace palpable {

/// Measures from the things to the bodies' vertices at rest; world frame, m. Capsules whose boxes
/// are farther away than an earlier line's are skipped.
class NearestApproach {
 public:
  /// @param standing  the bodies; their skins are copied
  explicit NearestApproach(const std::vector<PlacedBody>& standing);

  /// Measures one line. Allocates for a thing that was not there before.
  void add(const ThingsLine& line);

  /// A line for each thing (the nearest ones of many), and one that says what to try.
  [[nodiscard]] std::string text() const;

 private:
  struct Body {
    std::string name;
    Eigen::Matrix3Xd vertices;
    Eigen::AlignedBox3d box;
  };
  struct Approach {
    std::int64_t id = 0;
    double distance = std::numeric_limits<double>::infinity();  // m, negative: inside the skin
    double time = 0;                                            // s
    std::size_t body = 0;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();  // m, from the vertex to the thing
  };

  Approach& approach_of(std::int64_t id);
  void measure(const Capsule& capsule, double time, Approach& nearest) const;
  void measure_turned(const Capsule& capsule);

  std::vector<Body> bodies_;
  std::vector<Approach> things_;
  // m, between boxes, if the axis that points up were the other one: (x, -z, y) and (x, z, -y) in
  // place of (x, y, z).
  double y_was_up_ = std::numeric_limits<double>::infinity();
  double z_was_up_ = std::numeric_limits<double>::infinity();
};

}  // namespace palpable
