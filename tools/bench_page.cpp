// SPDX-License-Identifier: Apache-2.0
#include "tools/bench_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace morsel::tools {
namespace {

using nlohmann::json;

constexpr const char* kStyle =
    "body{font:16px/1.5 sans-serif;max-width:52em;margin:2em auto;padding:0 1em;color:#222}"
    "h1{font-size:1.5em}h2{font-size:1.2em;margin-top:2em}p{color:#555}"
    "table{border-collapse:collapse}td,th{padding:.2em .8em;text-align:left;"
    "border-bottom:1px solid #ddd}td.n{text-align:right;font-variant-numeric:tabular-nums}"
    "svg{display:block;margin:1em 0;font:13px sans-serif}"
    "figure{display:inline-block;margin:0 1em 1em 0}figcaption{color:#555}"
    "summary{cursor:pointer}pre{overflow:auto;background:#f6f6f6;padding:1em}";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= count ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

// A value with the least and the largest of its repetitions.
struct Bar {
  std::string name;
  double value, low, high;
};

// Bars to the right, on a logarithmic scale about 1, which is marked: ratios.
std::string ratio_plot(const std::vector<Bar>& bars) {
  double least = 0.5, most = 2.0;
  for (const Bar& b : bars) {
    if (b.low > 0.0) least = std::min(least, b.low);
    most = std::max(most, b.high);
  }
  const double low = std::floor(std::log10(least)), high = std::ceil(std::log10(most));
  constexpr double kLeft = 110.0, kWidth = 560.0, kRow = 30.0;
  const auto x = [&](double value) {
    const double at = (std::log10(std::max(value, 1e-300)) - low) / (high - low);
    return kLeft + kWidth * std::clamp(at, 0.0, 1.0);
  };
  const double bottom = kRow * static_cast<double>(bars.size());
  std::string svg = fmt::format(
      "<svg class=\"plot\" width=\"760\" height=\"{:.0f}\" role=\"img\">\n", bottom + 28.0);
  for (int decade = static_cast<int>(low); decade <= static_cast<int>(high); ++decade) {
    const double value = std::pow(10.0, decade);
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.0f}\" stroke=\"{2}\"/>"
        "<text x=\"{0:.1f}\" y=\"{3:.0f}\" text-anchor=\"middle\">{4:g}</text>\n",
        x(value), bottom, decade == 0 ? "#000" : "#ddd", bottom + 18.0, value);
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const Bar& b = bars[i];
    const double y = kRow * static_cast<double>(i) + 6.0;
    const double from = std::min(x(1.0), x(b.value)), to = std::max(x(1.0), x(b.value));
    svg += fmt::format(
        "<text x=\"0\" y=\"{0:.1f}\">{1}</text>"
        "<rect x=\"{2:.1f}\" y=\"{3:.1f}\" width=\"{4:.1f}\" height=\"18\" fill=\"#4a7ab5\"/>"
        "<line x1=\"{5:.1f}\" x2=\"{6:.1f}\" y1=\"{7:.1f}\" y2=\"{7:.1f}\" stroke=\"#000\"/>"
        "<text x=\"{8:.1f}\" y=\"{0:.1f}\">{9:.3g}</text>\n",
        y + 14.0, escaped(b.name), from, y, std::max(to - from, 1.0), x(b.low), x(b.high), y + 9.0,
        kLeft + kWidth + 12.0, b.value);
  }
  return svg + "</svg>\n";
}

struct Line {
  std::string name;
  std::vector<std::pair<double, double>> points;
};

// Lines over a few whole numbers, from 0 upwards.
std::string line_plot(const std::vector<Line>& lines, const std::string& x_name,
                      const std::string& y_name) {
  static constexpr const char* kColours[] = {"#4a7ab5", "#c8553d", "#4f8a4c", "#7d5ba6"};
  double left = 1e300, right = -1e300, top = 0.0;
  for (const Line& line : lines)
    for (const auto& [x, y] : line.points) {
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::max(top, y);
    }
  if (!(left <= right) || !(top > 0.0)) return "";
  if (left == right) right = left + 1.0;
  const auto px = [&](double x) { return 60.0 + 560.0 * (x - left) / (right - left); };
  const auto py = [&](double y) { return 230.0 - 210.0 * y / top; };
  std::string svg = "<svg class=\"plot\" width=\"760\" height=\"280\" role=\"img\">\n";
  for (int i = 0; i <= 4; ++i) {
    const double y = top * i / 4.0;
    svg += fmt::format(
        "<line x1=\"60\" x2=\"620\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"#ddd\"/>"
        "<text x=\"54\" y=\"{1:.1f}\" text-anchor=\"end\">{2:.3g}</text>\n",
        py(y), py(y) + 4.0, y);
  }
  for (double x = left; x <= right + 1e-9; x += std::max(1.0, std::ceil((right - left) / 10.0)))
    svg +=
        fmt::format("<text x=\"{:.1f}\" y=\"250\" text-anchor=\"middle\">{:g}</text>\n", px(x), x);
  svg += fmt::format(
      "<text x=\"340\" y=\"272\" text-anchor=\"middle\">{}</text>"
      "<text x=\"60\" y=\"12\">{}</text>\n",
      escaped(x_name), escaped(y_name));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const char* colour = kColours[i % std::size(kColours)];
    std::string path;
    for (const auto& [x, y] : lines[i].points) {
      path += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", px(x), py(y),
                         colour);
    }
    svg += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>"
        "<text x=\"632\" y=\"{}\" fill=\"{}\">{}</text>\n",
        path, colour, 30 + 20 * i, colour, escaped(lines[i].name));
  }
  return svg + "</svg>\n";
}

// Numbers of an object, and those of the objects in it, one a row.
void add_rows(const json& object, const std::string& prefix, std::string& rows) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object())
      add_rows(value, prefix + key + ".", rows);
    else if (value.is_number())
      rows += fmt::format("<tr><td>{}{}</td><td class=\"n\">{:.6g}</td></tr>\n", escaped(prefix),
                          escaped(key), value.get<double>());
  }
}

std::string vs_mesh_section(const json& result) {
  const json& v = result["vs_mesh"];
  std::vector<Bar> bars;
  for (const char* kind : {"primary", "incoherent", "shadow"})
    bars.push_back({kind, v[kind].get<double>(), v["spread"][kind][0].get<double>(),
                    v["spread"][kind][1].get<double>()});
  for (const auto& [key, name] :
       {std::pair("memory", "memory"), std::pair("ready_time", "ready time")})
    bars.push_back({name, v[key].get<double>(), v[key].get<double>(), v[key].get<double>()});
  std::string html = fmt::format(
      "<h2>{}: hypertexture / triangles of the same surface</h2>\n<p>Triangles within {:.3g} of "
      "the surface. Rays per second: above 1 the hypertexture is faster. Memory and time until "
      "the first ray: below 1 it is smaller and sooner. Medians; black lines from the least to "
      "the largest of the repetitions.</p>\n",
      escaped(result["geometry"].get<std::string>()), v["error"].get<double>());
  html += ratio_plot(bars);
  html += "<h2>Evaluations of the field, a ray</h2>\n<table><tr><th>rays</th>";
  const json& kinds = result["evaluations_per_ray_of"];
  for (const auto& item : kinds.begin()->items()) html += "<th>" + escaped(item.key()) + "</th>";
  html += "</tr>\n";
  for (const auto& [kind, solvers] : kinds.items()) {
    html += "<tr><td>" + escaped(kind) + "</td>";
    for (const auto& item : solvers.items())
      html += fmt::format("<td class=\"n\">{:.3g}</td>", item.value().get<double>());
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string renderer_section(const json& r) {
  return fmt::format(
      "<h2>The scene's render</h2>\n<p>Share of the processor time that is Embree's, by tracing "
      "the {} rays of a render of {} x {} pixels again: median {:.3f}, {:.3f} to {:.3f}.</p>\n",
      r["rays"].get<std::uint64_t>(), r["width"].get<int>(), r["height"].get<int>(),
      r["efficiency"].get<double>(), r["spread"][0].get<double>(), r["spread"][1].get<double>());
}

std::string mixed_section(const json& m, const std::vector<BenchPicture>& pictures) {
  const json& rate = m["samples_per_second"];
  std::string html = fmt::format(
      "<h2>The scene / the same of meshes alone</h2>\n<p>{} hypertexture{} against {} triangles "
      "within {:.3g} of what they are meshes of. Samples per second of the render, {:.4g} against "
      "{:.4g}: above 1 the scene with hypertextures is faster.</p>\n",
      m["hypertextures"].get<std::uint64_t>(), m["hypertextures"] == 1 ? "" : "s",
      m["triangles"].get<std::uint64_t>(), m["relative_error"].get<double>(),
      rate["mixed"].get<double>(), rate["mesh"].get<double>());
  html += ratio_plot({{"render", m["ratio"].get<double>(), m["spread"][0].get<double>(),
                       m["spread"][1].get<double>()}});
  for (const BenchPicture& p : pictures)
    html += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption>"
        "</figure>\n",
        escaped(p.caption), base64(p.png));
  return html;
}

// Rows of numbers by one of them.
Line line_of(const json& rows, const char* x, const char* y, const char* name) {
  Line line{name, {}};
  for (const json& row : rows) line.points.emplace_back(row[x].get<double>(), row[y].get<double>());
  return line;
}

// Components and seconds by every method; grids against their resolution, the others as levels.
std::string engines_section(const json& rows) {
  double least = 1e300, most = 0.0;
  for (const json& row : rows)
    if (row.contains("resolution")) {
      least = std::min(least, row["resolution"].get<double>());
      most = std::max(most, row["resolution"].get<double>());
    }
  const auto lines = [&](const char* value) {
    std::vector<Line> all;
    for (const json& row : rows) {
      const auto name = row["engine"].get<std::string>();
      const double y = row[value].get<double>();
      if (!row.contains("resolution")) {
        all.push_back({name, {{least, y}, {most, y}}});
        continue;
      }
      if (all.empty() || all.back().name != name) all.push_back({name, {}});
      all.back().points.emplace_back(row["resolution"].get<double>(), y);
    }
    return all;
  };
  std::string html =
      "<h2>Components, as every method counts them</h2>\n<p>Only certified labels are proved. "
      "Voxels and a polygonal mesh of them join what is apart by less than a cell, and lose what "
      "is smaller; the Morse engine finds critical points by proof and follows separatrices by "
      "numbers.</p>\n";
  html += line_plot(lines("components"), "cells along each side", "components");
  html += line_plot(lines("seconds"), "cells along each side", "seconds");
  html +=
      "<table><tr><th>method</th><th>cells a side</th><th>components</th><th>certified</th>"
      "<th>seconds</th></tr>\n";
  for (const json& row : rows)
    html += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td "
        "class=\"n\">{:.3g}</td></tr>\n",
        escaped(row["engine"].get<std::string>()),
        row.contains("resolution") ? std::to_string(row["resolution"].get<int>()) : "",
        row["components"].get<std::uint64_t>(), row["certified"].get<bool>() ? "yes" : "no",
        row["seconds"].get<double>());
  return html + "</table>\n";
}

}  // namespace

std::string bench_page(const json& result, const std::vector<BenchPicture>& pictures) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Morsel "
      "benchmark</title>\n<style>" +
      std::string(kStyle) + "</style></head><body>\n";
  html += fmt::format("<h1>Morsel benchmark</h1>\n<p>{}, {} threads</p>\n",
                      escaped(result["scene"].get<std::string>()), result["threads"].get<int>());
  if (result.contains("vs_mesh")) html += vs_mesh_section(result);
  if (result.contains("renderer")) html += renderer_section(result["renderer"]);
  if (result.contains("mixed")) html += mixed_section(result["mixed"], pictures);
  if (result.contains("scaling"))
    html += "<h2>Threads</h2>\n<p>Samples per second of the render, against one thread.</p>\n" +
            line_plot({line_of(result["scaling"], "threads", "speedup", "measured"),
                       line_of(result["scaling"], "threads", "threads", "ideal")},
                      "threads", "speed-up");
  if (result.contains("layers")) {
    html += "<h2>Layers of noise</h2>\n<p>Certified labels, and camera rays of the render.</p>\n";
    html += line_plot({line_of(result["layers"], "layers", "label_seconds", "labels")}, "layers",
                      "seconds");
    html += line_plot({line_of(result["layers"], "layers", "evaluations_per_ray", "camera rays")},
                      "layers", "evaluations of the field, a ray");
  }
  if (result.contains("engines")) html += engines_section(result["engines"]);
  std::string rows;
  add_rows(result, "", rows);
  return html + "<details><summary>All numbers</summary>\n<table>\n" + rows +
         "</table></details>\n</body></html>\n";
}

}  // namespace morsel::tools
