#include "render.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>

#include "tetropolis/core/error.h"

#include "bindings.h"

namespace tetropolis::python {

namespace {

namespace nb = nanobind;

template <typename Value>
Value value_of(const std::string& name, nb::handle value) {
  Value result{};
  if (!nb::try_cast(value, result))
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: {} has the wrong type", name, nb::repr(value).c_str()));
  return result;
}

template <typename Enumeration>
Enumeration choice_of(const std::string& name, nb::handle value,
                      std::span<const std::string_view> words) {
  const auto word = value_of<std::string>(name, value);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end())
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: '{}' is not one of {}", name, word, fmt::join(words, ", ")));
  return static_cast<Enumeration>(found - words.begin());
}

void render_folder(const std::filesystem::path& path, const std::filesystem::path& picture,
                   const nb::dict& keywords) {
  const RenderOptions options = render_options(keywords);
  const nb::gil_scoped_release release;
  write_png(picture, render_picture(read_render_input(path, options.view), options));
}

}  // namespace

RenderOptions render_options(const nb::dict& keywords) {
  RenderOptions options;
  for (const auto& [key, value] : keywords) {
    const auto name = nb::cast<std::string>(key);
    if (name == "view")
      options.view = choice_of<View>(name, value, kViewNames);
    else if (name == "colour")
      options.colour = choice_of<PictureColour>(name, value, kPictureColourNames);
    else if (name == "width")
      options.width = value_of<int>(name, value);
    else if (name == "height")
      options.height = value_of<int>(name, value);
    else if (name == "azimuth")
      options.azimuth = value_of<double>(name, value);
    else if (name == "elevation")
      options.elevation = value_of<double>(name, value);
    else if (name == "edges")
      options.edges = value_of<bool>(name, value);
    else if (name == "cut")
      options.cut = cut_named(nb::str(value).c_str());
    else
      throw Error(ErrorKind::kUsage,
                  fmt::format("{}: pictures have no such option; there are view, colour, width, "
                              "height, azimuth, elevation, edges, cut",
                              name));
  }
  return options;
}

void bind_render(nb::module_& module) {
  module.def("render", render_folder, nb::arg("path"), nb::arg("picture"), nb::arg("options"));
}

}  // namespace tetropolis::python
