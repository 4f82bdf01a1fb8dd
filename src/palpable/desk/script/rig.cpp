#include "palpable/desk/script/rig.h"

#include "palpable/desk/script/random.h"

#include <Eigen/Geometry>

namespace palpable {

StereoRig zed_mini_rig() {
  // RX, CV (about Y) and RZ of the file are the rotation of the right eye; T is the baseline in its
  // frame. TY and TZ in the file are in millimetres.
  const Eigen::AngleAxisd about_x(0.00300136, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd about_y(0.000189208, Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd about_z(-0.000855091, Eigen::Vector3d::UnitZ());
  StereoRig rig;
  rig.left.pinhole = {1280, 720, 700.21, 700.21, 650.413, 360.661};
  rig.left.distortion = {-0.174219, 0.0277628, -0.0000310761, -0.0000335258, 0.0};
  rig.right.pinhole = {1280, 720, 699.838, 699.838, 654.776, 350.501};
  rig.right.distortion = {-0.176395, 0.0290527, 0.0000150278, 0.00018937, 0.0};
  rig.right_from_left.linear() = (about_x * about_y * about_z).toRotationMatrix();
  rig.right_from_left.translation() << -0.0630226, 0.00000302386, -0.0000360835;
  return rig;
}

SensorFaults sensor_faults(std::uint64_t seed) {
  Random random(seed, "sensor");
  SensorFaults faults;
  // Both ranges are the outer half of the allowed range, so that no seed gives a rig almost without
  // faults.
  const double gain_sign = random.sign();
  faults.right_gain = 1.0 + gain_sign * random.between(0.015, 0.029);
  const double row_sign = random.sign();
  faults.row_error_px = row_sign * random.between(0.05, 0.09);
  return faults;
}

}  // namespace palpable
