#include "palpable/live/play/nearest_approach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>

namespace palpable {
namespace {

constexpr double kFarForMetres = 5;     // m; a hand beside a body is nearer
constexpr double kClearlyNearer = 0.3;  // ratio of distances
constexpr std::size_t kMostThingsTold = 4;

Capsule turned_capsule(const Capsule& capsule, double sign) {
  const auto turn = [sign](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(x.x(), -sign * x.z(), sign * x.y());
  };
  return {turn(capsule.a), turn(capsule.b), capsule.ra, capsule.rb};
}

// m, by how much the distance of a point to a capsule changes at most from one to the other.
double largest_move(const Capsule& from, const Capsule& to) {
  return std::max((to.a - from.a).norm() + std::abs(to.ra - from.ra),
                  (to.b - from.b).norm() + std::abs(to.rb - from.rb));
}

}  // namespace

NearestApproach::NearestApproach(const std::vector<PlacedBody>& standing) {
  for (const PlacedBody& placed : standing) {
    Body& body = bodies_.emplace_back();
    body.name = placed.shown_name();
    body.vertices = placed.world_from_body * placed.body.body.surface.vertices;
    body.box =
        Eigen::AlignedBox3d(body.vertices.rowwise().minCoeff(), body.vertices.rowwise().maxCoeff());
  }
}

NearestApproach::Approach& NearestApproach::approach_of(std::int64_t id) {
  const auto found = std::find_if(things_.begin(), things_.end(),
                                  [id](const Approach& one) { return one.id == id; });
  if (found != things_.end()) return *found;
  if (things_.size() < kMostToldApart) return things_.emplace_back(Approach{.id = id});
  return others_;
}

double NearestApproach::measure(const Capsule& capsule, double time, Approach& nearest) {
  const Eigen::AlignedBox3d around = box_of(capsule);
  const CapsuleField field(capsule);
  double at_least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    const double boxes = body.box.exteriorDistance(around);
    if (boxes > nearest.distance - kNoticed) {
      at_least = std::min(at_least, boxes);
      continue;
    }
    ++measured_;
    for (Eigen::Index v = 0; v < body.vertices.cols(); ++v) {
      const Eigen::Vector3d x = body.vertices.col(v);
      const double distance = field.distance(x);
      at_least = std::min(at_least, distance);
      if (distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.time = time;
      nearest.body = k;
      nearest.way = -distance * field.normal(x);
    }
  }
  return at_least;
}

void NearestApproach::measure_turned(const Capsule& capsule) {
  const Eigen::AlignedBox3d y_was_up = box_of(turned_capsule(capsule, 1));
  const Eigen::AlignedBox3d z_was_up = box_of(turned_capsule(capsule, -1));
  for (const Body& body : bodies_) {
    y_was_up_ = std::min(y_was_up_, body.box.exteriorDistance(y_was_up));
    z_was_up_ = std::min(z_was_up_, body.box.exteriorDistance(z_was_up));
  }
}

void NearestApproach::add(const ThingsLine& line) {
  for (const ThingsLine::Thing& thing : line.things) {
    const std::size_t first = thing.first, count = thing.count;
    Approach& nearest = approach_of(thing.id);
    // Things that are not told apart have no capsules that could be found again.
    const bool is_known = &nearest != &others_;
    if (is_known && nearest.capsules.size() < count) nearest.capsules.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const Capsule& capsule = line.capsules[first + k];
      measure_turned(capsule);
      if (!is_known) {
        measure(capsule, line.time, nearest);
        continue;
      }
      Measured& last = nearest.capsules[k];
      const double bound = last.at_least - largest_move(last.capsule, capsule);
      if (bound > nearest.distance - kNoticed) continue;
      last = {capsule, measure(capsule, line.time, nearest)};
    }
  }
}

std::string NearestApproach::text() const {
  std::vector<const Approach*> told;
  const bool any_others = others_.distance < 1e30;
  const Approach* nearest_of_all = any_others ? &others_ : nullptr;
  for (const Approach& one : things_) {
    if (!(one.distance < 1e30)) continue;
    told.push_back(&one);
    if (nearest_of_all == nullptr || one.distance < nearest_of_all->distance) nearest_of_all = &one;
  }
  if (nearest_of_all == nullptr)
    return "no line has a thing that may press: \"things\" are empty everywhere\n";
  std::sort(told.begin(), told.end(), [](const Approach* one, const Approach* other) {
    return one->distance < other->distance;
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(told.size(), kMostThingsTold); ++k) {
    fmt::format_to(std::back_inserter(text),
                   "thing {} came no nearer than {:.1f} mm to a vertex of {}, at {:.3g} s\n",
                   told[k]->id, 1e3 * told[k]->distance, bodies_[told[k]->body].name,
                   told[k]->time);
  }
  if (told.size() > kMostThingsTold) {
    text += fmt::format("{} more things stayed farther away\n", told.size() - kMostThingsTold);
  }
  if (any_others) {
    text += fmt::format("further things, beyond {}, came no nearer than {:.1f} mm\n",
                        kMostToldApart, 1e3 * others_.distance);
  }
  const Approach& nearest = *nearest_of_all;
  if (nearest.distance > kFarForMetres) {
    return text +
           "so far away: is the file in metres (palpable hands --unit), and in the same world as "
           "the body (--place, or at in a scene file)?\n";
  }
  const double wanted = kClearlyNearer * nearest.distance;
  if (y_was_up_ < wanted && y_was_up_ <= z_was_up_) {
    return text + fmt::format(
                      "with Y up turned to Z up they would come within {:.0f} mm: palpable hands "
                      "--up y makes such a file\n",
                      1e3 * y_was_up_);
  }
  if (z_was_up_ < wanted) {
    return text + fmt::format(
                      "with Z up taken as it is they would come within {:.0f} mm: was --up y given "
                      "to palpable hands for a table with Z up?\n",
                      1e3 * z_was_up_);
  }
  const Eigen::Vector3d& way = nearest.way;
  return text + fmt::format(
                    "{} would be touched if it stood {:.3f} {:.3f} {:.3f} m farther along X, Y, Z: "
                    "--place, or at in a scene file, says where\n",
                    bodies_[nearest.body].name, way.x(), way.y(), way.z());
}

}  // namespace palpable
