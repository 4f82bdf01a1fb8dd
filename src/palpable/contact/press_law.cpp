#include "palpable/contact/press_law.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;

// m around the deepest vertex: a touched vertex farther away belongs to another finger.
constexpr float kRegionRadius = 0.025f;

// s: a longer gap between two frames counts as this one, so that the press does not jump after it.
constexpr double kLongestFrame = 0.1;

// A measurement that differs from the press by at least so many sigma is followed at once.
constexpr double kPromptInSigmas = 4;

// Halvings between two samples of the level axis: what they leave is far below any camera's noise.
constexpr int kBisections = 7;

double distance_to_site(const ReducedBody& body, int site, const Vector3f& x) {
  return (body.surface.vertices.col(body.sites[site].vertex) - x.cast<double>()).norm();
}

int nearest_site(const ReducedBody& body, const Vector3f& x) {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < static_cast<int>(body.sites.size()); ++s) {
    const double d = distance_to_site(body, s, x);
    if (d < least) {
      least = d;
      nearest = s;
    }
  }
  return nearest;
}

}  // namespace

PressLaw::PressLaw(const ReducedBody& body, const PressSettings& settings)
    : body_(&body),
      settings_(settings),
      rest_(body.surface.vertices.cast<float>()),
      paths_(press_paths(body, settings.least_share)) {
  PALPABLE_EXPECT(
      settings.noise_constant >= 0 && settings.noise_linear >= 0 && settings.noise_quadratic >= 0,
      "noise is not negative");
  PALPABLE_EXPECT(0 <= settings.hysteresis && settings.hysteresis <= 1, "hysteresis is a share");
  PALPABLE_EXPECT(0 <= settings.site_keeping && settings.site_keeping <= 1,
                  "site_keeping is a share");
  PALPABLE_EXPECT(0 < settings.least_follow && settings.least_follow <= 1,
                  "a press follows by a share in (0, 1]");
  PALPABLE_EXPECT(settings.fastest > 0, "a press must end some day");
}

double PressLaw::noise(float depth) const {
  const auto Z = static_cast<double>(depth);
  return settings_.noise_constant + Z * (settings_.noise_linear + Z * settings_.noise_quadratic);
}

bool PressLaw::inside(const Vector3f& x, const SeenSurface& seen, double tolerance_share,
                      NearestSeen& nearest) const {
  const std::optional<NearestSeen> found = seen.nearest(x);
  if (!found || found->support < settings_.least_support) return false;
  nearest = *found;
  const float Z = seen.points()[found->point].depth;
  return static_cast<double>(found->distance) < -tolerance_share * noise(Z);
}

std::optional<TouchedRegion> PressLaw::touched_region(const SeenSurface& seen,
                                                      double tolerance_share) const {
  const auto depth_beyond = [&](const NearestSeen& n) {
    const float Z = seen.points()[n.point].depth;
    return -static_cast<double>(n.distance) - tolerance_share * noise(Z);
  };
  TouchedRegion region;
  Eigen::Index deepest = -1;
  NearestSeen nearest;
  for (Eigen::Index k = 0; k < rest_.cols(); ++k) {
    if (body_->fixed[k] != 0) continue;
    if (!inside(rest_.col(k), seen, tolerance_share, nearest)) continue;
    const double depth = depth_beyond(nearest);
    if (depth > region.depth) {
      const SeenPoint& point = seen.points()[nearest.point];
      region.depth = depth;
      region.point = point.point;
      region.seen_at = point.depth;
      deepest = k;
    }
  }
  if (deepest < 0) return std::nullopt;
  Vector3f sum = Vector3f::Zero();
  float weight = 0;
  for (Eigen::Index k = 0; k < rest_.cols(); ++k) {
    if (body_->fixed[k] != 0) continue;
    if ((rest_.col(k) - rest_.col(deepest)).norm() > kRegionRadius) continue;
    if (!inside(rest_.col(k), seen, tolerance_share, nearest)) continue;
    const auto w = static_cast<float>(depth_beyond(nearest));
    sum += w * rest_.col(k);
    weight += w;
    ++region.vertex_count;
  }
  region.middle = sum / weight;
  return region;
}

PressLaw::Demand PressLaw::demanded_level(int site, const SeenSurface& seen,
                                          double tolerance_share) const {
  const SitePath& path = paths_[site];
  const Eigen::VectorXd& levels = body_->levels();
  const Eigen::Index L = levels.size();
  Demand demand;
  NearestSeen nearest;
  for (std::size_t j = 0; j < path.vertices.size(); ++j) {
    const auto x = path.positions.middleCols(static_cast<Eigen::Index>(j) * L, L);
    // From the deepest level down: an object that has gone right through the vertex at rest still
    // presses. A level that another vertex already demands need not be looked at.
    for (Eigen::Index l = L - 1; l >= 0; --l) {
      if (l + 1 < L && levels[l + 1] <= demand.level) break;
      if (!inside(x.col(l), seen, tolerance_share, nearest)) continue;
      double in = 0;  // where between levels l and l + 1 the vertex leaves the object
      double out = l + 1 < L ? 1 : 0;
      for (int i = 0; i < kBisections && out > in; ++i) {
        const double t = (in + out) / 2;
        const auto s = static_cast<float>(t);
        NearestSeen there;
        if (inside((1 - s) * x.col(l) + s * x.col(l + 1), seen, tolerance_share, there)) {
          in = t;
          nearest = there;
        } else {
          out = t;
        }
      }
      const double level = l + 1 < L ? levels[l] + out * (levels[l + 1] - levels[l]) : levels[l];
      if (level > demand.level) {
        const SeenPoint& point = seen.points()[nearest.point];
        demand = {level, point.point, point.depth};
      }
      break;
    }
  }
  return demand;
}

PressLaw::Need PressLaw::need_of(int site, const SeenSurface& seen,
                                 const std::optional<TouchedRegion>& region_of_site,
                                 double tolerance_share) const {
  const Demand demand = demanded_level(site, seen, tolerance_share);
  Need need;
  if (demand.level > 0) {
    need = {press_depth_of_level(*body_, site, demand.level), demand.point, demand.seen_at};
  }
  if (region_of_site && region_of_site->depth > need.depth) {
    need = {region_of_site->depth, region_of_site->point, region_of_site->seen_at};
  }
  return need;
}

Touch PressLaw::touch_with(int site, double level, const Need& need) const {
  const Site& at = body_->sites[site];
  return Touch{site,
               level,
               level * at.full_load,
               press_depth_of_level(*body_, site, level),
               need.point.cast<double>(),
               at.direction};
}

double PressLaw::followed_level(const Touch& before, const Need& need) const {
  const double sigma = noise(need.seen_at);
  const double slack = settings_.hysteresis * sigma;
  const double wanted = std::clamp(before.press_depth, need.depth - slack, need.depth + slack);
  // Small changes may be noise and are followed slowly; large ones cannot be and are followed at
  // once.
  const double change = std::abs(wanted - before.press_depth);
  const double follow = change < kPromptInSigmas * sigma
                            ? std::max(settings_.least_follow, change / (kPromptInSigmas * sigma))
                            : 1.0;
  const double depth = before.press_depth + follow * (wanted - before.press_depth);
  // The same depth keeps the same level to the bit: from level to depth and back would be 2e-5 off.
  return depth == before.press_depth ? before.level
                                     : level_of_press_depth(*body_, before.site, depth);
}

PressState PressLaw::advance(const PressState& previous, const SeenSurface& seen,
                             double time) const {
  PressState next;
  next.time = time;
  const double step =
      settings_.fastest *
      (previous.time ? std::clamp(time - *previous.time, 0.0, kLongestFrame) : kLongestFrame);
  const bool held = previous.touch.has_value();
  const double share = held ? 1 - settings_.hysteresis : 1.0;
  const std::optional<TouchedRegion> region = touched_region(seen, share);
  const int candidate = region ? nearest_site(*body_, region->middle) : -1;
  const auto need = [&](int site) {
    return need_of(site, seen, site == candidate ? region : std::nullopt, share);
  };

  if (held) {
    const Touch& before = *previous.touch;
    const Need here = need(before.site);
    if (candidate >= 0 && candidate != before.site) {
      const auto at = [&](int s) { return distance_to_site(*body_, s, region->middle); };
      next.leaving_site = previous.leaving_site || here.depth == 0 ||
                          at(candidate) < settings_.site_keeping * at(before.site);
    }
    double level = here.depth > 0 ? followed_level(before, here) : 0;
    if (level > 0) {
      level = next.leaving_site ? before.level - step
                                : std::clamp(level, before.level - step, before.level + step);
    } else if (next.leaving_site && region) {  // the hand is there, at the other site
      level = before.level - step;
    }
    if (level > 0) {
      next.touch = touch_with(before.site, level, here);
      return next;
    }
  }
  if (candidate >= 0 && !(held && previous.touch->site == candidate)) {
    const Need there = need(candidate);
    const double level = std::min(level_of_press_depth(*body_, candidate, there.depth), step);
    next.leaving_site = false;
    if (level > 0) next.touch = touch_with(candidate, level, there);
  }
  return next;
}

}  // namespace palpable
