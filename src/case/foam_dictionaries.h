// The dictionaries of a case, below constant/ and system/. Private to src/case.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tetropolis/case/openfoam_case.h"

#include "foam_mesh.h"
#include "leaf_marks.h"
#include "sample_points.h"

namespace tetropolis {

/// Files of a case begin with them.
inline constexpr const char* kFoamFirstWords = "// Written by tetropolis";

/// The words, and the header FoamFile of a class of OpenFOAM.
std::string foam_head(const std::string& type, const std::string& object);

/// `points`: the file of the points of people.
std::string control_dict(const OpenfoamCaseOptions& options, const char* points);

/// The file of the points of people.
std::string pedestrian_dict(const OpenfoamCaseOptions& options, const SamplePoints& samples);

/// `leaves`: with sources of k and epsilon in them.
std::string turbulence_dict(const std::string& object, bool is_org, bool leaves);

/// Drag of leaves: explicit porosity with the force -f |U| U / 2 per volume and density. Versions
/// that call it porosityForce know the older name, too.
std::string leaf_drag(const OpenfoamCaseOptions& options, const FoamMesh& mesh,
                      const std::string& object);

/// The sources for kEpsilonLopesdaCosta, without a header. The model finds them in the porosity of
/// the same author, with Cd 0 here, whose cells are those right below a surface: marks over their
/// centres, in the files `marks_name`.
std::string leaf_sources(const OpenfoamCaseOptions& options, const FoamMesh& mesh,
                         const std::vector<LeafMarks>& marks);

/// Name of the surface of the i-th marks.
std::string marks_name(std::size_t i);

}  // namespace tetropolis
