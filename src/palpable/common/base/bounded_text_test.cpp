#include "palpable/common/base/bounded_text.h"

#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using test::repeated;

TEST_CASE("real texts may be parsed", "[base][bounded_text]") {
  const auto may = [](const std::string& text, Notation notation) {
    INFO(text);
    CHECK_FALSE(why_not_parsed(text, notation));
  };
  // Each text has more brackets, dots or quotes than the limit, but they are not nested.
  may("a = [" + repeated("0.5, ", 500) + "1.5]\n" + repeated("[[t]]\nx = {a.b = 1}\n", 200),
      Notation::kToml);
  may(repeated("s = \"[[[[{{{{ a.b.c.d.e\\\" [[[[\" # [[[[[[[ ]]]]\n", 100), Notation::kToml);
  may("s = '''" + repeated("[\n", 100) + "'''\n", Notation::kToml);
  may(R"({"a": [)" + repeated(R"({"b": [1, "[[[[{{{{\"[["]},)", 100) + "0]}", Notation::kJson);
  may("%YAML:1.0\n---\n# " + std::string(70, '-') +
          "\ncalibration_time: \"Tue 10 Feb 12:20:01 [CET]\"\n" +
          repeated("K1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                   "   data: [ 1.5e-05, -2.,\n       0., 1. ]\n",
                   200),
      Notation::kYaml);
  may("<?xml version=\"1.0\"?><!-- <a><a> --><a b='>'>" +
          repeated("<b c=\"1\"/><d>1 2<![CDATA[<a>]]></d>", 200) + "</a>",
      Notation::kXml);
}

TEST_CASE("a text that is nested too deep is refused with its line, before a parser sees it",
          "[base][bounded_text]") {
  const auto refused = [](const std::string& text, Notation notation, std::size_t line) {
    INFO(text.substr(0, 60));
    const auto why = why_not_parsed(text, notation);
    REQUIRE(why);
    CHECK(why->line == line);
    CHECK(why->what == "nested more than 64 deep, which is not read");
  };
  const int deep = 60'000;
  refused("\n\na = " + repeated("[", deep), Notation::kToml, 3);
  refused("a = 1\n" + repeated("a.", deep) + "a = 1", Notation::kToml, 2);
  refused("a = 1\n[" + repeated("'a' . ", deep) + "a]", Notation::kToml, 2);
  refused(repeated("{a=", deep), Notation::kToml, 1);
  refused("a = [\n" + repeated("{x.y = [\n", 40), Notation::kToml, 23);
  refused("\n" + repeated("[", deep), Notation::kJson, 2);
  refused(repeated("{\"a\":\n", deep), Notation::kJson, 65);
  refused("%YAML:1.0\nK1: " + repeated("[", deep), Notation::kYaml, 2);
  refused("%YAML:1.0\nK1: [" + repeated(" \"]\", [", deep), Notation::kYaml, 2);
  refused("%YAML:1.0\n" + repeated("a: ", deep), Notation::kYaml, 2);
  refused("%YAML:1.0\n" + repeated("- ", deep), Notation::kYaml, 2);
  {
    std::string ladder = "%YAML:1.0\n";
    for (int i = 0; i < 300; ++i) ladder += std::string(i, ' ') + "a:\n";
    refused(ladder, Notation::kYaml, 66);
  }
  refused("<a>\n" + repeated("<a>", deep), Notation::kXml, 2);
  refused(repeated("<a b='/>'>\n", deep), Notation::kXml, 65);
}

TEST_CASE("the text of a file is read whole, or the file is named", "[base][bounded_text]") {
  const test::ScratchFolder folder("bounded_text");
  test::write_bytes(folder / "a.toml", "a = 1\r\n");
  CHECK(value_or_throw(read_bounded_text(folder / "a.toml", Notation::kToml)) == "a = 1\n");
  const auto problem = [&](const char* file, Notation notation) {
    return read_bounded_text(folder / file, notation).problem().message;
  };
  test::write_bytes(folder / "deep.json", "1\n" + std::string(100, '['));
  CHECK_THAT(problem("deep.json", Notation::kJson), Catch::EndsWith("deep.json: line 2: nested "
                                                                    "more than 64 deep, which is "
                                                                    "not read"));
  test::write_bytes(folder / "long.yml", std::string(2'500'000, ' '));
  CHECK_THAT(problem("long.yml", Notation::kYaml),
             Catch::Contains("long.yml: 2.5 MB, where 1 are read at most; is it"));
  CHECK_THAT(problem("none.yml", Notation::kYaml), Catch::EndsWith("none.yml: no such file"));
  CHECK_THAT(problem(".", Notation::kYaml), Catch::EndsWith(": is a folder, not a file"));
  test::write_bytes(folder / "wide.toml", std::string("\xff\xfe"
                                                      "a\0=\0",
                                                      6));
  CHECK_THAT(problem("wide.toml", Notation::kToml), Catch::EndsWith("is UTF-16: save it as UTF-8"));
}

}  // namespace
}  // namespace palpable
