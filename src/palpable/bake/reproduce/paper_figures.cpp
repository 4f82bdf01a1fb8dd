#include "palpable/bake/reproduce/paper_figures.h"

#include "palpable/bake/reproduce/chart.h"
#include "palpable/bake/reproduce/report_table.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kFunctionsShown = 4;

std::vector<ChartLine> functions(const std::vector<ReportRow>& table, const std::string& field,
                                 ChartLine (*of)(const std::vector<ReportRow>&, const std::string&,
                                                 int)) {
  std::vector<ChartLine> lines;
  for (int mode = 1; mode <= kFunctionsShown; ++mode) {
    ChartLine line = of(table, field, mode);
    if (line.x.empty()) break;
    line.name = fmt::format("mode {}", mode);
    lines.push_back(std::move(line));
  }
  return lines;
}

// Charts of a separated field, sum_i F_i(x) G_i(site) H_i(load): the factors G_i and H_i of its
// first modes.
std::vector<Chart> function_charts(const std::vector<ReportRow>& table, const std::string& field) {
  return {Chart{fmt::format("{}: functions of the contact point", field), "contact point",
                "G_i(point)", false, functions(table, field, over_sites)},
          Chart{fmt::format("{}: functions of the load", field), "share of the full load",
                "G_i(load)", false, functions(table, field, over_levels)}};
}

Chart error_chart(const std::vector<ReportRow>& table, const std::string& quantity,
                  const std::string& title) {
  return {title,
          "modes",
          "relative L2 error",
          true,
          {over_modes(table, quantity, "displacement", "displacement"),
           over_modes(table, quantity, "stress", "stress")}};
}

// Adds to one figure what entries of paper.toml say.
class FigureMaker {
 public:
  FigureMaker(const PaperPlan& plan, PaperFigure& figure)
      : plan_(plan), out_(plan.settings().out), figure_(figure) {}

  void add(PaperEntry& entry) {
    for (PaperEntry& picture : entry.entries("pictures")) add_picture(picture);
    if (const std::string source = entry.text_or_empty("table"); !source.empty()) {
      const fs::path name =
          fs::path("figures") / (figure_.number + fs::path(source).extension().string());
      copy(out_ / source, name);
      figure_.tables.push_back(name);
    }
    for (const std::string& run : entry.texts("films")) {
      figure_.films.push_back(fs::path("runs") / run / "touch.mp4");
    }
    for (const std::string& name : entry.texts("steps")) {
      figure_.commands.push_back(plan_.step(name).command(plan_.settings().root));
    }
  }

 private:
  void add_picture(PaperEntry& entry) {
    const std::string stem = fmt::format("{}_{}", figure_.number, figure_.pictures.size() + 1);
    const fs::path name = fs::path("figures") / (stem + ".png");
    if (entry.section.has("frame")) {
      // The picture that a run wrote of a frame of its film.
      copy(out_ / "runs" / entry.text("run") / "pictures" /
               fmt::format("{:06}.png", film_frame(entry.text("frame"))),
           name);
    } else if (entry.section.has("file")) {
      copy(out_ / entry.text("file"), name);
    } else {
      add_charts(charts_of(entry), stem);
    }
    figure_.pictures.push_back({name, entry.text("caption")});
    entry.section.refuse_unknown();
  }
  [[nodiscard]] std::vector<Chart> charts_of(PaperEntry& entry) const {
    const std::vector<ReportRow> table =
        read_report_table(out_ / "reports" / (entry.example + ".csv"));
    if (entry.section.has("functions")) return function_charts(table, entry.text("functions"));
    const std::vector<std::string> errors = entry.texts("errors"), titles = entry.texts("titles");
    PALPABLE_EXPECT(errors.size() == titles.size(), "each chart has its title");
    std::vector<Chart> charts;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      charts.push_back(error_chart(table, errors[i], titles[i]));
    }
    return charts;
  }
  void add_charts(const std::vector<Chart>& charts, const std::string& stem) {
    draw_charts(charts, out_ / "figures" / (stem + ".png"));
    for (std::size_t i = 0; i < charts.size(); ++i) {
      const std::string end = charts.size() > 1 ? fmt::format("_{}", i + 1) : "";
      const fs::path table = fs::path("figures") / (stem + end + ".csv");
      write_whole_file(out_ / table, chart_table(charts[i]));
      figure_.tables.push_back(table);
    }
  }
  void copy(const fs::path& source, const fs::path& name) const {
    std::error_code error;
    fs::copy_file(source, out_ / name, fs::copy_options::overwrite_existing, error);
    if (error) {
      throw Error(fmt::format("{}: is to be a picture of Figure {}: {}", source.string(),
                              figure_.number, error.message()));
    }
  }

  const PaperPlan& plan_;
  fs::path out_;
  PaperFigure& figure_;
};

// The figure of a number, which another example may have begun.
PaperFigure& figure_of(std::vector<PaperFigure>& figures, const std::string& number) {
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const PaperFigure& figure) {
    return figure.number == number;
  });
  return found != figures.end() ? *found : figures.emplace_back(PaperFigure{.number = number});
}

int order_of(const std::string& number) { return std::atoi(number.c_str()); }

}  // namespace

std::vector<PaperFigure> make_figures(const PaperPlan& plan) {
  make_folder(plan.settings().out / "figures");
  std::vector<PaperFigure> figures;
  for (PaperEntry& entry : plan.entries("figure")) {
    PaperFigure& figure = figure_of(figures, entry.text("number"));
    figure.title = entry.text("title");
    figure.paper = entry.text("paper");
    figure.differs = entry.text("differs");
    const std::string differs_touch = entry.text_or_empty("differs_touch");
    if (plan.settings().touch && !differs_touch.empty()) figure.differs = differs_touch;
    FigureMaker(plan, figure).add(entry);
    entry.section.refuse_unknown();
  }
  std::stable_sort(figures.begin(), figures.end(), [](const PaperFigure& a, const PaperFigure& b) {
    return order_of(a.number) < order_of(b.number);
  });
  return figures;
}

}  // namespace palpable
