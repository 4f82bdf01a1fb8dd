#include "palpable/desk/clip_files/truth_camera_file.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/core.h>
#include <toml++/toml.h>

#include <cmath>

namespace palpable {
namespace {

double positive_number(const toml::table& table, const char* key, const std::string& path) {
  const toml::node* node = table.get(key);
  if (node == nullptr) throw Error(fmt::format("{}: has no {}", path, key));
  const std::optional<double> value = node->value<double>();
  if (!value || !std::isfinite(*value) || *value <= 0) {
    throw Error(fmt::format("{}: line {}: {} must be a number above 0", path,
                            node->source().begin.line, key));
  }
  return *value;
}

std::optional<PinholeCamera> camera_of(const toml::table& table) {
  const auto width = table["width"].value<int>(), height = table["height"].value<int>();
  const auto fx = table["fx"].value<double>(), fy = table["fy"].value<double>();
  const auto cx = table["cx"].value<double>(), cy = table["cy"].value<double>();
  if (!width || !height || !fx || !fy || !cx || !cy) return std::nullopt;
  PinholeCamera camera;
  camera.width = *width;
  camera.height = *height;
  camera.fx_px = *fx;
  camera.fy_px = *fy;
  camera.cx_px = *cx;
  camera.cy_px = *cy;
  return camera;
}

// A TOML literal string ('''), as in all earlier files, if the name allows it, else a quoted one.
std::string file_name_text(const std::string& name) {
  const std::string quoted = quoted_text(name);
  const bool plain = quoted == '"' + name + '"' && name.find('\'') == std::string::npos;
  return plain ? "'''" + name + "'''" : quoted;
}

}  // namespace

void write_truth_camera(const std::filesystem::path& path, const TruthCamera& camera) {
  PALPABLE_EXPECT(camera.camera && camera.baseline && camera.seed, "a whole truth is written");
  const PinholeCamera& view = *camera.camera;
  TextFile file(path);
  file.write(fmt::format(
      "# The rectified left camera at half size: px; baseline in m.\n"
      "width = {}\nheight = {}\nfx = {:.12g}\nfy = {:.12g}\ncx = {:.12g}\ncy = {:.12g}\n"
      "baseline_m = {:.12g}\nfps = {}\ndepth_unit_m = {}\nsequence = {}\nseed = {}\n"
      "body = {}\n",
      view.width, view.height, view.fx_px, view.fy_px, view.cx_px, view.cy_px, *camera.baseline,
      camera.frames_per_second, camera.depth_unit, quoted_text(camera.sequence), *camera.seed,
      file_name_text(camera.body)));
  file.close();
}

TruthCamera read_truth_camera(const std::filesystem::path& file) {
  const std::string path = file.string();
  const std::string text = value_or_throw(read_bounded_text(file, Notation::kToml));
  try {
    const toml::table table = toml::parse(text, path);
    TruthCamera camera;
    camera.depth_unit = positive_number(table, "depth_unit_m", path);
    camera.frames_per_second = positive_number(table, "fps", path);
    camera.camera = camera_of(table);
    camera.baseline = table["baseline_m"].value<double>();
    camera.sequence = table["sequence"].value_or(std::string());
    camera.seed = table["seed"].value<std::uint64_t>();
    camera.body = table["body"].value_or(std::string());
    return camera;
  } catch (const toml::parse_error& error) {
    throw Error(fmt::format("{}: line {}: {}", path, error.source().begin.line,
                            std::string(error.description())));
  }
}

}  // namespace palpable
