// palpable bench answer: the time of the answer alone, the response of a body to what presses it:
// without friction, with it, and with friction and inertia.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/live_settings.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/desk/clip_files/clip_hands.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/seen_object/object_surface.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/bench_clips.h"
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3f;

constexpr double kHandFrame = 1.0 / 30;  // s, of a clip's true hand

struct AnswerBenchOptions {
  fs::path body;
  std::vector<std::string> clips;
  double friction = 0.3;
  bool true_hand = false;
  int frames = 0;  // of each clip; 0: all
  bool json = false;
};

// What presses a body in one frame, body frame: the balls that a camera saw, or capsules.
struct RecordedPressers {
  double passed = 0;  // s since the frame before
  std::vector<ObjectBall> balls;
  Vector3f camera = Vector3f::Zero();  // m, its position
  std::vector<Capsule> capsules;
};

// The pressers of a clip by the camera's chain. The run that records them has friction, so that the
// balls have their motion.
std::vector<RecordedPressers> pressers_by_camera(const AnswerBenchOptions& options,
                                                 const fs::path& clip, ProgressBar& bar) {
  LiveOptions live;
  live.body = options.body;
  live.input.source = (clip / "frames").string();
  live.frames = options.frames > 0 ? options.frames : -1;
  live.run.friction = options.friction;
  LiveSetUp setup = set_up_live(live);
  const ObjectSurface& seen = setup.run.loop.session.body().response.surface();
  std::vector<RecordedPressers> frames;
  LiveLoop loop(setup.run, live.frames);
  double before = 0;
  while (const Scene* scene = loop.next()) {
    bar.show({clip.filename().string(), static_cast<double>(frames.size()),
              static_cast<double>(loop.total()), "the camera's chain"});
    RecordedPressers& now = frames.emplace_back();
    now.passed = frames.size() > 1 ? scene->time - before : 0.0;
    before = scene->time;
    now.balls.assign(seen.balls().begin(), seen.balls().end());
    now.camera = scene->bodies.front().camera_from_body.inverse().translation().cast<float>();
  }
  return frames;
}

std::vector<RecordedPressers> pressers_by_truth(const AnswerBenchOptions& options,
                                                const fs::path& clip) {
  std::vector<RecordedPressers> frames;
  for (std::vector<Capsule>& capsules : read_clip_hands(clip, {}).capsules) {
    if (options.frames > 0 && std::ssize(frames) == options.frames) break;
    RecordedPressers& now = frames.emplace_back();
    now.passed = frames.size() > 1 ? kHandFrame : 0.0;
    now.capsules = std::move(capsules);
  }
  return frames;
}

// The recorded pressers, frame by frame, as obstacles.
class PlayedPressers {
 public:
  explicit PlayedPressers(const SurfaceMesh& skin) : region_(box_of(skin)) {}

  void show(const RecordedPressers& now, bool by_camera) {
    by_camera_ = by_camera;
    if (by_camera) return seen_.build(now.balls, region_, now.camera);
    capsules_.set(now.capsules);
    // The hand of a clip keeps its capsules, unless it comes or goes.
    become_.assign(before_.size(), -1);
    if (before_.size() == now.capsules.size()) std::iota(become_.begin(), become_.end(), 0);
    friction_.assign(now.capsules.size(), kFrictionOfBody);
    capsules_.set_friction(friction_, before_, become_);
    before_ = now.capsules;
  }
  [[nodiscard]] const Obstacles& obstacles() const {
    if (by_camera_) return seen_;
    return capsules_;
  }
  // m, the step limit of the frame
  [[nodiscard]] double largest_move() const {
    return by_camera_ ? SkinContact::largest_move(seen_) : std::numeric_limits<double>::infinity();
  }

 private:
  Eigen::AlignedBox3d region_;
  bool by_camera_ = true;
  ObjectSurface seen_;
  CapsuleObstacles capsules_;
  std::vector<Capsule> before_;
  std::vector<int> become_;
  std::vector<float> friction_;
};

// The body with one coefficient of friction, with or without inertia, and the times of its answers.
class TimedAnswer {
 public:
  // @param by_camera  what presses is seen by a camera, and is let in as deep as there
  TimedAnswer(const TouchableBody& body, double friction, bool moves, bool by_camera)
      : moves_(moves),
        contact_(body.body.surface, body.body.fixed, *body.touch,
                 {.entry = by_camera ? ResponseSettings().touch.entry : TouchSettings().entry,
                  .friction = friction}) {}

  // Answers one frame. Returns its time, ms of CPU.
  double answer(const PlayedPressers& pressers, double passed) {
    double seconds = 0;
    const std::optional<double> time = moves_ ? std::optional(passed) : std::nullopt;
    {
      const CpuTimer timer(seconds);
      const TouchReport report =
          contact_.solver().advance(state_, pressers.obstacles(), pressers.largest_move(), time);
      residual_ = report.friction_residual;
    }
    return 1e3 * seconds;
  }
  [[nodiscard]] bool is_pressed() const { return !state_.forces.empty(); }
  [[nodiscard]] bool rubs() const { return !state_.anchors.empty(); }
  // m, of the last answer
  [[nodiscard]] double residual() const { return residual_; }

 private:
  bool moves_;
  SkinContact contact_;
  TouchState state_;
  double residual_ = 0;
};

// Of the frames in which something presses.
struct AnswerTimes {
  std::vector<double> without, with, moving;  // ms
  std::vector<double> residuals;              // m, with friction
  int rubbing = 0;                            // frames in which a point has friction

  void add(const AnswerTimes& other) {
    without.insert(without.end(), other.without.begin(), other.without.end());
    with.insert(with.end(), other.with.begin(), other.with.end());
    moving.insert(moving.end(), other.moving.begin(), other.moving.end());
    residuals.insert(residuals.end(), other.residuals.begin(), other.residuals.end());
    rubbing += other.rubbing;
  }
};

AnswerTimes answers_of(const TouchableBody& body, const std::vector<RecordedPressers>& frames,
                       const AnswerBenchOptions& options) {
  PlayedPressers pressers(body.body.surface);
  const bool by_camera = !options.true_hand;
  TimedAnswer without(body, 0, false, by_camera), with(body, options.friction, false, by_camera),
      moving(body, options.friction, true, by_camera);
  AnswerTimes times;
  std::size_t turn = 0;
  for (const RecordedPressers& now : frames) {
    pressers.show(now, !options.true_hand);
    // Each of them comes first in turn: what the first one read is then in the caches.
    const std::array<TimedAnswer*, 3> all{&without, &with, &moving};
    std::array<double, 3> ms{};
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::size_t who = (turn + k) % all.size();
      ms[who] = all[who]->answer(pressers, now.passed);
    }
    ++turn;
    if (!without.is_pressed() && !with.is_pressed() && !moving.is_pressed()) continue;
    times.without.push_back(ms[0]);
    times.with.push_back(ms[1]);
    times.moving.push_back(ms[2]);
    times.residuals.push_back(with.residual());
    times.rubbing += with.rubs();
  }
  return times;
}

Json json_of_times(const AnswerTimes& times) {
  if (times.with.empty()) return Json{{"frames", 0}};
  Json result{{"frames", times.with.size()}, {"frames_rubbing", times.rubbing}};
  for (const auto& [key, share] : {std::pair{"p50", 0.5}, std::pair{"p99", 0.99}}) {
    const double without = percentile(times.without, share), with = percentile(times.with, share);
    result["without_friction_ms"][key] = without;
    result["with_friction_ms"][key] = with;
    result["with_both_ms"][key] = percentile(times.moving, share);
    result["ratio"][key] = without > 0 ? Json(with / without) : Json();
  }
  result["friction_residual_p99_mm"] = 1e3 * percentile(times.residuals, 0.99);
  return result;
}

void print_answers(const Json& result) {
  fmt::print(
      "ms of CPU for an answer, median (99th percentile), friction {:g}\n{:<24}{:>8}{:>20}"
      "{:>20}{:>16}{:>20}\n",
      result["friction"].get<double>(), "", "frames", "without", "with", "ratio", "and inertia");
  const auto print_line = [](const std::string& name, const Json& of) {
    fmt::print("{:<24}{:>8}", name, of["frames"].get<int>());
    for (const auto& [key, wide] :
         {std::pair{"without_friction_ms", 20}, std::pair{"with_friction_ms", 20},
          std::pair{"ratio", 16}, std::pair{"with_both_ms", 20}}) {
      if (!of.contains(key)) continue;
      fmt::print("{:>{}}",
                 fmt::format("{:.2f} ({:.2f})", of[key]["p50"].get<double>(),
                             of[key]["p99"].get<double>()),
                 wide);
    }
    fmt::print("\n");
  };
  for (const auto& [name, of] : result["clips"].items()) print_line(name, of);
  print_line("all", result["all"]);
}

void bench_answer(AnswerBenchOptions options) {
  if (options.body.empty()) {
    options.body = first_there({"build/bodies/bunny.palpable", "out/demo/bunny.palpable"});
  }
  if (options.body.empty()) throw Error("name a body file with --body; ./demo makes one");
  const TouchableBody body = value_or_throw(read_touchable_body(options.body));
  if (!body.touch) {
    throw Error(fmt::format("{}: it has no tables of touch; palpable bake makes them ([touch])",
                            options.body.string()));
  }
  ProgressBar bar;
  AnswerTimes all;
  Json clips = Json::object();
  for (const fs::path clip : options.clips) {
    const AnswerTimes times = answers_of(body,
                                         options.true_hand ? pressers_by_truth(options, clip)
                                                           : pressers_by_camera(options, clip, bar),
                                         options);
    clips[clip.string()] = json_of_times(times);
    all.add(times);
  }
  bar.finish();
  if (all.with.empty()) throw Error("nothing presses the body in these clips");
  const Json result{{"bench", "answer"},
                    {"machine", processor_name()},
                    {"body", options.body.string()},
                    {"friction", options.friction},
                    {"pressers", options.true_hand ? "true hand" : "camera"},
                    {"clips", clips},
                    {"all", json_of_times(all)}};
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
  } else {
    print_answers(result);
  }
}

}  // namespace

void add_bench_answer(Command bench) {
  auto options = std::make_shared<AnswerBenchOptions>();
  Command command = bench.add_subcommand(
      "answer",
      "The time of a body's response alone: without friction, with it, and with inertia, too");
  command.add_option("clips", options->clips, "Folders that palpable synth has made")
      .required()
      .type_name("CLIP");
  command.add_option("--body", options->body, "Body file with tables of touch")
      .default_is("build/bodies/bunny.palpable, else out/demo/bunny.palpable");
  command.add_option("--friction", options->friction, "Coulomb's coefficient of the second body")
      .in_range(0.001, 10.0)
      .show_default();
  command.add_flag("--true-hand", options->true_hand,
                   "Pressed by the capsules of the clips' true hands, instead of what the camera's "
                   "chain sees");
  command.add_option("--frames", options->frames, "Largest number of frames of each clip; 0: all")
      .in_range(0, 100'000)
      .show_default();
  command.add_json(options->json);
  command.footer(
      "What presses is recorded once. Then three bodies answer it frame by frame in turn, one "
      "without friction, one with friction, one with inertia, too, where the body file has "
      "vibration modes: all get the same input. Frames in which nothing presses do not count.\n"
      "Example: palpable synth press --seed 1005 -o press\n"
      "         palpable bench answer press --friction 0.3 --json");
  command.callback([options] { bench_answer(*options); });
}

}  // namespace palpable::app
