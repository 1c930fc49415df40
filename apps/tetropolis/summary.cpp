#include "summary.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "options.h"

namespace tetropolis::app {

namespace {

/// "1,666,811".
std::string grouped(std::int64_t count) {
  std::string text = std::to_string(count);
  for (std::ptrdiff_t at = std::ssize(text) - 3; at > (count < 0 ? 1 : 0); at -= 3)
    text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

std::string counted(std::int64_t count, const char* one, const char* several) {
  return grouped(count) + ' ' + (count == 1 ? one : several);
}

std::string path_of(const Report& report, std::string_view name) {
  const std::string& out = report.config.out;
  return fmt::format("{}{}{}", out, out.ends_with('/') ? "" : "/", name);
}

bool has_file(const Report& report, std::string_view name) {
  return std::find(report.files.begin(), report.files.end(), name) != report.files.end();
}

/// "282 m x 249 m at 52.0121 N, 4.3591 E (Netherlands)".
std::string where(const Report& report) {
  const Bounds2& box = report.domain;
  const WindDomainFacts domain = report.city ? report.city->domain : WindDomainFacts{};
  const bool is_fitted = !domain.inlet.empty() || domain.radius > 0;
  return fmt::format("{:.0f} m x {:.0f} m{}", is_fitted ? domain.length : box.width(),
                     is_fitted ? domain.width : box.height(),
                     report.place ? " at " + place_text(*report.place) : ", of unknown place");
}

/// What became of all footprints: one line.
std::string account(const Report& report) {
  if (const std::string line = account_line(report); !line.empty()) return with_options(line);
  const auto dropped = std::ssize(report.city->dropped);
  return dropped == 0 ? ""
                      : fmt::format("{} left out; city.dropped in {} says why",
                                    counted(dropped, "footprint is", "footprints are"),
                                    path_of(report, "report.json"));
}

std::string what_to_open(const Report& report) {
  std::string text;
  const auto add = [&](std::string_view name, const char* program) {
    if (has_file(report, name))
      text += fmt::format("{}{} in {}", text.empty() ? "Open " : ", or ", path_of(report, name),
                          program);
  };
  add("index.html", "a browser");
  if (report.volume_mesh)
    add(has_file(report, "surface.vtp") ? "surface.vtp" : "boundary.vtp", "ParaView");
  else
    add("buildings.gpkg", "QGIS");
  return text;
}

void say_synth(const Report& report, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("Invented {} and {} points, {}",
                              counted(report.input->footprints_read, "footprint", "footprints"),
                              grouped(report.input->points_kept), where(report)));
  for (const char* footprints : {"footprints.shp", "footprints.geojson"})
    if (has_file(report, footprints))
      lines.push_back(fmt::format("Next: tetropolis build {} {} RESULT",
                                  path_of(report, footprints), report.config.out));
}

std::string cells_of(const VolumeMeshFacts& mesh) {
  const std::int64_t prisms = mesh.prisms.cells, tets = mesh.cells - prisms;
  if (prisms == 0) return grouped(tets) + " tetrahedra";
  if (tets == 0) return grouped(prisms) + " prisms";
  return grouped(tets) + " tetrahedra and " + grouped(prisms) + " prisms";
}

void say_city(const Report& report, std::vector<std::string>& lines) {
  const CityFacts& city = *report.city;
  std::string source;
  if (report.input)
    source = fmt::format(
        " from {} of {}",
        grouped(report.input->footprint_parts - std::ssize(city.dropped) - city.account.unlisted),
        counted(report.input->footprint_parts, "footprint", "footprints"));
  lines.push_back(fmt::format("Built {}{}, {}", counted(city.buildings, "building", "buildings"),
                              source, where(report)));
  if (report.volume_mesh)
    lines.push_back(fmt::format("Meshed the air around: {}, up to elevation {:.0f} m",
                                cells_of(*report.volume_mesh), report.volume_mesh->top));
  if (const std::string line = account(report); !line.empty()) lines.push_back(line);
}

void say_quality(const Report& report, std::vector<std::string>& lines) {
  if (const auto& mesh = report.volume_mesh; mesh && mesh->prisms.cells > 0)
    lines.push_back(
        fmt::format("prisms     non-orthogonality at most {:.1f}, mean {:.1f} degrees; skewness at "
                    "most {:.2f}, "
                    "aspect ratio {:.1f}",
                    mesh->prisms.max_non_orthogonality_deg, mesh->prisms.mean_non_orthogonality_deg,
                    mesh->prisms.max_skewness, mesh->prisms.max_aspect_ratio));
  if (report.volume_mesh && report.volume_mesh->cells > report.volume_mesh->prisms.cells)
    lines.push_back(fmt::format(
        "cells      dihedral angles {:.1f} .. {:.1f} degrees, median of least {:.1f}; {} inverted",
        report.volume_mesh->dihedral_min, report.volume_mesh->dihedral_max,
        report.volume_mesh->dihedral_median, report.volume_mesh->inverted));
  if (report.ground_mesh)
    lines.push_back(fmt::format("ground     {} triangles, least angle {:.1f} degrees",
                                grouped(report.ground_mesh->triangles),
                                report.ground_mesh->min_angle_deg));
  if (report.surface_mesh)
    lines.push_back(
        fmt::format("boundary   {} faces, {}, {}",
                    grouped(report.surface_mesh->triangles + report.surface_mesh->quads),
                    report.surface_mesh->closed ? "closed" : "open",
                    report.surface_mesh->manifold ? "manifold" : "not manifold"));
  if (report.city && std::isfinite(report.city->min_clearance))
    lines.push_back(
        fmt::format("clearance  {:.3f} m between outlines", report.city->min_clearance));
}

}  // namespace

std::vector<std::string> summary(const Report& report) {
  std::vector<std::string> lines;
  if (report.command == "synth" && report.input) say_synth(report, lines);
  if (report.city) say_city(report, lines);
  if (const std::string line = what_to_open(report); !line.empty()) lines.push_back(line);
  for (const Warning& warning : report.warnings)
    lines.push_back(fmt::format("note       {}: {}", warning.code, with_options(warning.message)));
  say_quality(report, lines);
  double seconds = 0;
  for (const StepTime& step : report.steps) seconds += step.seconds;
  lines.push_back(fmt::format("done       {:.1f} s, {:.0f} MB at most; results in {}", seconds,
                              static_cast<double>(report.peak_rss_bytes) / 1e6, report.config.out));
  return lines;
}

}  // namespace tetropolis::app
