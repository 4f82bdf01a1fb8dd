/// @file
/// The contact laws of a session. A law decides which forces act on a body that something presses,
/// and what shape the body then has. Each body has one of four laws (BodyLaw), and each law has two
/// functions, which the session calls once a frame, one after the other:
///
///     find_touches()   computes forces and state of the body from the surface that presses it
///     reconstruct()    computes shape, normals, stress and stated error from that state
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
#include "palpable/live/session/rest_shape.h"
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

/// What presses a body in one frame: the input of find_touches().
struct Pressing {
  const ObjectSurface& seen;  ///< the surface of real things, body frame
  double time = 0;            ///< s, of the frame
  /// m, body frame: points of another body's skin. PaperLaw alone reads them.
  std::span<const Eigen::Vector3f> others;
  int by = -1;  ///< the number of that body
};

/// Unilateral contact all over the skin, solved with the body's tables of touch
/// (contact/skin_contact.h).
class TablesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  /// @param rest  gets the stress of the preload, which the tables may hold
  TablesLaw(const ReducedBody& body, const TouchTables& tables, const TouchSettings& settings,
            RestShape& rest);

  /// From now on `together` solves the contact of this body and of others, in which the body has
  /// this number; find_touches() reads what was solved.
  void join(PressingBodies& together, int number);
  /// The body as `together` needs it, without its pose. It points to parts of this law, which must
  /// not be moved afterwards.
  [[nodiscard]] PressingBodies::Body among_others(const ObjectSurface& seen);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);

  std::optional<Refiner> refiner;  ///< gives exact answers, which are taken up; none: tables alone
  [[nodiscard]] const TouchState& state() const { return state_; }
  [[nodiscard]] const TouchTables& tables() const { return *tables_; }

 private:
  const ReducedBody* body_;
  const TouchTables* tables_;
  SkinContact contact_;
  TouchState state_;
  // Answered together with others and not at rest, though nothing may touch it in this frame.
  bool is_moved_ = false;
  std::optional<StatedError> stated_;
  PressingBodies* together_ = nullptr;
  int number_ = -1;
};

/// Unilateral contact all over the skin of a body whose energy is known in modes. ModalBodies
/// solves it for all such bodies of a session at once; this law reads what was solved.
class ModesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  explicit ModesLaw(const ModalTables& tables) : tables_(&tables) {}
  /// @param member  the body's place among those of `together`
  void join(ModalBodies& together, int member);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] const ModalTables& tables() const { return *tables_; }

 private:
  const ModalTables* tables_;
  ModalBodies* together_ = nullptr;
  int member_ = -1;
};

/// One press at a time, at the nearest of the sites that the body was baked for; its level follows
/// from the measured depth of the press (contact/press_law.h).
class SitesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kSite;
  SitesLaw(const ReducedBody& body, const PressSettings& settings)
      : body_(&body), law_(body, settings) {}

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);

 private:
  const ReducedBody* body_;
  PressLaw law_;
  PressState state_;
};

/// Algorithm 1 of the paper as printed (contact/paper_contact.h). Where no real thing is near, the
/// skin of another body presses, and is not pressed back (paper Sec. 5.1).
class PaperLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kPaper;
  PaperLaw(const ReducedBody& body, const Eigen::AlignedBox3d& region,
           const PaperSettings& settings);

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);

 private:
  const ReducedBody* body_;
  PaperSettings settings_;
  PaperState state_;
  PaperNodes nodes_;
  CloudDistance seen_;
};

using BodyLaw = std::variant<TablesLaw, ModesLaw, SitesLaw, PaperLaw>;

}  // namespace palpable
