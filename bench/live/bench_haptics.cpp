// palpable bench haptics: the forces of a thousand ticks a second beside those of whole frames, and
// a simulated force device that leans on a body.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/touch_file.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/bench_clips.h"
#include "bench/live/device_study.h"
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct HapticsBenchOptions {
  std::filesystem::path body;
  int places = 6;
  std::uint64_t seed = 1;
  double speed = 0.2;  // m/s
  double friction = 0.3;
  double seconds = 10;  // that the device leans
  bool json = false;
};

// The largest gain that is tried: a body as many times stiffer.
constexpr double kLargestGain = 64;

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

Json percentiles(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {{"p50", percentile(values, 0.5)},
          {"p90", percentile(values, 0.9)},
          {"p99", percentile(values, 0.99)},
          {"largest", percentile(values, 1.0)}};
}

Json json_of(const LeanFigures& lean) {
  return {{"stable", lean.is_stable()},
          {"shake_mm_s", 1e3 * lean.shake},
          {"force_n", lean.force},
          {"depth_mm", 1e3 * lean.depth},
          {"stiffness_n_m", lean.stiffness},
          {"least_energy_in_cycle_j", lean.least_in_cycle},
          {"largest_energy_j", lean.largest_energy}};
}

// The device leans on one place: slowly, fast, and with the force of ever stiffer bodies.
Json device_figures(const TouchableBody& body, const Fingertip& finger,
                    const HapticsBenchOptions& options) {
  DeviceSettings device;
  device.friction = options.friction;
  const LeanFigures slow = lean(body, finger, device, options.seconds, false);
  const LeanFigures fast = lean(body, finger, device, options.seconds, true);
  Json figures{{"slow", json_of(slow)}, {"fast", json_of(fast)}};
  double stable = slow.is_stable() ? slow.stiffness : 0;
  Json tried = Json::array();
  for (device.gain = 2; device.gain <= kLargestGain; device.gain *= std::sqrt(2.0)) {
    const LeanFigures stiff = lean(body, finger, device, 3, false);
    tried.push_back(
        {{"gain", device.gain}, {"stable", stiff.is_stable()}, {"stiffness_n_m", stiff.stiffness}});
    if (!stiff.is_stable()) break;
    stable = stiff.stiffness;
  }
  figures["stiffer"] = tried;
  figures["stable_stiffness"] = stable;
  return figures;
}

void print_haptics(const Json& result) {
  const auto number = [](const Json& of, const char* key) { return of[key].get<double>(); };
  fmt::print(
      "{} ticks with a force: {:.2f} ms of CPU (p99 {:.2f}); a whole frame {:.2f} ({:.2f})\n",
      result["ticks"].get<int>(), number(result, "tick_ms_p50"), number(result, "tick_ms_p99"),
      number(result["frame_ms"], "p50"), number(result["frame_ms"], "p99"));
  fmt::print(
      "paced, a force is there {:.2f} ms after it was due ({:.2f} at 99 of 100, {:.2f} at most)\n",
      number(result["tick_late_ms"], "p50"), number(result["tick_late_ms"], "p99"),
      number(result["tick_late_ms"], "largest"));
  fmt::print("force of a tick beside that of a whole frame: {:.1f} % off, {:.1f} at 90 of 100\n",
             100 * number(result, "tick_force_error"), 100 * number(result, "tick_force_p90"));
  fmt::print("jump where a frame takes a tick's place: {:.1f} %, {:.1f} at most\n",
             100 * number(result["jump"], "p50"), 100 * number(result["jump"], "largest"));
  fmt::print("device of 50 g: stable up to {:.0f} N/m (the place where it is least)\n",
             number(result, "stable_stiffness"));
  for (const Json& place : result["places"]) {
    for (const char* how : {"slow", "fast"}) {
      const Json& of = place[how];
      fmt::print(
          "  {}: {:.2f} N, {:.1f} mm deep, {:.0f} N/m; shakes by {:.2f} mm/s; energy that the body "
          "took in each cycle at least {:.1e} J\n",
          how, number(of, "force_n"), number(of, "depth_mm"), number(of, "stiffness_n_m"),
          number(of, "shake_mm_s"), number(of, "least_energy_in_cycle_j"));
    }
  }
}

void bench_haptics(HapticsBenchOptions options) {
  if (options.body.empty()) {
    options.body = first_there({"build/bodies/bunny.palpable", "out/demo/bunny.palpable"});
  }
  if (options.body.empty()) throw Error("name a body file; ./demo makes one");
  const TouchableBody body = value_or_throw(read_touchable_body(options.body));
  if (!body.touch) {
    throw Error(fmt::format("{}: it has no tables of touch; palpable bake makes them ([touch])",
                            options.body.string()));
  }
  ProgressBar bar;
  TickFigures all;
  std::vector<double> late;
  Json places = Json::array();
  double stable = kLargestGain * 1e6;
  const std::vector<Fingertip> fingers = fingertips(body, options.places, options.seed);
  for (const Fingertip& finger : fingers) {
    bar.show(
        {"leans", static_cast<double>(places.size()), static_cast<double>(fingers.size()), {}});
    const TickFigures one = tick_figures(body, finger, options.friction, options.speed);
    append(all.ms, one.ms);
    append(all.frame_ms, one.frame_ms);
    append(all.force, one.force);
    append(all.air_ms, one.air_ms);
    append(all.press_ms, one.press_ms);
    append(all.faint, one.faint);
    append(all.jump, one.jump);
    append(late, lateness(body, finger, options.friction));
    Json place = device_figures(body, finger, options);
    place["force"] = percentiles(one.force);
    place["jump"] = percentiles(one.jump);
    stable = std::min(stable, place["stable_stiffness"].get<double>());
    places.push_back(place);
  }
  bar.finish();
  if (all.force.empty()) throw Error("no finger pressed the body");
  const Json result{{"bench", "haptics"},
                    {"machine", processor_name()},
                    {"body", options.body.string()},
                    {"friction", options.friction},
                    {"speed", options.speed},
                    {"seed", options.seed},
                    {"inertia", body.touch->vibration.has_value()},
                    {"ticks", all.ms.size()},
                    {"tick_ms_p50", percentile(all.ms, 0.5)},
                    {"tick_ms_p99", percentile(all.ms, 0.99)},
                    {"tick_late_ms", percentiles(late)},
                    {"tick_in_air_ms", percentiles(all.air_ms)},
                    {"frame_ms", percentiles(all.frame_ms)},
                    {"press_ms", percentiles(all.press_ms)},
                    {"tick_force_error", percentile(all.force, 0.5)},
                    {"tick_force_p90", percentile(all.force, 0.9)},
                    {"tick_force_largest", percentile(all.force, 1.0)},
                    {"tick_force_off_when_faint_n", percentiles(all.faint)},
                    {"jump", percentiles(all.jump)},
                    {"jumps", all.jump.size()},
                    {"stable_stiffness", stable},
                    {"places", places}};
  if (options.json) {
    fmt::print("{}\n", result.dump(2));
  } else {
    print_haptics(result);
  }
}

}  // namespace

void add_bench_haptics(Command bench) {
  auto options = std::make_shared<HapticsBenchOptions>();
  Command command = bench.add_subcommand(
      "haptics", "A thousand forces a second: their time and error, and a simulated force device");
  command.add_option("body", options->body, "Body file with tables of touch")
      .default_is("build/bodies/bunny.palpable, else out/demo/bunny.palpable");
  command.add_option("--places", options->places, "Random places of the skin")
      .in_range(1, 100)
      .show_default();
  command.add_option("--seed", options->seed, "Of the places").show_default();
  command.add_option("--speed", options->speed, "m/s, of the finger")
      .in_range(0.01, 1.0)
      .show_default();
  command.add_option("--friction", options->friction, "Coulomb's coefficient")
      .in_range(0.0, 10.0)
      .show_default();
  command.add_option("--seconds", options->seconds, "For which the device leans")
      .in_range(3, 1000)
      .show_default();
  command.add_json(options->json);
  command.footer(
      "The truth of a tick is the force of a whole frame at the same time (live's own, of 1 ms): "
      "palpable bench touch and bench dynamics compare those with full finite elements.\n"
      "Example: palpable bench haptics bunny.palpable --json");
  command.callback([options] { bench_haptics(*options); });
}

}  // namespace palpable::app
