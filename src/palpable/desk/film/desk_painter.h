/// @file
/// Paints the desk and what moves on it as an eye without a lens sees them at one moment: into the
/// pictures of an Eye, or, for the truth, as depth. OpenGL's names and terms; the context must be
/// current.
///
/// Words of this file:
///
///     moment    `along` 0 as the shutter opens .. 1 as it closes; movers go straight in between
///     still     a picture of the desk without movers; it is kept while the eye does not move
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

/// Both eyes and the truth use the same painter: meshes and shadows do not depend on the eye.
class DeskPainter {
 public:
  /// Uploads the scene and casts its shadows.
  /// @param look  of the movers
  DeskPainter(PaintPrograms programs, const DeskScene& scene, const DeskLook& look);

  /// Uploads what moves, as the shutter opens and as it closes; without its shadow. Quick when it
  /// has not changed.
  void place(const Movers& first, const Movers& last);
  /// Casts the shadow of what was placed, as it is at the moment `along`. Quick when it has not
  /// changed.
  void shade_by_movers(float along);

  /// The ideal picture of one moment, within `wanted`. What is outside is left as it is.
  /// @param seen  a depth buffer of the eye (Eye::seen_depth ...), used unless there is a still
  void paint_ideal(Eye& eye, const Rigid3& eye_from_desk, const Box& wanted, const GlTexture& seen,
                   float along);
  /// Into eye.stills: what stands still, with the shadow of what moves.
  /// @param alone  the exposure has no other reference
  void paint_reference(Eye& eye, int index, const Rigid3& eye_from_desk, bool alone);
  /// Into eye.layers: the movers where nothing still hides them, and elsewhere alpha 0.
  void paint_layer(const Eye& eye, int index, const Rigid3& eye_from_desk, float along);

  /// Rectangles of the ideal picture that hold all movers, without their shadow, while the shutter
  /// is open and the eye goes through the poses.
  /// @param cup  whether one is there: its capsules do not show what is drawn, so all movers
  /// together
  ///             get one rectangle
  [[nodiscard]] std::vector<Box> parts_touched(const Eye& eye, std::span<const Rigid3> poses,
                                               bool cup) const;

  /// Z, m, and whether it moves, of everything in view: into the target's pixels.
  void measure(const GlFramebuffer& target, const Rigid3& camera_from_desk,
               const PinholeCamera& view) const;

 private:
  void draw_static() const;
  void draw_movers() const;
  [[nodiscard]] bool any_in_shade(std::span<const HandCapsule> capsules) const;
  [[nodiscard]] LightBox movers_in(const ShadowMap& map) const;
  void light_desk(const ShadowMap& map, const Box& box) const;
  template <class Draw>
  void cast_shadows(const ShadowMap& map, float along, const Draw& draw) const;
  [[nodiscard]] Box touched(const Eye& eye, const Rigid3& eye_from_desk, bool shadow = true) const;

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
  // What `movers_` shows, as the shutter opens and as it closes.
  std::vector<HandCapsule> first_, last_;
  std::optional<float> shadow_along_;  // the moment of the movers' shadow, if it was cast
  bool in_shade_ = false;              // a shadow of what stands still may fall on the movers
  std::vector<Caster> casters_;
  ShadowMap still_shadow_, moving_shadow_;
  // Where each of `meshes_` is in still_shadow_'s map, and where the movers are.
  std::vector<LightBox> places_;
  LightBox shaded_by_movers_;
};

/// The rectangle of all pixels.
[[nodiscard]] inline Box all_of(const PinholeCamera& camera) {
  return {0, 0, camera.width, camera.height};
}

/// From here on only the rectangle is drawn to, until GL_SCISSOR_TEST is disabled.
inline void cut_to(const Box& box) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x, box.y, box.width, box.height);
}

}  // namespace palpable
