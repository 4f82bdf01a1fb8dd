#include "palpable/desk/film/mover_meshes.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/capsule_mesh.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/film/painted_shapes.h"
#include "palpable/desk/film/texture_images.h"
#include "palpable/desk/script/things.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace palpable {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kChordError = 0.00009;  // m, of the triangles of movers
constexpr double kShadeReach = 0.014;  // m, distance within which the hand blocks the room's light

/// The cup as one mesh: outside, rounded rim, inside and bottom, in its own frame.
PaintedMesh cup_mesh() {
  PaintedMesh mesh;
  mesh.gloss = 0.45F;
  mesh.sharpness = 50.0F;
  const double R = kCupRadius;
  const double h = kCupHeight;
  const double r = kCupWallRadius;
  const Vector3d base = Vector3d::Zero();
  std::vector<Vector2d> rim;  // half a circle over the wall
  for (int i = 0; i <= 8; ++i) {
    const double t = std::numbers::pi * i / 8.0;
    rim.emplace_back(R - r + r * std::cos(t), h - r + r * std::sin(t));
  }
  std::vector<Vector2d> foot;
  for (int i = 0; i <= 4; ++i) {
    const double t = 0.5 * std::numbers::pi * (i / 4.0 - 1.0);
    foot.emplace_back(R - r + r * std::cos(t), r + r * std::sin(t));
  }
  add_turned(mesh, base, {{0.0001, 0.0}, foot.front()}, 0.99, 0.98);
  add_turned(mesh, base, foot, 0.98, 0.96);
  add_turned(mesh, base, {foot.back(), {R, 0.03}, {R, 0.06}, rim.front()}, 0.96, 0.06);
  add_turned(mesh, base, rim, 0.06, 0.02);
  add_turned(mesh, base, {rim.back(), {R - 2 * r, 0.006}}, 0.02, 0.14);
  add_turned(mesh, base, {{R - 2 * r, 0.006}, {0.0001, 0.006}}, 0.14, 0.16);
  return mesh;
}

void move(PaintedMesh& mesh, const Rigid3& transform) {
  const Eigen::Isometry3f T = transform.cast<float>();
  for (PaintedVertex& v : mesh.vertices) {
    v.position = T * v.position;
    v.normal = T.linear() * v.normal;
  }
}

enum MoverImage : int { kSkin, kCloth, kPaint, kRawWood, kLead, kCupGlaze, kMoverImages };

MoverImage image_of(HandPart part) {
  switch (part) {
    case HandPart::kSleeve:
      return kCloth;
    case HandPart::kPencil:
      return kPaint;
    case HandPart::kPencilWood:
      return kRawWood;
    case HandPart::kPencilLead:
      return kLead;
    case HandPart::kCup:
      return kCupGlaze;
    case HandPart::kPalm:
    case HandPart::kBone:
    case HandPart::kFingerTip:
    case HandPart::kForearm:
      break;
  }
  return kSkin;
}

bool is_held(const HandCapsule& c) { return image_of(c.part) >= kPaint; }
bool is_sleeve(const HandCapsule& c) { return c.part == HandPart::kSleeve; }

/// Empty meshes with their materials, one for each image.
std::vector<PaintedMesh> unfilled_meshes(const DeskLook& look) {
  std::vector<PaintedMesh> meshes(kMoverImages);
  for (int i = 0; i < kMoverImages; ++i) meshes[i].image = i;
  meshes[kSkin].gloss = static_cast<float>(look.skin_gloss);
  meshes[kSkin].sharpness = 18.0F;
  meshes[kPaint].gloss = 0.35F;
  meshes[kPaint].sharpness = 40.0F;
  return meshes;
}

/// The capsules that are drawn one by one: all except the staves of a cup that is drawn as one
/// mesh. Its handle is drawn as capsules.
std::vector<const HandCapsule*> drawn_one_by_one(std::span<const HandCapsule> capsules,
                                                 bool cup_is_one_piece) {
  std::vector<const HandCapsule*> drawn;
  int of_cup = 0;  // number of cup capsules so far
  for (const HandCapsule& c : capsules) {
    const bool stave = c.part == HandPart::kCup && cup_is_one_piece &&
                       of_cup++ % (kCupStaves + kCupHandleParts) < kCupStaves;
    if (!stave) drawn.push_back(&c);
  }
  return drawn;
}

/// The capsules of a hand near one of its capsules, without held things, and their distances to the
/// vertices of that capsule.
struct Neighbours {
  std::vector<const HandCapsule*> capsules;
  std::vector<CapsuleField> fields;
  Eigen::MatrixXd distances;  // (capsules x vertices) signed, m

  /// @param reach  m
  Neighbours(const Capsule& own, const CapsuleMesh& mesh, double reach,
             std::span<const HandCapsule> all) {
    const Vector3d middle = 0.5 * (own.a + own.b);
    const double within = 0.5 * (own.b - own.a).norm() + std::max(own.ra, own.rb) + reach;
    for (const HandCapsule& other : all)
      if (!is_held(other) && (other.shape.a != own.a || other.shape.b != own.b) &&
          signed_distance(other.shape, middle) < within) {
        capsules.push_back(&other);
        fields.emplace_back(other.shape);
      }
    distances.resize(static_cast<Eigen::Index>(fields.size()), mesh.vertices.cols());
    for (Eigen::Index v = 0; v < distances.cols(); ++v) {
      const Vector3d x = mesh.vertices.col(v);
      for (Eigen::Index k = 0; k < distances.rows(); ++k) distances(k, v) = fields[k].distance(x);
    }
  }

  /// Whether a triangle lies inside one of the capsules, deeper than the chord error of that
  /// capsule's own triangles. (Capsules are convex: a triangle lies inside when its corners do.)
  [[nodiscard]] bool hide(const Eigen::Vector3i& triangle) const {
    for (Eigen::Index k = 0; k < distances.rows(); ++k) {
      const double farthest_out = std::max(
          {distances(k, triangle[0]), distances(k, triangle[1]), distances(k, triangle[2])});
      if (farthest_out < -1.5 * kChordError) return true;
    }
    return false;
  }
};

/// Adds the indices of the triangles that are visible at one of the two instants.
/// @return for each vertex whether an added triangle uses it; the others need not be painted
std::vector<bool> add_seen_triangles(PaintedMesh& out, const CapsuleMesh& mesh,
                                     const Neighbours& now, const std::optional<Neighbours>& also) {
  const auto first = static_cast<std::uint32_t>(out.vertices.size());
  std::vector<bool> is_seen(mesh.vertices.cols(), false);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3i triangle = mesh.triangles.col(t);
    if (now.hide(triangle) && (!also || also->hide(triangle))) continue;
    for (const int corner : triangle) {
      is_seen[corner] = true;
      out.indices.push_back(first + static_cast<std::uint32_t>(corner));
    }
  }
  return is_seen;
}

/// Computes the painted vertices of one capsule.
class CapsulePaint {
 public:
  /// @param number  index of the capsule, so that each shows another part of the image
  CapsulePaint(const HandCapsule& own, const Neighbours& neighbours, std::uint32_t number)
      : own_(own), neighbours_(neighbours), number_(number) {
    const Capsule& c = own.shape;
    blend_ = own.part == HandPart::kPalm ? 0.0055 : 0.0026;
    tile_ = is_sleeve(own) || own.part == HandPart::kPencil ? 0.05 : 0.045;
    turns_ = own.part == HandPart::kPencil
                 ? 1.0
                 : std::max(1.0, std::round(kTurn * std::max(c.ra, c.rb) / tile_ * 2.0)) / 2.0;
    axis_ = (c.b - c.a).normalized();
    back_ = (own.back - own.back.dot(axis_) * axis_).normalized();
    side_ = axis_.cross(back_);
  }

  [[nodiscard]] PaintedVertex vertex(const CapsuleMesh& mesh, Eigen::Index v) const {
    const Vector3d x = mesh.vertices.col(v);
    const Vector3d n = mesh.normals.col(v);
    const auto [normal, open] = smoothed(x, n, v);
    PaintedVertex vertex;
    vertex.position = x.cast<float>();
    vertex.normal = normal.normalized().cast<float>();
    vertex.uv =
        Eigen::Vector2f(static_cast<float>(mesh.where(0, v) / tile_ + 0.37 * number_),
                        static_cast<float>(mesh.where(1, v) / kTurn * turns_ + 0.61 * number_));
    vertex.extra.x() = static_cast<float>(0.35 + 0.65 * std::clamp(open / kShadeReach, 0.0, 1.0));
    const Capsule& c = own_.shape;
    if (own_.part == HandPart::kFingerTip && n.dot(back_) > 0.0) {
      const Vector3d local = x - c.b;
      vertex.extra.z() = static_cast<float>((local.dot(axis_) + 0.10 * c.rb) / (0.86 * c.rb));
      vertex.extra.w() = static_cast<float>(local.dot(side_) / (0.74 * c.rb));
    }
    // Creases are rings round the back of the finger at its joints.
    if (own_.part == HandPart::kBone || own_.part == HandPart::kFingerTip) {
      const double from_joint = std::abs((x - c.a).dot(axis_)) / 0.0042;
      if (n.dot(back_) > -0.3)
        vertex.extra.y() = static_cast<float>(std::exp(-from_joint * from_joint));
    }
    return vertex;
  }

 private:
  struct Smoothed {
    Vector3d normal;  // not unit
    double open;      // m, distance of other parts of the hand above the surface, <= kShadeReach
  };
  /// The normal of the smooth union of the capsules at vertex v, and the distance of the other
  /// parts of the hand.
  [[nodiscard]] Smoothed smoothed(const Vector3d& x, const Vector3d& n, Eigen::Index v) const {
    Smoothed result{n, kShadeReach};
    if (is_held(own_)) return result;
    Vector3d& normal = result.normal;
    bool hidden = false;
    for (std::size_t k = 0; k < neighbours_.fields.size(); ++k) {
      const double d = neighbours_.distances(static_cast<Eigen::Index>(k), v);
      hidden = hidden || d < -2.0 * blend_;
      if (d > 2.5 * kShadeReach) continue;
      if (d < 4.0 * blend_ && is_sleeve(own_) == is_sleeve(*neighbours_.capsules[k]))
        normal += std::exp(-d / blend_) * neighbours_.fields[k].normal(x);
      // From x to the point evaluated next, the distance changes by at most kShadeReach.
      if (d - kShadeReach < result.open)
        result.open = std::min(
            result.open, neighbours_.fields[k].distance(x + kShadeReach * normal.normalized()));
    }
    if (hidden) normal = n;
    return result;
  }

  const HandCapsule& own_;
  const Neighbours& neighbours_;
  std::uint32_t number_;
  // m, width of the smooth union; small for fingers, whose joints stay visible, and larger for the
  // back of the hand, which becomes one surface.
  double blend_;
  double tile_;   // m, length of surface that the image covers
  double turns_;  // repetitions of the image round the capsule
  Vector3d axis_, back_, side_;
};

/// Adds one capsule to the mesh of its image.
/// @param then  the same capsule at the other instant, if there is one
/// @param also  all capsules at the other instant
void add_capsule(PaintedMesh& out, const HandCapsule& own, std::span<const HandCapsule> capsules,
                 const HandCapsule* then, std::span<const HandCapsule> also, std::uint32_t number) {
  const CapsuleMesh mesh = tessellate(own.shape, own.back, kChordError);
  const Neighbours now(own.shape, mesh, 2.0 * kShadeReach, capsules);
  std::optional<Neighbours> other;
  if (then != nullptr) {
    const CapsuleMesh moved = tessellate(then->shape, then->back, kChordError);
    PALPABLE_EXPECT(moved.triangles == mesh.triangles, "a moving capsule keeps its triangles");
    other.emplace(then->shape, moved, 0.0, also);
  }
  const std::vector<bool> is_seen = add_seen_triangles(out, mesh, now, other);
  const CapsulePaint paint(own, now, number);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    if (is_seen[v])
      out.vertices.push_back(paint.vertex(mesh, v));
    else
      out.vertices.push_back({mesh.vertices.col(v).cast<float>(), mesh.normals.col(v).cast<float>(),
                              Eigen::Vector2f::Zero()});
  }
}

}  // namespace

std::vector<ColorImage> mover_images(const DeskLook& look) {
  return {skin_image(512, look.skin_texture, look.seed),
          cloth_image(256, look.seed),
          pencil_image(256, look.seed),
          ColorImage(8, 8, Rgb{222, 184, 138}),
          ColorImage(8, 8, Rgb{58, 58, 62}),
          glaze_image(1024, look.seed + 1)};
}

std::vector<PaintedMesh> mover_meshes(std::span<const HandCapsule> capsules,
                                      const std::optional<Rigid3>& desk_from_cup,
                                      const DeskLook& look, std::span<const HandCapsule> also) {
  PALPABLE_EXPECT(also.empty() || also.size() == capsules.size(),
                  "both instants have the same capsules");
  std::vector<PaintedMesh> meshes = unfilled_meshes(look);
  if (desk_from_cup) {
    static const PaintedMesh kCup = cup_mesh();
    PaintedMesh cup = kCup;
    move(cup, *desk_from_cup);
    cup.image = kCupGlaze;
    meshes[kCupGlaze] = std::move(cup);
  }
  std::uint32_t number = 0;
  for (const HandCapsule* own : drawn_one_by_one(capsules, desk_from_cup.has_value())) {
    const HandCapsule* then = also.empty() ? nullptr : &also[own - capsules.data()];
    add_capsule(meshes[image_of(own->part)], *own, capsules, then, also, number++);
  }
  return meshes;
}

}  // namespace palpable
