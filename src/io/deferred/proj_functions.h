// PROJ, loaded when first needed. What is missing here is not found when linking.
#pragma once

#include <proj.h>

#include "deferred_library.h"

namespace tetropolis {

inline constinit DeferredLibrary proj_library(TETROPOLIS_PROJ_FILE);

TETROPOLIS_DEFER(proj_library, proj_context_create);
TETROPOLIS_DEFER(proj_library, proj_context_destroy);
TETROPOLIS_DEFER(proj_library, proj_context_set_search_paths);
TETROPOLIS_DEFER(proj_library, proj_coordoperation_get_accuracy);
TETROPOLIS_DEFER(proj_library, proj_coordoperation_get_grid_used);
TETROPOLIS_DEFER(proj_library, proj_coordoperation_get_grid_used_count);
TETROPOLIS_DEFER(proj_library, proj_coordoperation_is_instantiable);
TETROPOLIS_DEFER(proj_library, proj_create);
TETROPOLIS_DEFER(proj_library, proj_create_operation_factory_context);
TETROPOLIS_DEFER(proj_library, proj_create_operations);
TETROPOLIS_DEFER(proj_library, proj_destroy);
TETROPOLIS_DEFER(proj_library, proj_list_destroy);
TETROPOLIS_DEFER(proj_library, proj_list_get);
TETROPOLIS_DEFER(proj_library, proj_list_get_count);
TETROPOLIS_DEFER(proj_library, proj_log_level);
TETROPOLIS_DEFER(proj_library, proj_operation_factory_context_destroy);
TETROPOLIS_DEFER(proj_library, proj_operation_factory_context_set_area_of_interest);
TETROPOLIS_DEFER(proj_library, proj_operation_factory_context_set_grid_availability_use);
TETROPOLIS_DEFER(proj_library, proj_operation_factory_context_set_spatial_criterion);

}  // namespace tetropolis
