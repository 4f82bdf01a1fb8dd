#include "palpable/live/live_page/live_page.h"

#include "tests/support/allocations.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

using test::ScratchFolder;

void write_bundle(const ScratchFolder& folder) {
  test::write_bytes(folder / "index.html",
                    "<html>/*palpable:page*/<!-- palpable:scripts --></html>");
  for (const char* name : {"page.js", "page-classic.js", "palpable.wasm"}) {
    test::write_bytes(folder / name, name);
  }
}

LivePageBody triangle() {
  return {.event = {.name = "body", .vertices = 3, .triangles = 1},
          .material = "rubber",
          .corners = Eigen::Vector3i(0, 1, 2)};
}

Scene scene_of_triangle() {
  Scene scene;
  SceneBody& body = scene.bodies.emplace_back();
  body.vertices = body.normals = Eigen::Matrix3Xf::Zero(3, 3);
  body.von_mises = {1, 2, 3};
  return scene;
}

TEST_CASE("while no page is open, a frame costs no memory, and no picture is wanted",
          "[live_page]") {
  const ScratchFolder folder("live_page");
  write_bundle(folder);
  LivePage page(LivePageSettings{0, folder.path()});
  page.begin({triangle()}, {.has_picture = true});
  CHECK_THAT(page.url(), Catch::StartsWith("http://127.0.0.1:") && Catch::EndsWith("/"));
  const Scene scene = scene_of_triangle();
  const ColorImage picture(640, 360);
  const std::vector<Touch> touches(2);
  CHECK_FALSE(page.wants_picture());
  CHECK(test::allocations_during([&] {
          page.send(scene);
          page.send(3, 1, 0.5, touches);
          page.send_picture(picture);
        }) == 0);
  CHECK_THAT(page.text(), Catch::StartsWith("page: 0 clients, 0 refused"));
}

TEST_CASE("a run without a page has no address, and sends nothing", "[live_page]") {
  LivePage none(std::nullopt);
  none.begin({triangle()}, {});
  none.send(scene_of_triangle());
  none.send_at_rest(scene_of_triangle());
  CHECK_FALSE(none.is_served());
  CHECK_FALSE(none.wants_picture());
  CHECK(none.url().empty());
  CHECK(none.text().empty());
}

TEST_CASE("each run has an address of its own", "[live_page]") {
  const ScratchFolder folder("live_page");
  write_bundle(folder);
  const LivePage one(LivePageSettings{0, folder.path()}), other(LivePageSettings{0, folder.path()});
  CHECK(one.url().substr(one.url().size() - 33) != other.url().substr(other.url().size() - 33));
}

TEST_CASE("a page that was not built names the option and the command that builds it",
          "[live_page]") {
  const ScratchFolder folder("live_page");
  CHECK_THROWS_WITH(LivePage(LivePageSettings{0, folder / "none"}),
                    Catch::StartsWith("--serve: ") && Catch::Contains("web/build.sh"));
}

}  // namespace
}  // namespace palpable
