#include "apps/palpable/shared_options.h"

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/play/run_options.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/view/show_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace palpable::app {
namespace {

bool is_depth_size(const std::string& word) {
  return std::find(kDepthSizes.begin(), kDepthSizes.end(), word) != kDepthSizes.end();
}

}  // namespace

std::string depth_size(const SourceOptions& options) {
  return is_depth_size(options.depth) ? options.depth : "";
}

void add_source_options(Command command, SourceOptions& options, SourceKind kind) {
  command.add_option(
      "--right", options.right,
      "The right eye's camera, video, image or images by name; the source is then the left's");
  if (kind == SourceKind::kAny) {
    command
        .add_option(
            "--depth", options.depth,
            "Of stereo: the size at which pairs are matched. half: refined at full size, best for "
            "what is near; full: finer outlines, in 3 to 6 times the time; auto: full for pictures "
            "up to 640 px wide, else half (docs/depth.md). Default: half. Else the depth camera, "
            "or depth images by name: from where the source looks, "
            "or from where intrinsics.txt says")
        .type_name("half|full|auto|DEVICE|IMAGES");
    command
        .add_option("--farthest", options.farthest,
                    "Depths beyond are taken for unknown, m. A street wants more than a desk")
        .in_range(0.2, 1000.0);
    command.add_option(
        "--calibration", options.calibration,
        "OpenCV YAML, a ZED's SN*.conf or intrinsics.txt. Default: what lies beside the "
        "images, or what palpable calibrate has kept of the camera");
  }
  command
      .add_option(
          "--size", options.size,
          "For a camera: size of its picture, of both eyes together if they are side by side")
      .type_name("WIDTHxHEIGHT");
  command.add_option("--fps", options.frames_per_second, "For a camera: pictures a second")
      .in_range(0.1, 1000.0);
  command.add_option("--exposure", options.exposure_ms, "For a camera: a fixed exposure, ms")
      .in_range(0.01, 10000.0);
  command.add_option("--gain", options.gain, "For a camera: a fixed gain, in its own unit")
      .in_range(0.0, 1e6);
  command.add_flag(
      "--lock-exposure", options.lock_exposure,
      "For a camera: after a second, keep exposure, gain and white balance as they are");
}

CameraRequest request_of(const SourceOptions& options) {
  CameraRequest request;
  request.device = options.source;
  request.right = options.right;
  if (!is_depth_size(options.depth)) request.depth = options.depth;
  request.calibration = options.calibration;
  request.folders = calibration_folders();
  if (!options.size.empty()) {
    const auto sides = parse_extent(options.size);
    if (!sides) throw Error(fmt::format("--size {}: should be like 2560x720", options.size));
    request.width = (*sides)[0];
    request.height = (*sides)[1];
  }
  request.frames_per_second = options.frames_per_second;
  if (options.exposure_ms > 0) request.exposure_ms = options.exposure_ms;
  if (options.gain >= 0) request.gain = options.gain;
  request.lock = options.lock_exposure;
  return request;
}

std::vector<std::filesystem::path> inputs_of(const SourceOptions& options) {
  std::vector<std::filesystem::path> inputs;
  const std::string depth = is_depth_size(options.depth) ? "" : options.depth;
  for (const std::filesystem::path& input :
       {std::filesystem::path(options.source), std::filesystem::path(options.right),
        std::filesystem::path(depth), options.calibration}) {
    if (input.empty()) continue;
    inputs.push_back(is_pattern(input) ? std::filesystem::absolute(input).parent_path() : input);
  }
  return inputs;
}

void add_board_options(Command command, BoardOptions& options) {
  command.add_option("--board", options.corners, "Inner corners of the chessboard")
      .type_name("COLUMNSxROWS")
      .show_default();
  command.add_option("--square", options.square_mm, "Side of one of its squares, mm")
      .in_range(0.1, 10000.0)
      .show_default();
}

BoardPattern pattern_of(const BoardOptions& options) {
  const auto sides = parse_extent(options.corners).value_or(std::array{0, 0});
  if (*std::min_element(sides.begin(), sides.end()) < 3 ||
      *std::max_element(sides.begin(), sides.end()) > 100) {
    throw Error(
        fmt::format("--board {}: should be like 9x6, the board's inner corners", options.corners));
  }
  BoardPattern pattern;
  pattern.columns = sides[0];
  pattern.rows = sides[1];
  pattern.square = 1e-3 * options.square_mm;
  return pattern;
}

void add_paint_option(Command command, std::string& paint) {
  std::vector<std::string> names;
  for (const NamedPaint& known : kPaints) names.emplace_back(known.name);
  command
      .add_option("--paint", paint,
                  "What is painted on bodies: stress (von Mises), pressure (above 0 where it is "
                  "compressed), sxx ... szx: a component of the Cauchy stress along the body's own "
                  "axes, z up (above 0 where it is pulled), contact (how hard things press the "
                  "skin), displacement, or none: the material alone")
      .one_of(names)
      .show_default();
}

std::vector<PlacedLoad> parse_loads(const ReducedBody& body,
                                    const std::vector<std::string>& texts) {
  std::vector<PlacedLoad> loads;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const auto place = to_numbers(std::string_view(text).substr(0, equals));
    const auto force = to_numbers(std::string_view(text).substr(equals + (equals < text.size())));
    if (!place || place->size() != 3 || !force || force->size() != 1) {
      throw Error(
          fmt::format("--load {}: wants X,Y,Z=F in m and N, finite numbers such as "
                      "0,0.02,0.05=1.5",
                      text));
    }
    const Eigen::Vector3d X((*place)[0], (*place)[1], (*place)[2]);
    const Result<PlacedLoad> load = load_at(body, X, force->front());
    if (!load.ok()) throw Error(fmt::format("--load {}: {}", text, load.problem().message));
    loads.push_back(load.value());
  }
  return loads;
}

}  // namespace palpable::app
