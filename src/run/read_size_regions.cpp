#include "read_size_regions.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/run/report.h"

#include "options_of.h"
#include "read_areas.h"
#include "result_files.h"

namespace tetropolis {

namespace {

std::optional<double> number_of(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<Bounds2> box_of(std::string_view text) {
  std::array<double, 4> sides{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (i == 3)) return std::nullopt;
    const auto side = number_of(text.substr(0, comma));
    if (!side) return std::nullopt;
    sides[i] = *side;
    text.remove_prefix(i == 3 ? text.size() : comma + 1);
  }
  return Bounds2{sides[0], sides[1], sides[2], sides[3]};
}

GivenDomain domain_of_results(const std::filesystem::path& folder, const std::string& crs) {
  const std::filesystem::path file = folder / results::kCity;
  const CityModel city = read_city(file);
  if (city.domain.empty())
    throw Error(ErrorKind::kInput, file.string() + ": has no domain; give a polygon");
  if (!crs.empty() && !city.crs.empty() && !same_horizontal_crs(city.crs, crs))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: its domain is in {}, this city is in {}; give a polygon",
                            file.string(), crs_name(city.crs), crs_name(crs)));
  const std::optional<ReadReport> made = read_report(folder);
  const bool has_mesh = made && made->report.volume_mesh;
  return {city.domain.moved(city.origin),
          has_mesh ? made->report.volume_mesh->top : city.domain_top};
}

}  // namespace

RefineEntry parse_refine(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const auto size = colon == std::string::npos
                        ? std::nullopt
                        : number_of(std::string_view(text).substr(colon + 1));
  if (!size || !(*size > 0) || colon == 0)
    throw Error(ErrorKind::kUsage,
                fmt::format("refine: '{}': give FILE:SIZE or XMIN,YMIN,XMAX,YMAX:SIZE, a size in "
                            "metres above 0",
                            text));
  RefineEntry entry;
  entry.size = *size;
  const std::string area = text.substr(0, colon);
  if (const auto box = box_of(area)) {
    entry.box = *box;
    if (box->width() > 0 && box->height() > 0) return entry;
    throw Error(ErrorKind::kUsage,
                fmt::format("refine: '{}': the box is empty; give XMIN,YMIN,XMAX,YMAX", text));
  }
  entry.file = area;
  return entry;
}

std::vector<SizeRegion> read_size_regions(const Config& config, const CityModel& city,
                                          std::vector<Warning>& warnings) {
  std::vector<SizeRegion> regions;
  const Bounds2 domain = city.domain.bounds().moved(city.origin);
  for (const std::string& text : config.refine) {
    const RefineEntry entry = parse_refine(text);
    if (entry.file.empty()) {
      regions.push_back({rectangle(entry.box), entry.size});
      if (!entry.box.intersects(domain)) warn_of_areas_outside(text, entry.box, domain, warnings);
      continue;
    }
    FootprintsInput input = read_areas(entry.file, city.crs, domain, false, warnings);
    if (input.features.empty())
      throw Error(ErrorKind::kInput,
                  entry.file + ": has no polygon to refine in; give areas, or leave it out");
    for (Footprint& feature : input.features)
      regions.push_back({std::move(feature.polygon), entry.size});
  }
  return regions;
}

GivenDomain read_domain(const Config& config, const std::string& crs,
                        std::vector<Warning>& warnings) {
  if (domain_shape(config) != DomainShape::kGiven) return {};
  if (std::filesystem::exists(std::filesystem::path(config.domain) / results::kCity))
    return domain_of_results(config.domain, crs);
  FootprintsInput input = read_areas(config.domain, crs, Bounds2::nothing(), false, warnings);
  // The place of the city tells whether it is right.
  std::erase_if(warnings, [](const Warning& w) { return w.code == "areas_crs_unknown"; });
  if (input.features.empty())
    throw Error(ErrorKind::kInput,
                config.domain + ": has no polygon for the domain; give one, or domain = \"auto\"");
  return {polygon_domain(input.features.front().polygon)};
}

}  // namespace tetropolis
