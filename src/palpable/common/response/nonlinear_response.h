/// @file
/// The displacement of a body beyond its linear response under all its loads: of each patch of load
/// by the modes of a region around it, and of the interaction of patches by modes of the whole
/// body.
///
///   V, W  vertices of the skin, and nodes: those and inner ones
///   C, k  clusters of the compliance, and numbers of a target (compliance.h)
///   r  modes of a region        x  modes of the cross terms
///
/// The loads are divided into *patches*, each of which lies within the modes of one region. With
/// a_b the coordinates of patch b in its region and c_b its coordinates in the cross terms' modes,
///
///     u = G f + sum_b U_b q_b(a_b) + X q_x,
///     q_x = - 1/2 ( A_x(c, c) - sum_b A_x(c_b, c_b) ),     c = sum_b c_b
///
/// so that the effect of a patch on itself comes from its region alone. Without the cross terms the
/// displacement by two fingers that squeeze a body would be wrong by half: each bends back what the
/// other bends.
#pragma once

#include "palpable/common/response/compliance.h"
#include "palpable/common/response/region.h"
#include "palpable/common/response/symmetric_form.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Modes of the whole body for the interaction of patches.
struct CrossTable {
  RoundedRows modes;    ///< (3W x x) sqrt(m/N)
  SymmetricForm cubic;  ///< A_x; without modes: patches do not interact
};

/// The table reduced to its first modes; the whole table if it has no more. @pre modes is a
/// multiple of 16
[[nodiscard]] CrossTable leading(const CrossTable& table, int modes);

/// A region whose modes hold a vertex.
struct RegionAtVertex {
  int region = 0;
  float distance = 0;  ///< m, of the vertex from the region's middle
};

/// For each vertex the regions whose modes hold it, nearest first: those whose middles are within
/// 1.4 `reach`, or the nearest one if there is none.
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

/// Whether the interaction of patches is evaluated anew or taken from the last evaluation.
enum class CrossTerms { kAnew, kAsBefore };

/// Keeps the memory of its evaluations, which allocate nothing.
class NonlinearResponse {
 public:
  static constexpr int kMostPatches = 16;

  /// How many of the cross terms' modes are used, the leading ones. They are ordered by how much of
  /// the loads on a body they carry: 192 modes change no film's figures (docs/lab/touch.md) and
  /// cost eight times as much.
  static constexpr int kCrossModes = 96;

  /// All arguments except the cross terms outlive this.
  NonlinearResponse(const Compliance& compliance, std::span<const RegionTable> regions,
                    const RegionMap& map, const CrossTable& cross);

  /// Divides vertices into patches, at most kMostPatches. Region by region, that one is chosen
  /// which covers most of the weight that is not yet assigned; weight counts less towards the edge
  /// of a region's reach. A vertex joins the first chosen patch whose region is listed for it
  /// (RegionMap), else the first one whose modes hold it, else none.
  /// @param vertices  of the skin, each once
  /// @param weights   how strongly each vertex is pressed or is about to be; any unit
  /// @param before    regions of the last frame: chosen again where they cover nearly as much
  void choose_patches(std::span<const int> vertices, std::span<const float> weights,
                      std::span<const int> before);
  /// The region of each patch.
  [[nodiscard]] std::span<const int> regions() const { return {chosen_.data(), chosen_.size()}; }

  /// Forgets the cross terms of earlier loads: later results depend on their arguments alone.
  void start() { cross_patches_ = 0; }

  /// Computes coordinates, q and H of each patch under these loads. The cross terms are kept from
  /// the evaluation before if the coordinates of the patches in the cross terms' modes have changed
  /// by less than 2 % (L2) since then. @pre the loads' vertices were given to choose_patches()
  void evaluate(std::span<const VertexForce> loads, CrossTerms cross = CrossTerms::kAnew);

  /// The displacement of a vertex beyond the linear one, m. @pre it was given to choose_patches(),
  /// or find_far_targets() was called
  [[nodiscard]] Eigen::Vector3f displacement_at(int vertex) const;
  /// Computes the targets in all clusters; evaluate() computes those in the clusters of the
  /// vertices that were given to choose_patches().
  void find_far_targets();
  /// (C x k) targets of the regions' modes in the clusters beyond the regions' own nodes, for
  /// Compliance::add_beyond().
  [[nodiscard]] std::span<const float> far_targets() const { return far_targets_; }
  /// Adds the regions' modes at their own nodes, of the first n nodes. @param u  (3 x n) m, n <= W
  void add_near(Eigen::Ref<Eigen::Matrix3Xf> u) const;
  /// Adds the interaction of the patches at the first n nodes. @param u  (3 x n) m, n <= W
  void add_cross(Eigen::Ref<Eigen::Matrix3Xf> u) const;

  [[nodiscard]] int patch_count() const { return static_cast<int>(chosen_.size()); }
  [[nodiscard]] const RegionTable& region_of(int patch) const { return regions_[chosen_[patch]]; }
  /// (r) coordinates of a patch under the loads that were evaluated.
  [[nodiscard]] std::span<const float> coordinates(int patch) const {
    return {coordinates_.data() + static_cast<std::size_t>(patch) * most_modes_,
            static_cast<std::size_t>(region_of(patch).mode_count())};
  }
  /// (r) q of a patch.
  [[nodiscard]] std::span<const float> q(int patch) const { return responses_[patch].q(); }
  [[nodiscard]] int patch_of(int vertex) const { return patch_of_vertex_[vertex]; }
  /// row += direction . U at a vertex, the contribution of that vertex to a contact point's row of
  /// modes. False if the modes of the patch's region do not hold the vertex. @param row  (r)
  bool add_mode_row(int patch, int vertex, const Eigen::Vector3f& direction,
                    std::span<float> row) const;
  /// result = H x of a patch.
  void times(int patch, std::span<const float> x, std::span<float> result) const {
    responses_[patch].times(x, result);
  }
  /// The largest RegionResponse::last_share() of the patches.
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
  std::vector<int> chosen_;                            // regions of the patches
  std::vector<int> patch_of_vertex_;                   // (V) -1: none
  std::vector<int> queried_;                           // vertices whose patch is set
  std::vector<RegionResponse> responses_;              // by patch
  std::vector<float> score_;                           // by region
  std::size_t most_modes_ = 0;                         // r of the largest region
  std::vector<float> coordinates_, far_targets_;       // (patches x r), (C x k)
  std::vector<float> far_coordinates_, arriving_;      // (f), (k)
  std::vector<char> queried_cluster_, every_cluster_;  // (C) 1: targets are computed there
  std::vector<char> own_cluster_;  // (regions x C) 1: its nodes are in the region
  std::vector<float> cross_coordinates_, pairs_, cross_q_;  // (patches + 1 x x), (p), (x)
  std::vector<float> cross_coordinates_before_;  // (patches x x) those of which cross_q_ is
  std::size_t cross_patches_ = 0;                // patches in them; 0: cross_q_ is not computed
  float last_share_ = 0;
};

}  // namespace palpable
