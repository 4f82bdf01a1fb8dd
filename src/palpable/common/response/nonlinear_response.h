/// @file
/// What a body does beyond its linear answer under all that presses it: each patch of load by the
/// modes of the region around it, and what patches do to each other by modes of the whole body.
///
///   V, W  vertices of the skin, and nodes: those and inner ones
///   C, k  clusters of the compliance and their numbers (compliance.h)
///   r  modes of a region        x  modes of the cross terms
///
/// The loads form *patches*: groups that one region's modes can tell apart. With a_b the
/// coordinates of patch b in its region and c_b its coordinates in the cross terms' modes,
///
///     u = G f + sum_b U_b q_b(a_b) + X q_x,
///     q_x = - 1/2 ( A_x(c, c) - sum_b A_x(c_b, c_b) ),     c = sum_b c_b
///
/// so that what a patch does to itself is taken from its region alone. Without the cross terms two
/// fingers that squeeze a body would be wrong by half: what each bends, the other bends back.
#pragma once

#include "palpable/common/response/compliance.h"
#include "palpable/common/response/form_rows.h"
#include "palpable/common/response/region.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Modes in which patches act on each other.
struct CrossTable {
  RoundedRows modes;    ///< (3W x x) sqrt(m/N)
  SymmetricForm cubic;  ///< A_x; of no modes: patches do not act on each other
};

/// In the first of the table's modes alone. @pre modes is a multiple of 16; of fewer modes all are
/// kept
[[nodiscard]] CrossTable leading(const CrossTable& table, int modes);

/// Which region answers for the loads at a vertex.
struct RegionAtVertex {
  int region = 0;
  float distance = 0;  ///< m, of the vertex from the region's middle
};

/// For each vertex the regions whose modes know it, nearest first: those within 1.4 times `reach`
/// of it, or the nearest one if there is none.
class RegionMap {
 public:
  /// @param vertices  (3 x V) m, at rest
  RegionMap(const Eigen::Matrix3Xf& vertices, std::span<const RegionTable> regions, double reach);

  [[nodiscard]] std::span<const RegionAtVertex> at(int vertex) const {
    return {list_.data() + first_[vertex],
            static_cast<std::size_t>(first_[vertex + 1] - first_[vertex])};
  }
  [[nodiscard]] double reach() const { return reach_; }

 private:
  double reach_;
  std::vector<int> first_;
  std::vector<RegionAtVertex> list_;
};

/// Whether what patches do to each other is evaluated anew.
enum class CrossTerms { kAnew, kAsBefore };

/// Holds the memory of its evaluations, which allocate nothing.
class NonlinearResponse {
 public:
  static constexpr int kMostPatches = 16;

  /// Of the cross terms' modes the leading ones are used. They are ordered by how much of what
  /// presses a body they carry: 192 of them change no film's figures (docs/touch.md), and cost
  /// eight times as much.
  static constexpr int kCrossModes = 96;

  /// All arguments but the cross terms outlive this.
  NonlinearResponse(const Compliance& compliance, std::span<const RegionTable> regions,
                    const RegionMap& map, const CrossTable& cross);

  /// Assigns vertices to patches: as few as have every vertex with weight within the map's reach of
  /// their region's middle, the heaviest first. A vertex without weight joins the nearest patch
  /// whose region knows it, or none.
  /// @param vertices  of the skin, each once
  /// @param weights   how much each presses or is about to; any unit
  /// @param before    regions that answered last: kept where they serve nearly as well
  void choose_patches(std::span<const int> vertices, std::span<const float> weights,
                      std::span<const int> before);
  /// The patches' regions.
  [[nodiscard]] std::span<const int> regions() const { return {chosen_.data(), chosen_.size()}; }

  /// Lets go of what was found for other loads: what follows is a function of its arguments alone.
  void start() { cross_patches_ = 0; }

  /// Codes, q and H under these loads. What patches do to each other is taken from the evaluation
  /// before where no patch's load has changed by more than a fiftieth of all since then. @pre their
  /// vertices were handed to choose_patches()
  void evaluate(std::span<const VertexForce> loads, CrossTerms cross = CrossTerms::kAnew);

  /// What is added to the linear displacement of a vertex, m. @pre it was handed to
  /// choose_patches(), or find_far_targets() was called
  [[nodiscard]] Eigen::Vector3f displacement_at(int vertex) const;
  /// Targets in all clusters; evaluate() finds those of the vertices that it was told of.
  void find_far_targets();
  /// (C x k) targets of what the patches' regions do beyond their own vertices, for
  /// Compliance::add_beyond().
  [[nodiscard]] std::span<const float> far_targets() const { return far_targets_; }
  /// Adds the regions' part but far_targets() at the first n nodes. @param u  (3 x n) m, n <= W
  void add_near(Eigen::Ref<Eigen::Matrix3Xf> u) const;
  /// Adds what the patches do to each other, likewise.
  void add_cross(Eigen::Ref<Eigen::Matrix3Xf> u) const;

  [[nodiscard]] int patch_count() const { return static_cast<int>(chosen_.size()); }
  [[nodiscard]] const RegionTable& region_of(int patch) const { return regions_[chosen_[patch]]; }
  /// (r) its coordinates under the loads that were evaluated.
  [[nodiscard]] std::span<const float> coordinates(int patch) const {
    return {coordinates_.data() + static_cast<std::size_t>(patch) * most_modes_,
            static_cast<std::size_t>(region_of(patch).mode_count())};
  }
  /// (r) q of a patch.
  [[nodiscard]] std::span<const float> q(int patch) const { return answers_[patch].q(); }
  [[nodiscard]] int patch_of(int vertex) const { return patch_of_vertex_[vertex]; }
  /// row = (direction . U) at a vertex, added: the row of a contact point's modes. False if the
  /// region does not hold the vertex. @param row  (r)
  bool add_mode_row(int patch, int vertex, const Eigen::Vector3f& direction,
                    std::span<float> row) const;
  /// result = H x of a patch.
  void times(int patch, std::span<const float> x, std::span<float> result) const {
    answers_[patch].times(x, result);
  }
  /// The largest of the patches' last orders, against what came before it.
  [[nodiscard]] float last_share() const { return last_share_; }

 private:
  [[nodiscard]] int row_of(int region, int vertex) const;
  void add_far_targets(int region, std::span<const float> q, std::span<const char> clusters);
  [[nodiscard]] bool has_cross_terms() const;
  void evaluate_cross_terms(std::span<const VertexForce> loads);
  int next_region(std::span<const int> vertices, std::span<const float> weights,
                  std::span<const int> before);

  const Compliance& compliance_;
  std::span<const RegionTable> regions_;
  const RegionMap& map_;
  CrossTable cross_;
  std::vector<FormRows> cubic_, quartic_;  // by region
  FormRows cross_cubic_;
  std::vector<int> chosen_;           // regions of the patches
  std::vector<int> patch_of_vertex_;  // (V) -1: none
  std::vector<int> asked_;            // vertices whose patch is set
  std::vector<RegionResponse> answers_;
  std::vector<float> score_;                         // by region
  std::size_t most_modes_ = 0;                       // r of the largest region
  std::vector<float> coordinates_, far_targets_;     // (patches x r), (C x k)
  std::vector<float> far_coordinates_, arriving_;    // (f), (k)
  std::vector<char> asked_cluster_, every_cluster_;  // (C) 1: targets are wanted there
  std::vector<char> own_cluster_;                    // (regions x C) 1: its nodes are the region's
  std::vector<float> cross_coordinates_, pairs_, cross_q_;  // (patches + 1 x x), (p), (x)
  std::vector<float> cross_coordinates_before_;  // (patches x x) to which cross_q_ belongs
  std::size_t cross_patches_ = 0;                // how many; 0: to none
  float last_share_ = 0;
};

}  // namespace palpable
