#include "palpable/live/session/body_response.h"

#include "palpable/common/base/contract.h"

#include <cstddef>
#include <type_traits>
#include <utility>

namespace palpable {

BodyResponse::BodyResponse(TouchableBody body, const ResponseSettings& settings,
                           const BodyResponse* twin)
    : body_(std::move(body.body)),
      tables_(std::move(body.touch)),
      modal_(std::move(body.modal)),
      rest_(body_),
      region_(box_of(body_.surface)),
      surface_(settings.surface),
      law_(make_law(settings, twin)) {
  if (deforms()) coefficient_ = contact_body().friction();
  const bool has_inertia = settings.dynamics && tables() != nullptr && tables()->vibration;
  if (coefficient_ > 0 || has_inertia) friction_.emplace();
}

BodyLaw BodyResponse::make_law(const ResponseSettings& settings, const BodyResponse* twin) {
  if (settings.contact == ContactKind::kPaper) {
    return BodyLaw(std::in_place_type<PaperLaw>, body_, region_, settings.paper);
  }
  if (settings.contact == ContactKind::kAnywhere && tables_) {
    return BodyLaw(std::in_place_type<TablesLaw>, body_, *tables_, settings.touch, rest_);
  }
  if (settings.contact == ContactKind::kAnywhere && modal_) {
    const ModesLaw* other = twin != nullptr ? std::get_if<ModesLaw>(&twin->law_) : nullptr;
    const ModalBody* same = other != nullptr ? &other->modal_body() : nullptr;
    return BodyLaw(std::in_place_type<ModesLaw>, body_, *modal_, same, rest_);
  }
  return BodyLaw(std::in_place_type<SitesLaw>, body_, settings.press);
}

TouchableBody BodyResponse::take_body() {
  return TouchableBody(std::move(body_), std::move(tables_), std::move(modal_));
}

ContactKind BodyResponse::contact() const {
  return std::visit([](const auto& law) { return law.kKind; }, law_);
}

bool BodyResponse::reads_others() const { return std::holds_alternative<PaperLaw>(law_); }

const ModalTables* BodyResponse::modal() const {
  const auto* law = std::get_if<ModesLaw>(&law_);
  return law != nullptr ? &law->tables() : nullptr;
}

const TouchTables* BodyResponse::tables() const {
  const auto* law = std::get_if<TablesLaw>(&law_);
  return law != nullptr ? &law->tables() : nullptr;
}

PixelBox BodyResponse::box_of_interest(const Rigid3& camera_from_body,
                                       const PinholeCamera& camera) const {
  return surface_.box_of_interest(region_, camera_from_body, camera);
}

void BodyResponse::look(const SeenFrame& seen, const MaskImage& shows, const Image<float>* coverage,
                        const Rigid3& camera_from_body) {
  surface_.build(seen.depth, shows, seen.depth_camera, camera_from_body.inverse(), region_,
                 seen.time, coverage);
  if (!friction_) return;
  const Eigen::Vector3d camera = camera_from_body.inverse().translation();
  friction_->add(surface_, camera.cast<float>(), seen.time);
}

void BodyResponse::find_touches(const FrameTime& at, std::span<const Eigen::Vector3f> others,
                                int by, std::vector<Touch>& touches) {
  const Pressing pressing{surface_, at, others, by};
  std::visit([&](auto& law) { law.find_touches(pressing, touches); }, law_);
  for (Touch& touch : touches) state_friction(touch);
}

// States how a seen obstacle rubs where it presses.
void BodyResponse::state_friction(Touch& touch) const {
  if (!(coefficient_ > 0) || touch.by >= 0) return;
  const auto found = surface_.nearest(touch.point_in_body.cast<float>());
  if (!found) return;
  const ObjectBall& ball = surface_.balls()[static_cast<std::size_t>(found->ball)];
  touch.coefficient = static_cast<double>(ball.friction_share) * coefficient_;
  touch.way_is_mean = ball.friction_share > 0 && ball.way_is_mean;
}

void BodyResponse::reconstruct(const std::vector<Touch>& touches, const SceneExtras& extras,
                               SceneBody& shown) {
  std::visit([&](auto& law) { law.reconstruct(rest_, touches, extras, shown); }, law_);
}

namespace {

template <class Law>
constexpr bool kDeforms = std::is_same_v<Law, TablesLaw> || std::is_same_v<Law, ModesLaw>;

}  // namespace

bool BodyResponse::deforms() const {
  return std::visit([](const auto& law) { return kDeforms<std::decay_t<decltype(law)>>; }, law_);
}

ContactBody& BodyResponse::contact_body() {
  return std::visit(
      [this](auto& law) -> ContactBody& {
        if constexpr (kDeforms<std::decay_t<decltype(law)>>) {
          return law.contact_body();
        } else {
          if (!obstacle_) obstacle_.emplace(body_.surface);
          return *obstacle_;
        }
      },
      law_);
}

ContactSolver::Near BodyResponse::near() const {
  return std::visit(
      [this](const auto& law) -> ContactSolver::Near {
        if constexpr (kDeforms<std::decay_t<decltype(law)>>) {
          return {&surface_, law.largest_move(surface_)};
        } else {
          return {nullptr, 0};
        }
      },
      law_);
}

void BodyResponse::join(const ContactSolver& together, int number) {
  std::visit(
      [&](auto& law) {
        if constexpr (kDeforms<std::decay_t<decltype(law)>>) law.join(together, number);
      },
      law_);
}

ContactReport BodyResponse::report() const {
  const auto* law = std::get_if<TablesLaw>(&law_);
  return law != nullptr ? law->report() : ContactReport();
}

void BodyResponse::move_obstacle(const Eigen::Matrix3Xf& vertices) {
  if (obstacle_) obstacle_->move(vertices);
}

void BodyResponse::refine_with(Refiner refiner) {
  if (auto* law = std::get_if<TablesLaw>(&law_)) law->refiner.emplace(std::move(refiner));
}

const TouchState& BodyResponse::touched() const {
  const auto* law = std::get_if<TablesLaw>(&law_);
  PALPABLE_EXPECT(law != nullptr, "only a body with tables has a touch state");
  return law->state();
}

const Refiner* BodyResponse::refiner() const {
  const auto* law = std::get_if<TablesLaw>(&law_);
  return law != nullptr && law->refiner ? &*law->refiner : nullptr;
}

Refiner* BodyResponse::refiner() {
  auto* law = std::get_if<TablesLaw>(&law_);
  return law != nullptr && law->refiner ? &*law->refiner : nullptr;
}

}  // namespace palpable
