#include "palpable/live/calibrate/factory_calibration.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <clocale>
#include <string>

namespace palpable {
namespace {

using test::ScratchFolder;
using test::write_bytes;

std::string eye(const std::string& name, double scale) {
  const auto number = [&](double value) { return std::to_string(scale * value); };
  return "[" + name + "]\r\nfx=" + number(700) + "\r\nfy = " + number(701) + "\ncx=" + number(640) +
         "\ncy=" + number(360) + "\nk1=-0.17\nk2=0.027\np1=-3.1e-05\np2=0.0001\nk3=0\n\n";
}

const std::string kConf =
    eye("LEFT_CAM_FHD", 1.5) + eye("RIGHT_CAM_FHD", 1.5) + eye("LEFT_CAM_HD", 1) +
    eye("RIGHT_CAM_HD", 0.999) +
    "[STEREO]\nBaseline=63.5\nTY=0.5\nTZ=-0.25\nCV_FHD=0.02\nRX_FHD=0\nRZ_FHD=0\n"
    "CV_HD=0.02\nRX_HD=0.003\nRZ_HD=-0.001\n";

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("a factory file gives the rig of the size that is asked for", "[calibrate]") {
  const ScratchFolder folder("factory");
  const auto path = folder / "SN1.conf";
  write_bytes(path, kConf);
  const StereoRig rig = value_or_throw(read_factory_calibration(path, 1280, 720)).rig;
  CHECK(rig.left ==
        DistortedCamera{{1280, 720, 700, 701, 640, 360}, {-0.17, 0.027, -3.1e-05, 0.0001, 0}});
  CHECK(rig.right.pinhole.fx_px == Approx(699.3));
  CHECK(rig.right_from_left.translation().isApprox(Eigen::Vector3d(-0.0635, 0.0005, -0.00025)));
  const Eigen::AngleAxisd turn(rig.right_from_left.linear());
  CHECK((turn.angle() * turn.axis()).isApprox(Eigen::Vector3d(0.003, 0.02, -0.001), 1e-9));
  CHECK(value_or_throw(read_factory_calibration(path, 1920, 1080)).rig.left.pinhole.fx_px == 1050);
  CHECK(value_or_throw(read_factory_calibration(path, 0, 0)).rig.left.pinhole.width == 1280);

  // The sign differs between the vendor's own files.
  std::string negative = kConf;
  negative.replace(negative.find("=63.5"), 5, "=-63.5");
  write_bytes(path, negative);
  CHECK(value_or_throw(read_factory_calibration(path, 1280, 720))
            .rig.right_from_left.translation()
            .x() == -0.0635);
}

TEST_CASE("a factory file is read the same under a locale with decimal commas", "[calibrate]") {
  const ScratchFolder folder("factory_locale");
  write_bytes(folder / "SN1.conf", kConf);
  const std::string before = std::setlocale(LC_ALL, nullptr);
  // If none is installed, the file is read under the default locale.
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  const auto calibration = read_factory_calibration(folder / "SN1.conf", 1280, 720);
  std::setlocale(LC_ALL, before.c_str());
  CHECK(value_or_throw(calibration).rig.left.distortion[0] == -0.17);
}

TEST_CASE("a factory file that cannot be used says why", "[calibrate][refusal]") {
  const ScratchFolder folder("factory_refusals");
  const auto path = folder / "SN1.conf";
  const auto refusal = [&](const std::string& bytes, int width = 1280, int height = 720) {
    write_bytes(path, bytes);
    const auto result = read_factory_calibration(path, width, height);
    REQUIRE_FALSE(result.ok());
    CHECK(contains(result.problem().message, path.string()));
    CHECK(result.problem().message.find('\n') == std::string::npos);
    return result.problem().message;
  };
  CHECK_FALSE(read_factory_calibration(folder / "none.conf", 0, 0).ok());
  CHECK(contains(refusal(""), "no factory calibration"));
  CHECK(contains(refusal(std::string(1000, '\0')), "no factory calibration"));
  CHECK(contains(refusal(kConf, 672, 376), "1280 x 720, 1920 x 1080 px, not for 672 x 376"));
  std::string broken = kConf;
  broken.replace(broken.find("RX_HD=0.003"), 11, "RX_HD=zero!");
  CHECK(contains(refusal(broken), "no number STEREO.RX_HD"));
  broken = kConf;
  broken.replace(broken.find("=63.5"), 5, "=63500");
  CHECK(contains(refusal(broken), "63.5 m apart"));
}

}  // namespace
}  // namespace palpable
