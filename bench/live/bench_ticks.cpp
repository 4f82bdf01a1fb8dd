// palpable bench ticks: error of the contact between frames, compared with the true
// hand at that moment.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/live_settings.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/session/between_frames.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/true_hand.h"
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3Xf;
using Eigen::Vector3f;

constexpr double kFrame = 1.0 / 30;  // s, of every clip
// m, smallest largest displacement of the true response that is compared.
constexpr double kPressed = 0.001;

struct TicksBenchOptions {
  LiveOptions live;
  fs::path clip;
  double rate = 1000;  // Hz
  bool json = false;
};

// The hand at the fraction `part` between two frames.
std::vector<ObjectBall> hand_between(const HandLine& from, const HandLine& to, double part,
                                     const Rigid3& body_from_camera) {
  std::vector<ObjectBall> balls;
  if (from.capsules.size() != to.capsules.size()) return balls;
  for (std::size_t k = 0; k < from.capsules.size(); ++k) {
    const Capsule &a = from.capsules[k], &b = to.capsules[k];
    add_balls({(1 - part) * a.a + part * b.a, (1 - part) * a.b + part * b.b, a.ra, a.rb},
              body_from_camera, balls);
  }
  return balls;
}

double farthest(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

// Errors of one method to obtain the state between frames.
struct Errors {
  std::vector<double> place;  // ratio to the largest true displacement
  std::vector<double> force;  // ratio to the true force

  void add(double off, double of, double force_off, double true_force) {
    place.push_back(off / of);
    if (true_force > 0) force.push_back(force_off / true_force);
  }
  [[nodiscard]] Json json() const {
    const auto of = [](const std::vector<double>& all, double share) {
      return all.empty() ? Json(nullptr) : Json(percentile(all, share));
    };
    return {{"displacement_median", of(place, 0.5)},
            {"displacement_p90", of(place, 0.9)},
            {"force_median", of(force, 0.5)},
            {"force_p90", of(force, 0.9)}};
  }
};

// The response to the true hand, advanced tick by tick through the clip.
struct Truth {
  Truth(const Session& session, double rate)
      : ticks(std::max(1, static_cast<int>(std::lround(rate * kFrame)))),
        region(box_of(session.body().model().surface)),
        contact(session.body().model().surface, session.body().model().fixed,
                *session.body().response.tables(), session.settings().touch),
        skin(3, session.body().model().surface.vertex_count()) {}

  void advance(const std::vector<ObjectBall>& balls, const Vector3f& camera) {
    surface.build(balls, region, camera);
    contact.solver().advance(state, surface);
    contact.place(state, skin);
  }

  int ticks;
  Eigen::AlignedBox3d region;
  SkinContact contact;
  ObjectSurface surface;
  TouchState state;
  Matrix3Xf skin;
};

// Two approximations that are compared with it: the state of a frame advanced by the ticks, and the
// state held unchanged.
struct Follower {
  explicit Follower(const Session& session)
      : between(session),
        timed(session),
        skin(3, session.body().model().surface.vertex_count()),
        held(skin) {}

  void begin(const SolvedFrame& frame) {
    between.begin(frame);
    timed.begin(frame);
    between.place(held);
    held_force = force_size(frame.state);
  }
  void compare(double ahead, const Truth& truth, const Matrix3Xf& rest, std::vector<double>* ms) {
    double cpu = 0;
    {
      const CpuTimer timer(cpu);
      timed.advance(ahead);
    }
    between.advance(ahead);
    between.place(skin);
    const double moved = farthest(truth.skin, rest), force = force_size(truth.state);
    if (moved < kPressed) return;
    if (ms != nullptr) ms->push_back(1e3 * cpu);
    carried.add(farthest(skin, truth.skin), moved, std::abs(force_size(between.state()) - force),
                force);
    holding.add(farthest(held, truth.skin), moved, std::abs(held_force - force), force);
  }

  BetweenFrames between, timed;  // the latter is not asked for its skin in between
  Matrix3Xf skin, held;
  double held_force = 0;
  Errors carried, holding;
};

void print_ticks(const Json& result, double rate) {
  fmt::print("{} ticks at {} Hz, {:.2f} ms of CPU each (p99 {:.2f})\n",
             result["ticks_compared"].get<int>(), rate, result["tick_ms_p50"].get<double>(),
             result["tick_ms_p99"].get<double>());
  fmt::print("error relative to the response to the true hand at that moment, %, median (p90):\n");
  fmt::print("{:<44} {:>16} {:>16}\n", "", "displacement", "force");
  for (const auto& [name, what] : std::map<std::string, std::string>{
           {"camera_carried", "seen by the camera, carried on"},
           {"camera_held", "seen by the camera, held till the next frame"},
           {"hand_carried", "the true hand of each frame, carried on"},
           {"hand_held", "the true hand of each frame, held"}}) {
    const Json& of = result[name];
    fmt::print("{:<44} {:>8.1f} ({:>5.1f}) {:>8.1f} ({:>5.1f})\n", what,
               100 * of["displacement_median"].get<double>(),
               100 * of["displacement_p90"].get<double>(), 100 * of["force_median"].get<double>(),
               100 * of["force_p90"].get<double>());
  }
}

void bench_ticks(TicksBenchOptions options) {
  options.live.input.source = (options.clip / "frames").string();
  const std::vector<HandLine> hands = read_hands(options.clip / "truth/hand.jsonl");
  LiveSetUp setup = set_up_live(options.live);
  const Session& session = setup.run.loop.session;
  if (const auto trouble = BetweenFrames::trouble_of(session)) throw Error(trouble->message);
  const Matrix3Xf rest = session.body().model().surface.vertices.cast<float>();
  Truth truth(session, options.rate);
  Follower by_camera(session), by_hand(session);
  SolvedFrame seen, exact;
  std::vector<double> ms;
  ProgressBar bar;
  LiveLoop loop(setup.run, options.live.frames);
  int frames = 0;
  while (const Scene* scene = loop.next()) {
    bar.show({"ticks", static_cast<double>(++frames), static_cast<double>(loop.total()), ""});
    const auto n = static_cast<std::size_t>(scene->number);
    if (n + 1 >= hands.size()) break;
    const Rigid3 body_from_camera = scene->bodies.front().camera_from_body.inverse();
    const Vector3f camera = body_from_camera.translation().cast<float>();
    // At the frame itself, the true state takes the place of a frame's solution.
    const std::vector<ObjectBall> now = hand_between(hands[n], hands[n + 1], 0, body_from_camera);
    truth.advance(now, camera);
    exact.number = scene->number;
    exact.time = scene->time;
    exact.balls = now;
    exact.camera = camera;
    exact.state = truth.state;
    by_hand.begin(exact);
    seen.take(session, *scene);
    by_camera.begin(seen);
    for (int tick = 1; tick <= truth.ticks; ++tick) {
      const double part = static_cast<double>(tick) / truth.ticks;
      truth.advance(hand_between(hands[n], hands[n + 1], part, body_from_camera), camera);
      by_camera.compare(tick / options.rate, truth, rest, &ms);
      by_hand.compare(tick / options.rate, truth, rest, nullptr);
    }
  }
  bar.finish();
  if (ms.empty()) throw Error(options.clip.string() + ": its hand presses nothing");
  Json result{{"bench", "ticks"},
              {"clip", options.clip.string()},
              {"rate", options.rate},
              {"frames", frames},
              {"ticks_compared", ms.size()},
              {"tick_ms_p50", percentile(ms, 0.5)},
              {"tick_ms_p99", percentile(ms, 0.99)},
              {"camera_carried", by_camera.carried.json()},
              {"camera_held", by_camera.holding.json()},
              {"hand_carried", by_hand.carried.json()},
              {"hand_held", by_hand.holding.json()}};
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
    return;
  }
  print_ticks(result, options.rate);
}

}  // namespace

void add_bench_ticks(Command bench) {
  auto options = std::make_shared<TicksBenchOptions>();
  Command command = bench.add_subcommand("ticks",
                                         "Contact between frames (live --contact-rate), "
                                         "against the true hand at that moment");
  command.add_option("body", options->live.body, "Body file with tables of touch").required();
  command.add_option("clip", options->clip, "Folder that palpable synth has made")
      .required()
      .type_name("DIR");
  command.add_option("--rate", options->rate, "Ticks a second")
      .type_name("HZ")
      .in_range(30, 10'000)
      .show_default();
  command.add_option("--frames", options->live.frames, "Largest number of frames")
      .in_range(1, 100'000)
      .default_is("all");
  command.add_json(options->json);
  command.footer(
      "The truth is the response of the same tables to the hand of truth/hand.jsonl, which moves "
      "linearly from frame to frame: this compares moments, not tables (palpable bench touch "
      "does).\n"
      "Example: palpable synth press --seed 5 --frames 300 -o press\n"
      "         palpable bench ticks bunny.palpable press");
  command.callback([options] { bench_ticks(*options); });
}

}  // namespace palpable::app
