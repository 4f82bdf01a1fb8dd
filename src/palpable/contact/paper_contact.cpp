#include "palpable/contact/paper_contact.h"

#include "palpable/base/contract.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {

std::optional<NearestNode> nearest_node(const Eigen::Matrix3Xf& nodes,
                                        std::span<const Eigen::Vector3f> cloud) {
  float least = std::numeric_limits<float>::infinity();
  NearestNode nearest;
  for (Eigen::Index s = 0; s < nodes.cols(); ++s) {
    for (const Eigen::Vector3f& seen : cloud) {
      const float d2 = (nodes.col(s) - seen).squaredNorm();
      if (d2 < least) {
        least = d2;
        nearest.site = static_cast<int>(s);
        nearest.point = seen.cast<double>();
      }
    }
  }
  if (!std::isfinite(least)) return std::nullopt;
  nearest.distance = std::sqrt(static_cast<double>(least));
  return nearest;
}

PaperState advance_as_printed(const PaperState& previous, const std::optional<NearestNode>& nearest,
                              int last_step, const PaperSettings& settings) {
  PALPABLE_EXPECT(0 < settings.press_distance, "distances are positive");
  PALPABLE_EXPECT(settings.press_distance < settings.release_distance, "the press ends first");
  PALPABLE_EXPECT(last_step >= 1, "at least one load level was solved");
  if (!nearest) return previous;
  const double d = nearest->distance;
  PaperState next{nearest->site, previous.step, nearest->point};
  if (d < settings.press_distance && previous.step < last_step) {
    ++next.step;
    return next;
  }
  if (settings.press_distance < d && d < settings.release_distance && previous.step > 0) {
    --next.step;
    return next;
  }
  return previous;
}

std::optional<Touch> touch_of(const PaperState& state, const ReducedBody& body) {
  if (state.step == 0) return std::nullopt;
  const double level = body.levels()[state.step];
  const Site& site = body.sites[state.site];
  return Touch{state.site,
               level,
               level * site.full_load,
               body.press_depth(state.step, state.site),
               state.point_in_body,
               site.direction};
}

void deformed_nodes(const PaperState& state, const ReducedBody& body, Eigen::Matrix3Xf& nodes) {
  nodes.resize(3, static_cast<Eigen::Index>(body.sites.size()));
  const std::array mu{static_cast<double>(state.site), body.levels()[state.step]};
  for (Eigen::Index s = 0; s < nodes.cols(); ++s) {
    const int k = body.sites[s].vertex;
    Eigen::Vector3f u;
    body.displacement.evaluate_part(mu, 3 * k, std::span<float>(u.data(), 3));
    nodes.col(s) = body.surface.vertices.col(k).cast<float>() + u;
  }
}

}  // namespace palpable
