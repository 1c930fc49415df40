#include "render_command.h"

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "choice.h"

namespace tetropolis::app {

void add_render_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  const auto number = [&](const std::string& name, auto& value, const std::string& help,
                          const char* type) {
    command.add_option(name, value, fmt::format("{} (default {})", help, value))->type_name(type);
  };
  command.add_option("path", arguments.path, "Folder of results or file")
      ->required()
      ->type_name("PATH")
      ->check(wrong_name);
  command.add_option("-o,--out", arguments.out, "Picture to write, PNG")
      ->required()
      ->type_name("FILE")
      ->check(wrong_name);
  add_choice(command, "--view", arguments.view, kViewNames,
             "From the air, from above, or a vertical plane through the volume");
  add_choice(command, "--colour", arguments.colour, kPictureColourNames,
             "What colours say; quality is that of the cells of a section");
  command.add_flag("--edges", options.edges, "Draw the edges of triangles");
  number("--width", options.width, "Width of the picture [pixels]", "INT");
  number("--height", options.height, "Height of the picture [pixels]", "INT");
  number("--azimuth", options.azimuth, "Compass direction one looks in [degrees]", "NUMBER");
  number("--elevation", options.elevation, "How far one looks down [degrees]", "NUMBER");
  command
      .add_option("--cut", arguments.cut,
                  "Plane of the section: x, y, x=METRES, y=METRES or the compass direction of its "
                  "line (default: the one with most walls)")
      ->type_name("PLANE");
}

void render(const RenderArguments& arguments, Console& console) {
  RenderOptions options = arguments.options;
  options.view = named<View>(arguments.view, kViewNames);
  options.colour = named<PictureColour>(arguments.colour, kPictureColourNames);
  Picture picture;
  try {
    if (!arguments.cut.empty()) options.cut = cut_named(arguments.cut);
    picture = render_picture(read_render_input(arguments.path, options.view), options);
  } catch (const Error& error) {  // of usage, they begin with the option's name
    if (error.kind() != ErrorKind::kUsage) throw;
    throw Error(ErrorKind::kUsage, fmt::format("--{}", error.what()));
  }
  write_png(arguments.out, picture);
  console.result(fmt::format("{}: {} x {} pixels", arguments.out, picture.width, picture.height));
}

}  // namespace tetropolis::app
