#include "palpable/bake/reproduce/paper_figures.h"

#include "palpable/bake/reproduce/chart.h"
#include "palpable/bake/reproduce/report_table.h"
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

// Builds one figure.
class FigureMaker {
 public:
  FigureMaker(const PaperPlan& plan, PaperFigure figure)
      : plan_(plan), out_(plan.settings().out), figure_(std::move(figure)) {}

  FigureMaker& picture(const fs::path& source, const std::string& caption) {
    const fs::path name =
        fs::path("figures") / fmt::format("{}_{}.png", figure_.number, figure_.pictures.size() + 1);
    copy(source, name);
    figure_.pictures.push_back({name, caption});
    return *this;
  }
  // Adds the picture that a run wrote of a frame of its film.
  FigureMaker& frame(const std::string& run, int number, const std::string& caption) {
    return picture(out_ / "runs" / run / "pictures" / fmt::format("{:06}.png", number), caption);
  }
  FigureMaker& charts(const std::vector<Chart>& charts, const std::string& caption) {
    const std::string stem = fmt::format("{}_{}", figure_.number, figure_.pictures.size() + 1);
    const fs::path name = fs::path("figures") / (stem + ".png");
    draw_charts(charts, out_ / name);
    figure_.pictures.push_back({name, caption});
    for (std::size_t i = 0; i < charts.size(); ++i) {
      const std::string end = charts.size() > 1 ? fmt::format("_{}", i + 1) : "";
      const fs::path table = fs::path("figures") / (stem + end + ".csv");
      write_whole_file(out_ / table, chart_table(charts[i]));
      figure_.tables.push_back(table);
    }
    return *this;
  }
  FigureMaker& table(const fs::path& source) {
    const fs::path name =
        fs::path("figures") / fmt::format("{}{}", figure_.number, source.extension().string());
    copy(source, name);
    figure_.tables.push_back(name);
    return *this;
  }
  FigureMaker& film(const std::string& run) {
    figure_.films.push_back(fs::path("runs") / run / "touch.mp4");
    return *this;
  }
  FigureMaker& by(std::initializer_list<std::string> steps) {
    for (const std::string& name : steps) {
      figure_.commands.push_back(plan_.step(name).command(plan_.settings().root));
    }
    return *this;
  }
  [[nodiscard]] PaperFigure made() const { return figure_; }

 private:
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
  PaperFigure figure_;
};

std::vector<ReportRow> report_of(const PaperPlan& plan, const std::string& body) {
  return read_report_table(plan.settings().out / "reports" / (body + ".csv"));
}

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

void add_beam_figures(const PaperPlan& plan, std::vector<PaperFigure>& figures) {
  using F = FigureFrames;
  figures.push_back(
      FigureMaker(plan,
                  {.number = "10",
                   .title = "Where the beams lie",
                   .paper = "Two cantilevers at right angles whose free ends lie above each "
                            "other; the load acts on the upper face of the upper one.",
                   .differs = "The same (scenes/crossed-beams.toml); lengths are not printed: "
                              "ours are 0.20 x 0.05 x 0.025 m, 10 mm apart."})
          .frame("beams-live", F::kBeamsAtRest, "before the hand comes")
          .by({"beams/film", "beams/live"})
          .made());
  figures.push_back(
      FigureMaker(plan, {.number = "11",
                         .title = "Modes of the beam, and their functions of the load's place",
                         .paper = "Spatial modes 1, 2, 3 and 6, by component, of a mesh of 3,381 "
                                  "nodes, and functions of the place on the upper face, 1,749 "
                                  "positions. No numbers.",
                         .differs = "One picture for all three components of a mode: the bent "
                                    "shape. 4,538 nodes on the skin, 1,612 positions (those within "
                                    "two patch radii of the clamp are left out). The load's size "
                                    "is a parameter, too."})
          .picture(plan.settings().out / "pictures" / "beam-modes" / "modes.png",
                   "modes 1 to 6, and below each its function of where the load stands")
          .table(plan.settings().out / "reports" / "beam.csv")
          .by({"beams/bake", "beams/modes", "beams/report"})
          .made());
  figures.push_back(
      FigureMaker(plan,
                  {.number = "12",
                   .title = "A finger presses the upper beam, that one the lower",
                   .paper = "Two frames of the film: the upper beam alone, then both in contact. "
                            "The lower beam takes the upper one as an obstacle.",
                   .differs = "Here both are answered together, with equal forces, at once; "
                              "`--contact paper` is one way, as printed, a level a frame."})
          .frame("beams-live", F::kBeamsPressed, "the upper one alone")
          .frame("beams-live", F::kBeamsBoth, "both")
          .frame("beams-paper", F::kBeamsBoth, "the same frame by Algorithm 1 as printed")
          .film("beams-live")
          .film("beams-paper")
          .by({"beams/film", "beams/live", "beams/paper"})
          .made());
}

void add_camera_figures(const PaperPlan& plan, std::vector<PaperFigure>& figures) {
  using F = FigureFrames;
  figures.push_back(
      FigureMaker(plan,
                  {.number = "6",
                   .title = "Trajectory and map",
                   .paper = "The path of a walking stereo camera, in blue, through the "
                            "surface that its depths add up to; tracking and fusion are the "
                            "camera maker's.",
                   .differs = "Tracking and map are this project's, on a CPU; the room is the "
                              "synthetic one, whose truth is known."})
          .frame("room-live", 449, "the room from outside after 15 s, the way through it, the body")
          .table(plan.settings().out / "runs" / "room-live" / "trajectory.txt")
          .film("room-live")
          .by({"room/film", "room/live"})
          .made());
  figures.push_back(
      FigureMaker(plan, {.number = "7",
                         .title = "Point shell against the real surface",
                         .paper = "A sketch: points on the skin of the virtual body are tested "
                                  "against the zero set of the real object's distance.",
                         .differs = "A frame instead of a sketch: the surface that the camera "
                                    "sees, its unseen side that is assumed, and the pressed skin."})
          .frame("bunny-surface", F::kFlank, "what touches the body, and the skin, from outside")
          .film("bunny-surface")
          .by({"bunny/film", "bunny/surface"})
          .made());
  figures.push_back(
      FigureMaker(plan, {.number = "8",
                         .title = "The depth that the camera measures",
                         .paper = "Picture above, contours of the distance to the camera below; "
                                  "blue is near. Range 0.2 to 15 m, 1 % to 9 % accurate, says the "
                                  "maker.",
                         .differs = "Depth is found on a CPU at half resolution; what it is worth "
                                    "at eight distances stands in docs/results.md."})
          .frame("bunny-live", F::kHandBefore, "the picture")
          .frame("bunny-depth", F::kHandBefore, "its depth")
          .film("bunny-depth")
          .by({"bunny/film", "bunny/depth"})
          .made());
  figures.push_back(
      FigureMaker(plan, {.number = "9",
                         .title = "Who hides whom",
                         .paper = "a) the hand before the body, b) the body before the hand, c) a "
                                  "press; each pixel is decided by its own depth, in a shader.",
                         .differs = "Outlines are found together, by depth, colour and motion; the "
                                    "fourth picture is the paper's test of each pixel."})
          .frame("bunny-live", F::kHandBefore, "a) hand nearer")
          .frame("bunny-live", F::kHandBehind, "b) body nearer")
          .frame("bunny-live", F::kFlank, "c) a press")
          .frame("bunny-hard", F::kHandBefore, "a) once more, pixel by pixel")
          .by({"bunny/film", "bunny/live", "bunny/hard"})
          .made());
}

struct SolidTexts {
  const char* modes_number;
  const char* frames_number;
  const char* modes_paper;
  const char* modes_differs;
  const char* frames_paper;
};

void add_modes_and_frames(const PaperPlan& plan, const std::string& name, const SolidTexts& texts,
                          std::vector<PaperFigure>& figures) {
  using F = FigureFrames;
  const std::vector<ReportRow> table = report_of(plan, name);
  const std::string bake = name + "/bake", reduce = name + "/reduce", report = name + "/report",
                    modes = name + "/modes", stress = name + "/stress-modes", film = name + "/film",
                    live = name + "/live", paper = name + "/paper", anywhere = name + "/anywhere";
  figures.push_back(
      FigureMaker(plan, {.number = texts.modes_number,
                         .title = fmt::format("Modes of the {}, and their functions", name),
                         .paper = texts.modes_paper,
                         .differs = texts.modes_differs})
          .picture(plan.settings().out / "pictures" / (name + "-modes") / "modes.png",
                   "modes 1 to 4 of displacement, and below each its value at each contact point")
          .picture(plan.settings().out / "pictures" / (name + "-stress-modes") / "modes.png",
                   "modes 1 to 4 of the stress, likewise")
          .charts(function_charts(table, "displacement"), "functions of displacement's modes")
          .charts(function_charts(table, "stress"), "functions of the stress' modes")
          .table(plan.settings().out / "reports" / (name + ".csv"))
          .by({bake, reduce, modes, stress, report})
          .made());
  const bool touch = plan.settings().touch;
  const std::string run = name + (touch ? "-anywhere" : "-live");
  FigureMaker frames(
      plan,
      {.number = texts.frames_number,
       .title = fmt::format("Four frames of the {} under a hand, with its stress", name),
       .paper = texts.frames_paper,
       .differs = touch ? "A synthetic hand, whose truth is known; touched anywhere, several "
                          "times at once, by tables of touch (docs/touch.md)."
                        : "A synthetic hand, whose truth is known. These bodies know their "
                          "contact points alone, as the paper's do: what presses between them "
                          "moves the nearest. `reproduce --touch` bakes what is touched "
                          "anywhere."});
  frames.frame(run, F::kFlank, "a flank")
      .frame(run, F::kBack, "the back")
      .frame(run, F::kEar, "an ear's root")
      .frame(run, F::kSqueeze, "finger and thumb")
      .frame(name + "-paper", F::kBack, "the second one by Algorithm 1 as printed")
      .film(run)
      .film(name + "-paper")
      .by({film, touch ? anywhere : live, paper});
  figures.push_back(frames.made());
}

void add_bunny_figures(const PaperPlan& plan, std::vector<PaperFigure>& figures) {
  const fs::path sites = plan.settings().out / "pictures" / "bunny-sites";
  figures.push_back(
      FigureMaker(plan, {.number = "2c",
                         .title = "A load on the bunny that grows",
                         .paper = "Contact as loads that grow on patches of the skin, since what "
                                  "presses has no known stiffness.",
                         .differs = "The same: 34 patches, 26 loads each, found so that the last "
                                    "one presses by a tenth of the height."})
          .picture(sites / "3_press_site_7_level_33.png", "a third of the load at one point")
          .picture(sites / "5_press_site_7_level_100.png", "all of it")
          .by({"bunny/bake", "bunny/sites"})
          .made());
  add_modes_and_frames(
      plan, "bunny",
      {"13", "16", "Modes in space, of displacement and stress; no numbers.",
       "The same three-factor PGD (space, contact point, load); modes of displacement as bent "
       "shapes, those of stress by their von Mises stress.",
       "Four frames of a desk film: a hand touches the bunny at different points."},
      figures);
  const std::vector<ReportRow> table = report_of(plan, "bunny");
  figures.push_back(
      FigureMaker(plan, {.number = "14",
                         .title = "Error against modes, bunny",
                         .paper = "L2 error of the projection; numbers can only be read off the "
                                  "plot.",
                         .differs = "All snapshots together, displacement and stress each against "
                                    "its own norm. The body that is played uses a block of modes "
                                    "for each contact point instead, far fewer at a time "
                                    "(docs/reduction.md)."})
          .charts({error_chart(table, "error_all_together", "Stanford bunny, all loads together")},
                  "as modes are added")
          .by({"bunny/reduce", "bunny/report"})
          .made());
}

void add_dragon_figures(const PaperPlan& plan, std::vector<PaperFigure>& figures) {
  add_modes_and_frames(plan, "dragon",
                       {"17", "19", "Modes in space of a mesh of 22,982 nodes; no numbers.",
                        "23,408 vertices on the skin; the interior is meshed, too (40,159 nodes).",
                        "Four frames of the same film as the bunny's: two points are touched."},
                       figures);
  const std::vector<ReportRow> table = report_of(plan, "dragon");
  figures.push_back(
      FigureMaker(plan,
                  {.number = "18",
                   .title = "Errors against modes, dragon",
                   .paper = "L2 error; the median over the places of the load; the largest of any "
                            "place and increment.",
                   .differs = "Median and maximum are over all places and increments, each field "
                              "against its own norm: small loads count as large ones do, so the "
                              "maximum stays high for long."})
          .charts({error_chart(table, "error_all_together", "all together"),
                   error_chart(table, "error_median", "median of all loads"),
                   error_chart(table, "error_worst", "the worst load")},
                  "as modes are added")
          .by({"dragon/reduce", "dragon/report"})
          .made());
}

void add_contact_points(const PaperPlan& plan, std::vector<PaperFigure>& figures) {
  FigureMaker figure(
      plan, {.number = "15",
             .title = "Contact points and their patches",
             .paper = "Bunny: 34 points, dragon: 32; loads spread over neighbours up to two edges "
                      "away.",
             .differs = "As many, chosen as farthest points. The dragon's edges are half as long "
                        "as the bunny's, so its patches reach four edges."});
  for (const std::string name : {"bunny", "dragon"}) {
    if (!plan.has(name == "bunny" ? PaperExample::kBunny : PaperExample::kDragon)) continue;
    figure.picture(plan.settings().out / "pictures" / (name + "-sites") / "2_sites.png", name)
        .by({name + "/sites"});
  }
  figures.push_back(figure.made());
}

int order_of(const std::string& number) { return std::atoi(number.c_str()); }

}  // namespace

std::vector<PaperFigure> make_figures(const PaperPlan& plan) {
  make_folder(plan.settings().out / "figures");
  std::vector<PaperFigure> figures;
  if (plan.has(PaperExample::kBeams)) add_beam_figures(plan, figures);
  if (plan.has(PaperExample::kBunny)) {
    add_bunny_figures(plan, figures);
    add_camera_figures(plan, figures);
  }
  if (plan.has(PaperExample::kDragon)) add_dragon_figures(plan, figures);
  if (plan.has(PaperExample::kBunny) || plan.has(PaperExample::kDragon)) {
    add_contact_points(plan, figures);
  }
  std::stable_sort(figures.begin(), figures.end(), [](const PaperFigure& a, const PaperFigure& b) {
    return order_of(a.number) < order_of(b.number);
  });
  return figures;
}

}  // namespace palpable
