/// @file
/// The contact laws of a session. A law decides which forces act on a body that something presses,
/// and what shape the body then has. Each body has one of four laws (BodyLaw), and each law has two
/// functions, which the session calls once a frame, one after the other:
///
///     find_touches()   computes forces and state of the body from the surface that presses it
///     reconstruct()    computes shape, normals, stress and stated error from that state
#pragma once

#include "palpable/common/contact/cloud_distance.h"
#include "palpable/common/contact/contact_pressure.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/paper_contact.h"
#include "palpable/common/contact/press_law.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_patches.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/modal_body.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_state.h"
#include "palpable/common/response/touch_tables.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/rest_shape.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <limits>
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

/// When a frame was taken.
struct FrameTime {
  double time = 0;                    ///< s
  std::optional<double> passed = {};  ///< s since the frame before; none: without inertia
};

/// What presses a body in one frame: the input of find_touches().
struct Pressing {
  const ObjectSurface& seen;  ///< the surface of real things, body frame
  FrameTime at;
  /// m, body frame: points of another body's skin. PaperLaw alone reads them.
  std::span<const Eigen::Vector3f> others;
  int by = -1;  ///< the number of that body
};

/// Unilateral contact all over the skin, solved with the body's tables of touch
/// (response/skin_contact.h).
class TablesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  /// @param rest  gets the stress of the preload, which the tables may hold
  TablesLaw(const ReducedBody& body, const TouchTables& tables, const TouchSettings& settings,
            RestShape& rest);

  /// The body, for a solver of several bodies.
  [[nodiscard]] ContactBody& contact_body() { return contact_.solver().body(); }
  /// From now on `together` solves the contact of this body, its number `number`; find_touches()
  /// reads what was solved. The law must not be moved afterwards.
  void join(const ContactSolver& together, int number);
  /// m, the step limit of a vertex in a frame.
  [[nodiscard]] double largest_move(const PressingSurface& seen) const {
    return SkinContact::largest_move(seen);
  }

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);

  /// How the contact of the frame went, where no other solver was joined.
  [[nodiscard]] const ContactReport& report() const { return report_; }

  std::optional<Refiner> refiner;  ///< gives full-order solutions; none: the tables alone
  [[nodiscard]] const TouchState& state() const { return state_; }
  [[nodiscard]] const TouchTables& tables() const { return *tables_; }

 private:
  const ReducedBody* body_;
  const TouchTables* tables_;
  SkinContact contact_;
  TouchState state_;
  // The body was solved with others and is not at rest, or rings, even if nothing touches it.
  bool is_moved_ = false;
  ContactReport report_;
  std::optional<StatedError> stated_;
  const ContactSolver* together_ = nullptr;
  int number_ = -1;
};

/// Unilateral contact all over the skin of a body whose energy is known in modes
/// (response/modal_body.h). A solver that it joins solves it; this law reads what was solved.
class ModesLaw {
 public:
  static constexpr ContactKind kKind = ContactKind::kAnywhere;
  /// @param twin  a body with the same numbers (are_twins()), or none
  /// @param rest  gets the stress at rest
  ModesLaw(const ReducedBody& body, const ModalTables& tables, const ModalBody* twin,
           RestShape& rest);

  // As those of TablesLaw.
  [[nodiscard]] ContactBody& contact_body() { return contact_body_; }
  void join(const ContactSolver& together, int number);
  [[nodiscard]] double largest_move(const PressingSurface&) const {
    return std::numeric_limits<double>::infinity();
  }

  void find_touches(const Pressing& pressing, std::vector<Touch>& touches);
  void reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                   const SceneExtras& extras, SceneBody& shown);
  [[nodiscard]] const ModalTables& tables() const { return *contact_body_.member().tables; }
  [[nodiscard]] const ModalBody& modal_body() const { return contact_body_; }

 private:
  ModalBody contact_body_;
  ModalState state_;
  TouchPatches patches_;  // of the frame solved last
  ContactPressure pressure_;
  const ContactSolver* together_ = nullptr;
  int number_ = -1;
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

/// Algorithm 1 of the paper as printed (contact/paper_contact.h). Where no real obstacle is near,
/// the skin of another body presses this one without being pressed back (paper Sec. 5.1).
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
