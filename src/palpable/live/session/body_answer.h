/// @file
/// What one body of a session answers: the surface of what presses it, its touches, its shape.
///
///   V  surface vertices
#pragma once

#include "palpable/common/contact/cloud_distance.h"
#include "palpable/common/contact/paper_contact.h"
#include "palpable/common/contact/press_law.h"
#include "palpable/common/contact/pressing_bodies.h"
#include "palpable/common/contact/skin_contact.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace palpable {

enum class ContactKind {
  kAnywhere,  ///< nothing enters the skin, anywhere (skin_contact.h, modal_bodies.h); a body
              ///< without tables: kSite
  kSite,      ///< at the body's sites, one at a time; level from the measured depth (press_law.h)
  kPaper      ///< Algorithm 1 as printed (paper_contact.h)
};

/// "anywhere", "site" or "paper".
[[nodiscard]] std::string_view name_of(ContactKind kind);

/// How touches are answered.
struct AnswerSettings {
  ContactKind contact = ContactKind::kAnywhere;
  ObjectSurfaceSettings surface{};
  TouchSettings touch{.entry = 1e-4};  ///< m: a tenth of what a camera knows
  PressSettings press{};
  PaperSettings paper{};
};

/// Remembers its state from frame to frame. Where nothing presses it costs next to nothing.
/// Allocates nothing after the first frames. A body whose energy is known in modes is answered
/// elsewhere, together with others (modal_bodies.h): of it there is the surface alone.
class BodyAnswer {
 public:
  BodyAnswer(TouchableBody body, const AnswerSettings& settings);
  BodyAnswer(const BodyAnswer&) = delete;  // parts of it know where others are
  BodyAnswer& operator=(const BodyAnswer&) = delete;

  /// The part of the image in which things that matter to the body may be seen.
  [[nodiscard]] PixelBox box_of_interest(const Rigid3& camera_from_body,
                                         const PinholeCamera& camera) const;

  /// Makes the surface of the things that press near the body.
  /// @param shows  of each pixel what it shows (PressingMask)
  void look(const SeenFrame& seen, const MaskImage& shows, const Rigid3& camera_from_body);

  /// One frame's touches, the strongest first.
  /// @param time     s, of the frame
  /// @param others   m, body frame: points of other bodies' skins. ContactKind::kPaper alone asks
  ///                 them, where nothing real is near (paper Sec. 5.1: one way)
  /// @param by       number of the body that they are of
  /// @param touches  overwritten
  void find_touches(double time, std::span<const Eigen::Vector3f> others, int by,
                    std::vector<Touch>& touches);

  /// The same of a body that was answered together with others.
  /// @param number  of the body among them
  void find_touches(PressingBodies& together, int number, std::vector<Touch>& touches);

  /// Shape, normals, stress and stated error of the touches found last.
  /// @param touches  as find_touches() gave them
  /// @param extras   what is wanted, too; else it is emptied
  void reconstruct(const std::vector<Touch>& touches, const SceneExtras& extras, SceneBody& shown);

  /// Its body, with what it was given beside; only the destructor may be called after it.
  [[nodiscard]] TouchableBody take_body();

  /// From now on exact answers are taken up where the body is touched anywhere.
  void refine_with(Refiner refiner) { refiner_.emplace(std::move(refiner)); }
  [[nodiscard]] Refiner* refiner() { return refiner_ ? &*refiner_ : nullptr; }
  [[nodiscard]] const Refiner* refiner() const { return refiner_ ? &*refiner_ : nullptr; }

  /// The settings', or what the body has tables for.
  [[nodiscard]] ContactKind contact() const;
  /// What others are to know to press it, and to be pressed by it where its tables answer.
  [[nodiscard]] PressingBodies::Body among_others(const Rigid3& world_from_body);
  /// Whether its tables answer.
  [[nodiscard]] bool is_anywhere() const { return anywhere_.has_value(); }
  /// Null unless the body is answered by its energy in modes.
  [[nodiscard]] const ModalTables* modal() const;
  /// Which answer it; null unless they do.
  [[nodiscard]] const TouchTables* tables() const { return anywhere_ ? &*tables_ : nullptr; }
  /// What they remember of the frame answered last.
  [[nodiscard]] const TouchState& touched() const { return touched_; }
  [[nodiscard]] const ReducedBody& body() const { return body_; }
  [[nodiscard]] const ObjectSurface& surface() const { return surface_; }

 private:
  ReducedBody body_;
  std::optional<TouchTables> tables_;
  std::optional<ModalTables> modal_;
  ContactKind contact_;
  PaperSettings paper_settings_;
  Eigen::Matrix3Xf rest_, rest_normals_;  // (3 x V) m
  // Where nothing touches: von Mises stress, and Cauchy stress as SceneBody::cauchy.
  std::vector<float> at_rest_, cauchy_at_rest_;  // (V), (6V) Pa
  Eigen::AlignedBox3d region_;
  ObjectSurface surface_;
  std::optional<SkinContact> anywhere_;
  std::optional<Refiner> refiner_;
  TouchState touched_;
  bool is_moved_ = false;  // though nothing may touch it: it is on its way back
  std::optional<StatedError> stated_;
  std::optional<PressLaw> law_;
  PressState press_;
  PaperState paper_;
  std::optional<PaperNodes> nodes_;
  std::optional<CloudDistance> seen_;
};

}  // namespace palpable
