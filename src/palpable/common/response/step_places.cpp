#include "palpable/common/response/step_places.h"

#include <algorithm>

namespace palpable {

Eigen::Vector3f position_of(const Place& place, const Eigen::Matrix3Xf& u) {
  Eigen::Vector3f x = place.at_rest;
  for (std::size_t k = 0; k < place.shares.count; ++k) {
    x += place.shares.of[k].weight * u.col(place.local[k]);
  }
  return x;
}

void StepPlaces::make_room(std::size_t most_places, std::size_t most_vertices,
                           std::size_t most_own) {
  most_places_ = most_places;
  most_vertices_ = most_vertices;
  most_own_ = most_own;
  places_.reserve(most_places);
  vertices_.reserve(most_vertices);
}

void StepPlaces::clear() {
  for (const int v : vertices_) local_of_vertex_[static_cast<std::size_t>(v)] = -1;
  vertices_.clear();
  places_.clear();
  own_ = 0;
}

bool StepPlaces::add(Place place) {
  const std::span shares(place.shares.of.data(), place.shares.count);
  const auto missing = std::count_if(shares.begin(), shares.end(), [&](const ForceShare& share) {
    return local_of_vertex_[static_cast<std::size_t>(share.vertex)] < 0;
  });
  const auto more = static_cast<std::size_t>(missing);
  if (places_.size() == most_places_ || vertices_.size() + more > most_vertices_ ||
      (!place.is_foot && own_ + more > most_own_)) {
    return false;
  }
  if (!place.is_foot) own_ += more;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    int& local = local_of_vertex_[static_cast<std::size_t>(shares[k].vertex)];
    if (local < 0) {
      local = static_cast<int>(vertices_.size());
      vertices_.push_back(shares[k].vertex);
    }
    place.local[k] = local;
  }
  places_.push_back(place);
  return true;
}

}  // namespace palpable
