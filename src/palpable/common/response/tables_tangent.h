/// @file
/// The places of a body with tables that take part in a step, and the tangent of the body among
/// unit forces at its places: the derivative of the displacement along one force by the magnitude
/// of another.
///
///     J = G + sum over patches  U H U^T + Phi D Phi^T
///
/// with G from compliance.h, U the modes of a patch's region, and H the derivative of their
/// amplitudes by the modal coordinates of the load (nonlinear_response.h). The last term is that of
/// inertia (inertia.h), where time passes.
///
///   V  vertices of the tables     P  places     S  vertices of the places, each once
///   r  modes of a region     w  3 x slots of the compliance cache
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/inertia.h"
#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/touch_skin.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A place that takes part in a step: a contact point, or the foot of another body's contact point.
/// Its displacement is a weighted sum of the displacements of vertices of the tables.
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

/// The state at which a tangent is taken.
struct TablesAt {
  std::span<const Place> places;      ///< (P)
  const ComplianceCache& compliance;  ///< with the places' vertices
  std::span<const float> field;       ///< (w) m, G f at the slots' vertices
  /// The response beyond the linear one, evaluated under the present loads at the places. Null: the
  /// tangent is G alone, which does not depend on the loads.
  NonlinearResponse* regions = nullptr;
  /// Under the present loads, too. Null: no time passes.
  const Inertia* inertia = nullptr;
};

/// Allocates in its constructor and in make_room().
class TablesTangent {
 public:
  /// @param most_modes  r of the largest region
  /// @param inertia     Inertia::row_width() at most, 0: without inertia
  explicit TablesTangent(std::size_t most_modes, std::size_t inertia = 0);
  /// @param width  w
  void make_room(std::size_t most_places, std::size_t width);

  /// As ContactBody::add_compliance().
  void add_compliance(const TablesAt& at, std::span<const UnitForce> forces, std::span<double> W,
                      std::size_t m, std::span<double> q);
  /// As ContactBody::add_tangential(), by the linear tables and inertia alone: the terms by which
  /// normals turn are a small part of the tangent.
  void add_tangential(const TablesAt& at, std::span<const UnitForce> forces, std::span<float> W_nt,
                      std::size_t wide, std::span<double> W_tt, std::span<double> q_t);
  /// The same with all terms of the last add_compliance(), for friction, where the two tangents of
  /// a contact follow each other.
  void add_all_tangential(const TablesAt& at, std::span<const UnitForce> forces,
                          std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                          std::span<double> q_t);
  /// m/N, the mean compliance of a force on itself, over the forces of the last add_compliance().
  /// With inertia that at once, without the vibration modes: a share of it is small beside every
  /// compliance of a time step, and does not depend on the step.
  [[nodiscard]] double mean() const { return mean_; }

 private:
  struct PatchRows {                  // the unit forces of one patch
    std::size_t first = 0, last = 0;  // in order_
    std::size_t at = 0;               // where their rows begin in mode_rows_ and turned_
  };
  void fill_row(const TablesAt& at, const UnitForce& unit, std::span<float> row) const;
  void find_mode_rows(const TablesAt& at, std::span<const UnitForce> forces);
  void add_modes(const TablesAt& at, std::span<const UnitForce> forces, std::span<double> W,
                 std::size_t m, std::span<double> q);
  void add_tangential_modes(const TablesAt& at, std::span<const UnitForce> forces,
                            std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                            std::span<double> q_t);
  void add_inertia(const TablesAt& at, std::span<const UnitForce> forces, std::span<double> W,
                   std::size_t m, std::span<double> q);
  void add_tangential_inertia(const TablesAt& at, std::span<const UnitForce> forces,
                              std::span<float> W_nt, std::size_t wide, std::span<double> W_tt,
                              std::span<double> q_t);

  std::size_t modes_wide_, inertia_wide_, width_ = 0;
  std::vector<float> rows_;                // (P x w) G d, with d a unit force
  std::vector<float> mode_rows_, turned_;  // (P x r) d U, d U H, patch by patch
  std::vector<std::size_t> order_;         // (P) unit forces, patch by patch
  std::vector<PatchRows> patches_;
  std::vector<int> patch_of_;                     // (P) of each unit force; -1: none
  std::vector<float> turned_coordinates_, sums_;  // (r), (P)
  std::vector<float> tangent_row_;                // (w)
  std::vector<UnitForce> normals_;                // of the last add_compliance()
  bool has_mode_rows_ = false;                    // of normals_
  std::vector<float> tangent_modes_;              // (2P x r) d U, of tangential unit forces
  std::vector<std::size_t> tangent_order_;        // (2P) of one patch: tangential unit forces
  std::vector<int> tangent_patch_;                // (2P) of each tangential unit force; -1: none
  std::vector<float> tangent_sums_;               // (2P)
  // Of inertia: Phi^T d of the normal and of the tangential unit forces, and D times one of them.
  std::vector<float> inertia_rows_, tangent_inertia_rows_, turned_inertia_;
  double mean_ = 0;
};

}  // namespace palpable
