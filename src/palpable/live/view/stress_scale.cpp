#include "palpable/live/view/stress_scale.h"

#include "palpable/common/base/order_statistics.h"

#include <algorithm>
#include <array>
#include <vector>

namespace palpable {
namespace {

// The 99th percentile of the vertices' von Mises stress under the site's full load, Pa.
double high_stress(const ReducedBody& body, int site) {
  const auto V = static_cast<std::size_t>(body.surface.vertices.cols());
  std::vector<float> stress(6 * V), mises(V);
  body.stress.evaluate(std::array{static_cast<double>(site), 1.0}, stress);
  von_mises(stress, mises);
  return percentile(std::vector<double>(mises.begin(), mises.end()), 0.99);
}

}  // namespace

double stress_scale_of_site(const ReducedBody& body, int site) {
  return std::max(high_stress(body, site), 1.0);
}

double stress_scale(const ReducedBody& body) {
  std::vector<double> per_site;
  for (int s = 0; s < static_cast<int>(body.sites.size()); ++s) {
    per_site.push_back(high_stress(body, s));
  }
  return std::max(percentile(per_site, 0.75), 1.0);
}

double stress_scale(const Session& session) {
  double scale = 0;
  for (int k = 0; k < session.body_count(); ++k) {
    scale = std::max(scale, stress_scale(session.body(k).model()));
  }
  return scale;
}

}  // namespace palpable
