#include "palpable/live/page/press_page.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::file_bytes;
using test::ScratchFolder;

PageBundle small_bundle() {
  return {.html = "<html>/*palpable:page*/<!-- palpable:scripts --></html>",
          .script = "module",
          .classic = "classic",
          .core = "core"};
}

PageBody small_body(const std::string& name) {
  return {.name = name,
          .file = "bunny.palpweb",
          .bytes = "bytes",
          .material = "soft",
          .stress_top = 1500,
          .credit = std::nullopt,
          .vertices = {},
          .triangles = {}};
}

TEST_CASE("a page of one file has core, body and script in it", "[page]") {
  const std::vector<PageBody> bodies{small_body("bunny")};
  const std::string html = page_text(small_bundle(), bodies, true);
  CHECK(html.find(R"({"inline":true,"bodies":[{"name":"bunny","file":"bunny.palpweb","bytes":5,)"
                  R"("material":"soft","stressTop":1500.0}]})") != std::string::npos);
  CHECK(html.find(R"(id="palpable.wasm">Y29yZQ==</script>)") != std::string::npos);
  CHECK(html.find(R"(id="bunny.palpweb">Ynl0ZXM=</script>)") != std::string::npos);
  CHECK(html.find("<script>classic</script>") != std::string::npos);
}

TEST_CASE("a page for a server has its parts beside it", "[page]") {
  const ScratchFolder folder("page");
  const std::vector<PageBody> bodies{small_body("bunny")};
  write_page(folder / "page", small_bundle(), bodies, false);
  CHECK(file_bytes(folder / "page/palpable.wasm") == "core");
  CHECK(file_bytes(folder / "page/page.js") == "module");
  CHECK(file_bytes(folder / "page/bunny.palpweb") == "bytes");
  const std::string html = file_bytes(folder / "page/index.html");
  CHECK(html.find(R"(<script type="module" src="page.js">)") != std::string::npos);
  CHECK(html.find("Ynl0ZXM=") == std::string::npos);
}

TEST_CASE("what finds hands lies beside a page for a server, and not in a page of one file",
          "[page]") {
  const ScratchFolder folder("page");
  const std::vector<PageBody> bodies{small_body("bunny")};
  PageBundle bundle = small_bundle();
  bundle.hands = {{"files.json", "{}"}, {"hand_worker.js", "worker"}};
  write_page(folder / "served", bundle, bodies, false);
  CHECK(file_bytes(folder / "served/hands/hand_worker.js") == "worker");
  CHECK(fs::exists(folder / "served/hands/files.json"));
  write_page(folder / "alone", bundle, bodies, true);
  CHECK_FALSE(fs::exists(folder / "alone/hands"));
}

TEST_CASE("a body's name cannot end the page's script", "[page]") {
  const std::vector<PageBody> bodies{small_body("</script><!-- palpable:scripts -->")};
  const std::string html = page_text(small_bundle(), bodies, false);
  CHECK(html.find("</script><!--") == std::string::npos);
  CHECK(html.find("\\u003c/script>") != std::string::npos);
}

TEST_CASE("bodies of the same name get files that differ", "[page]") {
  std::vector<PageBody> bodies{small_body("a"), small_body("b"), small_body("c")};
  name_files_apart(bodies);
  CHECK(bodies[0].file == "bunny.palpweb");
  CHECK(bodies[1].file == "bunny-2.palpweb");
  CHECK(bodies[2].file == "bunny-3.palpweb");
}

TEST_CASE("a shape's credit is that of its description", "[page]") {
  const auto credit = credit_of({.mesh_source = "bunny.off",
                                 .credit = "Scan: A. Carver",
                                 .credit_url = "https://example.org/hare",
                                 .terms = "CC BY 4.0"});
  REQUIRE(credit.has_value());
  CHECK(credit->text == "Scan: A. Carver");
  CHECK(credit->url == "https://example.org/hare");
  CHECK(credit->terms == "(CC BY 4.0)");
  CHECK(credit_of({.credit = "me"})->terms.empty());
  CHECK(credit_of({.credit = "me", .credit_url = "javascript:alert(1)"})->url.empty());
}

TEST_CASE("bodies of before that key: Stanford's shapes carry its credit, ours none", "[page]") {
  const auto credit =
      credit_of({.mesh_source = "bunny.off, CGAL isotropic remeshing to 0.0075 m, TetGen 1.5"});
  REQUIRE(credit.has_value());
  CHECK(credit->text.find("Stanford") != std::string::npos);
  CHECK(credit->terms.find("not commercial") != std::string::npos);
  CHECK_FALSE(
      credit_of({.mesh_source = "post.off, CGAL isotropic remeshing to 0.008 m, TetGen 1.5"})
          .has_value());
}

TEST_CASE("the script of a page of one file, and the skin at rest, come before the bodies",
          "[page]") {
  std::vector<PageBody> bodies{small_body("bunny")};
  CHECK(page_text(small_bundle(), bodies, true).find("\"skin\"") == std::string::npos);
  bodies[0].vertices = {1, -2, 0.5};
  bodies[0].triangles = {7, 258, 0};
  const std::string html = page_text(small_bundle(), bodies, true);
  const std::size_t skin =
      html.find(R"("skin":{"vertices":"AACAPwAAAMAAAAA/","triangles":"BwAAAAIBAAAAAAAA"})");
  const std::size_t script = html.find("<script>classic</script>");
  REQUIRE(skin != std::string::npos);
  REQUIRE(script != std::string::npos);
  CHECK(html.find("Y29yZQ==") < script);
  CHECK(skin < script);
  CHECK(script < html.find("Ynl0ZXM="));
}

TEST_CASE("a live page holds no body, but where its session is", "[page]") {
  const std::string html = live_page_text(small_bundle(), "live");
  CHECK(html.find("{\"live\":\"live\"}") != std::string::npos);
  CHECK(html.find("src=\"page.js\"") != std::string::npos);
  CHECK(html.find(kPageScripts) == std::string::npos);
}

TEST_CASE("a bundle that was not built names the command that builds it", "[page]") {
  const ScratchFolder folder("page");
  CHECK_THROWS_WITH(read_page_bundle(folder / "none"), Catch::Contains("web/build.sh"));
  PageBundle old = small_bundle();
  old.html = "<html></html>";
  CHECK_THROWS_WITH(page_text(old, {}, true), Catch::Contains("lacks"));
}

}  // namespace
}  // namespace palpable
