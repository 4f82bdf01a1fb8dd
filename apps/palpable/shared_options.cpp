#include "apps/palpable/shared_options.h"

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/play/run_options.h"
#include "palpable/live/slam/room_scan.h"
#include "palpable/live/sources/depth_unit.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/view/show_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace palpable::app {
namespace {

constexpr LengthRange kFarthest{0.2, 1000.0};  // m
constexpr LengthRange kDepthUnits{kLeastDepthUnit, kLargestDepthUnit};
constexpr LengthRange kSquareSides{1e-4, 10.0};  // m

// Begins a group that in `live` is for experts.
void begin_detail_group(Command& command, const std::string& heading, SourceOptionsFor use) {
  if (use == SourceOptionsFor::kLive) {
    command.begin_expert_group(heading);
  } else {
    command.begin_group(heading);
  }
}

std::string usual_farthest(SourceOptionsFor use) {
  if (use == SourceOptionsFor::kScan) {
    return length_text(RoomScanSettings{}.slam.surface.farthest);
  }
  return length_text(kUsualFarthest) + ", more with a long baseline";
}

void add_depth_options(Command command, SourceOptions& options, SourceOptionsFor use) {
  begin_detail_group(command, "Depth", use);
  command
      .add_option("--depth-source", options.depth_source,
                  "Instead of a second eye: the depth camera, or depth images by name "
                  "(\"depth/*.png\"). It looks from where the source looks, or from where "
                  "intrinsics.txt says. auto: the depth device of the same camera")
      .type_name("DEVICE|IMAGES|auto")
      .default_is("none: stereo");
  command
      .add_length("--depth-unit", options.depth_unit,
                  "What one step of a depth image's or a depth camera's numbers is, such as 1mm, "
                  "0.2mm (5000 steps in a metre) or 0.1mm (RealSense D405)",
                  kDepthUnits)
      .default_is("as intrinsics.txt, the data set or a known camera has it, else 1mm");
  command
      .add_option("--stereo-size", options.stereo_size,
                  "The size at which stereo pairs are matched (docs/depth.md). half: refined at "
                  "full size, best for what is near; full: finer outlines, "
                  "matching takes 3 to 4 times as long; auto: full for pictures up to 640 px wide, "
                  "else half")
      .one_of({kDepthSizes.begin(), kDepthSizes.end()})
      .default_is(std::string(kDepthSizes.front()));
  command
      .add_length("--farthest", options.farthest,
                  "Depths beyond this are taken for unknown. A street needs more than a desk",
                  kFarthest)
      .default_is(usual_farthest(use));
}

void add_camera_options(Command command, SourceOptions& options, SourceOptionsFor use) {
  begin_detail_group(command, use == SourceOptionsFor::kLive ? "Camera, more" : "Camera", use);
  command
      .add_option("--size", options.size,
                  "Size of a camera's picture, of both eyes together if they are side by side")
      .type_name("WIDTHxHEIGHT")
      .default_is("the calibration's, or the camera's own");
  command
      .add_option("--fps", options.frames_per_second, "How many pictures a second a camera takes")
      .in_range(0.1, 1000.0)
      .default_is("the most that it offers");
  command.add_option("--exposure", options.exposure_ms, "A camera's fixed exposure, ms")
      .type_name("MS")
      .in_range(0.01, 10000.0)
      .default_is("automatic");
  command.add_option("--gain", options.gain, "A camera's fixed gain, in its own unit")
      .in_range(0.0, 1e6)
      .default_is("automatic");
  command.add_flag("--lock-exposure", options.lock_exposure,
                   "Keep a camera's exposure, gain and white balance as they are after a second");
}

void add_baseline_option(Command command, SourceOptions& options, SourceOptionsFor use) {
  begin_detail_group(command, use == SourceOptionsFor::kLive ? "Camera, more" : "Camera", use);
  command.add_flag("--baseline-ok", options.baseline_ok,
                   "Accept eyes that are less than 10 mm or more than 1 m apart. Without it they "
                   "are an error: such a baseline is nearly always in another unit than the metre");
}

}  // namespace

void add_source_argument(Command command, SourceOptions& options, const std::string& what) {
  command.begin_group("Input");
  command.add_option("source,-s,--source", options.source, what).type_name("SOURCE").required();
}

void add_source_options(Command command, SourceOptions& options, SourceOptionsFor use) {
  command.begin_group("Input");
  command
      .add_option("--right", options.right,
                  "The right eye's camera, video, image or images by name; the source is then the "
                  "left eye's")
      .type_name("SOURCE")
      .default_is("none: the source has both eyes");
  if (use != SourceOptionsFor::kCalibrate) {
    command.begin_group("Camera");
    command
        .add_option("--calibration", options.calibration,
                    "Calibration of the camera, a file or a folder: of OpenCV, ROS, Kalibr, "
                    "RealSense, a ZED (SN*.conf) or palpable calibrate, or intrinsics.txt")
        .default_is("what lies beside the images, or what palpable calibrate has kept");
    add_depth_options(command, options, use);
  }
  add_baseline_option(command, options, use);
  add_camera_options(command, options, use);
}

CameraRequest request_of(const SourceOptions& options) {
  CameraRequest request;
  request.device = options.source;
  request.right = options.right;
  request.depth = options.depth_source;
  request.depth_unit = options.depth_unit;
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
  if (options.baseline_ok) request.baselines = BaselineRule::kAnyPossible;
  return request;
}

std::vector<std::filesystem::path> named_inputs(const SourceOptions& options) {
  std::vector<std::filesystem::path> inputs;
  for (const std::filesystem::path& input :
       {std::filesystem::path(options.source), std::filesystem::path(options.right),
        std::filesystem::path(options.depth_source), options.calibration}) {
    if (!input.empty()) inputs.push_back(input);
  }
  return inputs;
}

std::vector<std::filesystem::path> inputs_of(const SourceOptions& options) {
  std::vector<std::filesystem::path> inputs = named_inputs(options);
  for (std::filesystem::path& input : inputs) {
    if (is_pattern(input)) input = std::filesystem::absolute(input).parent_path();
  }
  return inputs;
}

void add_board_options(Command command, BoardOptions& options, SourceOptionsFor use) {
  begin_detail_group(command, "Chessboard", use);
  command
      .add_option("--board", options.corners,
                  "Inner corners of the chessboard, those where four squares meet")
      .type_name("COLUMNSxROWS")
      .show_default();
  command.add_length("--square", options.square, "Side of one of its squares", kSquareSides);
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
  pattern.square = options.square;
  return pattern;
}

void add_paint_options(Command command, std::string& paint, std::string& colors) {
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
  command
      .add_option(
          "--colors", colors,
          "The colours of what --paint paints; all but rainbow are lighter where there is "
          "more. pressure and components of stress, which have two signs, keep blue and red")
      .one_of({kColorScaleNames.begin(), kColorScaleNames.end()})
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
