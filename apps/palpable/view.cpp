// palpable view: a body in a window, turned and pressed by the mouse; or pictures of it in a
// folder.

#include "apps/common/command_line.h"
#include "apps/palpable/body_view.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/mode_shapes.h"
#include "apps/palpable/named_loads.h"
#include "apps/palpable/view_controls.h"
#include "palpable/base/error.h"
#include "palpable/geometry/surface_mesh.h"
#include "palpable/reduced/body_file.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/orbit_camera.h"
#include "palpable/render/picture_file.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/render/studio.h"
#include "palpable/render/window.h"

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
  std::string load;              // X,Y,Z=F instead of site and level
  int modes = 0;                 // drawn instead of presses, if above 0
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
    BodyLook look = pressed_.look();
    dots_.clear();
    if (sites_shown) {
      pressed_.site_dots(dot_radius_, dots_);
      look.marks = pressed_.patch_marks();
    }
    if (pressed_.level() > 0) pressed_.load_dots(dot_radius_, dots_);
    look.dots = dots_;
    view_.legend_title = legend_shown ? "von Mises stress" : "";
    return draw(look, orbit);
  }

  /// Another look than the pressed body's. Its colours are in mm of a displacement in m, or have no
  /// legend.
  const ColorImage& draw_other(const BodyLook& look, const std::string& legend,
                               const OrbitCamera& orbit) {
    view_.legend_title = legend;
    view_.legend_unit = "mm";
    view_.legend_scale = 1e3;
    return draw(look, orbit);
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
  const ColorImage& draw(BodyLook look, const OrbitCamera& orbit) {
    const Rigid3 camera_from_body = orbit.camera_from_body();
    if (studio_is_old_ || !camera_from_body.isApprox(camera_from_body_, 0.0)) {
      studio_.draw(view_.camera, camera_from_body, background_);
      camera_from_body_ = camera_from_body;
      studio_is_old_ = false;
    }
    view_.background = &background_;
    look.camera_from_body = camera_from_body;
    view_.bodies.assign(1, look);
    view_.brightness = 1.12f;  // a studio is lit better than a room
    view_.caption = caption;
    renderer_.draw(view_, picture_, nullptr, &depth_);
    return picture_;
  }

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

/// Pictures of one size, row by row.
ColorImage sheet_of(const std::vector<ColorImage>& cells, int columns) {
  constexpr int kGap = 8;
  const int width = cells[0].width() + kGap, height = cells[0].height() + kGap;
  const int rows = (static_cast<int>(cells.size()) + columns - 1) / columns;
  ColorImage sheet(columns * width + kGap, rows * height + kGap, {255, 255, 255});
  for (int i = 0; i < static_cast<int>(cells.size()); ++i) {
    paste(cells[static_cast<std::size_t>(i)], kGap + i % columns * width,
          kGap + i / columns * height, sheet);
  }
  return sheet;
}

void make_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(fmt::format("cannot make {}: {}", folder.string(), failed.message()));
}

void check_gl(const GlContext& context) {
  if (context.errors().count() > 0) {
    throw Error(fmt::format("OpenGL reported {} errors, the first: {}", context.errors().count(),
                            context.errors().first()));
  }
}

void write_pictures(const ReducedBody& body, const ViewOptions& options, Size size,
                    const fs::path& folder) {
  make_folder(folder);
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
  const auto written = [&](const std::string& name, const ColorImage& picture) {
    const fs::path file = folder / (name + ".png");
    write_png(file, picture);
    fmt::print("{}\n", file.string());
  };
  for (const Shot& shot : shots) written(shot.file, draw(shot));

  scene.resize({size.width / 2, size.height / 2});
  std::vector<ColorImage> cells;
  for (const Shot& shot : shots) cells.push_back(draw(shot));
  written("contact_sheet", sheet_of(cells, 3));
  check_gl(context);
}

// Modes above, functions below.
void write_modes(const ReducedBody& body, const ViewOptions& options, Size size,
                 const fs::path& folder) {
  const std::vector<ModeShape> shapes = value_or_throw(first_modes(body, options.modes));
  make_folder(folder);
  const GlContext context = value_or_throw(GlContext::offscreen());
  StudioScene scene(body, {size.width / 2, size.height / 2});
  const OrbitCamera usual = usual_camera(body, static_cast<double>(size.width) / size.height);
  OrbitCamera above = usual;
  above.elevation = 0.9;
  const double extent =
      (body.surface.vertices.rowwise().maxCoeff() - body.surface.vertices.rowwise().minCoeff())
          .norm();
  const Eigen::Matrix3Xf at_rest = body.surface.vertices.cast<float>();
  Eigen::Matrix3Xf vertices = at_rest, normals(3, at_rest.cols());
  const auto V = static_cast<std::size_t>(at_rest.cols());
  std::vector<float> scalar(V), marks(V);
  BodyLook look;
  look.vertices = &vertices;
  look.normals = &normals;
  look.triangles = &body.surface.triangles;
  look.scalar = scalar;
  const auto draw = [&](const std::string& legend, const OrbitCamera& camera) {
    vertex_normals(vertices, body.surface.triangles, normals);
    return scene.draw_other(look, legend, camera);
  };
  std::vector<ColorImage> cells;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ModeShape& shape = shapes[i];
    const auto u = shape.displacement.reshaped(3, at_rest.cols());
    // As large as a picture needs it: an eighth of the body.
    const double shown = shape.largest > 0 ? 0.125 * extent / shape.largest : 0.0;
    vertices = at_rest + static_cast<float>(shown) * u;
    Eigen::Map<Eigen::VectorXf>(scalar.data(), at_rest.cols()) = u.colwise().norm();
    look.scalar_max = static_cast<float>(std::max(shape.largest, 1e-9));
    scene.caption = {fmt::format("mode {}: up to {:.3g} mm, drawn {:.2g} times as large", i + 1,
                                 1e3 * shape.largest, shown)};
    cells.push_back(draw("displacement", usual));
  }
  vertices = at_rest;
  look.marks = marks;
  look.mark_color = {150, 150, 150};
  look.scalar_max = 1;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::VectorXd values = on_skin(body, shapes[i].over_sites);
    for (std::size_t v = 0; v < V; ++v) {
      const double value = values[static_cast<Eigen::Index>(v)];
      marks[v] = std::isnan(value) ? 1.0f : 0.0f;
      scalar[v] = std::isnan(value) ? 0.0f : static_cast<float>(0.5 + 0.5 * value);
    }
    scene.caption = {
        fmt::format("function {} of the load's position, {:.2f} to {:.2f} of its "
                    "largest; dark -1, light 1, grey none",
                    i + 1, shapes[i].over_sites.minCoeff(), shapes[i].over_sites.maxCoeff())};
    cells.push_back(draw("", above));
  }
  const fs::path file = folder / "modes.png";
  write_png(file, sheet_of(cells, static_cast<int>(shapes.size())));
  fmt::print("{}\n", file.string());
  check_gl(context);
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

// --load as --site and --level.
void settle_load(const ReducedBody& body, ViewOptions& options) {
  const PlacedLoad load = parse_loads(body, {options.load})[0];
  if (load.place >= static_cast<int>(body.sites.size())) {
    throw Error(fmt::format(
        "--load {}: there the body may only be pushed back, beside a press; pictures show one "
        "press (numbers of both: palpable press)",
        options.load));
  }
  options.site = load.place;
  options.level = load.level;
}

void run_view(ViewOptions options) {
  const Size size = read_size(options.size);
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.body, parse_settings(options.set)));
  if (!options.load.empty()) settle_load(body, options);
  const int site_count = static_cast<int>(body.sites.size());
  if (options.site >= site_count) {
    throw Error(fmt::format("--site {}: {} has the sites 0 to {}", options.site,
                            options.body.string(), site_count - 1));
  }
  if (options.modes > 0) {
    write_modes(
        body, options, size,
        options.out.empty() ? fs::path(options.body.stem().string() + "_view") : options.out);
    return;
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

void add_view(Command app) {
  auto options = std::make_shared<ViewOptions>();
  Command view = app.add_subcommand("view", "Turn a body and press it with the mouse");
  view.add_option("BODY", options->body, "A body file (.palpable)").required();
  view.add_option("--out", options->out,
                  "Write pictures into this folder instead of opening a window");
  const Option site = view.add_option("--site", options->site, "Press this site").not_negative();
  const Option level =
      view.add_option("--level", options->level, "How hard, 0 to 1 of the site's full load")
          .in_range(0.0, 1.0)
          .show_default();
  const Option load =
      view.add_option(
              "--load", options->load,
              "Press with this force (N) at this point of the skin (m, body frame, at rest)")
          .type_name("X,Y,Z=F")
          .excludes(site)
          .excludes(level);
  view.add_option("--modes", options->modes,
                  "Instead: the first so many modes of displacement, and their functions of where "
                  "the load is, as modes.png in the folder of --out")
      .in_range(1, 16)
      .excludes(site)
      .excludes(level)
      .excludes(load);
  add_set_option(view, options->set);
  view.add_option("--size", options->size, "Pixels of window and pictures, WIDTHxHEIGHT")
      .show_default();
  view.add_option("--close-after", options->close_after, "Close the window after so many seconds")
      .positive();
  view.footer(
      "Without a display, pictures are written into NAME_view.\n"
      "Example: palpable view bunny.palpable\n"
      "         palpable view bunny.palpable --out pictures --site 4 --level 0.8\n"
      "         palpable view beam.palpable --out pictures --modes 4");
  view.callback([options] { run_view(*options); });
}

}  // namespace palpable::app
