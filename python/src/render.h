// Pictures. Private to python/src.
#pragma once

#include <nanobind/nanobind.h>

#include "tetropolis/render/render.h"

namespace tetropolis::python {

/// Of keyword arguments. Throws Error(kUsage) for one that does not exist or has no such value.
RenderOptions render_options(const nanobind::dict& keywords);

}  // namespace tetropolis::python
