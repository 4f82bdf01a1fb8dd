#include "palpable/live/session/body_answer.h"

#include "palpable/common/reduced/pressed_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace palpable {

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

BodyAnswer::BodyAnswer(TouchableBody body, const AnswerSettings& settings)
    : body_(std::move(body.body)),
      tables_(std::move(body.touch)),
      modal_(std::move(body.modal)),
      contact_(settings.contact),
      paper_settings_(settings.paper),
      rest_(body_.surface.vertices.cast<float>()),
      rest_normals_(3, rest_.cols()),
      at_rest_(static_cast<std::size_t>(rest_.cols()), 0.0f),
      cauchy_at_rest_(6 * at_rest_.size(), 0.0f),
      region_(box_of(body_.surface)),
      surface_(settings.surface) {
  vertex_normals(rest_, body_.surface.triangles, rest_normals_);
  if (contact_ == ContactKind::kAnywhere && !tables_ && !modal_) contact_ = ContactKind::kSite;
  if (contact_ == ContactKind::kAnywhere && tables_) {
    anywhere_.emplace(body_.surface, body_.fixed, *tables_, settings.touch);
    anywhere_->stress(touched_, at_rest_, cauchy_at_rest_);
  } else if (contact_ == ContactKind::kSite) {
    law_.emplace(body_, settings.press);
  } else if (contact_ == ContactKind::kPaper) {
    nodes_.emplace(body_, paper_settings_.nodes);
    seen_.emplace(paper_settings_.distance, region_, paper_settings_.release_distance,
                  paper_settings_.voxel);
  }
}

TouchableBody BodyAnswer::take_body() {
  return TouchableBody(std::move(body_), std::move(tables_), std::move(modal_));
}

ContactKind BodyAnswer::contact() const { return contact_; }

const ModalTables* BodyAnswer::modal() const {
  return contact_ == ContactKind::kAnywhere && !tables_ ? &*modal_ : nullptr;
}

PixelBox BodyAnswer::box_of_interest(const Rigid3& camera_from_body,
                                     const PinholeCamera& camera) const {
  return surface_.box_of_interest(region_, camera_from_body, camera);
}

void BodyAnswer::look(const SeenFrame& seen, const MaskImage& shows,
                      const Rigid3& camera_from_body) {
  surface_.build(seen.depth, shows, seen.depth_camera, camera_from_body.inverse(), region_,
                 seen.time);
}

void BodyAnswer::find_touches(double time, std::span<const Eigen::Vector3f> others, int by,
                              std::vector<Touch>& touches) {
  touches.clear();
  stated_.reset();
  is_moved_ = false;
  if (anywhere_) {
    if (refiner_) refiner_->begin_frame(anywhere_->solver(), touched_);
    const TouchReport report = anywhere_->advance(touched_, surface_, touches);
    if (refiner_) refiner_->end_frame(anywhere_->solver(), touched_, report);
    stated_ = report.stated;
    return;
  }
  if (law_) {
    press_ = law_->advance(press_, surface_, time);
    if (press_.touch) touches.push_back(*press_.touch);
    return;
  }
  nodes_->deform(paper_, body_);
  const int last = static_cast<int>(body_.levels().size()) - 1;
  seen_->reserve(surface_.cloud_room());
  seen_->build(surface_.cloud());
  std::optional<NearestNode> nearest = nearest_node(*nodes_, *seen_);
  const bool is_real = nearest && nearest->distance < paper_settings_.release_distance;
  if (!is_real && !others.empty()) {
    seen_->build(others);
    nearest = nearest_node(*nodes_, *seen_);
  }
  paper_ = advance_as_printed(paper_, nearest, last, paper_settings_);
  if (auto touch = touch_of(paper_, body_)) {
    if (!is_real && !others.empty()) touch->by = by;
    touches.push_back(*touch);
  }
}

void BodyAnswer::find_touches(PressingBodies& together, int number, std::vector<Touch>& touches) {
  together.find_touches(number, touches);
  is_moved_ = !together.is_at_rest(number);
  stated_.reset();
  if (is_moved_) stated_ = together.report_of(number).stated;
}

PressingBodies::Body BodyAnswer::among_others(const Rigid3& world_from_body) {
  PressingBodies::Body body{&body_.surface, world_from_body};
  if (!anywhere_) return body;
  body.tables = &*tables_;
  body.contact = &*anywhere_;
  body.state = &touched_;
  body.seen = &surface_;
  return body;
}

void BodyAnswer::reconstruct(const std::vector<Touch>& touches, const SceneExtras& extras,
                             SceneBody& shown) {
  shown.stated_error = stated_;
  shown.cauchy.resize(extras.components ? cauchy_at_rest_.size() : 0);
  shown.contact_pressure.clear();
  if (touches.empty() && !is_moved_) {
    shown.vertices = rest_;
    shown.normals = rest_normals_;
    shown.von_mises = at_rest_;
    if (extras.components) shown.cauchy = cauchy_at_rest_;
    if (extras.contact_pressure && anywhere_) shown.contact_pressure.resize(at_rest_.size(), 0.0f);
    return;
  }
  shown.vertices.resize(3, rest_.cols());
  shown.normals.resize(3, rest_.cols());
  shown.von_mises.resize(static_cast<std::size_t>(rest_.cols()));
  if (anywhere_) {
    anywhere_->place(touched_, shown.vertices);
    vertex_normals(shown.vertices, body_.surface.triangles, shown.normals);
    anywhere_->stress(touched_, shown.von_mises, shown.cauchy);
    if (extras.contact_pressure) {
      anywhere_->find_pressure(shown.vertices, shown.normals, shown.contact_pressure);
    }
  } else {
    const Touch& touch = touches.front();
    const std::array mu{static_cast<double>(touch.site), touch.level};
    press_surface(body_, rest_, mu, shown.vertices, shown.normals, shown.von_mises, shown.cauchy);
  }
}

}  // namespace palpable
