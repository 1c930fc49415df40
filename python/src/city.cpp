#include "city.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/raster/geotiff.h"
#include "tetropolis/io/vector/city_layers.h"
#include "tetropolis/run/in_memory.h"

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "settings.h"

namespace tetropolis::python {

namespace {

using Coordinates3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Coordinates2 = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Codes = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Points as Python has them; keeps the arrays alive.
struct Points {
  Coordinates3 xyz;
  std::optional<Codes> classification;
  std::optional<Codes> withheld;
  std::string crs;

  PointArrays arrays() const {
    static_assert(sizeof(std::array<double, 3>) == 3 * sizeof(double));
    PointArrays result;
    const void* data = xyz.data();
    result.xyz = {static_cast<const std::array<double, 3>*>(data), xyz.shape(0)};
    const auto codes = [](const std::optional<Codes>& array) {
      return array ? std::span(array->data(), array->shape(0)) : std::span<const std::uint8_t>();
    };
    result.classification = codes(classification);
    result.withheld = codes(withheld);
    result.crs = crs;
    return result;
  }
};

City build(const nb::dict& settings, const std::vector<std::string>& footprints,
           const std::vector<std::string>& points, const std::optional<FootprintTable>& table,
           const std::optional<Points>& arrays, const nb::object& progress) {
  Config config = config_of("build_city", settings);
  config.footprints = footprints;
  config.points = points;
  CityInMemory city;
  call(progress, kCity, config, [&](const StepHooks& hooks) {
    InputInMemory input;
    input.footprints = table;
    if (arrays) input.points = arrays->arrays();
    city = make_city(config, std::move(input), hooks);
  });
  return City(std::move(city));
}

City read(const nb::dict& settings, const std::string& path, const std::string& dtm,
          const nb::object& progress) {
  Config config = config_of("read_city", settings);
  config.city = path;
  if (!dtm.empty()) config.dtm = {dtm};
  CityInMemory city;
  call(progress, "read city and terrain",
       [&](const StepHooks& hooks) { city = load_city(config, hooks); });
  return City(std::move(city));
}

using Text = std::vector<std::string>;
using Rows = nb::ndarray<nb::numpy, double, nb::shape<-1, 2>>;
using Offsets = nb::ndarray<nb::numpy, std::int64_t, nb::ndim<1>>;

Offsets offsets_of(const std::vector<std::int64_t>& values) {
  return make_array<std::int64_t>(
      values.size(), [&](std::int64_t* out) { std::copy(values.begin(), values.end(), out); });
}

/// Rings closed, CRS coordinates: coordinates, and offsets of rings and polygons, as
/// shapely.from_ragged_array takes them.
std::tuple<Rows, Offsets, Offsets> ragged(const std::vector<const Polygon*>& list, Point2 origin) {
  std::vector<Point2> points;
  std::vector<std::int64_t> rings{0}, polygons{0};
  const auto add = [&](const Ring& ring) {
    for (std::size_t i = 0; i <= ring.size(); ++i) {
      const Point2 p = ring[i % ring.size()];
      points.push_back({p.x + origin.x, p.y + origin.y});
    }
    rings.push_back(static_cast<std::int64_t>(points.size()));
  };
  for (const Polygon* polygon : list) {
    for_each_ring(*polygon, add);
    polygons.push_back(static_cast<std::int64_t>(rings.size()) - 1);
  }
  return {make_rows<double, 2, std::array<double, 2>>(points.size(),
                                                      [&](std::array<double, 2>* out) {
                                                        for (const Point2 p : points)
                                                          *out++ = {p.x, p.y};
                                                      }),
          offsets_of(rings), offsets_of(polygons)};
}

std::tuple<Rows, Offsets, Offsets> footprints_of(const CityModel& model) {
  std::vector<const Polygon*> list;
  for (const Building& building : model.buildings) list.push_back(&building.footprint);
  return ragged(list, model.origin);
}

std::tuple<Rows, Offsets, Offsets> part_outlines_of(const CityModel& model) {
  std::vector<const Polygon*> list;
  for (const Building& building : model.buildings)
    for (const RoofPart& part : building.parts) list.push_back(&part.outline);
  return ragged(list, model.origin);
}

/// A value per part, building by building: value(building's number, part's number, part).
template <typename Value>
auto column_of_parts(const CityModel& model, const Value& value) {
  std::vector<decltype(value(std::size_t{}, std::size_t{}, RoofPart{}))> column;
  for (std::size_t b = 0; b < model.buildings.size(); ++b) {
    const std::vector<RoofPart>& parts = model.buildings[b].parts;
    for (std::size_t k = 0; k < parts.size(); ++k) column.push_back(value(b, k, parts[k]));
  }
  return column;
}

/// Columns by name, as lists.
nb::dict parts_of(const CityModel& model) {
  nb::dict columns;
  const auto add = [&](const char* name, const auto& value) {
    columns[name] = column_of_parts(model, value);
  };
  using Part = const RoofPart&;
  add("building", [](std::size_t b, std::size_t, Part) { return b; });
  add("id", [&](std::size_t b, std::size_t, Part) { return model.buildings[b].id; });
  add("part", [](std::size_t, std::size_t k, Part) { return k; });
  add("source_id", [](std::size_t, std::size_t, Part part) { return part.source_id; });
  add("lod", [](std::size_t, std::size_t, Part part) { return std::string(name_of(part.lod)); });
  add("slope", [](std::size_t, std::size_t, Part part) { return slope_degrees(part.roof); });
  add("azimuth", [](std::size_t, std::size_t, Part part) {
    return azimuth_degrees(part.roof).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  add("area", [](std::size_t, std::size_t, Part part) { return area(part.outline); });
  add("rmse", [](std::size_t, std::size_t, Part part) { return part.rmse; });
  add("n_points", [](std::size_t, std::size_t, Part part) { return part.n_points; });
  add("h_min", [](std::size_t, std::size_t, Part part) { return range_of(part).low; });
  add("h_max", [](std::size_t, std::size_t, Part part) { return range_of(part).high; });
  return columns;
}

/// An array over one member of all buildings.
template <typename Number>
auto member(Number Building::*which) {
  return [which](nb::pointer_and_handle<CityModel> self) {
    return view_member(self.p->buildings, which, self.h);
  };
}

/// By NumPy's kinds of types.
AttributeType type_of_kind(const std::string& kind) {
  if (kind == "b") return AttributeType::kBoolean;
  if (kind == "i" || kind == "u") return AttributeType::kInteger;
  return kind == "f" ? AttributeType::kReal : AttributeType::kText;
}

void bind_input(nb::module_& module) {
  nb::class_<FootprintTable>(module, "FootprintTable", "Footprints in memory: WKB and attributes.")
      .def(
          "__init__",
          [](FootprintTable* self, const std::vector<nb::bytes>& wkb, Text ids,
             std::vector<std::tuple<std::string, std::string, Text>> columns, std::string crs) {
            new (self) FootprintTable();
            for (const nb::bytes& bytes : wkb) self->wkb.emplace_back(bytes.c_str(), bytes.size());
            self->ids = std::move(ids);
            for (auto& [name, kind, values] : columns)
              self->columns.push_back({std::move(name), type_of_kind(kind), std::move(values)});
            self->crs = std::move(crs);
          },
          nb::arg("wkb"), nb::arg("ids"), nb::arg("columns"), nb::arg("crs"));
  nb::class_<Points>(module, "Points", "Points in memory.")
      .def(
          "__init__",
          [](Points* self, Coordinates3 xyz, std::optional<Codes> classification,
             std::optional<Codes> withheld, std::string crs) {
            new (self) Points{std::move(xyz), std::move(classification), std::move(withheld),
                              std::move(crs)};
          },
          nb::arg("xyz"), nb::arg("classification") = nb::none(), nb::arg("withheld") = nb::none(),
          nb::arg("crs") = "");
}

void bind_model(nb::module_& module) {
  nb::class_<CityModel>(module, "CityModel", "Buildings; arrays have one element each.")
      .def("__len__", [](const CityModel& self) { return self.buildings.size(); })
      .def_prop_ro("h_ground", member(&Building::h_ground), kArray)
      .def_prop_ro("h_roof", member(&Building::h_roof), kArray)
      .def_prop_ro("attribute_height", member(&Building::attribute_height), kArray)
      .def_prop_ro("n_ground_points", member(&Building::n_ground_points), kArray)
      .def_prop_ro("n_roof_points", member(&Building::n_roof_points), kArray)
      .def_prop_ro("flags", member(&Building::flags), kArray)
      .def_prop_ro("ids",
                   [](const CityModel& self) {
                     Text ids;
                     for (const Building& building : self.buildings) ids.push_back(building.id);
                     return ids;
                   })
      .def_prop_ro("source_ids",
                   [](const CityModel& self) {
                     std::vector<Text> ids;
                     for (const Building& building : self.buildings)
                       ids.push_back(building.source_ids);
                     return ids;
                   })
      .def_prop_ro("flag_names",
                   [](const CityModel& self) {
                     std::vector<Text> names;
                     for (const Building& building : self.buildings)
                       names.push_back(flag_names(building.flags));
                     return names;
                   })
      .def_prop_ro("dropped",
                   [](const CityModel& self) {
                     std::vector<std::pair<std::string, std::string>> rows;
                     for (const Dropped& dropped : self.dropped)
                       rows.emplace_back(dropped.source_id, dropped.reason);
                     return rows;
                   })
      .def_prop_ro("footprints", footprints_of, kArray)
      .def_prop_ro("parts", parts_of)
      .def_prop_ro("part_outlines", part_outlines_of, kArray)
      .def_prop_ro("origin",
                   [](const CityModel& self) { return std::pair(self.origin.x, self.origin.y); })
      .def_prop_ro("domain",
                   [](const CityModel& self) {
                     const Bounds2 box = self.domain.moved(self.origin).bounds();
                     return std::tuple(box.xmin, box.ymin, box.xmax, box.ymax);
                   })
      .def_prop_ro("domain_outline",
                   [](const CityModel& self) {
                     std::vector<std::pair<double, double>> corners;
                     for (const Point2 p : self.domain.moved(self.origin).outline().outer)
                       corners.emplace_back(p.x, p.y);
                     return corners;
                   })
      .def_ro("crs", &CityModel::crs)
      .def(
          "save",
          [](const CityModel& self, const std::filesystem::path& path) {
            const nb::gil_scoped_release release;
            write_city(path, self);
          },
          nb::arg("path"));
}

void bind_terrain(nb::module_& module) {
  nb::class_<Raster>(module, "Raster", "Heights at the nodes of a grid.")
      .def_prop_ro(
          "values",
          [](nb::pointer_and_handle<Raster> self) {
            Raster& raster = *self.p;
            return nb::ndarray<nb::numpy, double, nb::ndim<2>>(
                raster.values.data(),
                {static_cast<std::size_t>(raster.ny), static_cast<std::size_t>(raster.nx)}, self.h);
          },
          kArray)
      .def_ro("x0", &Raster::x0)
      .def_ro("y0", &Raster::y0)
      .def_ro("step", &Raster::step)
      .def(
          "sample",
          [](const Raster& self, Coordinates2 at) {
            return make_array<double>(at.shape(0), [&](double* out) {
              for (std::size_t i = 0; i < at.shape(0); ++i)
                out[i] = sample(self, {at(i, 0), at(i, 1)});
            });
          },
          nb::arg("at"));
}

}  // namespace

void bind_city(nb::module_& module) {
  bind_input(module);
  bind_model(module);
  bind_terrain(module);
  nb::class_<City>(module, "City", "A city before and after merging, on its terrain.")
      .def_prop_ro("model", [](City& self) -> CityModel& { return self.built.city; })
      .def_prop_ro("raw", [](City& self) -> CityModel& { return self.built.raw; })
      .def_prop_ro("terrain", [](City& self) -> Raster& { return self.built.terrain; })
      .def("settle", &City::settle, "Lets roofs of parts follow edits of h_roof.")
      .def("copy", [](const City& self) { return City(self); })
      .def_prop_ro("report", [](const City& self) { return to_json(self.report); })
      .def_prop_ro("page",
                   [](const City& self) {
                     const nb::gil_scoped_release release;
                     return make_page(self);
                   })
      .def(
          "save_layers",
          [](const City& self, const std::filesystem::path& path) {
            const nb::gil_scoped_release release;
            write_city_layers(path, self.built.raw, self.built.city, self.built.footprints);
          },
          nb::arg("path"))
      .def(
          "save_terrain",
          [](const City& self, const std::filesystem::path& path) {
            const nb::gil_scoped_release release;
            const CityModel& city = self.built.city;
            write_raster(path, self.built.terrain, city.origin, city.crs, city.domain.bounds());
          },
          nb::arg("path"));
  module.def("build_city", build, nb::arg("settings"), nb::arg("footprints"), nb::arg("points"),
             nb::arg("table").none(), nb::arg("arrays").none(), nb::arg("progress").none());
  module.def("read_city", read, nb::arg("settings"), nb::arg("path"), nb::arg("dtm"),
             nb::arg("progress").none());
}

}  // namespace tetropolis::python
