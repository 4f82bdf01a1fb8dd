#include "palpable/live/live_writer/live_output.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/own_files.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/live/render/picture_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kInFlight = 4;
constexpr double kDefaultRate = 30;  // 1/s, of a clip of one frame
constexpr std::array kStages{"read",       "rectify", "disparity", "depth", "map",  "track",
                             "background", "contact", "evaluate",  "draw",  "write"};
constexpr std::chrono::seconds kFlushEvery(1);
constexpr double kDeepEnough = 0.004;  // m
// The line of touches.jsonl for the touches on one body of a scene.
// @param names  of the bodies; empty if there is only one
TouchesLine felt_in(const FrameLines& scene, int body, const std::vector<std::string>& names) {
  TouchesLine felt{.frame = scene.number, .touches = {}};
  for (const Touch& touch : scene.touches) {
    if (touch.body != body) continue;
    FeltTouch& entry = felt.touches.emplace_back();
    entry.press_depth = touch.press_depth;
    entry.force = touch.force * touch.direction;
    entry.point = touch.point_in_body;
    if (!touch.friction.isZero(0)) entry.friction = touch.friction;
    if (touch.coefficient > 0) entry.friction_coefficient = touch.coefficient;
    entry.mean_motion = touch.way_is_mean;
    if (touch.left_out > 0) entry.left_out = touch.left_out;
    entry.time = scene.time;
    if (touch.site >= 0) {
      entry.site = touch.site;
      entry.level = touch.level;
    } else {
      entry.area = touch.area;
      entry.assumed = touch.assumed;
      if (touch.by >= 0) entry.by = names[static_cast<std::size_t>(touch.by)];
    }
    const auto thing = static_cast<std::size_t>(touch.thing);
    if (touch.thing >= 0 && thing < scene.things.size()) entry.thing = scene.things[thing];
  }
  if (const auto& error = scene.bodies[static_cast<std::size_t>(body)].stated_error) {
    felt.displacement_error = error->displacement;
    felt.stress_error = error->von_mises;
  }
  return felt;
}

// Copies what FrameLines has of a scene and reuses the memory of `lines`.
void copy_lines(const Scene& scene, FrameLines& lines) {
  lines.number = scene.number;
  lines.time = scene.time;
  lines.touches = scene.touches;
  lines.things = scene.things;
  lines.answer = scene.answer;
  lines.bodies.resize(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    lines.bodies[k] = {scene.bodies[k].camera_from_body, scene.bodies[k].stated_error};
  }
  lines.camera = scene.camera;
  lines.row_correction_px = scene.seen.row_correction_px;
  lines.row_error_px = scene.seen.row_error_px;
  lines.times = scene.times;
}

constexpr std::array kFigureNames{"hand_nearer.png", "body_nearer.png", "touch.png"};
constexpr const char* kPictures = "pictures";
constexpr std::string_view kTimingBegin = "frame,";  // the first bytes of a run's timing.csv
// All files of a run (base/own_files.h). The two that identify a run's output are first.
constexpr std::array<std::string_view, 20> kOutputs{
    "timing.csv",       "live.json",      "touches.jsonl",       "trajectory.txt",
    "pose.jsonl",       "touch.mp4",      "depth/#.png",         "visible/#.png",
    "body_depth/#.png", "moving/#.png",   "rectification.jsonl", kFigureNames[0],
    kFigureNames[1],    kFigureNames[2],  "touch.mp4.part",      "meshes/#.ply",
    "meshes/rest.ply",  "meshes/*/#.ply", "meshes/*/rest.ply",   "pictures/#.png"};

// The files and folders of a run that are directly in its folder, each once, as far as they exist.
// @throws Error where a folder has the name of a file of a run, or the other way round
std::vector<fs::path> outputs_in(const fs::path& folder) {
  std::vector<fs::path> there;
  for (const std::string_view output : kOutputs) {
    const std::size_t slash = output.find('/');
    const fs::path path = folder / output.substr(0, slash);
    std::error_code ignored;  // a dangling link counts as existing
    if (!fs::exists(fs::symlink_status(path, ignored))) continue;
    if (std::find(there.begin(), there.end(), path) != there.end()) continue;
    const bool is_folder = fs::is_directory(path, ignored);
    if (is_folder && fs::is_symlink(path, ignored)) {
      throw Error(fmt::format(
          "{}: is a link to a folder, whose files may be somebody's; write into another folder",
          path.string()));
    }
    if (is_folder != (slash != std::string_view::npos)) {
      throw Error(fmt::format("{}: is a {} and in the way of this run's; write into another folder",
                              path.string(), is_folder ? "folder" : "file"));
    }
    there.push_back(path);
  }
  return there;
}

// Whether a run wrote the folder's files: it has a run's timing.csv, or, where the text files were
// not wanted, the summary of a run. A run that was killed immediately leaves timing.csv empty.
bool is_of_run(const fs::path& folder) {
  constexpr std::size_t kBegin = 1 << 16;  // B, much longer than the summary's part with this key
  const auto begin_of = [](const fs::path& file) -> std::optional<std::string> {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    std::string begin(kBegin, '\0');
    in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    begin.resize(static_cast<std::size_t>(in.gcount()));
    return begin;
  };
  const auto timing = begin_of(folder / "timing.csv");
  if (timing) return timing->empty() || timing->starts_with(kTimingBegin);
  const auto summary = begin_of(folder / "live.json");
  return summary && summary->find("\"video_codec\"") != std::string::npos;
}

}  // namespace

std::optional<std::vector<int>> truly_touching_frames(const fs::path& images) {
  const fs::path truth = fs::absolute(images).lexically_normal() / ".." / "truth" / "contact.jsonl";
  if (!fs::is_regular_file(truth.lexically_normal())) return std::nullopt;
  std::vector<int> frames;
  for (const ContactLine& contact : read_contacts(truth.lexically_normal())) {
    if (contact.touching && contact.depth >= kDeepEnough) frames.push_back(contact.frame);
  }
  return frames;
}

bool holds_earlier_run(const fs::path& folder, bool overwrite,
                       const std::vector<fs::path>& needed) {
  refuse_among_inputs(folder, needed);
  const std::vector<fs::path> there = outputs_in(folder);
  if (there.empty()) return false;
  // A folder depth/ alone may be a user's data, and so may one beside a timing.csv that is not a
  // run's.
  if (!is_of_run(folder)) {
    throw Error(
        fmt::format("{}: is in the way and not of an earlier run; write into another folder",
                    there.front().string()));
  }
  if (!overwrite) {
    throw Error(
        fmt::format("{}: holds an earlier run; give another --out, or --overwrite to replace it",
                    folder.string()));
  }
  for (const fs::path& input : needed) {
    if (input.empty()) continue;
    const auto holds = [&](const fs::path& path) { return lies_in(input, path); };
    if (std::none_of(there.begin(), there.end(), holds)) continue;
    throw Error(
        fmt::format("{}: is needed by this run and would be overwritten with {}; write into "
                    "another folder",
                    input.string(), folder.string()));
  }
  return true;
}

// What identifies a run's output is removed last, so that an interrupted removal can be repeated.
void remove_earlier_run(const fs::path& folder) { remove_own_files(folder, kOutputs); }

LiveOutput::Texts::Texts(const fs::path& folder, bool has_camera)
    : timing(folder / "timing.csv"), touches(folder / "touches.jsonl") {
  if (has_camera) of_camera.emplace(folder);
}

LiveOutput::Texts::OfCamera::OfCamera(const fs::path& folder)
    : trajectory(folder / "trajectory.txt"),
      poses(folder / "pose.jsonl"),
      corrections(folder / "rectification.jsonl") {
  trajectory.write(kTrajectoryRemark);
}

void LiveOutput::Texts::flush() {
  for (TextFile* file : {&timing, &touches}) file->flush();
  if (!of_camera) return;
  for (TextFile* file : {&of_camera->trajectory, &of_camera->poses, &of_camera->corrections}) {
    file->flush();
  }
}

void LiveOutput::Texts::close() {
  for (TextFile* file : {&timing, &touches}) file->close();
  if (!of_camera) return;
  for (TextFile* file : {&of_camera->trajectory, &of_camera->poses, &of_camera->corrections}) {
    file->close();
  }
}

LiveOutput::LiveOutput(const LiveOutputSettings& settings)
    : settings_(settings), ready_(kLines), free_lines_(kLines), free_(kInFlight) {
  const fs::path& folder = settings_.folder;
  make_folder(folder);
  // First: output without timing.csv, or live.json at the end, is not recognized as a run's.
  if (settings_.files.data) texts_.emplace(folder, settings_.has_camera);
  if (settings_.all_pictures || !settings_.kept_pictures.empty()) make_folder(folder / kPictures);
  if (settings_.files.depth) make_folder(folder / "depth");
  if (settings_.files.masks) {
    make_folder(folder / "visible");
    make_folder(folder / "body_depth");
    make_folder(folder / "moving");
  }
  for (const SurfaceMesh& rest : settings_.meshes_of) {
    const fs::path meshes = meshes_folder(drawn_.size());
    make_folder(meshes);
    drawn_.push_back({rest, Eigen::VectorXd::Zero(rest.vertex_count())});
    write_valued_ply(meshes / "rest.ply", drawn_.back(), kVonMisesProperty);
  }
  for (const char* stage : kStages) times_.emplace_back(stage, std::vector<double>());
  times_.emplace_back("total", std::vector<double>());
  std::vector<std::string> stages;
  for (const auto& [stage, values] : times_) stages.push_back(stage);
  if (texts_) texts_->timing.write(timing_header(stages));
  for (std::size_t i = 0; i < kInFlight; ++i) free_.push(std::make_unique<DrawnFrame>());
  if (!settings_.complete) spare_ = std::make_unique<DrawnFrame>();
  constexpr std::size_t kUsualTouches = 8;
  for (std::size_t i = 0; i < kLines; ++i) {
    auto lines = std::make_unique<Written>();
    lines->lines.touches.reserve(kUsualTouches);
    lines->lines.bodies.reserve(std::max<std::size_t>(settings_.bodies.size(), 1));
    free_lines_.push(std::move(lines));
  }
  thread_ = std::thread([this] { run(); });
}

LiveOutput::~LiveOutput() {
  close_queues();
  if (thread_.joinable()) thread_.join();
}

void LiveOutput::close_queues() {
  ready_.close();
  free_lines_.close();
  free_.close();
}

std::unique_ptr<DrawnFrame> LiveOutput::blank() {
  constexpr std::chrono::seconds kNow(0);
  std::optional<std::unique_ptr<DrawnFrame>> frame =
      settings_.complete ? free_.pop() : free_.pop_within(kNow);
  if (!frame && (settings_.complete || free_.closed())) {  // the thread has failed
    finish();
    throw Error("the output was ended");
  }
  std::unique_ptr<DrawnFrame> blank = std::move(frame ? *frame : spare_);
  blank->in_files = frame.has_value();
  return blank;
}

void LiveOutput::write(std::unique_ptr<DrawnFrame> frame) {
  constexpr std::chrono::seconds kNow(0);
  std::optional<std::unique_ptr<Written>> written = free_lines_.pop_within(kNow);
  if (!frame->in_files || !written) ++left_out_;
  const bool circulates = frame->in_files;
  if (written) {
    copy_lines(frame->scene, (*written)->lines);
    if (circulates) (*written)->drawn = std::move(frame);
    if (!ready_.push(std::move(*written))) finish();
  } else {
    ++lines_left_out_;
  }
  if (!frame) return;
  // The thread returns a frame before its lines, so that one of the four may have come here while
  // all lines are in use.
  if (circulates) {
    free_.push(std::move(frame));
  } else {
    spare_ = std::move(frame);
  }
}

void LiveOutput::finish() {
  ready_.close();
  if (thread_.joinable()) thread_.join();
  rethrow();
}

void LiveOutput::rethrow() {
  if (trouble_) std::rethrow_exception(std::exchange(trouble_, nullptr));
}

void LiveOutput::run() {
  try {
    flush();
    while (!ready_.drained()) {
      // Frames are written to the disk also while the source delivers none.
      if (std::optional<std::unique_ptr<Written>> frame = ready_.pop_within(kFlushEvery)) {
        write_frame(**frame);
        if ((*frame)->drawn) free_.push(std::move((*frame)->drawn));
        free_lines_.push(std::move(*frame));
      }
      if (std::chrono::steady_clock::now() - flushed_ >= kFlushEvery) flush();
    }
    end_files();
  } catch (...) {
    trouble_ = std::current_exception();
    close_queues();
  }
}

void LiveOutput::write_frame(Written& frame) {
  {
    const StageTimer timer(frame.lines.times, "write");
    if (frame.drawn) write_pictures(*frame.drawn);
    if (texts_) write_lines(frame.lines);
  }
  std::vector<double> row;
  double total = 0;
  for (auto& [stage, values] : times_) {
    const double ms = stage == "total" ? total : frame.lines.times.ms(stage);
    total += ms;
    values.push_back(ms);
    row.push_back(ms);
  }
  if (texts_) texts_->timing.write(timing_line(frame.lines.number, row));
}

void LiveOutput::write_pictures(const DrawnFrame& frame) {
  if (settings_.files.depth) write_depth(frame);
  if (settings_.files.masks) write_masks(frame);
  write_meshes(frame.scene);
  if (settings_.files.film) write_video(frame);
  write_picture(frame);
  keep_if_best(frame);
}

void LiveOutput::write_lines(const FrameLines& scene) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    TouchesLine felt = felt_in(scene, static_cast<int>(k), settings_.bodies);
    if (felt.touches.empty()) continue;
    felt.body = name_of(k);
    felt.answer = text_of(scene.answer);
    texts_->touches.write(touches_line(felt));
  }
  if (texts_->of_camera) write_camera_lines(scene, *texts_->of_camera);
}

void LiveOutput::write_camera_lines(const FrameLines& scene, Texts::OfCamera& texts) {
  if (scene.camera.state != TrackState::kLost) {  // a fixed camera has a constant pose
    texts.trajectory.write(
        trajectory_line({settings_.starts_at + scene.time, scene.camera.world_from_camera}));
  }
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    texts.poses.write(pose_line({scene.number, scene.bodies[k].camera_from_body, name_of(k)}));
  }
  const double correction = scene.row_correction_px;
  if (last_correction_ != correction) {
    last_correction_ = correction;
    std::optional<double> error;
    if (!std::isnan(scene.row_error_px)) error = scene.row_error_px;
    texts.corrections.write(correction_line({scene.number, correction, error}));
  }
}

void LiveOutput::write_depth(const DrawnFrame& frame) {
  const Scene& scene = frame.scene;
  depth_written_.push_back(
      write_measured_depth(settings_.folder / "depth" / frame_name(scene.number, ".png"),
                           scene.seen.depth, scene.seen.too_close));
}

void LiveOutput::write_masks(const DrawnFrame& frame) {
  const std::string name = frame_name(frame.scene.number, ".png");
  write_mask(settings_.folder / "visible" / name, frame.visible);
  write_body_depth(settings_.folder / "body_depth" / name, frame.body_depth);
  const MaskImage& moving = frame.scene.moving;
  if (!moving.empty()) write_mask(settings_.folder / "moving" / name, moving);
}

// Empty if there is only one body.
std::string LiveOutput::name_of(std::size_t body) const {
  return body < settings_.bodies.size() ? settings_.bodies[body] : std::string();
}

fs::path LiveOutput::meshes_folder(std::size_t body) const {
  return settings_.folder / "meshes" / name_of(body);
}

void LiveOutput::write_meshes(const Scene& scene) {
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    const SceneBody& body = scene.bodies[k];
    drawn_[k].surface.vertices = body.vertices.cast<double>();
    drawn_[k].values =
        Eigen::Map<const Eigen::VectorXf>(body.von_mises.data(), std::ssize(body.von_mises))
            .cast<double>();
    write_valued_ply(meshes_folder(k) / frame_name(scene.number, ".ply"), drawn_[k],
                     kVonMisesProperty);
  }
}

void LiveOutput::flush() {
  if (texts_) texts_->flush();
  if (video_) video_->flush();
  flushed_ = std::chrono::steady_clock::now();
}

void LiveOutput::open_video(const ColorImage& picture, double frames_per_second) {
  video_ = std::make_unique<VideoFileWriter>(settings_.folder / "touch.mp4", picture.width(),
                                             picture.height(), frames_per_second);
  codec_ = video_->codec();
}

void LiveOutput::write_video(const DrawnFrame& frame) {
  const Scene& scene = frame.scene;
  // With `complete` every frame is in the film, one after the other; gaps of the numbers do not
  // count.
  const int after = settings_.complete ? 1 : std::max(scene.number - last_number_, 1);
  last_number_ = scene.number;
  ++written_;
  if (written_ == 1) {
    first_picture_ = frame.picture;
    first_time_ = scene.time;
    return;
  }
  if (written_ == 2) {
    const double step = (scene.time - first_time_) / after;
    open_video(frame.picture, step > 1e-3 ? std::clamp(1 / step, 1.0, 240.0) : kDefaultRate);
    video_->append(first_picture_);
  }
  video_->append(frame.picture, after);
}

void LiveOutput::write_picture(const DrawnFrame& frame) {
  const std::vector<int>& kept = settings_.kept_pictures;
  if (!settings_.all_pictures &&
      !std::binary_search(kept.begin(), kept.end(), frame.scene.number)) {
    return;
  }
  write_png(settings_.folder / kPictures / fmt::format("{:06}.png", frame.scene.number),
            frame.picture);
}

void LiveOutput::keep_if_best(const DrawnFrame& frame) {
  if (!settings_.files.stills) return;
  const std::optional<std::vector<int>>& touching = settings_.touch_frames;
  const bool may_touch =
      !touching || std::binary_search(touching->begin(), touching->end(), frame.scene.number);
  const std::array scores{frame.scores.hand_nearer, frame.scores.body_nearer,
                          may_touch ? frame.scores.touch : 0.0};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] > best_score_[i]) {
      best_score_[i] = scores[i];
      best_[i] = frame.picture;
    }
  }
}

void LiveOutput::end_files() {
  if (written_ == 1) {
    open_video(first_picture_, kDefaultRate);
    video_->append(first_picture_);
  }
  if (video_) video_->close();
  if (texts_) texts_->close();
  for (std::size_t i = 0; i < best_.size(); ++i) {
    if (best_score_[i] <= 0) continue;
    write_png(settings_.folder / kFigureNames[i], best_[i]);
    figures_.emplace_back(kFigureNames[i]);
  }
}

}  // namespace palpable
