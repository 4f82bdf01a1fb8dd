#include "palpable/live/view/scene_picture.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/view/painted_stress.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace palpable {

namespace {

constexpr double kSameGround = 0.003;      // m, difference in height below which grounds are one
constexpr double kNewWorldShown = 5;       // s for which the warning of a new world is shown
constexpr float kShownOfHeight = 0.1f;     // top of displacement's colours, ratio to the height
constexpr float kDotRadius = 0.0022f;      // m
constexpr double kShortestArrow = 0.012;   // m
constexpr double kArrowPerNewton = 0.006;  // m
constexpr std::size_t kMostArrows = 6;
constexpr double kLeastOfStrongest = 0.05;  // force for an arrow, ratio to the strongest touch's
constexpr double kLongestArrow = 0.06;      // m
constexpr Rgb kTouch{245, 130, 32};
constexpr Rgb kHeldTouch{150, 150, 155};  // the obstacle is not seen at present

// The largest stated errors of all bodies; nothing if no body states one.
std::optional<StatedError> worst_stated_error(const Scene& scene) {
  std::optional<StatedError> worst;
  for (const SceneBody& body : scene.bodies) {
    if (!body.stated_error) continue;
    if (!worst) worst.emplace();
    worst->displacement = std::max(worst->displacement, body.stated_error->displacement);
    worst->von_mises = std::max(worst->von_mises, body.stated_error->von_mises);
  }
  return worst;
}

// Whether holds(number) is true for one of a session's bodies.
template <class Holds>
bool for_any_body(const Session& session, const Holds& holds) {
  for (int k = 0; k < session.body_count(); ++k) {
    if (holds(k)) return true;
  }
  return false;
}

bool any_knows_stress(const Session& session) {
  return for_any_body(session, [&](int k) { return knows_stress(session, k); });
}

bool any_knows_contact(const Session& session) {
  return for_any_body(session, [&](int k) { return knows_contact(session, k); });
}

}  // namespace

bool stands_on_first_ground(const Rigid3& first_from_body) {
  return std::abs(first_from_body.translation().z()) < kSameGround &&
         first_from_body.linear()(2, 2) > 0.999;
}

BodyLook look_of_body(const Scene& scene, const Session& session, int number, double scale,
                      ColorScale colors) {
  const SceneBody& shown = scene.bodies[static_cast<std::size_t>(number)];
  BodyLook look;
  look.vertices = &shown.vertices;
  look.normals = &shown.normals;
  look.triangles = &session.body(number).model().surface.triangles;
  look.scalar = shown.von_mises;
  look.scalar_max = static_cast<float>(scale);
  look.colors = colors;
  look.camera_from_body = shown.camera_from_body;
  look.material = session.body(number).color.value_or(kRubber);
  const Rigid3 first_from_body =
      session.body().world_from_body.inverse() * session.body(number).world_from_body;
  if (!stands_on_first_ground(first_from_body)) look.shadow = 0;
  return look;
}

std::string caption_of(const Scene& scene) {
  std::string text = fmt::format("{:.2f} s", scene.time);
  double hidden = 0;
  for (const SceneBody& body : scene.bodies) hidden = std::max(hidden, body.hidden_since_start);
  constexpr double kWorthTelling = 0.05;
  if (hidden >= kWorthTelling) {
    text += fmt::format("   {:.0f} % hidden since the start, not felt there", 100 * hidden);
  }
  if (scene.answer == Reached::kLater) text += "   not the answer yet";
  if (scene.answer == Reached::kNot) text += "   not an answer";
  if (scene.touches.empty()) return text;
  text += "   " + caption_of(scene.touches);
  if (const std::optional<StatedError> error = worst_stated_error(scene)) {
    text += "   " + caption_of(*error);
  }
  return text;
}

std::string caption_of(const StatedError& error) {
  // Above 100 % the number has no meaning; the response is then not reliable.
  const auto percent = [](double share) {
    return share > 1 ? std::string("> 100 %") : fmt::format("\u00b1{:.2g} %", 100 * share);
  };
  return fmt::format("model error {}, stress {}", percent(error.displacement),
                     percent(error.von_mises));
}

std::string caption_of(std::span<const Touch> touches) {
  if (touches.empty()) return "not touched";
  double deepest = 0, force = 0;
  for (const Touch& touch : touches) {
    deepest = std::max(deepest, touch.press_depth);
    force += touch.force;
  }
  std::string text;
  if (touches.front().site >= 0) text = fmt::format("site {}   ", touches.front().site);
  if (touches.size() == 1) return text + fmt::format("{:.1f} mm   {:.2f} N", deepest * 1e3, force);
  return fmt::format("{} touches   deepest {:.1f} mm   {:.2f} N in all", touches.size(),
                     deepest * 1e3, force);
}

std::string warning_of(const Scene& scene) {
  if (scene.camera.state == TrackState::kLost) {
    if (scene.camera.newest_keyframe < 0)
      return "Camera not placed yet: show it a place with texture";
    return "Camera lost: show it what it has seen before";
  }
  if (scene.camera.since_new_world < kNewWorldShown) {
    return "New surroundings: where the body stood is not known here";
  }
  for (const Touch& touch : scene.touches) {
    if (touch.unseen_for > 0) return "What presses is not seen at present: its last place is held";
  }
  switch (scene.seen.trouble) {
    case DepthTrouble::kRowsOff:
      return fmt::format("The eyes' rows are {:.1f} px out of line: calibrate the camera again",
                         std::abs(scene.seen.row_error_px));
    case DepthTrouble::kFewDepths:
      return fmt::format(
          "Depth in {:.0f} % of the picture only: dark, plain, blurred or not aligned",
          100 * scene.seen.density);
    case DepthTrouble::kNone:
      break;
  }
  return {};
}

SceneView& SceneViews::of(const Scene& scene, const Session& session, const SceneShow& show) {
  using Field = SceneShow::Field;
  view_.background = &scene.seen.color;
  using Occlusion = SceneShow::Occlusion;
  view_.real_depth = show.occlusion == Occlusion::kNone ? nullptr : &scene.seen.depth;
  view_.hard_occlusion = show.occlusion == Occlusion::kHard;
  view_.moving = scene.moving.empty() ? nullptr : &scene.moving;
  view_.borrowed = scene.borrowed.empty() ? nullptr : &scene.borrowed;
  view_.too_close = scene.seen.too_close.empty() ? nullptr : &scene.seen.too_close;
  view_.camera = scene.seen.camera;
  view_.bodies.clear();
  const auto count = static_cast<std::size_t>(session.body_count());
  painted_.resize(count);
  dots_.resize(count);
  for (int k = 0; k < session.body_count(); ++k) {
    view_.bodies.push_back(look_of_body(scene, session, k, scale_, show.colors));
    view_.bodies.back().blended = show.blended;
    if (show.field == Field::kDisplacement) show_displacement(scene, session, k);
    if (needs_components(show.field)) show_components(scene, session, show, k);
    if (show.field == Field::kContact) {
      view_.bodies.back().scalar = scene.bodies[static_cast<std::size_t>(k)].contact_pressure;
      view_.bodies.back().scalar_max *= static_cast<float>(kContactOfStress);
    }
    if (show.field == Field::kNone) view_.bodies.back().scalar = {};
  }
  show_touches(scene, show);
  show_legend(scene, session, show);
  view_.caption.resize(1);
  view_.caption.front() = caption_of(scene);
  view_.warning = warning_of(scene);
  return view_;
}

void SceneViews::show_legend(const Scene& scene, const Session& session, const SceneShow& show) {
  using Field = SceneShow::Field;
  const std::optional<StatedError> error = worst_stated_error(scene);
  view_.legend_title.clear();
  view_.legend_unit = "kPa";
  view_.legend_scale = 1e-3;
  view_.stated_error = error ? error->von_mises : 0;
  view_.stated_error_of.clear();
  switch (show.field) {
    case Field::kVonMises:
      if (any_knows_stress(session)) view_.legend_title = "von Mises";
      break;
    case Field::kPressure:
    case Field::kComponent:
      name_painted_stress(show.field, show.component, view_.legend_title);
      if (!any_knows_stress(session)) view_.legend_title = kNoStressKnown;
      view_.stated_error_of = kErrorOfStress;
      break;
    case Field::kContact:
      view_.legend_title = any_knows_contact(session) ? kContactPressure : kNoContactKnown;
      view_.stated_error = 0;  // none is stated for contact pressure
      break;
    case Field::kDisplacement:
      view_.legend_title = "displacement";
      view_.legend_unit = "mm";
      view_.legend_scale = 1e3;
      view_.stated_error = error ? error->displacement : 0;
      break;
    case Field::kNone:
      break;
  }
  if (!show.legend) view_.legend_title.clear();
}

void displacement_of(const Eigen::Matrix3Xf& now, const SurfaceMesh& baked,
                     std::vector<float>& moved) {
  moved.resize(static_cast<std::size_t>(now.cols()));
  for (Eigen::Index i = 0; i < now.cols(); ++i) {
    moved[static_cast<std::size_t>(i)] = (now.col(i) - baked.vertices.col(i).cast<float>()).norm();
  }
}

float displacement_scale(const SurfaceMesh& baked) {
  const auto heights = baked.vertices.row(2);
  return kShownOfHeight *
         static_cast<float>(std::max(heights.maxCoeff() - heights.minCoeff(), 1e-3));
}

void SceneViews::show_displacement(const Scene& scene, const Session& session, int number) {
  const auto k = static_cast<std::size_t>(number);
  const SurfaceMesh& baked = session.body(number).model().surface;
  displacement_of(scene.bodies[k].vertices, baked, painted_[k]);
  view_.bodies[k].scalar = painted_[k];
  view_.bodies[k].scalar_max = displacement_scale(baked);
}

void SceneViews::show_components(const Scene& scene, const Session& session, const SceneShow& show,
                                 int number) {
  const auto k = static_cast<std::size_t>(number);
  const std::vector<float>& cauchy = scene.bodies[k].cauchy;
  PALPABLE_EXPECT(!cauchy.empty(), "the session keeps what is painted");
  painted_stress(show.field, show.component, cauchy, painted_[k]);
  view_.bodies[k].scalar = painted_[k];
  if (!knows_stress(session, number)) view_.bodies[k].scalar = {};
  view_.bodies[k].two_sided = true;
}

void SceneViews::show_touches(const Scene& scene, const SceneShow& show) {
  for (std::vector<Dot>& dots : dots_) dots.clear();
  view_.arrows.clear();
  for (const Touch& touch : scene.touches) {
    const auto k = static_cast<std::size_t>(touch.body);
    const Rgb color = touch.unseen_for > 0 ? kHeldTouch : kTouch;
    const Eigen::Vector3f point = touch.point_in_body.cast<float>();
    if (show.contacts) dots_[k].push_back({point, kDotRadius, color});
    // Touches are sorted by force; arrows for many weak ones would hide the body.
    if (!show.forces || view_.arrows.size() >= kMostArrows ||
        touch.force < kLeastOfStrongest * scene.touches.front().force) {
      continue;
    }
    const double length = std::min(kShortestArrow + kArrowPerNewton * touch.force, kLongestArrow);
    const Rigid3& camera_from_body = scene.bodies[k].camera_from_body;
    const Eigen::Vector3d tip = camera_from_body * touch.point_in_body;
    view_.arrows.push_back({tip - length * (camera_from_body.linear() * touch.direction), tip,
                            color, fmt::format("{:.2f} N", touch.force)});
  }
  for (std::size_t k = 0; k < dots_.size(); ++k) view_.bodies[k].dots = dots_[k];
}

}  // namespace palpable
