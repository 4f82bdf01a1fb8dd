// Presses a body without any camera: reads its file, loads one site fully, prints how far the skin
// moves there.
//
//     press_body out/demo/bunny.palpable 3

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/reduced/pressed_surface.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

int main(int argc, char** argv) try {
  using namespace palpable;
  if (argc != 3) throw Error("usage: press_body BODY SITE");
  const ReducedBody body = value_or_throw(read_pressable_body(argv[1]));
  const int site = std::atoi(argv[2]);
  if (site < 0 || site >= static_cast<int>(body.sites.size())) throw Error("no such site");

  // The skin at rest, and what press_surface() fills: positions (m), normals, stress (Pa).
  const Eigen::Matrix3Xf rest = body.surface.vertices.cast<float>();
  Eigen::Matrix3Xf pressed(3, rest.cols()), normals(3, rest.cols());
  std::vector<float> von_mises(rest.cols());
  const std::array mu{static_cast<double>(site), 1.0};  // which site, which share of its full load
  press_surface(body, rest, mu, pressed, normals, von_mises);

  const Site& where = body.sites[site];
  const Eigen::Vector3f moved = pressed.col(where.vertex) - rest.col(where.vertex);
  std::printf("%.2f mm\n", 1e3 * static_cast<double>(moved.norm()));

  // The skin goes where the load pushes it.
  const bool follows =
      moved.cast<double>().dot(where.direction) > 0.5 * moved.cast<double>().norm();
  return follows && moved.norm() > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "press_body: %s\n", error.what());
  return 1;
}
