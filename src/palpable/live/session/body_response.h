/// @file
/// What one body of a session answers: the surface of what presses it, its touches, its shape. Its
/// contact law (body_laws.h) is chosen once.
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

/// How touches are answered.
struct ResponseSettings {
  ContactKind contact = ContactKind::kAnywhere;
  ObjectSurfaceSettings surface{};
  TouchSettings touch{.entry = 1e-4};  ///< m: a tenth of what a camera knows
  PressSettings press{};
  PaperSettings paper{};
};

/// Remembers its state from frame to frame. Where nothing presses it costs next to nothing.
/// Allocates nothing after the first frames.
class BodyResponse {
 public:
  /// @param twin  of the same make (are_twins()), or none: both read the same numbers; outlives
  /// this
  BodyResponse(TouchableBody body, const ResponseSettings& settings,
               const BodyResponse* twin = nullptr);
  BodyResponse(const BodyResponse&) = delete;  // its law points to the body
  BodyResponse& operator=(const BodyResponse&) = delete;

  /// The part of the image in which things that matter to the body may be seen.
  [[nodiscard]] PixelBox box_of_interest(const Rigid3& camera_from_body,
                                         const PinholeCamera& camera) const;

  /// Makes the surface of the things that press near the body.
  /// @param shows  of each pixel what it shows (PressingMask)
  void look(const SeenFrame& seen, const MaskImage& shows, const Rigid3& camera_from_body);

  /// One frame's touches, the strongest first. Of bodies that were joined the contact of the frame
  /// must have been solved before, by what they were joined to.
  /// @param time     s, of the frame
  /// @param others   m, body frame: points of another body's skin, if asks_for_others()
  /// @param by       number of the body that they are of
  /// @param touches  overwritten
  void find_touches(double time, std::span<const Eigen::Vector3f> others, int by,
                    std::vector<Touch>& touches);
  /// Whether the law reads the points of another body's skin.
  [[nodiscard]] bool asks_for_others() const;

  /// Shape, normals, stress and stated error of the touches found last.
  /// @param touches  as find_touches() gave them
  /// @param extras   what is wanted, too; else it is emptied
  void reconstruct(const std::vector<Touch>& touches, const SceneExtras& extras, SceneBody& shown);

  /// Its body, with what it was given beside; only the destructor may be called after it.
  [[nodiscard]] TouchableBody take_body();

  /// From now on exact answers are taken up, if tables answer the body; else nothing comes of it.
  void refine_with(Refiner refiner);
  [[nodiscard]] Refiner* refiner();
  [[nodiscard]] const Refiner* refiner() const;

  /// The settings', or what the body has tables for.
  [[nodiscard]] ContactKind contact() const;
  /// Whether forces on the body move it all over its skin, so that others press it and it presses
  /// them.
  [[nodiscard]] bool gives_way() const;
  /// The body for a solver of several. One that does not give way is an obstacle there.
  [[nodiscard]] ContactBody& contact_body();
  /// What is near the body in this frame, for that solver.
  [[nodiscard]] ContactSolver::Near near() const;
  /// From now on `together` solves the body's contact; in it the body has this number.
  void join(const ContactSolver& together, int number);
  /// How the contact of the frame went; nothing unless its own tables solved it.
  [[nodiscard]] ContactReport report() const;
  /// The obstacle is where the body is shown. Nothing happens if it gives way.
  void move_obstacle(const Eigen::Matrix3Xf& vertices);

  /// Null unless the body is answered by its energy in modes.
  [[nodiscard]] const ModalTables* modal() const;
  /// Which answer it; null unless they do.
  [[nodiscard]] const TouchTables* tables() const;
  /// What they remember of the frame answered last. @pre tables()
  [[nodiscard]] const TouchState& touched() const;
  [[nodiscard]] const ReducedBody& body() const { return body_; }
  [[nodiscard]] const ObjectSurface& surface() const { return surface_; }

 private:
  [[nodiscard]] BodyLaw make_law(const ResponseSettings& settings, const BodyResponse* twin);

  ReducedBody body_;
  std::optional<TouchTables> tables_;
  std::optional<ModalTables> modal_;
  RestShape rest_;
  Eigen::AlignedBox3d region_;
  ObjectSurface surface_;
  BodyLaw law_;
  std::optional<PrescribedSkin> obstacle_;  // where others need one
};

}  // namespace palpable
