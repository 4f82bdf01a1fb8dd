#include "palpable/bake/exchange/web_page.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/output_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("the table of a page lies beside it, and never in its place", "[exchange][pages]") {
  CHECK(table_beside("out/report.html") == "out/report.csv");
  CHECK(table_beside("out.d/report") == "out.d/report.csv");
  CHECK_THROWS_WITH(table_beside("out/report.csv"),
                    "out/report.csv: is where the table goes; call the page report.html");
}

TEST_CASE("a file of the user's beside a page is not replaced", "[exchange][pages]") {
  const test::ScratchFolder folder("web_page");
  const std::filesystem::path page = folder.path() / "b.html";
  write_whole_file(folder.path() / "b.csv", "quantity,field,modes,unit\n");
  CHECK(table_beside(page) == folder.path() / "b.csv");
  write_whole_file(folder.path() / "b.csv", "my,own,measurements\n");
  CHECK_THROWS_WITH(table_beside(page), Contains("b.csv: is somebody's"));
}

TEST_CASE("a cell of a CSV file is quoted where it must be", "[exchange][pages]") {
  CHECK(csv_cell("plain text") == "plain text");
  CHECK(csv_cell("a, b") == "\"a, b\"");
  CHECK(csv_cell("say \"a\"") == "\"say \"\"a\"\"\"");
  CHECK(csv_cell("two\nlines") == "\"two\nlines\"");
}

TEST_CASE("a page holds its parts, and no text or datum can end them", "[exchange][pages]") {
  const std::string page = web_page({"<b> & \"c\"",
                                     "compare.html",
                                     {"compare.js"},
                                     {{"lead", "1 < 2 {{title}}"}, {"footer", "</main>"}},
                                     R"({"x":"</script><!-- {{data}}"})"});
  CHECK_THAT(page, Contains("<title>&lt;b&gt; &amp; &quot;c&quot;</title>") &&
                       Contains("1 &lt; 2 {{title}}") && Contains("&lt;/main&gt;"));
  CHECK_THAT(page, Contains(R"({"x":"\u003c/script>\u003c!-- {{data}}"})"));
  // The library with its licence, our scripts once each.
  CHECK_THAT(page, Contains("var uPlot=") && Contains("Permission is hereby granted") &&
                       Contains("The page that compares methods"));
  std::size_t ends = 0;
  for (std::size_t at = 0; (at = page.find("</script>", at)) != std::string::npos; ++at) ++ends;
  CHECK(ends == 2);
}

TEST_CASE("a page of parts that are not there is a mistake of ours", "[exchange][pages]") {
  CHECK_THROWS_AS(web_page({"t", "none.html", {}, {}, "{}"}), ContractViolation);
  CHECK_THROWS_AS(web_page({"t", "compare.html", {}, {}, "{}"}), ContractViolation);  // no "lead"
}

}  // namespace
}  // namespace palpable
