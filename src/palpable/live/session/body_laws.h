/// @file
/// The contact laws of a session: how one body answers what presses it. A body has one of four
/// (BodyLaw); all of them do the same two things in a frame:
///
///     find_touches()   what is seen -> touches, and the body's state
///     reconstruct()    the state -> shape, normals, stress and stated error
///
///   V  surface vertices
#pragma once

#include "palpable/common/contact/cloud_distance.h"
#include "palpable/common/contact/paper_contact.h"
#include "palpable/common/contact/press_law.h"
#include "palpable/common/contact/pressing_bodies.h"
#include "palpable/common/contact/skin_contact.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_state.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_tables.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/session/modal_bodies.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

namespace palpable {

enum class ContactKind {
  kAnywhere,  ///< nothing enters the skin, anywhere (TablesLaw, ModesLaw); a body without tables
              ///< and modes: kSite
  kSite,      ///< at the body's sites, one at a time; level from the measured depth (SitesLaw)
  kPaper      ///< Algorithm 1 as printed (PaperLaw)
};

/// "anywhere", "site" or "paper".
[[nodiscard]] std::string_view name_of(ContactKind kind);

/// A body that nothing presses.
struct RestShape {
  explicit RestShape(const ReducedBody& body);
  /// Shape, normals and stress; contact pressure is emptied.
  void show(const SceneExtras& extras, SceneBody& shown) const;

  Eigen::Matrix3Xf vertices, normals;  ///< (3 x V) m
  std::vector<float> von_mises;        ///< (V) Pa
  std::vector<float> cauchy;           ///< (6V) Pa, as SceneBody::cauchy
};

/// What a law is told in a frame.
struct Pressing {
  const ObjectSurface& seen;  ///< of real things, body frame
  double time = 0;            ///< s, of the frame
  /// m, body frame: points of another body's skin; for a law that asks_for_others().
  std::span<const Eigen::Vector3f> others;
  int by = -1;  ///< the number of that body
};

/// Nothing enters the skin, anywhere, by tables of touch (contact/skin_contact.h).
class TablesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  /// @param rest  its stress is filled: tables may hold one of the preload
  TablesLaw(const ReducedBody& body, const TouchTables& tables, const TouchSettings& settings,
            RestShape& rest);

  /// The body is answered together with others from now on, as number `number` of them.
  void join(PressingBodies& together, int number);
  /// What the others are to know of it; what it points to stays where it is.
  [[nodiscard]] PressingBodies::Body among_others(const ReducedBody& body,
                                                  const ObjectSurface& seen);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] static constexpr bool asks_for_others() { return false; }

  std::optional<Refiner> refiner;  ///< exact answers, taken up where there is one
  [[nodiscard]] const TouchState& state() const { return state_; }
  [[nodiscard]] const TouchTables& tables() const { return *tables_; }

 private:
  const ReducedBody* body_;
  const TouchTables* tables_;
  SkinContact contact_;
  TouchState state_;
  bool is_moved_ = false;  // though nothing may touch it: it is on its way back
  std::optional<StatedError> stated_;
  PressingBodies* together_ = nullptr;
  int number_ = -1;
};

/// Nothing enters the skin of bodies whose energy is known in modes; all of them are answered
/// together (modal_bodies.h).
class ModesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  explicit ModesLaw(const ModalTables& tables) : tables_(&tables) {}
  /// @param member  its place among them
  void join(ModalBodies& together, int member);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] static constexpr bool asks_for_others() { return false; }
  [[nodiscard]] const ModalTables& tables() const { return *tables_; }

 private:
  const ModalTables* tables_;
  ModalBodies* together_ = nullptr;
  int member_ = -1;
};

/// At the body's sites, one at a time (contact/press_law.h).
class SitesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kSite;
  SitesLaw(const ReducedBody& body, const PressSettings& settings)
      : body_(&body), law_(body, settings) {}

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] static constexpr bool asks_for_others() { return false; }

 private:
  const ReducedBody* body_;
  PressLaw law_;
  PressState state_;
};

/// Algorithm 1 as printed (contact/paper_contact.h). Where nothing real is near, the skin of
/// another body presses (paper Sec. 5.1: one way).
class PaperLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kPaper;
  PaperLaw(const ReducedBody& body, const Eigen::AlignedBox3d& region,
           const PaperSettings& settings);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] static constexpr bool asks_for_others() { return true; }

 private:
  const ReducedBody* body_;
  PaperSettings settings_;
  PaperState state_;
  PaperNodes nodes_;
  CloudDistance seen_;
};

using BodyLaw = std::variant<TablesLaw, ModesLaw, SitesLaw, PaperLaw>;

}  // namespace palpable
