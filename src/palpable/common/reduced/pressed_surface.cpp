#include "palpable/common/reduced/pressed_surface.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/mode_kernels.h"

#include <algorithm>
#include <array>

namespace palpable {

void press_surface(const ReducedBody& body, const Eigen::Matrix3Xf& rest,
                   std::span<const double> mu, Eigen::Matrix3Xf& vertices,
                   Eigen::Matrix3Xf& normals, std::span<float> von_mises, std::span<float> cauchy) {
  const Eigen::Index V = body.surface.vertices.cols();
  PALPABLE_EXPECT(rest.cols() == V && vertices.cols() == V && normals.cols() == V &&
                      static_cast<Eigen::Index>(von_mises.size()) == V &&
                      (cauchy.empty() || static_cast<Eigen::Index>(cauchy.size()) == 6 * V),
                  "one place per vertex");
  const ModeKernels& kernels = mode_kernels().front();
  constexpr Eigen::Index kBlock = 512;  // vertices; 18 kB
  std::array<float, 6 * kBlock> stress;
  for (Eigen::Index first = 0; first < V; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, V - first);
    const auto n = static_cast<std::size_t>(count);
    const int row = static_cast<int>(first);
    body.displacement.evaluate_part(mu, 3 * row, std::span(vertices.data() + 3 * first, 3 * n));
    vertices.middleCols(first, count) += rest.middleCols(first, count);
    const std::span<float> values =
        cauchy.empty() ? std::span(stress).first(6 * n)
                       : cauchy.subspan(6 * static_cast<std::size_t>(first), 6 * n);
    body.stress.evaluate_part(mu, 6 * row, values);
    kernels.von_mises(values.data(), von_mises.subspan(static_cast<std::size_t>(first), n));
  }

  normals.setZero();
  const float* x = vertices.data();
  float* const sums = normals.data();
  const int* corner = body.surface.triangles.data();
  for (Eigen::Index t = 0; t < body.surface.triangles.cols(); ++t, corner += 3) {
    const float *a = x + 3 * corner[0], *b = x + 3 * corner[1], *c = x + 3 * corner[2];
    const float p0 = b[0] - a[0], p1 = b[1] - a[1], p2 = b[2] - a[2];
    const float q0 = c[0] - a[0], q1 = c[1] - a[1], q2 = c[2] - a[2];
    // The length is twice the area, so that larger triangles have more weight.
    const float n[3] = {p1 * q2 - p2 * q1, p2 * q0 - p0 * q2, p0 * q1 - p1 * q0};
    for (int k = 0; k < 3; ++k) {
      float* sum = sums + 3 * corner[k];
      for (int d = 0; d < 3; ++d) sum[d] += n[d];
    }
  }
  kernels.normalise(sums, static_cast<std::size_t>(V));
}

}  // namespace palpable
