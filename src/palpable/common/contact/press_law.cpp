#include "palpable/common/contact/press_law.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

// Whether a point is a vertex of the site's patch.
bool is_in_patch(const SkinPoint& point, const Site& site) {
  return point.weights[0] == 1 &&
         std::find(site.patch.begin(), site.patch.end(), point.corners[0]) != site.patch.end();
}

}  // namespace

double level_that_moves(const SitePath& path, const Eigen::VectorXd& levels, double depth) {
  const Eigen::VectorXd& moved = path.farthest;
  if (!(depth > moved[0])) return levels[0];
  for (Eigen::Index l = 1; l < levels.size(); ++l) {
    if (moved[l] < depth) continue;
    const double t = (depth - moved[l - 1]) / (moved[l] - moved[l - 1]);
    return levels[l - 1] + t * (levels[l] - levels[l - 1]);
  }
  return levels[levels.size() - 1];
}

std::vector<SitePath> press_paths(const ReducedBody& body, std::span<const SkinPoint> skin,
                                  double least_share) {
  PALPABLE_EXPECT(0 < least_share && least_share <= 1, "a share is in (0, 1]");
  const Eigen::Matrix3Xf X = body.surface.vertices.cast<float>();
  const Eigen::VectorXd& levels = body.levels();
  const Eigen::Index L = levels.size();

  std::vector<SitePath> paths(body.sites.size());
  Eigen::Matrix3Xf u(3, X.cols());
  const std::span<float> values(u.data(), static_cast<std::size_t>(u.size()));
  for (std::size_t s = 0; s < paths.size(); ++s) {
    const Site& site = body.sites[s];
    SitePath& path = paths[s];
    body.displacement.evaluate(std::array{static_cast<double>(s), levels[L - 1]}, values);
    float most = 0;
    for (const int k : site.patch) most = std::max(most, u.col(k).norm());
    const float least = static_cast<float>(least_share) * most;
    for (std::size_t k = 0; k < skin.size(); ++k) {
      if (skin[k].at(u).norm() >= least || is_in_patch(skin[k], site)) {
        path.points.push_back(static_cast<int>(k));
      }
    }
    path.positions.resize(3, std::ssize(path.points) * L);
    path.farthest.setZero(L);
    for (Eigen::Index l = 0; l < L; ++l) {
      body.displacement.evaluate(std::array{static_cast<double>(s), levels[l]}, values);
      for (const int k : site.patch) {
        path.farthest[l] = std::max(path.farthest[l], static_cast<double>(u.col(k).norm()));
      }
      if (l > 0) path.farthest[l] = std::max(path.farthest[l], path.farthest[l - 1]);
      const Eigen::Matrix3Xf x = X + u;
      for (Eigen::Index j = 0; j < std::ssize(path.points); ++j) {
        path.positions.col(j * L + l) = skin[path.points[j]].at(x);
        path.box.extend(path.positions.col(j * L + l));
      }
    }
  }
  return paths;
}

namespace {

using Eigen::Vector3f;

// m, radius of the touched region around its deepest position; balls farther away belong to another
// finger.
constexpr float kRegionRadius = 0.025f;

// Largest tolerance, ratio to a ball's radius: a point deeper inside than this always counts as
// inside.
constexpr double kMostTolerance = 0.5;

// s, longest interval between two frames that is taken into account, so that the press does not
// jump after a gap.
constexpr double kLongestFrame = 0.1;

// Change of the measurement, in sigmas, from which on it is followed at once.
constexpr double kPromptInSigmas = 4;

// Bisections between two samples of the level axis: the remaining error is far below any camera's
// noise.
constexpr int kBisections = 7;

double distance_to_site(const ReducedBody& body, int site, const Vector3f& x) {
  return (body.surface.vertices.col(body.sites[site].vertex) - x.cast<double>()).norm();
}

int site_nearest_to_point(const ReducedBody& body, const Vector3f& x) {
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

// Largest number of points of the skin, approximately: on a body as large as a house points 2 mm
// apart would fill the memory.
constexpr double kMostPoints = 60000;

// m, the wanted spacing, or a larger one with which there are about kMostPoints points. A point
// stands for about half the square of the spacing, because triangles are divided by their longest
// edge.
double spacing_on(const SurfaceMesh& surface, double wanted) {
  PALPABLE_EXPECT(wanted > 0, "the spacing of points is positive");
  double area = 0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return std::max(wanted, std::sqrt(2 * area / kMostPoints));
}

TouchedPlace place_of(const ObjectBall& ball) { return {ball.point, ball.sigma, ball.unseen_for}; }

}  // namespace

PressLaw::PressLaw(const ReducedBody& body, const PressSettings& settings)
    : body_(&body),
      settings_(settings),
      skin_(skin_points(body.surface, body.fixed, spacing_on(body.surface, settings.spacing))),
      field_(body),
      paths_(press_paths(body, skin_, settings.least_share)) {
  PALPABLE_EXPECT(settings.tolerance >= 0, "a tolerance is not negative");
  PALPABLE_EXPECT(0 <= settings.hysteresis && settings.hysteresis <= 1, "hysteresis is a share");
  PALPABLE_EXPECT(0 <= settings.site_keeping && settings.site_keeping <= 1,
                  "site_keeping is a share");
  PALPABLE_EXPECT(0 < settings.least_follow && settings.least_follow <= 1,
                  "a press follows by a share in (0, 1]");
  PALPABLE_EXPECT(settings.fastest > 0, "the speed of a press is positive");
}

std::optional<PressLaw::Inside> PressLaw::inside(const Vector3f& x, const PressingSurface& seen,
                                                 double tolerance_share) const {
  if (!seen.bounds().contains(x)) return std::nullopt;
  const std::optional<NearestOnObject> found = seen.nearest(x, 0);
  if (!found) return std::nullopt;
  const ObjectBall& ball = seen.balls()[found->ball];
  const double tolerance = std::min(settings_.tolerance * static_cast<double>(ball.sigma),
                                    kMostTolerance * static_cast<double>(ball.radius));
  const double depth = -static_cast<double>(found->distance) - tolerance_share * tolerance;
  if (depth <= 0) return std::nullopt;
  return Inside{depth, found->ball};
}

std::optional<TouchedRegion> PressLaw::touched_region(const PressingSurface& seen,
                                                      double tolerance_share) const {
  const auto depth_of = [&](const ObjectBall& ball) -> std::optional<BodyField::Overlap> {
    auto found = field_.overlap(ball.centre, ball.radius);
    if (!found) return std::nullopt;
    found->depth -= tolerance_share * settings_.tolerance * static_cast<double>(ball.sigma);
    return found->depth > 0 ? found : std::nullopt;
  };
  TouchedRegion region;
  Vector3f deepest = Vector3f::Zero();
  for (const ObjectBall& ball : seen.balls()) {
    const auto found = depth_of(ball);
    if (!found || found->depth <= region.depth) continue;
    region.depth = found->depth;
    region.place = place_of(ball);
    deepest = found->place;
  }
  if (!(region.depth > 0)) return std::nullopt;
  Vector3f sum = Vector3f::Zero();
  float weight = 0;
  for (const ObjectBall& ball : seen.balls()) {
    const auto found = depth_of(ball);
    if (!found || (found->place - deepest).norm() > kRegionRadius) continue;
    const auto w = static_cast<float>(found->depth);
    sum += w * found->place;
    weight += w;
    ++region.ball_count;
  }
  region.middle = sum / weight;
  return region;
}

// Scans from the deepest level down, so that an object that has gone right through the point's
// position at rest still presses. An object that the path enters from behind (a thumb on the other
// side of a thin ear) pushes the point back, not forward, and does not count.
PressLaw::Demand PressLaw::last_inside(const Eigen::Ref<const Eigen::Matrix3Xf>& path,
                                       const PressingSurface& seen, double tolerance_share,
                                       double least) const {
  const Eigen::VectorXd& levels = body_->levels();
  const Eigen::Index L = levels.size();
  const auto pushed_forward = [&](const Vector3f& x, Eigen::Index l) -> std::optional<Inside> {
    const auto found = inside(x, seen, tolerance_share);
    const Eigen::Index from = std::max<Eigen::Index>(l - 1, 0);
    const Vector3f way = path.col(from + 1) - path.col(from);
    if (found && (x - seen.balls()[found->ball].centre).dot(way) > 0) return found;
    return std::nullopt;
  };
  for (Eigen::Index l = L - 1; l >= 0; --l) {
    if (l + 1 < L && levels[l + 1] <= least) break;
    auto found = pushed_forward(path.col(l), l);
    if (!found) continue;
    double in = 0;  // where between levels l and l + 1 the point leaves the object
    double out = l + 1 < L ? 1 : 0;
    for (int i = 0; i < kBisections && out > in; ++i) {
      const double t = (in + out) / 2;
      const auto s = static_cast<float>(t);
      if (const auto there = pushed_forward((1 - s) * path.col(l) + s * path.col(l + 1), l + 1)) {
        in = t;
        found = there;
      } else {
        out = t;
      }
    }
    const double level = l + 1 < L ? levels[l] + out * (levels[l + 1] - levels[l]) : levels[l];
    return {level, place_of(seen.balls()[found->ball])};
  }
  return {};
}

PressLaw::Demand PressLaw::demanded_level(int site, const PressingSurface& seen,
                                          double tolerance_share) const {
  const SitePath& path = paths_[site];
  const Eigen::Index L = body_->levels().size();
  Demand demand;
  if (!path.box.intersects(seen.bounds())) return demand;
  for (Eigen::Index j = 0; j < std::ssize(path.points); ++j) {
    // Levels up to the one already demanded need not be searched.
    const Demand other =
        last_inside(path.positions.middleCols(j * L, L), seen, tolerance_share, demand.level);
    if (other.level > demand.level) demand = other;
  }
  return demand;
}

PressLaw::Need PressLaw::need_of(int site, const PressingSurface& seen,
                                 const std::optional<TouchedRegion>& region_of_site,
                                 double tolerance_share) const {
  const Demand demand = demanded_level(site, seen, tolerance_share);
  Need need;
  if (demand.level > 0) { need = {press_depth_of_level(*body_, site, demand.level), demand.place}; }
  if (region_of_site) {
    const double level = level_that_moves(paths_[site], body_->levels(), region_of_site->depth);
    if (level > demand.level) {
      need = {press_depth_of_level(*body_, site, level), region_of_site->place};
    }
  }
  return need;
}

Touch PressLaw::touch_with(int site, double level, const Need& need) const {
  const Site& at = body_->sites[site];
  return Touch{site,
               level,
               level * at.full_load,
               press_depth_of_level(*body_, site, level),
               need.place.point.cast<double>(),
               at.direction,
               static_cast<double>(need.place.unseen_for)};
}

double PressLaw::followed_level(const Touch& before, const Need& need) const {
  const auto sigma = static_cast<double>(need.place.sigma);
  const double slack = settings_.hysteresis * settings_.tolerance * sigma;
  const double wanted = std::clamp(before.press_depth, need.depth - slack, need.depth + slack);
  // Small changes may be noise and are followed slowly; large ones are not, and are followed at
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

PressState PressLaw::advance(const PressState& previous, const PressingSurface& seen,
                             double time) const {
  PressState next;
  next.time = time;
  const double step =
      settings_.fastest *
      (previous.time ? std::clamp(time - *previous.time, 0.0, kLongestFrame) : kLongestFrame);
  const bool held = previous.touch.has_value();
  const double share = held ? 1 - settings_.hysteresis : 1.0;
  const std::optional<TouchedRegion> region = touched_region(seen, share);
  const int candidate = region ? site_nearest_to_point(*body_, region->middle) : -1;
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
    } else if (next.leaving_site && region) {  // the hand is at the other site
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
