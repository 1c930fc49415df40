// The command that draws.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "tetropolis/render/render.h"

#include "console.h"

namespace tetropolis::app {

/// What `render` is told.
struct RenderArguments {
  std::string path;
  std::string out;
  std::string view{kViewNames.front()};
  std::string colour{kPictureColourNames.front()};
  std::string cut;
  RenderOptions options;
};

/// Adds the options to `command`; `arguments` is filled when the command line is parsed.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Draws and writes the picture, and prints its name unless quiet. Throws Error.
void render(const RenderArguments& arguments, Console& console);

}  // namespace tetropolis::app
