#include "palpable/contact/press_law.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;

// m; what lies farther from the deepest vertex is another finger.
constexpr float kRegionRadius = 0.025f;

// A gap in the recording is not a licence to jump: s.
constexpr double kLongestFrame = 0.1;

// A measurement that differs by so many sigma is followed at once.
constexpr double kPromptInSigmas = 4;

// Halvings between two samples of the level axis: the rest is far below any camera's noise.
constexpr int kBisections = 7;

double distance_to_site(const ReducedBody& body, std::size_t site, const Vector3f& x) {
  return (body.surface.vertices.col(body.sites[site].vertex) - x.cast<double>()).norm();
}

int nearest_site(const ReducedBody& body, const Vector3f& x) {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    const double d = distance_to_site(body, s, x);
    if (d < least) {
      least = d;
      nearest = static_cast<int>(s);
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
  const float Z = seen.points()[static_cast<std::size_t>(found->point)].depth;
  return static_cast<double>(found->distance) < -tolerance_share * noise(Z);
}

std::optional<TouchedRegion> PressLaw::touched_region(const SeenSurface& seen,
                                                      double tolerance_share) const {
  const auto depth_beyond = [&](const NearestSeen& n) {
    const float Z = seen.points()[static_cast<std::size_t>(n.point)].depth;
    return -static_cast<double>(n.distance) - tolerance_share * noise(Z);
  };
  TouchedRegion region;
  Eigen::Index deepest = -1;
  NearestSeen nearest;
  for (Eigen::Index k = 0; k < rest_.cols(); ++k) {
    if (body_->fixed[static_cast<std::size_t>(k)] != 0) continue;
    if (!inside(rest_.col(k), seen, tolerance_share, nearest)) continue;
    const double depth = depth_beyond(nearest);
    if (depth > region.depth) {
      const SeenPoint& point = seen.points()[static_cast<std::size_t>(nearest.point)];
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
    if (body_->fixed[static_cast<std::size_t>(k)] != 0) continue;
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
  const SitePath& path = paths_[static_cast<std::size_t>(site)];
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
        const SeenPoint& point = seen.points()[static_cast<std::size_t>(nearest.point)];
        demand = {level, point.point, point.depth};
      }
      break;
    }
  }
  return demand;
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

  // The press that one site needs now, m along its load; 0 when nothing of it is inside.
  struct Need {
    double depth = 0;
    Vector3f point = Vector3f::Zero();
    float seen_at = 0;
  };
  const auto need_of = [&](int site) {
    const Demand demand = demanded_level(site, seen, share);
    Need need;
    if (demand.level > 0) {
      need = {press_depth_of_level(*body_, site, demand.level), demand.point, demand.seen_at};
    }
    if (site == candidate && region->depth > need.depth) {
      need = {region->depth, region->point, region->seen_at};
    }
    return need;
  };
  const auto touch_with = [&](int site, double level, const Need& need) {
    const Site& pressed = body_->sites[static_cast<std::size_t>(site)];
    return Touch{site, level, level * pressed.full_load, press_depth_of_level(*body_, site, level),
                 need.point.cast<double>()};
  };

  if (held) {
    const int site = previous.touch->site;
    const Need need = need_of(site);
    if (candidate >= 0 && candidate != site) {
      const auto at = [&](int s) {
        return distance_to_site(*body_, static_cast<std::size_t>(s), region->middle);
      };
      next.leaving_site = previous.leaving_site || need.depth == 0 ||
                          at(candidate) < settings_.site_keeping * at(site);
    }
    double level = 0;
    if (need.depth > 0) {
      const double sigma = noise(need.seen_at);
      const double slack = settings_.hysteresis * sigma;
      const double before = previous.touch->press_depth;
      const double wanted = std::clamp(before, need.depth - slack, need.depth + slack);
      // Calm where noise may be the reason, prompt where it cannot be.
      const double change = std::abs(wanted - before);
      const double follow =
          change < kPromptInSigmas * sigma
              ? std::max(settings_.least_follow, change / (kPromptInSigmas * sigma))
              : 1.0;
      const double depth = before + follow * (wanted - before);
      // What stays stays to the bit: there and back between level and depth is 2e-5 off.
      level = depth == before ? previous.touch->level : level_of_press_depth(*body_, site, depth);
    }
    if (level > 0) {
      const double before = previous.touch->level;
      level = next.leaving_site ? before - step : std::clamp(level, before - step, before + step);
    } else if (next.leaving_site && region) {  // the hand is there, at the other site
      level = previous.touch->level - step;
    }
    if (level > 0) {
      next.touch = touch_with(site, level, need);
      return next;
    }
  }
  if (candidate >= 0 && !(held && previous.touch->site == candidate)) {
    const Need need = need_of(candidate);
    const double wanted = level_of_press_depth(*body_, candidate, need.depth);
    const double level = std::min(wanted, step);
    next.leaving_site = false;
    if (level > 0) next.touch = touch_with(candidate, level, need);
  }
  return next;
}

}  // namespace palpable
