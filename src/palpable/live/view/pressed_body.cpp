#include "palpable/live/view/pressed_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/pressed_surface.h"
#include "palpable/live/view/stress_scale.h"

#include <algorithm>
#include <array>
#include <limits>

namespace palpable {

PressedBody::PressedBody(const ReducedBody& body)
    : body_(body),
      at_rest_(body.surface.vertices.cast<float>()),
      vertices_(at_rest_),
      normals_(3, at_rest_.cols()),
      von_mises_(at_rest_.cols()),
      cauchy_(6 * von_mises_.size()),
      patch_marks_(von_mises_.size()) {
  for (const Site& site : body.sites) {
    for (const int vertex : site.patch) patch_marks_[vertex] = 1.0f;
  }
  press(0, 0.0);
}

void PressedBody::press(int site, double level) {
  PALPABLE_EXPECT(site >= 0 && site < std::ssize(body_.sites), "the site exists");
  level_ = std::clamp(level, 0.0, 1.0);
  if (site != site_) {
    site_ = site;
    scale_ = stress_scale_of_site(body_, site_);
  }
  const std::array<double, 2> mu{static_cast<double>(site), level_};
  press_surface(body_, at_rest_, mu, vertices_, normals_, von_mises_, cauchy_);
}

double PressedBody::force() const { return level_ * body_.sites[site_].full_load; }

double PressedBody::press_depth() const { return press_depth_of_level(body_, site_, level_); }

double PressedBody::largest_von_mises() const {
  return *std::max_element(von_mises_.begin(), von_mises_.end());
}

BodyLook PressedBody::look() const {
  BodyLook look;
  look.vertices = &vertices_;
  look.normals = &normals_;
  look.triangles = &body_.surface.triangles;
  look.scalar = von_mises_;
  look.scalar_max = static_cast<float>(scale_);
  return look;
}

void PressedBody::site_dots(float radius, std::vector<Dot>& dots) const {
  for (const Site& site : body_.sites) {
    Dot dot;
    dot.at_in_body = vertices_.col(site.vertex);
    dot.radius = radius;
    dots.push_back(dot);
  }
}

void PressedBody::load_dots(float radius, std::vector<Dot>& dots) const {
  const Site& site = body_.sites[site_];
  constexpr int kBalls = 6;
  for (int i = 0; i < kBalls; ++i) {
    // Smaller towards the body, like the head of an arrow.
    const auto outwards = (1.2f + 2.3f * static_cast<float>(i)) * radius;
    Dot dot;
    dot.at_in_body = vertices_.col(site.vertex) - outwards * site.direction.cast<float>();
    dot.radius = radius * (0.55f + 0.09f * static_cast<float>(i));
    dots.push_back(dot);
  }
}

int PressedBody::nearest_site(const Eigen::Vector3d& at_in_body) const {
  int nearest = 0;
  float least = std::numeric_limits<float>::max();
  for (std::size_t s = 0; s < body_.sites.size(); ++s) {
    const float distance =
        (vertices_.col(body_.sites[s].vertex) - at_in_body.cast<float>()).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = static_cast<int>(s);
    }
  }
  return nearest;
}

std::vector<int> sites_to_show(const ReducedBody& body, int count) {
  const auto middle = [&](int site) {
    return Eigen::Vector3d(body.surface.vertices.col(body.sites[site].vertex));
  };
  const int site_count = static_cast<int>(body.sites.size());
  // Below this height the body is near its support and hardly deforms.
  const double lowest = 0.3 * body.surface.vertices.row(2).maxCoeff();
  std::vector<int> chosen;
  while (static_cast<int>(chosen.size()) < std::min(count, site_count)) {
    int best = 0;
    double best_value = -std::numeric_limits<double>::max();
    for (int s = 0; s < site_count; ++s) {
      double value = middle(s).z();  // the first site is the highest
      if (!chosen.empty()) {
        value = std::numeric_limits<double>::max();
        for (const int c : chosen) value = std::min(value, (middle(s) - middle(c)).norm());
        if (middle(s).z() < lowest) value *= 1e-3;  // chosen only after all others
      }
      if (value > best_value) {
        best_value = value;
        best = s;
      }
    }
    chosen.push_back(best);
  }
  return chosen;
}

}  // namespace palpable
