#include "xdmf_description.h"

#include <string_view>

#include <fmt/format.h>

#include "xdmf_layout.h"

namespace tetropolis::xdmf {

namespace {

std::string data_item(std::string_view number, int precision, const std::string& dimensions,
                      const std::string& file, std::string_view path) {
  return fmt::format(
      "<DataItem NumberType=\"{}\" Precision=\"{}\" Dimensions=\"{}\" "
      "Format=\"HDF\">{}:{}</DataItem>",
      number, precision, dimensions, file, path);
}

std::string topology(std::string_view type, std::int64_t elements, int nodes,
                     const std::string& file, std::string_view path) {
  return fmt::format(
      "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\" NodesPerElement=\"{}\">\n{}\n"
      "</Topology>\n",
      type, elements, nodes,
      data_item("Int", 8, fmt::format("{} {}", elements, nodes), file, path));
}

std::string attribute(std::string_view name, std::int64_t elements, const std::string& file,
                      std::string_view path) {
  return fmt::format(
      "<Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Cell\">\n{}\n</Attribute>\n", name,
      data_item("Int", 4, std::to_string(elements), file, path));
}

}  // namespace

/// DOLFINx finds grids by name and takes a grid's first attribute unless told its name.
std::string description(const Sizes& sizes, const Point3& origin, const std::string& file) {
  const auto [nodes, cells, faces] = sizes;
  const std::string points = fmt::format("{} 3", nodes);
  const std::string geometry = fmt::format("<Geometry GeometryType=\"XYZ\">\n{}\n</Geometry>\n",
                                           data_item("Float", 8, points, file, kGeometry));
  std::string text =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n"
      "<Xdmf Version=\"3.0\">\n<Domain>\n";
  text += fmt::format("<Information Name=\"origin\" Value=\"{} {} {}\"/>\n", origin[0], origin[1],
                      origin[2]);
  text += "<Grid Name=\"mesh\" GridType=\"Uniform\">\n";
  text += topology("Tetrahedron", cells, 4, file, kTopology) + geometry;
  text += attribute("region", cells, file, kRegion) + "</Grid>\n";
  text += "<Grid Name=\"boundary\" GridType=\"Uniform\">\n";
  text += topology("Triangle", faces, 3, file, kFaces) + geometry;
  text += attribute("patch", faces, file, kPatch);
  text += attribute("building", faces, file, kBuilding) + "</Grid>\n";
  return text + "</Domain>\n</Xdmf>\n";
}

}  // namespace tetropolis::xdmf
