// The parts of the extension `_core`.
#pragma once

#include <nanobind/nanobind.h>

namespace tetropolis::python {

/// Errors of the library become exceptions of tetropolis._errors.
void bind_errors(nanobind::module_& module);
void bind_city(nanobind::module_& module);
void bind_mesh(nanobind::module_& module);
/// Commands on files: synth, check.
void bind_files(nanobind::module_& module);
/// Cases for solvers.
void bind_case(nanobind::module_& module);
/// Pictures of files; those of meshes are members of theirs.
void bind_render(nanobind::module_& module);

}  // namespace tetropolis::python
