/// @file
/// A reduced body pressed at one site, as the arrays that a picture takes.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/render/scene_renderer.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// What the body looks like now. Body frame, m.
class PressedBody {
 public:
  /// @param body  must outlive this object; at rest to begin with
  explicit PressedBody(const ReducedBody& body);

  /// Presses `site` at `level` (0..1 of its full load; 0 is at rest).
  void press(int site, double level);

  [[nodiscard]] int site() const { return site_; }
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] double force() const;              ///< N
  [[nodiscard]] double press_depth() const;        ///< m, along the load
  [[nodiscard]] double largest_von_mises() const;  ///< Pa
  /// (6V) Pa, as SceneBody::cauchy.
  [[nodiscard]] const std::vector<float>& cauchy() const { return cauchy_; }

  /// Arrays of this object and of the body; nothing is marked. The colour scale ends at
  /// stress_scale_of_site().
  [[nodiscard]] BodyLook look() const;
  /// Appends an orange dot on each site as it lies now. @param radius  m
  void site_dots(float radius, std::vector<Dot>& dots) const;
  /// Appends a row of dots that comes to the pressed site along its load. @param radius  m
  void load_dots(float radius, std::vector<Dot>& dots) const;
  /// 1 on vertices of some site's patch, 0 elsewhere.
  [[nodiscard]] const std::vector<float>& patch_marks() const { return patch_marks_; }
  /// The site whose middle lies nearest to a point on the body as it is now.
  [[nodiscard]] int nearest_site(const Eigen::Vector3d& at_in_body) const;

 private:
  const ReducedBody& body_;
  int site_ = -1;
  double level_ = 0;
  double scale_ = 1;  // Pa
  Eigen::Matrix3Xf at_rest_, vertices_, normals_;
  std::vector<float> von_mises_, cauchy_, patch_marks_;
};

/// Up to `count` different sites far from each other, the highest first and low ones last: what
/// shows a body best.
[[nodiscard]] std::vector<int> sites_to_show(const ReducedBody& body, int count);

}  // namespace palpable
