/// @file
/// Those bodies of a session whose energy is known in modes: they are answered together, so that
/// they press each other (contact/modal_contact.h).
#pragma once

#include "palpable/common/contact/contact_pressure.h"
#include "palpable/common/contact/modal_contact.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_patches.h"
#include "palpable/live/session/rest_shape.h"
#include "palpable/live/session/scene.h"

#include <vector>

namespace palpable {

class ModalBodies {
 public:
  /// One of them.
  struct Member {
    ModalMember body;
    const PressingSurface* seen = nullptr;  ///< of what presses it; read in each frame
    int number = 0;                         ///< of the session's bodies
  };
  /// @param members  what they point to outlives this
  explicit ModalBodies(const std::vector<Member>& members);

  /// One frame: the states in which nothing enters a body.
  void advance();

  /// Of a member, by its place in the list: its touches, the strongest first.
  void find_touches(int member, std::vector<Touch>& touches);
  /// Shape, normals and stress. @param extras  what is wanted, too; else it is emptied
  void reconstruct(int member, const SceneExtras& extras, SceneBody& shown);

  [[nodiscard]] const ModalReport& report() const { return report_; }  ///< of the last frame

 private:
  std::vector<Member> members_;
  ModalContact contact_;
  std::vector<ModalState> states_;
  std::vector<const Obstacles*> seen_;   // what presses each
  std::vector<Eigen::Matrix3Xf> skins_;  // where they are now, m
  std::vector<RestShape> rest_;
  std::vector<TouchPatches> patches_;  // of the frame answered last
  std::vector<ContactPressure> pressures_;
  ModalReport report_;
};

}  // namespace palpable
