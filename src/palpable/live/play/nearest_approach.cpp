#include "palpable/live/play/nearest_approach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>

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
  return things_.emplace_back(Approach{.id = id});
}

void NearestApproach::measure(const Capsule& capsule, double time, Approach& nearest) const {
  const Eigen::AlignedBox3d around = box_of(capsule);
  std::optional<CapsuleField> field;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    if (body.box.exteriorDistance(around) >= nearest.distance) continue;
    if (!field) field.emplace(capsule);
    for (Eigen::Index v = 0; v < body.vertices.cols(); ++v) {
      const Eigen::Vector3d x = body.vertices.col(v);
      const double distance = field->distance(x);
      if (distance >= nearest.distance) continue;
      nearest.distance = distance;
      nearest.time = time;
      nearest.body = k;
      nearest.way = -distance * field->normal(x);
    }
  }
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
  for (const auto& [id, first, count] : line.things) {
    Approach& nearest = approach_of(id);
    for (std::size_t k = first; k < first + count; ++k) {
      measure(line.capsules[k], line.time, nearest);
      measure_turned(line.capsules[k]);
    }
  }
}

std::string NearestApproach::text() const {
  std::vector<Approach> told;
  std::copy_if(things_.begin(), things_.end(), std::back_inserter(told),
               [](const Approach& one) { return one.distance < 1e30; });
  if (told.empty()) return "no line has a thing that may press: \"things\" are empty everywhere\n";
  std::sort(told.begin(), told.end(), [](const Approach& one, const Approach& other) {
    return one.distance < other.distance;
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(told.size(), kMostThingsTold); ++k) {
    fmt::format_to(std::back_inserter(text),
                   "thing {} came no nearer than {:.1f} mm to {}, at {:.3g} s\n", told[k].id,
                   1e3 * told[k].distance, bodies_[told[k].body].name, told[k].time);
  }
  if (told.size() > kMostThingsTold) {
    text += fmt::format("{} more things stayed farther away\n", told.size() - kMostThingsTold);
  }
  const Approach& nearest = told.front();
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
