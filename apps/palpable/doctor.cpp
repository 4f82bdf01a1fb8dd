// palpable doctor: what this machine has for the live half and the bake, what it lacks, and what to
// do about it.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "apps/palpable/live_settings.h"
#include "apps/palpable/terminal.h"
#include "palpable/common/base/child_process.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/row_kernels.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/sources/camera_list.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/camera_trial.h"
#include "palpable/live/sources/video_system.h"
#include "palpable/live/view/drawn_frame.h"
#include "palpable/live/view/scene_painter.h"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

enum class Verdict {
  kGood,
  kLimits,  // something works less well, or not at all, but `live` runs
  kBlocks,  // `live` would not run
};

struct Finding {
  std::string what;   // "OpenGL"
  std::string state;  // what was found
  Verdict verdict = Verdict::kGood;
  std::string remedy;  // what to do; empty when all is well
};

constexpr double kGigabyte = 1e9;
// A live run needs 0.4 GB, the bake of a large body 2 GB.
constexpr double kLiveMemory = 0.5 * kGigabyte, kBakeMemory = 2 * kGigabyte;
// A film of ten seconds with its files takes 0.3 GB.
constexpr double kDisk = 0.5 * kGigabyte;

Finding check_opengl() {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) { return {"OpenGL", "none", Verdict::kBlocks, context.problem().message}; }
  return {"OpenGL", context.value().description(), Verdict::kGood, ""};
}

Finding check_window() {
  if (has_screen()) return {"screen", "there is one: --window works", Verdict::kGood, ""};
  return {"screen", "none", Verdict::kLimits,
          "live writes a film with --out DIR; for --window set DISPLAY (xvfb-run makes a screen)"};
}

Finding check_processor() {
  const std::string set = row_kernels().front().name;
  const std::string state = fmt::format("{}, vector instructions {}", processor_name(), set);
  if (set == "plain") {
    return {"processor", state, Verdict::kLimits,
            "without SSE4 or NEON the loop runs at a fraction of a camera's rate"};
  }
  return {"processor", state, Verdict::kGood, ""};
}

Finding check_camera(const ListedCamera& camera) {
  constexpr double kTrial = 3;  // s; the rate of a camera in dim light is known after two
  const std::string what = "camera " + camera.info.path;
  if (!camera.trouble.empty()) {
    return {what, camera.trouble, Verdict::kLimits,
            "sudo usermod -aG video $USER and log in again, if it is a matter of rights; palpable "
            "cameras says more"};
  }
  if (camera.kind == CameraKind::kUnreadable) {
    return {what, camera.info.name + ": no picture format that can be read", Verdict::kLimits,
            "record a folder with its maker's program (docs/camera.md)"};
  }
  const CameraTrial trial = try_camera(linux_video(), camera, kTrial);
  const std::string wrong = what_is_wrong_with(trial);
  std::string state = fmt::format("{}, {}x{} {}", camera.info.name, trial.width, trial.height,
                                  trial.format.empty() ? "does not start" : trial.format);
  if (!wrong.empty()) return {what, state, Verdict::kLimits, wrong};
  return {what, state, Verdict::kGood, ""};
}

std::vector<Finding> check_cameras() {
  const std::vector<ListedCamera> cameras = list_cameras(linux_video(), calibration_folders());
  std::vector<Finding> findings;
  for (const ListedCamera& camera : cameras) {
    if (!camera.is_data) findings.push_back(check_camera(camera));
  }
  if (findings.empty()) {
    return {{"cameras", "none: there is no /dev/video*", Verdict::kLimits,
             "plug one in (a container needs it passed on, a ZED Mini a USB 3 port), or play "
             "--source synthetic, a folder "
             "of images or a video file"}};
  }
  return findings;
}

// What `palpable-bake about` prints. Nothing if the program is missing or does not run.
std::optional<Json> about_bake(const fs::path& program) {
  Result<ChildProcess> child = ChildProcess::start(program, {"about"});
  if (!child.ok()) return std::nullopt;
  constexpr double kLongest = 10;  // s; a program that says nothing for so long does not run
  std::string text;
  std::array<std::byte, 4096> room{};
  while (const auto count = child.value().receive(room, kLongest)) {
    if (*count == 0) return std::nullopt;
    for (std::size_t i = 0; i < *count; ++i) text.push_back(static_cast<char>(room.at(i)));
  }
  const Result<Json> facts = Json::parse(text);
  return facts.ok() ? std::optional(facts.value()) : std::nullopt;
}

Finding check_bake() {
  const fs::path program = sibling_program(kBakeProgram);
  const std::optional<Json> facts = about_bake(program);
  if (!facts || !facts->contains("blas_is_thread_safe")) {
    return {"bake", fmt::format("{} does not run", program.string()), Verdict::kLimits,
            "bodies that are baked can be pressed; to bake some, install the package "
            "palpable-bake"};
  }
  const std::string state =
      fmt::format("{}, {} with kernels for {}", program.string(),
                  (*facts)["blas"].get<std::string>(), (*facts)["blas_kernels"].get<std::string>());
  if (!(*facts)["blas_is_thread_safe"].get<bool>()) {
    return {"bake", state, Verdict::kLimits,
            "this BLAS is the serial build, whose results are wrong in threads: install "
            "libopenblas0-pthread, and choose it with update-alternatives --config "
            "libopenblas.so.0-x86_64-linux-gnu"};
  }
  return {"bake", state, Verdict::kGood, ""};
}

Finding check_memory() {
  const std::optional<double> free = available_memory();
  if (!free) return {"memory", "the system does not say", Verdict::kGood, ""};
  const std::string state = fmt::format("{:.1f} GB free", *free / kGigabyte);
  if (*free < kLiveMemory) {
    return {"memory", state, Verdict::kBlocks, "a live run needs 0.5 GB: close other programs"};
  }
  if (*free < kBakeMemory) {
    return {"memory", state, Verdict::kLimits,
            "enough for live; the bake of a large body takes 2 GB (palpable bake --estimate)"};
  }
  return {"memory", state, Verdict::kGood, ""};
}

Finding check_disk() {
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const fs::space_info space = fs::space(here, error);
  if (error) return {"disk", error.message(), Verdict::kLimits, "go to a folder that exists"};
  const bool writable = ::access(here.c_str(), W_OK) == 0;
  const double free = static_cast<double>(space.available);
  const std::string state = fmt::format("{:.1f} GB free in {}", free / kGigabyte, here.string());
  if (!writable) {
    return {"disk", state + ", which is read-only", Verdict::kLimits,
            "give --out a folder that you may write to"};
  }
  if (free < kDisk) {
    return {"disk", state, Verdict::kLimits, "a film of ten seconds takes 0.3 GB: make room"};
  }
  return {"disk", state, Verdict::kGood, ""};
}

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "ok";
    case Verdict::kLimits:
      return "limited";
    case Verdict::kBlocks:
      break;
  }
  return "missing";
}

// Plays the built-in desk with the body that ships, off screen, for up to five seconds.
Finding check_loop() {
  constexpr double kLongest = 5;    // s
  constexpr int kFilmFrames = 120;  // filmed in some 10 s by two slow cores
  constexpr double kSlow = 15;      // frames/s; below it a touch visibly lags
  const auto failed = [](const std::string& why, const std::string& remedy) {
    return Finding{"loop", "not tried: " + why, Verdict::kLimits, remedy};
  };
  fs::path file;
  try {
    file = shipped_body();
  } catch (const Error&) {
    return failed("no body ships with this copy of palpable",
                  "live needs the name of a body file: bake one, or install the package palpable, "
                  "which has one");
  }
  LiveOptions live;
  live.body = file;
  live.clip = clip_cache(file);
  live.clip += "-short";
  live.clip_frames = kFilmFrames;
  share_drawing_threads(live.threads);
  LiveSetUp setup = set_up_live(live);
  ScenePainter painter({.masks = false}, setup.run.loop);
  LiveLoop loop(setup.run);
  DrawnFrame drawn;
  int frames = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::chrono::duration<double> taken{0};
  while (Scene* scene = taken.count() < kLongest ? loop.next() : nullptr) {
    std::swap(drawn.scene, *scene);
    painter.draw(drawn, setup.run.loop.session);
    ++frames;
    taken = std::chrono::steady_clock::now() - begin;
  }
  const double rate = frames / taken.count();
  Finding finding{"loop",
                  fmt::format("{:.0f} frames a second ({} frames of {} in {:.1f} s)", rate, frames,
                              file.filename().string(), taken.count()),
                  Verdict::kGood, ""};
  if (rate < kSlow) {
    finding.verdict = Verdict::kLimits;
    finding.remedy =
        "close other programs; a smaller --size of the camera is faster, and so is a graphics "
        "card with OpenGL 4.5";
  }
  return finding;
}

void print_findings(const std::vector<Finding>& findings, bool json) {
  if (!json) {
    for (const Finding& finding : findings) {
      print_text("{:<8} {:<12} {}\n", word_of(finding.verdict), finding.what, finding.state);
      if (!finding.remedy.empty()) print_text("{:<21} -> {}\n", "", finding.remedy);
    }
    return;
  }
  Json list = Json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"what", finding.what},
                    {"state", finding.state},
                    {"verdict", word_of(finding.verdict)},
                    {"remedy", finding.remedy}});
  }
  print_json({{"version", PALPABLE_VERSION}, {"findings", std::move(list)}});
}

void doctor(bool json) {
  std::vector<Finding> findings{check_processor(), check_memory(), check_disk(), check_opengl(),
                                check_window()};
  for (Finding& camera : check_cameras()) findings.push_back(std::move(camera));
  findings.push_back(check_bake());
  // What live would not run without.
  std::string missing;
  for (const Finding& finding : findings) {
    if (finding.verdict == Verdict::kBlocks)
      missing += (missing.empty() ? "" : ", ") + finding.what;
  }
  if (missing.empty()) {
    try {
      findings.push_back(check_loop());
    } catch (const Error& error) {
      missing = "loop";
      findings.push_back({missing, error.what(), Verdict::kBlocks, "this is what live would say"});
    }
  }
  print_findings(findings, json);
  if (!missing.empty()) throw Error("palpable live would not run here: " + missing);
}

}  // namespace

void add_doctor(Command app) {
  auto json = std::make_shared<bool>(false);
  Command command =
      app.add_subcommand("doctor", "What this machine has and lacks, and what to do about it");
  command.add_json(*json);
  command.footer(
      "Looks at processor, memory, disk, OpenGL, screen and palpable-bake, reads pictures from "
      "each "
      "camera for three seconds, and plays the built-in desk for five, which it films first. The "
      "exit code is 1 if palpable live "
      "BODY would not run here.\n"
      "Example: palpable doctor");
  command.callback([json] { doctor(*json); });
}

}  // namespace palpable::app
