/// @file
/// What a body does beyond its linear answer under all that presses it: each patch of load by the
/// modes of the region around it, and what patches do to each other by modes of the whole body.
///
///   V, W  vertices of the skin, and nodes: those and inner ones
///   C, k  clusters of the compliance and their numbers (compliance.h)
///   r  modes of a region        x  modes of the cross terms
///
/// The loads fall into *blobs*, patches that one region's modes can tell apart. With a_b the code
/// of blob b in its region and c_b its code in the cross terms' modes,
///
///     u = G f + sum_b U_b q_b(a_b) + X q_x,
///     q_x = - 1/2 ( A_x(c, c) - sum_b A_x(c_b, c_b) ),     c = sum_b c_b
///
/// so that what a blob does to itself is taken from its region alone. Without the cross terms two
/// fingers that squeeze a body would be wrong by half: what each bends, the other bends back.
#pragma once

#include "palpable/common/response/compliance.h"
#include "palpable/common/response/form_rows.h"
#include "palpable/common/response/region.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Modes in which blobs act on each other.
struct CrossTable {
  RoundedRows modes;    ///< (3W x x) sqrt(m/N)
  SymmetricForm cubic;  ///< A_x; of no modes: blobs do not act on each other
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

/// Whether what blobs do to each other is evaluated anew.
enum class CrossTerms { kAnew, kAsBefore };

/// Holds the memory of its evaluations, which allocate nothing.
class NonlinearAnswer {
 public:
  static constexpr int kMostBlobs = 16;

  /// Of the cross terms' modes the leading ones are used. They are ordered by how much of what
  /// presses a body they carry: 192 of them change no film's figures (docs/touch.md), and cost
  /// eight times as much.
  static constexpr int kCrossModes = 96;

  /// All arguments but the cross terms outlive this.
  NonlinearAnswer(const Compliance& compliance, std::span<const RegionTable> regions,
                  const RegionMap& map, const CrossTable& cross);

  /// Assigns vertices to blobs: as few as have every vertex with weight within the map's reach of
  /// their region's middle, the heaviest first. A vertex without weight joins the nearest blob
  /// whose region knows it, or none.
  /// @param vertices  of the skin, each once
  /// @param weights   how much each presses or is about to; any unit
  /// @param before    regions that answered last: kept where they serve nearly as well
  void choose_blobs(std::span<const int> vertices, std::span<const float> weights,
                    std::span<const int> before);
  /// The blobs' regions.
  [[nodiscard]] std::span<const int> regions() const { return {chosen_.data(), chosen_.size()}; }

  /// Lets go of what was found for other loads: what follows is a function of its arguments alone.
  void start() { cross_blobs_ = 0; }

  /// Codes, q and H under these loads. What blobs do to each other is taken from the evaluation
  /// before where no blob's load has changed by more than a fiftieth of all since then. @pre their
  /// vertices were handed to choose_blobs()
  void evaluate(std::span<const VertexForce> loads, CrossTerms cross = CrossTerms::kAnew);

  /// What is added to the linear displacement of a vertex, m. @pre it was handed to choose_blobs(),
  /// or find_far_targets() was called
  [[nodiscard]] Eigen::Vector3f displacement_at(int vertex) const;
  /// Targets in all clusters; evaluate() finds those of the vertices that it was told of.
  void find_far_targets();
  /// (C x k) targets of what the blobs' regions do beyond their own vertices, for
  /// Compliance::add_beyond().
  [[nodiscard]] std::span<const float> far_targets() const { return far_targets_; }
  /// Adds the regions' part but far_targets() at the first n nodes. @param u  (3 x n) m, n <= W
  void add_near(Eigen::Ref<Eigen::Matrix3Xf> u) const;
  /// Adds what the blobs do to each other, likewise.
  void add_cross(Eigen::Ref<Eigen::Matrix3Xf> u) const;

  [[nodiscard]] int blob_count() const { return static_cast<int>(chosen_.size()); }
  [[nodiscard]] const RegionTable& region_of(int blob) const { return regions_[chosen_[blob]]; }
  /// (r) its code under the loads that were evaluated.
  [[nodiscard]] std::span<const float> code(int blob) const {
    return {codes_.data() + static_cast<std::size_t>(blob) * most_modes_,
            static_cast<std::size_t>(region_of(blob).mode_count())};
  }
  /// (r) q of a blob.
  [[nodiscard]] std::span<const float> q(int blob) const { return answers_[blob].q(); }
  [[nodiscard]] int blob_of(int vertex) const { return blob_of_vertex_[vertex]; }
  /// row = (direction . U) at a vertex, added: the row of a contact point's modes. False if the
  /// region does not hold the vertex. @param row  (r)
  bool add_mode_row(int blob, int vertex, const Eigen::Vector3f& direction,
                    std::span<float> row) const;
  /// result = H x of a blob.
  void times(int blob, std::span<const float> x, std::span<float> result) const {
    answers_[blob].times(x, result);
  }
  /// The largest of the blobs' last orders, against what came before it.
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
  std::vector<int> chosen_;          // regions of the blobs
  std::vector<int> blob_of_vertex_;  // (V) -1: none
  std::vector<int> asked_;           // vertices whose blob is set
  std::vector<RegionAnswer> answers_;
  std::vector<float> score_;                          // by region
  std::size_t most_modes_ = 0;                        // r of the largest region
  std::vector<float> codes_, far_targets_;            // (blobs x r), (C x k)
  std::vector<float> far_code_, arriving_;            // (f), (k)
  std::vector<char> asked_cluster_, every_cluster_;   // (C) 1: targets are wanted there
  std::vector<char> own_cluster_;                     // (regions x C) 1: its nodes are the region's
  std::vector<float> cross_codes_, pairs_, cross_q_;  // (blobs + 1 x x), (p), (x)
  std::vector<float> cross_codes_before_;             // (blobs x x) to which cross_q_ belongs
  std::size_t cross_blobs_ = 0;                       // how many; 0: to none
  float last_share_ = 0;
};

}  // namespace palpable
