#include "palpable/live/track/picture_turn.h"

#include "tests/support/noise_room.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <numbers>

namespace palpable {
namespace {

using test::tolerance;

const PinholeCamera kTurningCamera{1280, 720, 720, 720, 639.5, 359.5};

// An eighth of the picture of a wall far away, brighter by `light`.
GrayImage eighth_of_wall(const Eigen::Matrix3d& world_from_camera, int light = 0) {
  const PinholeCamera small = kTurningCamera.scaled_down(8);
  GrayImage image(small.width, small.height);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Eigen::Vector3d ray = world_from_camera * small.unproject(x, y, 1);
      image(x, y) = static_cast<std::uint8_t>(
          test::wall_texture(ray.x() / ray.z(), ray.y() / ray.z(), 1) / 2 + light);
    }
  }
  return image;
}

TEST_CASE("a turn of up to 10 degrees is read from the shift of the picture, in any light",
          "[track]") {
  PictureTurn turned;
  turned.keep(eighth_of_wall(Eigen::Matrix3d::Identity()));
  for (const double degrees : {-10.0, -4.0, 0.0, 2.0, 6.0}) {
    INFO(degrees << " degrees");
    const Eigen::Vector3d axis = Eigen::Vector3d(0.3, 1, 0).normalized();
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis).toRotationMatrix();
    const auto found = turned.turn_to(eighth_of_wall(turn, 40), kTurningCamera);
    REQUIRE(found);
    // x_in_later = R^T x_in_kept
    CHECK(Eigen::AngleAxisd(*found * turn).angle() <=
          tolerance(9.0 / 720, "rad; a pixel of the eighth is 8 px"));
  }
}

TEST_CASE("pictures that are not alike, or of another size, have no turn", "[track]") {
  PictureTurn turned;
  const GrayImage wall = eighth_of_wall(Eigen::Matrix3d::Identity());
  CHECK_FALSE(turned.turn_to(wall, kTurningCamera));  // none is kept
  turned.keep(wall);
  CHECK_FALSE(turned.turn_to(GrayImage(80, 45, 7), kTurningCamera));
  CHECK_FALSE(turned.turn_to(GrayImage(wall.width(), wall.height(), 7), kTurningCamera));
  GrayImage other(wall.width(), wall.height());
  for (int y = 0; y < other.height(); ++y) {
    for (int x = 0; x < other.width(); ++x) {
      other(x, y) = static_cast<std::uint8_t>(255 * test::noise_at(x / 4, y / 4, 9));
    }
  }
  CHECK_FALSE(turned.turn_to(other, kTurningCamera));
}

}  // namespace
}  // namespace palpable
