#include "palpable/bake/exchange/method_page.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("the chart of methods and its table say the same", "[exchange][pages]") {
  MethodPage page{
      .title = "t", .lead = "l", .displacement = {}, .stress = {}, .provenance = {}, .footer = "f"};
  page.displacement.push_back({.name = "pgd, 3 factors",
                               .modes = {1, 2},
                               .columns = {1, 2},
                               .bytes = {400, 800},
                               .pooled = {0.5, 0.25},
                               .median = {0.4, 0.125},
                               .worst = {0.9, 0.75}});
  page.displacement.push_back({.name = "ball.palpable (per-site)",
                               .is_body = true,
                               .modes = {3},
                               .columns = {18},
                               .bytes = {7200},
                               .pooled = {0.0625},
                               .median = {0.03125},
                               .worst = {0.5}});
  CHECK(method_table(page) ==
        "field,method,source,modes,columns,bytes,error_all_together,error_median,error_worst\n"
        "displacement,\"pgd, 3 factors\",method,1,1,400,0.5,0.4,0.9\n"
        "displacement,\"pgd, 3 factors\",method,2,2,800,0.25,0.125,0.75\n"
        "displacement,ball.palpable (per-site),body,3,18,7200,0.0625,0.03125,0.5\n");
  const std::string text = method_page(page);
  CHECK_THAT(text, Contains(R"("name":"pgd, 3 factors","source":"method","modes":[1,2])") &&
                       Contains(R"("pooled":[0.5,0.25])") &&
                       Contains(R"("source":"body","modes":[3],"columns":[18])"));
  CHECK_THAT(text, !Contains(R"("stress":)"));  // no line, no chart
  CHECK(
      method_text(page) ==
      "displacement\n"
      "                                      modes  in all         MB all together    median     "
      "worst\n"
      "  pgd, 3 factors                          2       2       0.00         0.25      0.12      "
      "0.75\n"
      "  ball.palpable (per-site)                3      18       0.01        0.062     0.031       "
      "0.5\n");
}

}  // namespace
}  // namespace palpable
