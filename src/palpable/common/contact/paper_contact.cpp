#include "palpable/common/contact/paper_contact.h"

#include "palpable/common/base/contract.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {

namespace {

// Factor on a squared reach, so that rounding does not leave out a distance just within it.
constexpr double kSomewhatMore = 1 + 1e-6;

int site_nearest_to_vertex(const ReducedBody& body, int vertex) {
  const Eigen::Matrix3Xd& X = body.surface.vertices;
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    const double squared = (X.col(body.sites[s].vertex) - X.col(vertex)).squaredNorm();
    if (squared < least) least = squared, nearest = static_cast<int>(s);
  }
  return nearest;
}

}  // namespace

PaperNodes::PaperNodes(const ReducedBody& body, QueriedNodes which) : which_(which) {
  const int V = body.surface.vertex_count();
  if (which == QueriedNodes::kAll) {
    for (int k = 0; k < V; ++k) {
      if (body.fixed[static_cast<std::size_t>(k)] == 0) vertices_.push_back(k);
    }
    for (const int k : vertices_) sites_.push_back(site_nearest_to_vertex(body, k));
    displacement_.resize(3, V);
  } else {
    for (const Site& site : body.sites) {
      sites_.push_back(static_cast<int>(vertices_.size()));
      vertices_.push_back(site.vertex);
    }
  }
  rest_.resize(3, static_cast<Eigen::Index>(vertices_.size()));
  for (Eigen::Index i = 0; i < rest_.cols(); ++i) {
    rest_.col(i) = body.surface.vertices.col(vertices_[i]).cast<float>();
  }
  positions_ = rest_;
}

void PaperNodes::deform(const PaperState& state, const ReducedBody& body) {
  positions_ = rest_;
  if (state.step == 0) return;
  const std::array mu{static_cast<double>(state.site), body.levels()[state.step]};
  if (which_ == QueriedNodes::kAll) {
    const auto size = static_cast<std::size_t>(displacement_.size());
    body.displacement.evaluate(mu, std::span<float>(displacement_.data(), size));
    for (Eigen::Index i = 0; i < rest_.cols(); ++i) {
      positions_.col(i) += displacement_.col(vertices_[i]);
    }
    return;
  }
  for (Eigen::Index i = 0; i < rest_.cols(); ++i) {
    Eigen::Vector3f u;
    body.displacement.evaluate_part(mu, 3 * vertices_[i], std::span<float>(u.data(), 3));
    positions_.col(i) += u;
  }
}

std::optional<NearestNode> nearest_node(const PaperNodes& nodes, const CloudDistance& cloud) {
  std::optional<NearestSeen> nearest;
  Eigen::Index node = 0;
  auto below = static_cast<float>(cloud.reach() * cloud.reach() * kSomewhatMore);
  for (Eigen::Index i = 0; i < nodes.positions().cols(); ++i) {
    const auto found = cloud.nearest(nodes.positions().col(i), below);
    if (!found) continue;
    nearest = found;
    node = i;
    below = found->squared;
  }
  if (!nearest) return std::nullopt;
  return NearestNode{nodes.site_of(node), std::sqrt(static_cast<double>(nearest->squared)),
                     nearest->point.cast<double>()};
}

std::optional<NearestNode> nearest_by_all_pairs(const PaperNodes& nodes,
                                                std::span<const Eigen::Vector3f> cloud) {
  float least = std::numeric_limits<float>::infinity();
  NearestNode nearest;
  for (Eigen::Index i = 0; i < nodes.positions().cols(); ++i) {
    for (const Eigen::Vector3f& seen : cloud) {
      const float squared = (nodes.positions().col(i) - seen).squaredNorm();
      if (squared < least) {
        least = squared;
        nearest.site = nodes.site_of(i);
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

}  // namespace palpable
