#include "xdmf_description.h"

#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "xdmf_layout.h"

namespace tetropolis::xdmf {

namespace {

constexpr std::string_view kKey = "<map key=\"";

std::string data_item(std::string_view number, int precision, const std::string& dimensions,
                      const std::string& file, std::string_view path) {
  return fmt::format(
      "<DataItem NumberType=\"{}\" Precision=\"{}\" Dimensions=\"{}\" "
      "Format=\"HDF\">{}:{}</DataItem>",
      number, precision, dimensions, file, path);
}

std::string topology(const Kind& small, const Kind& large, const Elements& elements,
                     const std::string& file, std::string_view path) {
  if (elements.mixed())
    return fmt::format(
        "<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">\n{}\n</Topology>\n",
        elements.all(),
        data_item("Int", 8, std::to_string(mixed_size(small, large, elements)), file, path));
  const Kind& kind = elements.large > 0 ? large : small;
  return fmt::format(
      "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\" NodesPerElement=\"{}\">\n{}\n"
      "</Topology>\n",
      kind.name, elements.all(), kind.corners,
      data_item("Int", 8, fmt::format("{} {}", elements.all(), kind.corners), file, path));
}

std::string geometry(std::int64_t nodes, const std::string& file) {
  return fmt::format("<Geometry GeometryType=\"XYZ\">\n{}\n</Geometry>\n",
                     data_item("Float", 8, fmt::format("{} 3", nodes), file, kGeometry));
}

std::string cell_attribute(std::string_view name, std::int64_t elements, const std::string& file,
                           std::string_view path) {
  return fmt::format(
      "<Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Cell\">\n{}\n</Attribute>\n", name,
      data_item("Int", 4, std::to_string(elements), file, path));
}

/// One grid in the domain and nothing beside it: meshio ends the program at anything else.
std::string with_grid(std::string_view name, const Point3& origin, const std::string& content) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n"
      "<!-- origin {} {} {} -->\n<Xdmf Version=\"3.0\">\n<Domain>\n"
      "<Grid Name=\"{}\" GridType=\"Uniform\">\n{}</Grid>\n</Domain>\n</Xdmf>\n",
      origin[0], origin[1], origin[2], name, content);
}

}  // namespace

// DOLFINx finds grids by name and takes a grid's first attribute unless told its name.

std::string volume_description(std::int64_t nodes, const Elements& cells, bool zones,
                               const Point3& origin, const std::string& file) {
  return with_grid("mesh", origin,
                   topology(kTetrahedron, kWedge, cells, file, kTopology) + geometry(nodes, file) +
                       cell_attribute("region", cells.all(), file, kRegion) +
                       (zones ? cell_attribute("zone", cells.all(), file, kZone) : ""));
}

/// The names are where meshio puts its own `field_data`: numbers and dimensions by name.
std::string boundary_description(std::int64_t nodes, const Elements& faces,
                                 const PatchNames& patches, const Point3& origin,
                                 const std::string& volume_file, const std::string& file) {
  std::string names =
      fmt::format("<Information Name=\"patches\" Value=\"{}\"><![CDATA[<main>\n", patches.size());
  for (const auto& [number, name] : patches)
    names += fmt::format("{}{}\" dim=\"2\">{}</map>\n", kKey, name, number);
  names += "</main>]]></Information>\n";
  return with_grid("boundary", origin,
                   topology(kTriangle, kQuadrilateral, faces, file, kFaces) +
                       geometry(nodes, volume_file) +
                       cell_attribute("patch", faces.all(), file, kPatch) +
                       cell_attribute("building", faces.all(), file, kBuilding) + names);
}

PatchNames names_in(const std::string& description) {
  PatchNames names;
  for (std::size_t at = description.find(kKey); at != std::string::npos;
       at = description.find(kKey, at)) {
    at += kKey.size();
    const std::size_t end = description.find('"', at), number = description.find('>', at);
    if (number == std::string::npos) break;
    names[std::atoi(description.c_str() + number + 1)] = description.substr(at, end - at);
  }
  return names;
}

}  // namespace tetropolis::xdmf
