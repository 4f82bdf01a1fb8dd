/// @file
/// Contacts of bodies that are solved together: which contact points are near an obstacle or near
/// another body's skin, and the gaps there.
///
/// The gap of a point to an obstacle is queried anew in each iteration (obstacles.h). The gap to
/// another body's skin is that to a tangent plane, which is found once and moves with its foot x_b:
///
///     g = g_0 + n . (x_a - x_b - d_0)
///
/// with n the plane's normal, and g_0 and d_0 the gap and x_a - x_b when the plane was found. A
/// point that slides along the skin gets a new plane.
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/contact_problem.h"
#include "palpable/common/contact/near_points.h"
#include "palpable/common/contact/obstacles.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A body with the obstacles near it.
struct ContactPart {
  explicit ContactPart(ContactBody& the_body);

  ContactBody* body;
  const Obstacles* obstacles = nullptr;  ///< in the body's frame; null: none
  NearPoints near;
  /// (F) m, distance of each vertex from the nearest sharp edge at rest; 1 without one.
  std::vector<float> edge_distance;
  /// Vertices whose motion by inertia is followed since the last search (ContactFrame).
  std::vector<int> watched;
  std::size_t places = 0;                     ///< number of places of the next step
  std::vector<PlaceLoad> loads;               ///< of these
  std::vector<Eigen::Vector3f> place_forces;  ///< likewise, N
  double penetration = 0;                     ///< m, as ContactReport, of this body
  double share_gone = 1;                      ///< of its displacement; < 1: step limit
};

/// Contact points of one body before the skin of another.
struct SkinPair {
  int points = 0, skin = 0;  ///< indices of the two bodies
  Eigen::Isometry3f skin_from_points = Eigen::Isometry3f::Identity();
  float overlap = 0;  ///< m, added to gaps: the overlap of the shapes at rest
};

/// Its memory is used again in each frame.
class ContactSearch {
 public:
  /// Ratio to ContactLimits::largest_step: a point with a larger gap and no force is left out of an
  /// iteration. If the iteration moves it into an obstacle, the next one includes it.
  static constexpr double kTakesPart = 0.4;

  /// @param parts  outlive this
  /// @param most   contacts at a time, at most
  ContactSearch(std::span<ContactPart> parts, int most);

  /// Begins a frame. @param members, pairs  as ContactFrame::solve()  @param limits  of all members
  void begin(std::span<const int> members, std::span<const SkinPair> pairs,
             const ContactLimits& limits);

  [[nodiscard]] std::vector<Contact>& contacts() { return contacts_; }
  [[nodiscard]] const std::vector<Contact>& contacts() const { return contacts_; }
  /// The pair of a contact between bodies.
  [[nodiscard]] const SkinPair& pair_of(const Contact& contact) const;

  // A shift is how far obstacles are moved back in the present step, m.

  /// The contacts become those in the present shapes.
  void find(double shift);
  /// Remembers the contacts, those of the shapes with which the frame began.
  void remember() { found_ = contacts_; }
  /// The obstacles of the parts are others now.
  void change_obstacles();
  /// The contacts become those remembered that are near the obstacles at their present step.
  void choose_remembered(double shift);
  /// Adds the points that entered an obstacle by the shapes just formed. False: there are none.
  bool add_entered(double shift);
  /// Finds the contacts between bodies again in the shapes just formed. False: their gaps are those
  /// of the last iteration, and the contacts are unchanged.
  bool find_feet_again();
  /// Gives contacts places on their bodies as long as there is room, the deepest first, and drops
  /// the others. Returns how many were dropped.
  int keep_nearest();

  /// Gaps at the present positions of the contacts' places.
  void find_gaps(double shift);

 private:
  [[nodiscard]] ContactPart& part(int k) const { return parts_[static_cast<std::size_t>(k)]; }
  void add_contact(int body, int point, const SurfaceGap& gap);
  void add_anchored(int body, double shift);
  void mark_contacts(int body, std::size_t count, char value);
  void note_anchored();
  void find_between(const SkinPair& pair);
  void take_plane(Contact& contact, const NearestOnSkin& found, const Eigen::Vector3f& from_foot,
                  const SkinPair& pair);
  void thin(int body);
  bool add_places(const Contact& contact);
  void find_gaps_of(int body, double shift);
  void find_gap_between(Contact& contact);

  std::span<ContactPart> parts_;
  std::size_t most_;
  std::span<const int> members_;
  std::span<const SkinPair> pairs_;
  ContactLimits limits_;

  std::vector<Contact> contacts_;
  std::vector<Contact> found_;               // by remember()
  std::vector<Contact> feet_before_;         // contacts between bodies of the round before
  std::vector<char> is_contact_;             // by point, of one body
  std::vector<int> queried_points_;          // of one body: points whose gaps are queried,
  std::vector<std::size_t> of_queried_;      // their contacts,
  std::vector<Eigen::Vector3f> queried_at_;  // positions
  std::vector<SurfaceGap> gaps_;             // and gaps
};

}  // namespace palpable
