// How finely a mesh resolves buildings and streets, by the measures of wind engineering.
#pragma once

#include "tetropolis/city/city_model.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/volume/column/column_mesh.h"

namespace tetropolis {

/// Cells per building and per gap as the best practice guideline of COST action 732 counts them
/// (Franke et al. 2007: at least ten per cube root of the building's volume, and ten between
/// buildings), measured in plan.
///
/// A building has the cube root of its volume (area times height over its ground) over the mean
/// edge along its outline. A gap is that between two buildings whose fronts meet where each grows
/// over open ground by one edge at a time, from all walls at once; its cells are the edges from
/// wall to wall there, its width the distance between the two wall vertices, both where the two are
/// nearest. Gaps of kStreetWidth and more count.
ResolutionFacts score_resolution(const CityModel& city, const ColumnMesh& mesh);

}  // namespace tetropolis
