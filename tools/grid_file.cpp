// SPDX-License-Identifier: Apache-2.0
#include "tools/grid_file.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <ostream>
#include <string>

namespace morsel::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are written as they are");

constexpr std::size_t kNpyAlignment = 64;  // of the data, as the format's specification asks

}  // namespace

void write_npy_header(std::ostream& out, std::size_t n) {
  const std::string magic("\x93NUMPY\x01\x00", 8);
  std::string dictionary =
      fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({0}, {0}, {0}), }}", n);
  const std::size_t before = magic.size() + 2;
  while ((before + dictionary.size() + 1) % kNpyAlignment != 0) dictionary += ' ';
  dictionary += '\n';
  out << magic << static_cast<char>(dictionary.size() & 255)
      << static_cast<char>(dictionary.size() >> 8) << dictionary;
}

void write_vti_header(std::ostream& out, std::size_t n, const topology::Box& box) {
  const Imath::V3d spacing = (box.max - box.min) / static_cast<double>(n - 1);
  const std::string extent = fmt::format("0 {0} 0 {0} 0 {0}", n - 1);
  out << fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <ImageData WholeExtent=\"{0}\" Origin=\"{1:.17g} {2:.17g} {3:.17g}\" "
      "Spacing=\"{4:.17g} {5:.17g} {6:.17g}\">\n"
      "    <Piece Extent=\"{0}\">\n"
      "      <PointData Scalars=\"F\">\n"
      "        <DataArray type=\"Float64\" Name=\"F\" format=\"appended\" offset=\"0\"/>\n"
      "      </PointData>\n"
      "    </Piece>\n"
      "  </ImageData>\n"
      "  <AppendedData encoding=\"raw\">\n_",
      extent, box.min.x, box.min.y, box.min.z, spacing.x, spacing.y, spacing.z);
  const std::uint64_t bytes = std::uint64_t{n} * n * n * sizeof(double);
  out.write(reinterpret_cast<const char*>(&bytes), sizeof bytes);
}

void write_vti_footer(std::ostream& out) { out << "\n  </AppendedData>\n</VTKFile>\n"; }

}  // namespace morsel::tools
