#include "tetropolis/io/crs/datum.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <vector>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

#include "gdal_support.h"
#include "io/deferred/proj_functions.h"

namespace tetropolis {

namespace {

struct Deleter {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
  void operator()(PJ* object) const { proj_destroy(object); }
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* factory) const {
    proj_operation_factory_context_destroy(factory);
  }
  void operator()(PJ_OBJ_LIST* list) const { proj_list_destroy(list); }
};
template <typename Object>
using Owned = std::unique_ptr<Object, Deleter>;

/// Longitudes and latitudes around a box; empty where no transformation leads to them, as from the
/// system of a site.
Bounds2 in_degrees(const std::string& from, const Bounds2& box) {
  std::vector<Point2> corners{
      {box.xmin, box.ymin}, {box.xmax, box.ymin}, {box.xmin, box.ymax}, {box.xmax, box.ymax}};
  Bounds2 result = Bounds2::nothing();
  try {
    if (!is_geographic(from)) corners = reproject(corners, from, "EPSG:4326");
  } catch (const Error&) {
    return result;
  }
  for (const Point2 p : corners)
    if (std::isfinite(p.x)) result.extend(p);
  return result;
}

}  // namespace

std::optional<MissingGrid> find_missing_grid(const std::string& from, const std::string& to,
                                             const Bounds2& box) {
  if (from.empty() || to.empty() || box.empty() || same_horizontal_crs(from, to)) return {};
  gdal::initialise();
  Bounds2 degrees = Bounds2::nothing();
  try {
    degrees = in_degrees(from, box);
  } catch (const Error&) {
    return {};  // a local system, which nothing leads from
  }
  if (degrees.empty()) return {};
  const Owned<PJ_CONTEXT> context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  if (char** folders = OSRGetPROJSearchPaths(); folders != nullptr) {
    proj_context_set_search_paths(context.get(), CSLCount(folders), folders);
    CSLDestroy(folders);
  }
  const Owned<PJ> source(proj_create(context.get(), from.c_str()));
  const Owned<PJ> target(proj_create(context.get(), to.c_str()));
  if (source == nullptr || target == nullptr) return {};
  const Owned<PJ_OPERATION_FACTORY_CONTEXT> factory(
      proj_create_operation_factory_context(context.get(), nullptr));
  proj_operation_factory_context_set_area_of_interest(context.get(), factory.get(), degrees.xmin,
                                                      degrees.ymin, degrees.xmax, degrees.ymax);
  proj_operation_factory_context_set_spatial_criterion(context.get(), factory.get(),
                                                       PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_grid_availability_use(context.get(), factory.get(),
                                                           PROJ_GRID_AVAILABILITY_IGNORED);
  const Owned<PJ_OBJ_LIST> list(
      proj_create_operations(context.get(), source.get(), target.get(), factory.get()));
  if (list == nullptr) return {};
  std::optional<MissingGrid> missing;
  for (int k = 0; k < proj_list_get_count(list.get()); ++k) {
    const Owned<PJ> operation(proj_list_get(context.get(), list.get(), k));
    const double accuracy = proj_coordoperation_get_accuracy(context.get(), operation.get());
    if (proj_coordoperation_is_instantiable(context.get(), operation.get()) != 0) {
      if (!missing) return {};
      missing->accuracy = accuracy;
      const bool is_worse = accuracy < 0 || accuracy > missing->accuracy_with;
      return is_worse ? missing : std::nullopt;
    }
    if (missing) continue;
    for (int g = 0; g < proj_coordoperation_get_grid_used_count(context.get(), operation.get());
         ++g) {
      const char *name = nullptr, *full = nullptr, *package = nullptr, *url = nullptr;
      int direct = 0, open = 0, available = 0;
      if (proj_coordoperation_get_grid_used(context.get(), operation.get(), g, &name, &full,
                                            &package, &url, &direct, &open, &available) == 0 ||
          available != 0)
        continue;
      missing = MissingGrid{name == nullptr ? "" : name, url == nullptr ? "" : url, -1, accuracy};
      break;
    }
  }
  if (missing) missing->accuracy = -1;
  return missing;
}

}  // namespace tetropolis
