/// @file
/// Paints the desk and the movers on it as an eye without a lens sees them at one instant: into the
/// pictures of an Eye or, for the truth, as depth. The OpenGL context must be current.
///
/// Terms of this file:
///
///     along     instant of an exposure: 0 as the shutter opens .. 1 as it closes; movers move
///               linearly in between
///     still     a picture of the desk without movers; it is kept while the eye does not move
///     ideal     the picture of an eye without a lens, from which the raw picture is computed
///     wanted    the rectangle of the ideal picture that has to be painted
#pragma once

#include "palpable/desk/film/desk_programs.h"
#include "palpable/desk/film/desk_scene.h"
#include "palpable/desk/film/eye.h"
#include "palpable/desk/film/gpu_mesh.h"
#include "palpable/desk/film/light_box.h"
#include "palpable/desk/film/shadow_map.h"
#include "palpable/desk/script/desk_look.h"
#include "palpable/desk/script/sequence.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Both eyes and the truth share one painter, since meshes and shadows do not depend on the eye.
class DeskPainter {
 public:
  /// Uploads the scene and computes its shadows.
  /// @param look  appearance of the movers
  DeskPainter(PaintPrograms programs, const DeskScene& scene, const DeskLook& look);

  /// Uploads the movers as the shutter opens and as it closes, without their shadow. Fast if they
  /// have not changed.
  void place(const Movers& first, const Movers& last);
  /// Computes the shadow of the placed movers at the instant `along`. Fast if it has not changed.
  void shade_by_movers(float along);

  /// Paints the ideal picture of one instant within `wanted` and leaves the rest unchanged.
  /// @param seen  initial depth buffer: seen_depth or seen_depth_turned of the eye. Not used if
  ///              there is a still picture
  void paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const PixelBox& wanted,
                   const GlTexture& seen, float along);
  /// Paints the still things, with the shadow of the movers, into picture `index` of eye.stills.
  /// @param alone  whether the exposure has no other reference
  void paint_reference(Eye& eye, int index, const Rigid3& eye_from_desk, bool alone);
  /// Paints the movers into picture `index` of eye.layers, with alpha 0 where there is none or
  /// where a still thing hides it.
  void paint_layer(const Eye& eye, int index, const Rigid3& eye_from_desk, float along);

  /// Rectangles of the ideal picture that contain all movers, without their shadow, while the
  /// shutter is open and the eye passes through the poses.
  /// @param cup  whether there is a cup. Its capsules differ from the drawn surface, so all movers
  ///             together then get one rectangle
  [[nodiscard]] std::vector<PixelBox> parts_touched(const Eye& eye, std::span<const Rigid3> poses,
                                                    bool cup) const;

  /// Writes Z, m, and whether the surface moves into each pixel of the target.
  void measure(const GlFramebuffer& target, const Rigid3& camera_from_desk,
               const PinholeCamera& view) const;

 private:
  void draw_static() const;
  void draw_movers() const;
  [[nodiscard]] bool any_in_shade(std::span<const HandCapsule> capsules) const;
  [[nodiscard]] LightBox movers_in(const ShadowMap& map) const;
  void light_desk(const ShadowMap& map, const PixelBox& box) const;
  template <class Draw>
  void cast_shadows(const ShadowMap& map, float along, const Draw& draw) const;
  [[nodiscard]] PixelBox touched(const Eye& eye, const Rigid3& eye_from_desk,
                                 bool shadow = true) const;

  void look_from(const Paint& paint, const Eye& eye, const Rigid3& eye_from_desk,
                 float along) const;
  void begin_painting(const Eye& eye, const Rigid3& eye_from_desk, float along) const;
  void bind_shadows() const;
  void draw_still(const Paint& paint, const GpuMesh& mesh) const;
  [[nodiscard]] bool may_be_shaded(std::size_t i) const;
  void paint_one(std::size_t i, bool with_moving_shadows) const;
  void paint_static(bool with_moving_shadows) const;
  void paint_shaded() const;
  void paint_movers() const;
  bool has_still(Eye& eye, const Rigid3& eye_from_desk);

  DeskLook look_;
  PaintPrograms programs_;
  FullScreenTriangle full_screen_;
  std::vector<GlTexture> images_, mover_images_;
  std::vector<std::unique_ptr<GpuMesh>> meshes_;
  std::vector<std::unique_ptr<GpuMesh>> movers_;
  // The movers in `movers_` as the shutter opens and as it closes.
  std::vector<HandCapsule> first_, last_;
  std::optional<float> shadow_along_;  // `along` of the movers' shadow, if it is computed
  bool in_shade_ = false;              // whether a still thing may cast a shadow on movers
  std::vector<Caster> casters_;
  ShadowMap still_shadow_, moving_shadow_;
  // The extents of each of `meshes_`, and of the movers, in the map of still_shadow_.
  std::vector<LightBox> places_;
  LightBox shaded_by_movers_;
};

/// The rectangle of all pixels.
[[nodiscard]] inline PixelBox all_of(const PinholeCamera& camera) {
  return {0, 0, camera.width, camera.height};
}

/// Restricts drawing to the rectangle until GL_SCISSOR_TEST is disabled.
inline void cut_to(const PixelBox& box) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x, box.y, box.width, box.height);
}

}  // namespace palpable
