/// @file
/// A reduced body pressed at one site, as arrays for the renderer.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/render/scene_renderer.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// The present shape and stress of the body. Body frame, m.
class PressedBody {
 public:
  /// Begins at rest. @param body  must outlive this object
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

  /// Points to arrays of this object and of the body; no marks. The top of the colour scale is
  /// stress_scale_of_site().
  [[nodiscard]] BodyLook look() const;
  /// Appends an orange dot at the present position of each site. @param radius  m
  void site_dots(float radius, std::vector<Dot>& dots) const;
  /// Appends a row of dots along the load, towards the pressed site. @param radius  m
  void load_dots(float radius, std::vector<Dot>& dots) const;
  /// 1 at vertices that belong to the patch of a site, 0 elsewhere.
  [[nodiscard]] const std::vector<float>& patch_marks() const { return patch_marks_; }
  /// The site whose middle is nearest to a point on the deformed body.
  [[nodiscard]] int nearest_site(const Eigen::Vector3d& at_in_body) const;

 private:
  const ReducedBody& body_;
  int site_ = -1;
  double level_ = 0;
  double scale_ = 1;  // Pa
  Eigen::Matrix3Xf at_rest_, vertices_, normals_;
  std::vector<float> von_mises_, cauchy_, patch_marks_;
};

/// Chooses up to `count` sites for pictures of a body: far from each other, the highest first and
/// low ones last.
[[nodiscard]] std::vector<int> sites_to_show(const ReducedBody& body, int count);

}  // namespace palpable
