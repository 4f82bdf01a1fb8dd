#include "palpable/reduced/reduced_body.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {

double level_of_press_depth(const ReducedBody& body, int site, double depth) {
  PALPABLE_EXPECT(site >= 0 && static_cast<std::size_t>(site) < body.sites.size(),
                  "the site exists");
  const Eigen::VectorXd& levels = body.levels();
  const auto depths = body.press_depth.col(site);
  const Eigen::Index last = levels.size() - 1;
  if (!(depth > depths[0])) return levels[0];
  if (depth >= depths[last]) return levels[last];
  Eigen::Index right = 1;
  while (depths[right] <= depth) ++right;
  const double t = (depth - depths[right - 1]) / (depths[right] - depths[right - 1]);
  return levels[right - 1] + t * (levels[right] - levels[right - 1]);
}

void von_mises(std::span<const float> stress, std::span<float> result) {
  PALPABLE_EXPECT(stress.size() == 6 * result.size(), "six components per vertex");
  for (std::size_t i = 0; i < result.size(); ++i) {
    const float* s = stress.data() + 6 * i;
    const float xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
    const float shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
    result[i] = std::sqrt(0.5f * (xy * xy + yz * yz + zx * zx) + 3.0f * shear);
  }
}

}  // namespace palpable
