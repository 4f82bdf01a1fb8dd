// palpable view: a body in a window, turned and pressed by the mouse; or pictures of it in a
// folder.

#include "apps/common/command_line.h"
#include "apps/palpable/body_view.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/view_controls.h"
#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/orbit_camera.h"
#include "palpable/render/picture_file.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/render/studio.h"
#include "palpable/render/window.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  fs::path body;
  fs::path out;
  int site = -1;  // -1: not asked for
  double level = 1.0;
  std::vector<std::string> set;  // NAME=VALUE
  std::string size = "1280x720";
  double close_after = 0;  // s; 0: when the user wants
};

struct Size {
  int width = 0;
  int height = 0;
};

Size read_size(const std::string& text) {
  Size size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 ||
      std::min(size.width, size.height) < 64 || std::max(size.width, size.height) > 8192) {
    throw Error(
        fmt::format("--size {}: wants WIDTHxHEIGHT from 64 to 8192, for example 1280x720", text));
  }
  return size;
}

constexpr double kViewAngle = 0.55;  // rad, vertical

/// Where to stand to see the whole body from its broad side.
OrbitCamera usual_camera(const ReducedBody& body, double aspect) {
  const Eigen::Matrix3Xd& x = body.surface.vertices;
  const Eigen::Vector3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  OrbitCamera camera;
  camera.target = 0.5 * (low + high);
  double radius = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    radius = std::max(radius, (x.col(i) - camera.target).norm());
  }
  camera.distance = 1.12 * radius / std::sin(0.5 * kViewAngle * std::min(aspect, 1.0));
  // The horizontal direction in which it extends least is the one to look along.
  const Eigen::Matrix2Xd flat = x.topRows<2>().colwise() - camera.target.head<2>();
  const Eigen::Matrix2d spread = flat * flat.transpose();
  const double longest = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
  camera.azimuth = std::remainder(longest + 0.45, 2.0 * std::acos(-1.0));
  camera.elevation = 0.32;
  return camera;
}

/// The same from the side of a site, somewhat beside its load so that the dent has a profile.
OrbitCamera camera_towards(const Site& site, OrbitCamera camera) {
  const Eigen::Vector2d outwards = -site.direction.head<2>();
  if (outwards.norm() > 0.3) camera.azimuth = std::atan2(outwards.x(), -outwards.y()) + 0.75;
  return camera;
}

/// Draws a body in the studio. Needs a current context.
class StudioScene {
 public:
  StudioScene(const ReducedBody& body, Size size)
      : body_(body),
        pressed_(body),
        studio_(value_or_throw(Studio::make())),
        renderer_(value_or_throw(SceneRenderer::make())),
        dot_radius_(static_cast<float>(0.014 * body.surface.vertices.row(2).maxCoeff())) {
    resize(size);
  }

  void resize(Size size) {
    view_.camera = camera_of_view(size.width, size.height, kViewAngle);
    studio_is_old_ = true;
  }

  PressedBody& pressed() { return pressed_; }
  bool sites_shown = false;
  bool legend_shown = true;
  std::vector<std::string> caption;

  const ColorImage& draw(const OrbitCamera& orbit) {
    const Rigid3 camera_from_body = orbit.camera_from_body();
    if (studio_is_old_ || !camera_from_body.isApprox(camera_from_body_, 0.0)) {
      studio_.draw(view_.camera, camera_from_body, background_);
      camera_from_body_ = camera_from_body;
      studio_is_old_ = false;
    }
    view_.background = &background_;
    BodyLook look = pressed_.look();
    look.camera_from_body = camera_from_body;
    dots_.clear();
    if (sites_shown) {
      pressed_.site_dots(dot_radius_, dots_);
      look.marks = pressed_.patch_marks();
    }
    if (pressed_.level() > 0) pressed_.load_dots(dot_radius_, dots_);
    look.dots = dots_;
    view_.bodies.assign(1, look);
    view_.brightness = 1.12f;  // a studio is lit better than a room
    view_.legend_title = legend_shown ? "von Mises stress" : "";
    view_.caption = caption;
    renderer_.draw(view_, picture_, nullptr, &depth_);
    return picture_;
  }

  /// The point of the body that the last picture shows at a pixel, if it shows the body there.
  [[nodiscard]] std::optional<Eigen::Vector3d> point_at(double x_px, double y_px) const {
    const int x = static_cast<int>(std::lround(x_px)), y = static_cast<int>(std::lround(y_px));
    if (x < 0 || x >= depth_.width() || y < 0 || y >= depth_.height()) return std::nullopt;
    const float z = depth_(x, y);
    if (std::isnan(z)) return std::nullopt;
    return camera_from_body_.inverse() * view_.camera.unproject(x_px, y_px, z);
  }

  [[nodiscard]] std::string title() const {
    return fmt::format("{}   {} vertices, {} sites", body_.name, body_.surface.vertex_count(),
                       body_.sites.size());
  }
  [[nodiscard]] std::string reading() const {
    return fmt::format(
        "site {}   level {:.2f}   force {:.2f} N   depth {:.1f} mm   largest stress {:.1f} kPa",
        pressed_.site(), pressed_.level(), pressed_.force(), 1e3 * pressed_.press_depth(),
        1e-3 * pressed_.largest_von_mises());
  }

 private:
  const ReducedBody& body_;
  PressedBody pressed_;
  Studio studio_;
  SceneRenderer renderer_;
  float dot_radius_;
  SceneView view_;
  ColorImage background_, picture_;
  DepthImage depth_;
  Rigid3 camera_from_body_ = Rigid3::Identity();
  bool studio_is_old_ = true;
  std::vector<Dot> dots_;
};

/// One of the pictures that `--out` writes.
struct Shot {
  std::string file;
  OrbitCamera camera;
  bool sites = false;
  int site = 0;
  double level = 0;
};

std::vector<Shot> shots_of(const ReducedBody& body, const ViewOptions& options, double aspect) {
  const OrbitCamera usual = usual_camera(body, aspect);
  OrbitCamera other_side = usual;
  other_side.azimuth += std::acos(-1.0);
  std::vector<Shot> shots{{"1_at_rest", usual}, {"2_sites", usual, true}};
  const auto press = [&](int site, double level) {
    const Site& at = body.sites[static_cast<std::size_t>(site)];
    shots.push_back(
        {fmt::format("{}_press_site_{}_level_{:.0f}", shots.size() + 1, site, 100 * level),
         camera_towards(at, usual), false, site, level});
  };
  if (options.site >= 0) {
    for (const double share : {1.0 / 3.0, 2.0 / 3.0, 1.0})
      press(options.site, share * options.level);
  } else {
    for (const int site : sites_to_show(body, 3)) press(site, options.level);
  }
  shots.push_back({fmt::format("{}_sites_from_behind", shots.size() + 1), other_side, true});
  return shots;
}

/// Copies a picture into a larger one.
void paste(const ColorImage& from, int x, int y, ColorImage& to) {
  for (int row = 0; row < from.height(); ++row) {
    std::copy_n(from.row(row), from.width(), to.row(y + row) + x);
  }
}

void write_pictures(const ReducedBody& body, const ViewOptions& options, Size size,
                    const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(fmt::format("cannot make {}: {}", folder.string(), failed.message()));
  const GlContext context = value_or_throw(GlContext::offscreen());
  StudioScene scene(body, size);
  const double aspect = static_cast<double>(size.width) / size.height;
  const std::vector<Shot> shots = shots_of(body, options, aspect);

  const auto draw = [&](const Shot& shot) -> const ColorImage& {
    scene.pressed().press(shot.site, shot.level);
    scene.sites_shown = shot.sites;
    scene.legend_shown = shot.level > 0;
    scene.caption = {shot.level > 0 ? scene.reading() : scene.title()};
    return scene.draw(shot.camera);
  };
  for (const Shot& shot : shots) {
    const fs::path file = folder / (shot.file + ".png");
    write_png(file, draw(shot));
    fmt::print("{}\n", file.string());
  }

  constexpr int kColumns = 3, kGap = 8;
  const Size cell{size.width / 2, size.height / 2};
  const int rows = (static_cast<int>(shots.size()) + kColumns - 1) / kColumns;
  ColorImage sheet(kColumns * (cell.width + kGap) + kGap, rows * (cell.height + kGap) + kGap,
                   {255, 255, 255});
  scene.resize(cell);
  for (int i = 0; i < static_cast<int>(shots.size()); ++i) {
    paste(draw(shots[static_cast<std::size_t>(i)]), kGap + i % kColumns * (cell.width + kGap),
          kGap + i / kColumns * (cell.height + kGap), sheet);
  }
  const fs::path file = folder / "contact_sheet.png";
  write_png(file, sheet);
  fmt::print("{}\n", file.string());
  if (context.errors().count() > 0) {
    throw Error(fmt::format("OpenGL reported {} errors, the first: {}", context.errors().count(),
                            context.errors().first()));
  }
}

void show_window(Window& window, const ReducedBody& body, const ViewOptions& options, Size size) {
  StudioScene scene(body, size);
  const double aspect = static_cast<double>(size.width) / size.height;
  ViewControls controls(usual_camera(body, aspect));
  if (options.site >= 0) {
    controls.keep(options.site, options.level);
    controls.camera =
        camera_towards(body.sites[static_cast<std::size_t>(options.site)], controls.camera);
  }
  const auto opened = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - opened).count();
  };
  const auto site_at = [&](double x_px, double y_px) -> std::optional<int> {
    const auto point = scene.point_at(x_px, y_px);
    if (!point) return std::nullopt;
    return scene.pressed().nearest_site(*point);
  };
  int pictures = 0;
  bool changed = true;
  while (!controls.quit && !window.closed()) {
    const bool busy = changed || controls.moving(now());
    for (const WindowEvent& event : window.events(busy ? 0.0 : 0.05)) {
      controls.handle(event, now(), site_at);
      changed = true;
    }
    if (options.close_after > 0 && now() > options.close_after) controls.quit = true;
    const double level = controls.level(now());
    if (!changed && level == scene.pressed().level()) continue;
    scene.pressed().press(controls.site(), level);
    scene.sites_shown = controls.sites_shown;
    scene.legend_shown = controls.legend_shown && level > 0;
    scene.caption = {level > 0 ? scene.reading() : scene.title()};
    if (controls.help_shown) {
      scene.caption.insert(scene.caption.end(), ViewControls::help().begin(),
                           ViewControls::help().end());
    }
    const ColorImage& picture = scene.draw(controls.camera);
    window.show(picture);
    changed = false;
    if (controls.picture_wanted) {
      controls.picture_wanted = false;
      const fs::path file = fmt::format("{}_view_{}.png", body.name, ++pictures);
      write_png(file, picture);
      fmt::print("{}\n", file.string());
    }
  }
  if (window.gl_errors().count() > 0) {
    throw Error(fmt::format("OpenGL reported {} errors, the first: {}", window.gl_errors().count(),
                            window.gl_errors().first()));
  }
}

void run_view(const ViewOptions& options) {
  const Size size = read_size(options.size);
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.body, parse_settings(options.set)));
  const int site_count = static_cast<int>(body.sites.size());
  if (options.site >= site_count) {
    throw Error(fmt::format("--site {}: {} has the sites 0 to {}", options.site,
                            options.body.string(), site_count - 1));
  }
  if (!options.out.empty()) {
    write_pictures(body, options, size, options.out);
    return;
  }
  Result<Window> window =
      Window::open(fmt::format("{} - Palpable", body.name), size.width, size.height);
  if (window.ok()) {
    show_window(window.value(), body, options, size);
    return;
  }
  const fs::path folder = options.body.stem().string() + "_view";
  fmt::print(stderr, "{}; pictures go to {} instead\n", window.problem().message, folder.string());
  write_pictures(body, options, size, folder);
}

}  // namespace

void add_view(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* view = app.add_subcommand("view", "Turn a body and press it with the mouse");
  view->add_option("BODY", options->body, "A body file (.palpable)")->required();
  view->add_option("--out", options->out,
                   "Write pictures into this folder instead of opening a window");
  view->add_option("--site", options->site, "Press this site")->check(CLI::NonNegativeNumber);
  view->add_option("--level", options->level, "How hard, 0 to 1 of the site's full load")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  add_set_option(*view, options->set);
  view->add_option("--size", options->size, "Pixels of window and pictures, WIDTHxHEIGHT")
      ->capture_default_str();
  view->add_option("--close-after", options->close_after, "Close the window after so many seconds")
      ->check(CLI::PositiveNumber);
  view->footer(
      "Without a display, pictures are written into NAME_view.\n"
      "Example: palpable view bunny.palpable\n"
      "         palpable view bunny.palpable --out pictures --site 4 --level 0.8");
  view->callback([options] { run_view(*options); });
}

}  // namespace palpable::app
