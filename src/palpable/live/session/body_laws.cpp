#include "palpable/live/session/body_laws.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/reduced/pressed_surface.h"

#include <array>

namespace palpable {
namespace {

// The shape of a body that takes one press at a time, from its separated displacement.
void show_press(const ReducedBody& body, const RestShape& rest, const std::vector<Touch>& touches,
                const SceneExtras& extras, SceneBody& shown) {
  shown.stated_error.reset();
  if (touches.empty()) {
    rest.show(extras, shown);
    return;
  }
  rest.make_room(extras, shown);
  const Touch& touch = touches.front();
  const std::array mu{static_cast<double>(touch.site), touch.level};
  press_surface(body, rest.vertices, mu, shown.vertices, shown.normals, shown.von_mises,
                shown.cauchy);
}

}  // namespace

std::string_view name_of(ContactKind kind) {
  switch (kind) {
    case ContactKind::kAnywhere:
      return "anywhere";
    case ContactKind::kSite:
      return "site";
    case ContactKind::kPaper:
      break;
  }
  return "paper";
}

TablesLaw::TablesLaw(const ReducedBody& body, const TouchTables& tables,
                     const TouchSettings& settings, RestShape& rest)
    : body_(&body), tables_(&tables), contact_(body.surface, body.fixed, tables, settings) {
  contact_.stress(state_, rest.von_mises, rest.cauchy);
}

void TablesLaw::join(const ContactSolver& together, int number) {
  together_ = &together;
  number_ = number;
  contact_.solver().body().use(state_);
}

void TablesLaw::find_touches(const Pressing& pressing, std::vector<Touch>& touches) {
  stated_.reset();
  if (together_ != nullptr) {
    touches.clear();
    is_moved_ = !together_->is_at_rest(number_);
    if (!is_moved_) return;
    contact_.find_touches(state_, &pressing.seen, together_->pressed_by_others(number_), touches);
    stated_ = report_of(contact_.solver().body(), *together_, number_).stated;
    return;
  }
  touches.clear();
  is_moved_ = false;
  if (refiner) refiner->begin_frame(contact_.solver(), state_);
  const TouchReport report = contact_.advance(state_, pressing.seen, touches, pressing.at.passed);
  if (refiner) refiner->end_frame(contact_.solver(), state_, report);
  report_ = report;
  stated_ = report.stated;
  is_moved_ = state_.vibration.moves;
}

void TablesLaw::reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                            const SceneExtras& extras, SceneBody& shown) {
  shown.stated_error = stated_;
  if (touches.empty() && !is_moved_) {
    rest.show(extras, shown);
    if (extras.contact_pressure) shown.contact_pressure.resize(rest.von_mises.size(), 0.0f);
    return;
  }
  rest.make_room(extras, shown);
  contact_.place(state_, shown.vertices);
  vertex_normals(shown.vertices, body_->surface.triangles, shown.normals);
  contact_.stress(state_, shown.von_mises, shown.cauchy);
  if (extras.contact_pressure) {
    contact_.find_pressure(shown.vertices, shown.normals, shown.contact_pressure);
  }
}

ModesLaw::ModesLaw(const ReducedBody& body, const ModalTables& tables, const ModalBody* twin,
                   RestShape& rest)
    : contact_body_(ModalMember{&body, &tables}, twin),
      patches_(4 * std::size_t{kMostPlacesWithOthers}),
      pressure_(body.surface) {
  contact_body_.find_normals(state_, rest.normals);
  contact_body_.stress(state_, rest.von_mises, rest.cauchy);
}

void ModesLaw::join(const ContactSolver& together, int number) {
  together_ = &together;
  number_ = number;
  contact_body_.use(state_);
}

void ModesLaw::find_touches(const Pressing& pressing, std::vector<Touch>& touches) {
  PALPABLE_EXPECT(together_ != nullptr, "a body in modes has joined a solver");
  std::vector<PressedPoint>& points = patches_.points();
  points.clear();
  const SurfaceMesh& rest = contact_body_.member().body->surface;
  const Eigen::Matrix3Xf& skin = contact_body_.place(state_);
  for (const PointForce& force : state_.forces) {
    const SkinPoint& at = contact_body_.points()[static_cast<std::size_t>(force.point)];
    const Eigen::Vector3f now = at.at(skin);
    Eigen::Vector3f before = Eigen::Vector3f::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      before += at.weights[static_cast<int>(c)] * rest.vertices.col(at.corners[c]).cast<float>();
    }
    points.push_back({now, now - before, force.force, at.area, force.by, force.friction});
  }
  for (const PressedPoint& point : together_->pressed_by_others(number_)) points.push_back(point);
  patches_.find(&pressing.seen, touches);
}

void ModesLaw::reconstruct(const RestShape& rest, const std::vector<Touch>&,
                           const SceneExtras& extras, SceneBody& shown) {
  shown.stated_error.reset();
  if (state_.q.isZero(0)) {  // at rest: only a copy
    rest.show(extras, shown);
    if (extras.contact_pressure) shown.contact_pressure.resize(rest.von_mises.size(), 0.0f);
    return;
  }
  rest.make_room(extras, shown);
  shown.vertices = contact_body_.place(state_);
  contact_body_.find_normals(state_, shown.normals);
  contact_body_.stress(state_, shown.von_mises, shown.cauchy);
  if (extras.contact_pressure) {
    pressure_.spread(patches_, shown.vertices, shown.normals, shown.contact_pressure);
  }
}

void SitesLaw::find_touches(const Pressing& pressing, std::vector<Touch>& touches) {
  touches.clear();
  state_ = law_.advance(state_, pressing.seen, pressing.at.time);
  if (state_.touch) touches.push_back(*state_.touch);
}

void SitesLaw::reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                           const SceneExtras& extras, SceneBody& shown) {
  show_press(*body_, rest, touches, extras, shown);
}

PaperLaw::PaperLaw(const ReducedBody& body, const Eigen::AlignedBox3d& region,
                   const PaperSettings& settings)
    : body_(&body),
      settings_(settings),
      nodes_(body, settings.nodes),
      seen_(settings.distance, region, settings.release_distance, settings.voxel) {}

void PaperLaw::find_touches(const Pressing& pressing, std::vector<Touch>& touches) {
  touches.clear();
  nodes_.deform(state_, *body_);
  const int last = static_cast<int>(body_->levels().size()) - 1;
  seen_.reserve(pressing.seen.cloud_room());
  seen_.build(pressing.seen.cloud());
  std::optional<NearestNode> nearest = nearest_node(nodes_, seen_);
  const bool is_real = nearest && nearest->distance < settings_.release_distance;
  const bool by_other = !is_real && !pressing.others.empty();
  if (by_other) {
    seen_.build(pressing.others);
    nearest = nearest_node(nodes_, seen_);
  }
  state_ = advance_as_printed(state_, nearest, last, settings_);
  if (auto touch = touch_of(state_, *body_)) {
    if (by_other) touch->by = pressing.by;
    touches.push_back(*touch);
  }
}

void PaperLaw::reconstruct(const RestShape& rest, const std::vector<Touch>& touches,
                           const SceneExtras& extras, SceneBody& shown) {
  show_press(*body_, rest, touches, extras, shown);
}

}  // namespace palpable
