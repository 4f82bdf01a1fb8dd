#include "bench/live/surface_budget.h"

#include "palpable/common/base/order_statistics.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/desk/score/deformation_scores.h"

#include "bench/live/depth_errors.h"
#include "bench/live/true_hand.h"
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace palpable::app {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDeep = 0.004;       // m: frames with a press at least this deep are compared
constexpr double kTouchSeen = 0.5;    // share of the touch that the camera must see
constexpr double kNear = 0.03;        // m: outlines are exact while a thing is nearer to the body
constexpr double kAroundEnd = 0.010;  // m from the middle of an end's ball, beyond its radius

// A body that a surface presses, frame after frame.
struct PressedSkin {
  PressedSkin(const Session& session, const ObjectSurfaceSettings& settings)
      : surface(settings),
        contact(session.body().model().surface, session.body().model().fixed,
                *session.body().response.tables(), session.settings().touch),
        skin(3, session.body().model().surface.vertex_count()) {}

  void press() {
    contact.advance(state, surface, touches);
    contact.place(state, skin);
  }

  ObjectSurface surface;
  SkinContact contact;
  TouchState state;
  Matrix3Xf skin;
  std::vector<Touch> touches;
};

struct Line {
  Line(const Session& session, Perfect of, const ObjectSurfaceSettings& settings)
      : perfect(of), body(session, settings) {}
  Perfect perfect;
  PressedSkin body;
  std::vector<double> displacement, force;
};

// The settings without the corrections of errors that are not there.
ObjectSurfaceSettings settings_for(Perfect perfect, ObjectSurfaceSettings settings) {
  if (perfect == Perfect::kBias || perfect == Perfect::kDepth || perfect == Perfect::kFront) {
    settings.balls.too_far = 0;
  }
  if (perfect == Perfect::kOutline || perfect == Perfect::kFront) {
    settings.balls.fattening = 0;
    settings.silhouette.beside_unknown = settings.silhouette.by_color = 0;
    settings.silhouette.by_edge = 0;
  }
  return settings;
}

}  // namespace

const std::vector<BudgetLine>& budget_lines() {
  static const std::vector<BudgetLine> kLines{
      {Perfect::kNothing, "measured", "as measured"},
      {Perfect::kNoise, "noise", "depth of single pixels"},
      {Perfect::kBias, "bias", "depth averaged over 15 px"},
      {Perfect::kDepth, "depth", "depth (both)"},
      {Perfect::kOutline, "outline", "outline"},
      {Perfect::kFront, "front", "depth and outline"},
      {Perfect::kEnds, "ends", "ends of things"},
      {Perfect::kOtherSide, "other_side", "shape, at the measured depth"},
      {Perfect::kPose, "pose", "pose of the camera"}};
  return kLines;
}

struct SurfaceBudget::Parts {
  explicit Parts(const Session& of)
      : session(of),
        region(box_of(of.body().model().surface)),
        rest(of.body().model().surface.vertices),
        areas(vertex_areas(of.body().model().surface)),
        truth(of, ObjectSurfaceSettings()) {
    const ObjectSurfaceSettings& measured = of.body().response.surface().settings();
    for (const BudgetLine& line : budget_lines()) {
      lines.push_back(
          std::make_unique<Line>(of, line.perfect, settings_for(line.perfect, measured)));
    }
  }

  // Errors of the depth in this frame, m: of each pixel, and their averages.
  DepthImage errors, means;
  Image<float> coverage;  // the true one
  float usual = 0;        // m, median error

  const Session& session;
  Eigen::AlignedBox3d region;
  Eigen::Matrix3Xd rest;
  Eigen::VectorXd areas;
  PressedSkin truth;
  std::vector<std::unique_ptr<Line>> lines;
  int frames = 0;

  [[nodiscard]] bool is_around_end(const HandLine& hand, const PinholeCamera& camera, int x,
                                   int y) const;
  void look(Line& line, const Scene& scene, const HandLine& hand, const TrueView& view,
            const Rigid3& body_from_camera, const Rigid3& true_body_from_camera);
};

// Whether a pixel's ray passes an end of a thing nearby.
bool SurfaceBudget::Parts::is_around_end(const HandLine& hand, const PinholeCamera& camera, int x,
                                         int y) const {
  const Vector3d ray =
      Vector3d((x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px, 1)
          .normalized();
  for (const Capsule& capsule : hand.capsules) {
    for (const auto& [end, radius] :
         {std::pair{capsule.a, capsule.ra}, std::pair{capsule.b, capsule.rb}}) {
      if ((end - end.dot(ray) * ray).norm() < radius + kAroundEnd) return true;
    }
  }
  return false;
}

void SurfaceBudget::Parts::look(Line& line, const Scene& scene, const HandLine& hand,
                                const TrueView& view, const Rigid3& body_from_camera,
                                const Rigid3& true_body_from_camera) {
  const PinholeCamera& camera = scene.seen.depth_camera;
  ObjectSurface& surface = line.body.surface;
  if (line.perfect == Perfect::kOtherSide) {
    const double too_far = session.body().response.surface().settings().balls.too_far;
    std::vector<ObjectBall> balls;
    const auto width = static_cast<int>(means.width()), height = static_cast<int>(means.height());
    for (Capsule capsule : hand.capsules) {
      const auto moved = [&](const Vector3d& end, double radius) -> Vector3d {
        const Vector3d front = end - radius * end.normalized();
        const int x =
            static_cast<int>(std::lround(camera.cx_px + camera.fx_px * front.x() / front.z()));
        const int y =
            static_cast<int>(std::lround(camera.cy_px + camera.fy_px * front.y() / front.z()));
        const bool inside = x >= 0 && y >= 0 && x < width && y < height;
        const float mean = inside ? means(x, y) : kNoError;
        const double error =
            static_cast<double>(std::isnan(mean) ? usual : mean) - too_far * end.z() * end.z();
        return end * (1 + error / end.z());
      };
      capsule.a = moved(capsule.a, capsule.ra);
      capsule.b = moved(capsule.b, capsule.rb);
      add_balls(capsule, body_from_camera, balls);
    }
    surface.build(balls, region, body_from_camera.translation().cast<float>());
    return;
  }
  DepthImage depth = scene.seen.depth;
  MaskImage shows = session.shows();
  Image<float> share(depth.width(), depth.height());
  for (std::size_t i = 0; i < share.size(); ++i) {
    share.data()[i] = session.coverage() != nullptr      ? session.coverage()->data()[i]
                      : shows.data()[i] == kShowsPresser ? 1.0f
                                                         : 0.0f;
  }
  // Around ends the depth gets the error that the surface corrects everywhere.
  const auto too_far =
      static_cast<float>(line.perfect == Perfect::kEnds ? surface.settings().balls.too_far : 0);
  const auto replace = [&](std::size_t i, bool outline, bool exact) {
    const bool is_thing = view.shows.data()[i] == kShowsPresser;
    const float true_depth = view.depth.data()[i];
    if (outline) {
      if (!is_thing && shows.data()[i] == kShowsPresser) depth.data()[i] = true_depth;
      shows.data()[i] = is_thing ? kShowsPresser : kShowsRoomByEdge;
      share.data()[i] = coverage.data()[i];
    }
    if (!is_thing || shows.data()[i] != kShowsPresser) return;
    const bool is_same = std::abs(depth.data()[i] - true_depth) < kSameThing;
    if (exact)
      depth.data()[i] = true_depth + too_far * true_depth * true_depth;
    else if (!is_same)
      depth.data()[i] = true_depth + usual;  // the mask has added this pixel
  };
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(depth.width()) +
                            static_cast<std::size_t>(x);
      const float mean = means.data()[i];
      switch (line.perfect) {
        case Perfect::kNoise:
          if (!std::isnan(mean)) depth.data()[i] = view.depth.data()[i] + mean;
          break;
        case Perfect::kBias:
          if (!std::isnan(mean)) depth.data()[i] -= mean;
          break;
        case Perfect::kDepth:
          replace(i, false, true);
          break;
        case Perfect::kOutline:
          replace(i, true, false);
          break;
        case Perfect::kFront:
          replace(i, true, true);
          break;
        case Perfect::kEnds:
          if ((view.shows.data()[i] == kShowsPresser || shows.data()[i] == kShowsPresser) &&
              is_around_end(hand, camera, x, y)) {
            replace(i, true, true);
          }
          break;
        default:
          break;
      }
    }
  }
  surface.build(depth, shows, camera,
                line.perfect == Perfect::kPose ? true_body_from_camera : body_from_camera, region,
                scene.time, &share);
}

SurfaceBudget::SurfaceBudget(const Session& session) : parts_(std::make_unique<Parts>(session)) {}
SurfaceBudget::~SurfaceBudget() = default;

void SurfaceBudget::add(const Scene& scene, const HandLine& hand, const ContactLine& contact,
                        const TrueView& truth, const Rigid3& true_body_from_camera) {
  Parts& p = *parts_;
  const Rigid3 body_from_camera = scene.bodies.front().camera_from_body.inverse();
  p.truth.surface.build(balls_of(hand.capsules, true_body_from_camera), p.region,
                        true_body_from_camera.translation().cast<float>());
  p.truth.press();
  p.errors = errors_of(scene.seen.depth, p.session.shows(), truth);
  p.means = averaged(p.errors);
  p.usual = median_error(p.errors);
  const bool is_near = contact.touching || (contact.gap && *contact.gap < kNear);
  p.coverage = covered(truth.shows, is_near ? std::span(hand.capsules) : std::span<const Capsule>(),
                       scene.seen.depth_camera);
  const bool compared =
      contact.touching && contact.depth >= kDeep && contact.seen_share.value_or(1) >= kTouchSeen;
  p.frames += compared;
  const Eigen::Matrix3Xd true_u = p.truth.skin.cast<double>() - p.rest;
  const double true_force = force_size(p.truth.state);
  for (const auto& line : p.lines) {
    p.look(*line, scene, hand, truth, body_from_camera, true_body_from_camera);
    line->body.press();
    if (!compared || !(true_force > 0)) continue;
    const Eigen::Matrix3Xd u = line->body.skin.cast<double>() - p.rest;
    line->displacement.push_back(displacement_error(true_u, u, p.areas).relative);
    line->force.push_back(std::abs(force_size(line->body.state) - true_force) / true_force);
  }
}

Json SurfaceBudget::json() const {
  Json json;
  json["frames"] = parts_->frames;
  const auto of = [](const std::vector<double>& errors, double share) {
    return errors.empty() ? Json(nullptr) : Json(percentile(errors, share));
  };
  for (std::size_t k = 0; k < parts_->lines.size(); ++k) {
    const Line& line = *parts_->lines[k];
    json[std::string(budget_lines()[k].key)] = {{"displacement_median", of(line.displacement, 0.5)},
                                                {"displacement_p90", of(line.displacement, 0.9)},
                                                {"force_median", of(line.force, 0.5)},
                                                {"force_p90", of(line.force, 0.9)}};
  }
  return json;
}

}  // namespace palpable::app
