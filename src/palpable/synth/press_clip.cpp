#include "palpable/synth/press_clip.h"

#include "palpable/base/contract.h"
#include "palpable/synth/contact_truth.h"
#include "palpable/synth/random.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpable {

namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

// The camera looks down on the body as somebody who sits at the desk.
constexpr double kCameraDistance = 0.44;  // m, to the point it looks at
constexpr double kCameraElevation = 35.0 * kDegree;
const Vector3d kLookedAt(0.012, 0.0, 0.058);  // desk frame

// The touching surface must face the eye within 70 degrees; two are kept in reserve. Less than 30
// would be a press along the line of sight, which is another clip.
const double kWidestView = std::cos(68.0 * kDegree);
const double kNarrowestView = std::cos(30.0 * kDegree);

constexpr double kNear = 0.026;  // m: what belongs to the pressed place; beyond, nothing may touch
constexpr double kApproach = 0.045;  // m: straight way before a press
constexpr double kDeskGap = 0.003;   // m between hand and desk

/// The motion is written for this many frames with a hand and stretched to what is asked for.
constexpr double kScriptLength = 240.0;

Rigid3 look(const Vector3d& from, const Vector3d& at) {
  const Vector3d z = (at - from).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Rigid3 desk_from_camera = Rigid3::Identity();
  desk_from_camera.linear().col(0) = x;
  desk_from_camera.linear().col(1) = z.cross(x);
  desk_from_camera.linear().col(2) = z;
  desk_from_camera.translation() = from;
  return desk_from_camera.inverse();
}

/// Rotation whose columns are `x`, something near `z`, and what completes them.
Eigen::Matrix3d frame_of(const Vector3d& x, const Vector3d& z_hint) {
  Eigen::Matrix3d R;
  R.col(0) = x.normalized();
  R.col(2) = (z_hint - z_hint.dot(R.col(0)) * R.col(0)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

/// Turns the wrist so that the index finger's last bone points along `pointing`.
Quaterniond turn_for(const HandGesture& gesture, const Vector3d& pointing, const Vector3d& back) {
  const Eigen::Matrix3d local = frame_of(index_direction_in_wrist(gesture), Vector3d::UnitZ());
  return Quaterniond(frame_of(pointing, back) * local.transpose());
}

Eigen::Matrix3Xd every_nth(const Eigen::Matrix3Xd& points, Eigen::Index wanted) {
  const Eigen::Index step = std::max<Eigen::Index>(1, points.cols() / wanted);
  Eigen::Matrix3Xd some(3, (points.cols() + step - 1) / step);
  for (Eigen::Index i = 0; i < some.cols(); ++i) some.col(i) = points.col(i * step);
  return some;
}

double lowest_point(std::span<const Capsule> capsules) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Capsule& c : capsules) lowest = std::min({lowest, c.a.z() - c.ra, c.b.z() - c.rb});
  return lowest;
}

}  // namespace

// ---------------------------------------------------------------------------------------------

HandPose PressClip::pose_of(const Vector3d& tip, const Quaterniond& turn,
                            const HandGesture& gesture) {
  HandPose pose;
  pose.gesture = gesture;
  pose.desk_from_wrist.linear() = turn.toRotationMatrix();
  pose.desk_from_wrist.translation() = tip - turn * index_tip_in_wrist(gesture);
  // The arm comes from the right and behind the desk; the wrist takes up a third of the difference.
  const Vector3d wrist = pose.desk_from_wrist.translation();
  const Vector3d arm = Vector3d(0.85, 0.30, 0.40).normalized();
  const Vector3d straight = -(turn * Vector3d::UnitX());
  pose.elbow = wrist + 0.25 * (0.65 * straight + 0.35 * arm).normalized();
  pose.shoulder = pose.elbow + 0.32 * Vector3d(0.85, 0.20, 0.45).normalized();
  return pose;
}

HandPose PressClip::pose_at(double frame) const {
  const auto n = static_cast<int>(keys_.size());
  int k = 0;
  while (k + 2 < n && keys_[static_cast<std::size_t>(k) + 1].frame <= frame) ++k;
  const auto key = [this](int i) -> const Key& { return keys_[static_cast<std::size_t>(i)]; };
  const double span = key(k + 1).frame - key(k).frame;
  const double t = std::clamp((frame - key(k).frame) / span, 0.0, 1.0);

  // Fritsch and Carlson's monotone cubic: the harmonic mean of neighbouring slopes, zero where they
  // differ in sign. A press therefore ends where it was planned, and a straight approach is
  // straight.
  const auto interpolate = [&](auto value) {
    const auto slope = [&](int i) {
      return (value(key(i + 1)) - value(key(i))) / (key(i + 1).frame - key(i).frame);
    };
    const auto tangent = [&](int i) {
      if (i == 0 || i == n - 1) return 0.0;
      const double before = slope(i - 1);
      const double after = slope(i);
      return before * after <= 0.0 ? 0.0 : 2.0 * before * after / (before + after);
    };
    const double t2 = t * t;
    const double t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * value(key(k)) + (t3 - 2 * t2 + t) * span * tangent(k) +
           (3 * t2 - 2 * t3) * value(key(k + 1)) + (t3 - t2) * span * tangent(k + 1);
  };
  Vector3d tip;
  for (int axis = 0; axis < 3; ++axis)
    tip[axis] = interpolate([axis](const Key& at) { return at.tip[axis]; });
  const double open = interpolate([](const Key& at) { return at.open; });
  const double eased = t * t * (3.0 - 2.0 * t);
  const Quaterniond turn = key(k).turn.slerp(eased, key(k + 1).turn);
  return pose_of(tip, turn, blend(pointing_gesture(), open_gesture(), std::clamp(open, 0.0, 1.0)));
}

std::optional<HandPose> PressClip::hand(int frame) const {
  PALPABLE_EXPECT(frame >= 0 && frame < frames_, "the frame is one of the clip's");
  if (frame < kFramesWithoutHand) return std::nullopt;
  HandPose pose = pose_at(frame);
  // A living hand trembles: three sines an axis, together below 0.2 mm.
  Random random(seed_, "tremor");
  Vector3d shift = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis)
    for (const double hertz : {1.7, 4.1, 8.3}) {
      const double phase = random.between(0.0, 2.0 * std::numbers::pi);
      shift[axis] += 0.00006 * std::sin(2.0 * std::numbers::pi * hertz * frame / 30.0 + phase);
    }
  pose.desk_from_wrist.translation() += shift;
  pose.elbow += shift;
  return pose;
}

const PlannedPress* PressClip::press_at(int frame) const {
  for (const PlannedPress& press : presses_)
    if (press.first_frame <= frame && frame <= press.last_frame) return &press;
  return nullptr;
}

double PressClip::advance(int frame) const {
  const PlannedPress* press = press_at(frame);
  const std::optional<HandPose> pose = hand(frame);
  if (press == nullptr || !pose) return 0.0;
  const Vector3d tip = pose->desk_from_wrist * index_tip_in_wrist(pose->gesture);
  return std::max(0.0, (tip - press->first_touch).dot(press->direction));
}

// ---------------------------------------------------------------------------------------------

struct PressClip::Planner {
  /// A way to press a site.
  struct Candidate {
    int site = 0;
    Vector3d touch;  ///< the tip's middle at the first touch, desk frame
    Vector3d direction;
    Quaterniond turn;
    double view_angle = 0;
    double score = 0;
  };

  const DeskBody& body;
  Vector3d eye;               // desk frame
  Eigen::Matrix3Xd vertices;  // desk frame, all
  Eigen::Matrix3Xd some;      // some of them, for the search
  HandGesture pointing = pointing_gesture();

  void turn_body(double yaw) {
    const Eigen::Matrix3d R = AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    vertices = R * body.surface.vertices;
    some = every_nth(vertices, 700);
  }

  [[nodiscard]] Vector3d site_point(int site) const {
    return vertices.col(body.site_vertices[static_cast<std::size_t>(site)]);
  }

  /// How well the camera sees a press there; negative when it may not be used.
  [[nodiscard]] double site_score(int site, const Vector3d& normal, const Vector3d& d) const {
    const Vector3d x = site_point(site);
    const Vector3d to_eye = (eye - x).normalized();
    const double facing = d.dot(to_eye);
    if (facing < kWidestView || facing > kNarrowestView || x.z() < 0.03 || d.x() > -0.25)
      return -1.0;
    // The best sites are pressed from the right and can themselves be seen.
    return 1.0 + 1.2 * normal.dot(to_eye) - 0.6 * d.x() + 2.0 * std::min(x.z(), 0.1);
  }

  /// The tip's position along `d` at which the hand first touches the body.
  [[nodiscard]] std::optional<Vector3d> first_touch(int site, const Vector3d& d,
                                                    const Quaterniond& turn) const {
    const Vector3d surface = site_point(site) - index_tip_radius() * d;
    double outside = -0.02;  // m along d
    double inside = 0.004;
    const auto touches = [&](double s) {
      const HandPose pose = pose_of(surface + s * d, turn, pointing);
      return contact_truth(shapes_of(hand_capsules(pose)), vertices).touching;
    };
    if (touches(outside) || !touches(inside)) return std::nullopt;
    for (int i = 0; i < 20; ++i) {
      const double middle = 0.5 * (outside + inside);
      (touches(middle) ? inside : outside) = middle;
    }
    return Vector3d(surface + inside * d);
  }

  /// The best posture of the hand for a site, if there is one.
  [[nodiscard]] std::optional<Candidate> best_posture(int site, const Vector3d& d,
                                                      double depth) const {
    const Vector3d x = site_point(site);
    Eigen::Matrix3Xd far_ones(3, some.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < some.cols(); ++i)
      if ((some.col(i) - x).norm() > kNear) far_ones.col(count++) = some.col(i);
    far_ones.conservativeResize(3, count);

    const Vector3d tip = x + (depth - index_tip_radius()) * d;
    const Vector3d flat = Vector3d(d.x(), d.y(), 0.0).normalized();
    std::optional<Candidate> best;
    for (const double yaw : {0.0, -20.0, 20.0, -40.0, 40.0})
      for (const double down : {5.0, 20.0, 35.0, 50.0, 65.0})
        for (const double roll : {0.0, -25.0, 25.0, -50.0, 50.0, 75.0}) {
          const Vector3d level = AngleAxisd(yaw * kDegree, Vector3d::UnitZ()) * flat;
          const Vector3d f =
              std::cos(down * kDegree) * level - std::sin(down * kDegree) * Vector3d::UnitZ();
          if (f.dot(d) < std::cos(62.0 * kDegree)) continue;
          const Vector3d back = AngleAxisd(roll * kDegree, f) * Vector3d::UnitZ();
          const Quaterniond turn = turn_for(pointing, f, back);
          const std::vector<Capsule> hand = shapes_of(hand_capsules(pose_of(tip, turn, pointing)));
          const Vector3d before = tip - (kApproach + depth) * d;
          const std::vector<Capsule> hand_before =
              shapes_of(hand_capsules(pose_of(before, turn, pointing)));
          if (std::min(lowest_point(hand), lowest_point(hand_before)) < kDeskGap) continue;
          if (contact_truth(hand_before, some).touching) continue;
          const double clearance = contact_truth(hand, far_ones).clearance;
          if (clearance < 0.004) continue;
          // The touching point must not be hidden from the eye by the hand itself.
          const Vector3d touching = tip + index_tip_radius() * d;
          const Vector3d ray = (touching - eye).normalized();
          const double reach = (touching - eye).norm();
          if (ray_distance(hand, eye, ray, reach) < reach - 0.003) continue;
          const double score = 60.0 * std::min(clearance, 0.012) + 0.8 * f.dot(d) -
                               0.004 * std::abs(roll) - 0.3 * std::abs(level.y()) - 0.4 * level.x();
          if (!best || score > best->score)
            best = Candidate{site, Vector3d::Zero(), d, turn, 0.0, score};
        }
    return best;
  }
};

PressClip PressClip::plan(const DeskBody& body, int frames, std::uint64_t seed) {
  PALPABLE_EXPECT(frames >= 1, "a clip has frames");
  PALPABLE_EXPECT(
      body.surface.vertex_count() > 0 && !body.site_vertices.empty() &&
          body.directions.cols() == static_cast<Eigen::Index>(body.site_vertices.size()),
      "the body has vertices, and one direction per site");
  PressClip clip;
  clip.frames_ = frames;
  clip.seed_ = seed;
  const Vector3d eye = kLookedAt + kCameraDistance * Vector3d(0.0, -std::cos(kCameraElevation),
                                                              std::sin(kCameraElevation));
  clip.camera_from_desk_ = look(eye, kLookedAt);

  Planner planner{body, eye, {}, {}};
  const auto sites = static_cast<int>(body.site_vertices.size());
  Eigen::Matrix3Xf normals(3, body.surface.vertex_count());
  vertex_normals(body.surface.vertices.cast<float>(), body.surface.triangles, normals);

  // How the body is turned: the yaw with the best three sites. The seed turns the set of yaws.
  Random random(seed, "plan");
  const std::array<double, 3> depths = {0.008 + random.between(-0.001, 0.001),
                                        0.0055 + random.between(-0.0005, 0.001),
                                        0.0115 + random.between(-0.001, 0.0005)};
  struct Scored {
    int site;
    double score;
  };
  const auto ranked_sites = [&](double yaw) {
    planner.turn_body(yaw);
    const Eigen::Matrix3d R = AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    std::vector<Scored> ranked;
    for (int s = 0; s < sites; ++s) {
      const Eigen::Vector3d normal =
          R * normals.col(body.site_vertices[static_cast<std::size_t>(s)]).cast<double>();
      const double score = planner.site_score(s, normal, R * body.directions.col(s));
      if (score > 0.0) ranked.push_back({s, score});
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const Scored& a, const Scored& b) { return a.score > b.score; });
    return ranked;
  };
  std::vector<std::pair<double, double>> yaws;  // (value, yaw)
  for (int i = 0; i < 36; ++i) {
    const double yaw = 10.0 * i * kDegree;
    const std::vector<Scored> ranked = ranked_sites(yaw);
    double value = 0.0;
    for (std::size_t s = 0; s < std::min<std::size_t>(5, ranked.size()); ++s)
      value += ranked[s].score;
    yaws.emplace_back(value, yaw);
  }
  std::stable_sort(yaws.begin(), yaws.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });

  std::string why = "no site can be pressed where the left camera sees it";
  const auto attempt = [&](double yaw, std::size_t needed) {
    const std::vector<Scored> ranked = ranked_sites(yaw);
    const Eigen::Matrix3d R = AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    clip.desk_from_body_ = Rigid3::Identity();
    clip.desk_from_body_.linear() = R;

    std::vector<Planner::Candidate> found;
    for (const Scored& scored : ranked) {
      if (found.size() == 3) break;
      const Vector3d d = R * body.directions.col(scored.site);
      // Presses are spread over the body where it has enough sites.
      bool apart = true;
      for (const Planner::Candidate& other : found)
        apart = apart &&
                (planner.site_point(other.site) - planner.site_point(scored.site)).norm() > 0.015;
      if (!apart) continue;
      const double depth = depths[found.size()];
      std::optional<Planner::Candidate> candidate = planner.best_posture(scored.site, d, depth);
      if (!candidate) continue;
      const std::optional<Vector3d> touch = planner.first_touch(scored.site, d, candidate->turn);
      if (!touch) continue;
      candidate->touch = *touch;
      candidate->view_angle =
          std::acos(d.dot((eye - planner.site_point(scored.site)).normalized()));
      found.push_back(*candidate);
    }
    if (found.size() < needed) return false;
    // A body with few sites is pressed at one of them again.
    while (found.size() < 3) found.push_back(found.front());

    // The script. Tips and wrists in the desk frame; the hand is open where it only passes.
    const HandGesture open = open_gesture();
    const auto wrist_turn = [](const Vector3d& fingers, const Vector3d& back) {
      return Quaterniond(frame_of(fingers, back));
    };
    const auto palm_at = [&](const Vector3d& knuckles, const Quaterniond& turn) {
      // The tip of the open index finger when the palm's knuckles are at this place.
      return Vector3d(knuckles + turn * (index_tip_in_wrist(open) - Vector3d(0.08, 0.0, 0.0)));
    };
    const double stretch = (frames - kFramesWithoutHand) / kScriptLength;
    const auto script = [&](double at) { return kFramesWithoutHand + at * stretch; };
    clip.keys_.clear();
    clip.presses_.clear();
    const auto key = [&](double at, const Vector3d& tip, const Quaterniond& turn, double opened) {
      clip.keys_.push_back({script(at), tip, turn, opened});
    };
    const auto press = [&](std::size_t which, double start, double deep, double hold, double end) {
      const Planner::Candidate& c = found[which];
      const Vector3d before = c.touch - kApproach * c.direction;
      const Vector3d deepest = c.touch + depths[which] * c.direction;
      key(start, before, c.turn, 0.0);
      key(deep, deepest, c.turn, 0.0);
      key(hold, deepest, c.turn, 0.0);
      key(end, before, c.turn, 0.0);
      clip.presses_.push_back({c.site, depths[which], static_cast<int>(std::floor(script(start))),
                               static_cast<int>(std::ceil(script(end))), c.view_angle, c.touch,
                               c.direction});
    };
    const Quaterniond left_away = wrist_turn({-0.93, -0.20, -0.25}, {-0.15, -0.30, 0.94});
    const Quaterniond front_turn = wrist_turn({-0.95, 0.16, -0.12}, {-0.10, -0.55, 0.83});
    const Quaterniond behind_turn = wrist_turn({-0.98, -0.10, -0.05}, {-0.05, -0.20, 0.97});
    const Vector3d to_body = (Vector3d(0.0, 0.0, 0.075) - eye).normalized();
    const Vector3d front = eye + 0.285 * to_body;
    const Vector3d rest = palm_at({0.25, 0.05, 0.14}, left_away);

    key(0, palm_at({0.62, 0.16, 0.24}, left_away), left_away, 0.6);
    key(18, rest, left_away, 0.3);
    press(0, 28, 42, 54, 65);
    key(77, palm_at(front + Vector3d(0.20, 0.03, 0.0), front_turn), front_turn, 0.8);
    key(90, palm_at(front + Vector3d(0.035, 0.0, 0.0), front_turn), front_turn, 1.0);
    key(99, palm_at(front + Vector3d(0.015, 0.0, 0.005), front_turn), front_turn, 1.0);
    key(110, palm_at(front + Vector3d(0.21, 0.05, 0.02), front_turn), front_turn, 0.6);
    press(1, 122, 128, 136, 143);
    key(152, rest, left_away, 0.5);
    key(163, palm_at({0.20, 0.145, 0.095}, behind_turn), behind_turn, 0.8);
    key(172, palm_at({0.035, 0.145, 0.084}, behind_turn), behind_turn, 1.0);
    key(179, palm_at({0.015, 0.145, 0.082}, behind_turn), behind_turn, 1.0);
    key(190, rest, left_away, 0.5);
    press(2, 201, 213, 221, 229);
    key(kScriptLength, rest, left_away, 0.4);
    clip.in_front_ = {static_cast<int>(std::ceil(script(86))),
                      static_cast<int>(std::floor(script(103)))};
    clip.behind_ = {static_cast<int>(std::ceil(script(169))),
                    static_cast<int>(std::floor(script(182)))};

    // Every frame, all vertices: touched in the presses, at their places, and nowhere else.
    why.clear();
    for (int frame = kFramesWithoutHand; frame < frames && why.empty(); ++frame) {
      const std::vector<Capsule> hand = shapes_of(hand_capsules(*clip.hand(frame)));
      if (lowest_point(hand) < 0.0) why = fmt::format("the hand meets the desk in frame {}", frame);
      const ContactTruth truth = contact_truth(hand, planner.vertices);
      if (!truth.touching) continue;
      bool planned = false;
      for (const PlannedPress& p : clip.presses_)
        planned =
            planned ||
            (p.first_frame <= frame && frame <= p.last_frame && truth.depth < p.depth + 0.0006 &&
             (planner.vertices.col(truth.vertex) - planner.site_point(p.site)).norm() < kNear);
      if (!planned)
        why = fmt::format("the hand meets the body in frame {} ({:.1f} mm deep)", frame,
                          1e3 * truth.depth);
    }
    return why.empty();
  };
  // Three different sites if any way of turning the body allows it.
  for (const std::size_t needed : {3U, 2U, 1U})
    for (const auto& [value, yaw] : yaws)
      if (value > 0.0 && attempt(yaw, needed)) return clip;
  throw Error("the press clip cannot be planned for this body: " + why +
              "; the body should be 0.05 to 0.25 m high and have sites on several sides");
}

}  // namespace palpable
