/// @file
/// The places of a body with tables that take part in a step: contact points, and feet of other
/// bodies' contact points. Each is a weighted sum of vertices of the tables.
///
///   V  vertices of the tables     P  places     S  vertices of the places, each once
#pragma once

#include "palpable/common/response/touch_skin.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A place whose displacement is a weighted sum of the displacements of vertices.
struct Place {
  ForceShares shares;                                 ///< vertices (V) and their weights
  Eigen::Vector3f at_rest = Eigen::Vector3f::Zero();  ///< m, with its lift over a coarser skin
  std::array<int, 9> local{};                         ///< (S) index of each share's vertex
  std::array<int, 9> slots{};                         ///< ComplianceCache::slot_of() of each
  bool is_foot = false;                               ///< it is another body's point's foot
};

/// Position of a place, m. @param u  (3 x S) m, displacements of the step's vertices
[[nodiscard]] Eigen::Vector3f position_of(const Place& place, const Eigen::Matrix3Xf& u);

/// Allocates in make_room().
class StepPlaces {
 public:
  /// @param vertices  V
  explicit StepPlaces(std::size_t vertices) : local_of_vertex_(vertices, -1) {}

  /// @param most_vertices  of all places  @param most_own  of the places that are not feet
  void make_room(std::size_t most_places, std::size_t most_vertices, std::size_t most_own);
  void clear();
  /// False: there is no room for it or its vertices, and it is not added.
  bool add(Place place);

  [[nodiscard]] const std::vector<Place>& places() const { return places_; }    ///< (P)
  [[nodiscard]] const std::vector<int>& vertices() const { return vertices_; }  ///< (S) of V

 private:
  std::size_t most_places_ = 0, most_vertices_ = 0, most_own_ = 0;
  std::size_t own_ = 0;  // vertices that were added by places that are not feet
  std::vector<Place> places_;
  std::vector<int> vertices_;
  std::vector<int> local_of_vertex_;  // (V) in vertices_; -1: not among them
};

}  // namespace palpable
