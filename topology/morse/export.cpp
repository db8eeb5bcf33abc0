// SPDX-License-Identifier: Apache-2.0
#include "topology/morse/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace morsel::topology {
namespace {

constexpr int kSeparatrixType = 5;

// <DataArray> of one number a cell or point.
template <class Range, class Get>
void write_array(std::ostream& out, const char* type, const char* name, int components,
                 const Range& range, Get get) {
  out << fmt::format(
             R"(        <DataArray type="{}" Name="{}" NumberOfComponents="{}" format="ascii">)",
             type, name, components)
      << '\n';
  for (const auto& item : range) out << get(item) << '\n';
  out << "        </DataArray>\n";
}

std::string text(const Imath::V3d& v) { return fmt::format("{:.9g} {:.9g} {:.9g}", v.x, v.y, v.z); }

// A cell of the PolyData: its first point, how many, and what it carries.
struct Cell {
  std::size_t first, count;
  int type;
  double value;
  std::int64_t component;
  std::uint32_t point;
};

void write_cells(std::ostream& out, const char* tag, const std::vector<Cell>& cells) {
  out << fmt::format("      <{}>\n", tag);
  write_array(out, "Int64", "connectivity", 1, cells, [](const Cell& c) {
    std::string line;
    for (std::size_t i = 0; i < c.count; ++i) line += fmt::format("{} ", c.first + i);
    return line;
  });
  std::size_t end = 0;
  write_array(out, "Int64", "offsets", 1, cells, [&end](const Cell& c) { return end += c.count; });
  out << fmt::format("      </{}>\n", tag);
}

std::int64_t component_of(const CriticalPoint& p) {
  return p.set == kNoSet ? -1 : static_cast<std::int64_t>(p.set);
}

}  // namespace

void write_vtp(const MorseComplex& complex, std::ostream& out) {
  std::vector<Imath::V3d> places;
  std::vector<Cell> verts, lines;
  for (std::uint32_t i = 0; i < complex.points.size(); ++i) {
    const CriticalPoint& p = complex.points[i];
    verts.push_back({places.size(), 1, static_cast<int>(p.type), p.value, component_of(p), i});
    places.push_back(p.position);
  }
  for (const Separatrix& s : complex.separatrices) {
    if (s.path.empty()) continue;
    const CriticalPoint& p = complex.points[s.saddle];
    lines.push_back(
        {places.size(), s.path.size(), kSeparatrixType, p.value, component_of(p), s.saddle});
    places.insert(places.end(), s.path.begin(), s.path.end());
  }
  std::vector<Cell> cells = verts;
  cells.insert(cells.end(), lines.begin(), lines.end());
  out << "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "  <PolyData>\n";
  out << fmt::format(
      "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      <Points>\n",
      places.size(), verts.size(), lines.size());
  write_array(out, "Float64", "Points", 3, places, text);
  out << "      </Points>\n";
  write_cells(out, "Verts", verts);
  write_cells(out, "Lines", lines);
  out << "      <CellData Scalars=\"type\">\n";
  write_array(out, "Int32", "type", 1, cells, [](const Cell& c) { return c.type; });
  write_array(out, "Float64", "F", 1, cells,
              [](const Cell& c) { return fmt::format("{:.17g}", c.value); });
  write_array(out, "Int64", "component", 1, cells, [](const Cell& c) { return c.component; });
  write_array(out, "Int64", "point", 1, cells, [](const Cell& c) { return c.point; });
  out << "      </CellData>\n    </Piece>\n  </PolyData>\n</VTKFile>\n";
}

void write_csv(const MorseComplex& complex, std::ostream& out) {
  // Both ends of each 2-saddle, in order.
  std::vector<std::string> ends(complex.points.size());
  for (const Separatrix& s : complex.separatrices)
    ends[s.saddle] += s.maximum == Separatrix::kNoMaximum ? "," : fmt::format(",{}", s.maximum);
  out << "point,type,x,y,z,radius,F,eigenvalue1,eigenvalue2,eigenvalue3,basin,component,end1,"
         "end2\n";
  for (std::size_t i = 0; i < complex.points.size(); ++i) {
    const CriticalPoint& p = complex.points[i];
    out << fmt::format(
        "{},{},{:.17g},{:.17g},{:.17g},{:.3g},{:.17g},{:.17g},{:.17g},{:.17g},{:.6g},{}{}\n", i,
        to_string(p.type), p.position.x, p.position.y, p.position.z, p.radius, p.value,
        p.eigenvalues.x, p.eigenvalues.y, p.eigenvalues.z, p.basin,
        p.set == kNoSet ? "" : std::to_string(p.set), ends[i].empty() ? ",," : ends[i]);
  }
}

void write_svg(const MorseComplex& complex, std::ostream& out, int axis, int pixels) {
  const int right = (axis + 1) % 3, up = (axis + 2) % 3;
  // What there is to see, with a margin; the box when there is nothing.
  Box seen;
  for (const CriticalPoint& p : complex.points) seen.extendBy(p.position);
  if (seen.isEmpty()) seen = complex.box;
  const double extent =
      std::max({seen.max[right] - seen.min[right], seen.max[up] - seen.min[up], 1e-9});
  const double margin = 0.03 * extent, scale = pixels / (extent + 2.0 * margin);
  const auto x = [&](const Imath::V3d& v) { return (v[right] - seen.min[right] + margin) * scale; };
  const auto y = [&](const Imath::V3d& v) { return (seen.max[up] + margin - v[up]) * scale; };
  const double width = (seen.max[right] - seen.min[right] + 2.0 * margin) * scale,
               height = (seen.max[up] - seen.min[up] + 2.0 * margin) * scale;
  const auto colour = [&](std::uint32_t set) {
    return set == kNoSet ? "#888888" : set == complex.main ? "#000000" : "#cc2222";
  };
  out << fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.1f} {1:.1f}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height);
  out << "<g fill=\"none\" stroke-width=\"0.8\" stroke-linejoin=\"round\">\n";
  for (const Separatrix& s : complex.separatrices) {
    if (s.path.empty()) continue;
    out << fmt::format("<polyline stroke=\"{}\" points=\"", colour(complex.points[s.saddle].set));
    for (const Imath::V3d& v : s.path) out << fmt::format("{:.1f},{:.1f} ", x(v), y(v));
    out << "\"/>\n";
  }
  out << "</g>\n<g>\n";
  for (const CriticalPoint& p : complex.points)
    if (p.type == CriticalType::kMaximum)
      out << fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n",
                         x(p.position), y(p.position), colour(p.set));
  out << "</g>\n</svg>\n";
}

}  // namespace morsel::topology
