/// @file
/// The response of one body of a session: the seen surface that presses it, its touches and its
/// shape. Its contact law (body_laws.h) is chosen once.
///
///   V  surface vertices
#pragma once

#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/prescribed_skin.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/seen_object/surface_friction.h"
#include "palpable/live/session/body_laws.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/rest_shape.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// How touches are found, for each contact law.
struct ResponseSettings {
  ContactKind contact = ContactKind::kAnywhere;
  bool dynamics = false;  ///< SessionSettings::dynamics
  ObjectSurfaceSettings surface{};
  TouchSettings touch{.entry = 1e-4};  ///< m: a tenth of a camera's depth error
  PressSettings press{};
  PaperSettings paper{};
};

/// Keeps the body's state from frame to frame. A body that nothing presses costs next to nothing.
/// Allocates nothing after the first frames.
class BodyResponse {
 public:
  /// @param twin  a body with the same numbers (are_twins()), or none: both read one copy; outlives
  ///              this
  BodyResponse(TouchableBody body, const ResponseSettings& settings,
               const BodyResponse* twin = nullptr);
  BodyResponse(const BodyResponse&) = delete;  // its law points to the body
  BodyResponse& operator=(const BodyResponse&) = delete;

  /// The part of the image in which obstacles near the body may be seen.
  [[nodiscard]] PixelBox box_of_interest(const Rigid3& camera_from_body,
                                         const PinholeCamera& camera) const;

  /// Builds the surface of the obstacles near the body.
  /// @param shows     what each pixel shows (PressingMask)
  /// @param coverage  share of each pixel that shows a presser (PressingMask::coverage()), or null
  void look(const SeenFrame& seen, const MaskImage& shows, const Image<float>* coverage,
            const Rigid3& camera_from_body);

  /// The touches of a frame, the strongest first. If the body has joined a solver, that must have
  /// solved the frame before.
  /// @param at       of the frame
  /// @param others   m, body frame: points of another body's skin, if reads_others()
  /// @param by       number of that body
  /// @param touches  overwritten
  void find_touches(const FrameTime& at, std::span<const Eigen::Vector3f> others, int by,
                    std::vector<Touch>& touches);
  /// Whether the law reads the points of another body's skin.
  [[nodiscard]] bool reads_others() const;

  /// Shape, normals, stress and stated error of the touches found last.
  /// @param touches  as find_touches() returned them
  /// @param extras   additional arrays to fill; the others are emptied
  void reconstruct(const std::vector<Touch>& touches, const SceneExtras& extras, SceneBody& shown);

  /// Moves the body and its tables out; afterwards only the destructor may be called.
  [[nodiscard]] TouchableBody take_body();

  /// From now on full-order solutions refine the contact. Does nothing for a body without tables.
  void refine_with(Refiner refiner);
  [[nodiscard]] Refiner* refiner();
  [[nodiscard]] const Refiner* refiner() const;

  /// The law in use: that of the settings, or kSite where the body has no tables for it.
  [[nodiscard]] ContactKind contact() const;
  /// Whether the body deforms under forces anywhere on its skin, so that it and other bodies press
  /// each other.
  [[nodiscard]] bool deforms() const;
  /// The body for a solver of several bodies. A body that does not deform is an obstacle there.
  [[nodiscard]] ContactBody& contact_body();
  /// The obstacles near the body and its step limit in this frame, for that solver.
  [[nodiscard]] ContactSolver::Near near() const;
  /// From now on `together` solves the body's contact; the body has this number in it.
  void join(const ContactSolver& together, int number);
  /// How the contact of the frame went; the default unless the body's own tables solved it.
  [[nodiscard]] ContactReport report() const;
  /// To the other bodies, a body that does not deform is an obstacle: moves it to the vertices at
  /// which the body is drawn in this frame.
  void move_obstacle(const Eigen::Matrix3Xf& vertices);

  /// The tables of ModesLaw; null for another law.
  [[nodiscard]] const ModalTables* modal() const;
  /// The tables of TablesLaw; null for another law.
  [[nodiscard]] const TouchTables* tables() const;
  /// The state after the last frame. @pre tables() is not null
  [[nodiscard]] const TouchState& touched() const;
  /// Coulomb's coefficient of friction of the skin; 0 for a body that does not deform.
  [[nodiscard]] double coefficient() const { return coefficient_; }
  [[nodiscard]] const ReducedBody& body() const { return body_; }
  [[nodiscard]] const ObjectSurface& surface() const { return surface_; }
  /// The motion of that surface; null for a body that has neither friction nor inertia.
  [[nodiscard]] const SurfaceFriction* friction() const {
    return friction_ ? &*friction_ : nullptr;
  }

 private:
  void state_friction(Touch& touch) const;
  [[nodiscard]] BodyLaw make_law(const ResponseSettings& settings, const BodyResponse* twin);

  ReducedBody body_;
  std::optional<TouchTables> tables_;
  std::optional<ModalTables> modal_;
  RestShape rest_;
  Eigen::AlignedBox3d region_;
  ObjectSurface surface_;
  BodyLaw law_;
  std::optional<PrescribedSkin> obstacle_;   // made by contact_body()
  double coefficient_ = 0;                   // of friction
  std::optional<SurfaceFriction> friction_;  // of a body that has friction or inertia
};

}  // namespace palpable
