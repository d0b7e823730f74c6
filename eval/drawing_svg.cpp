// SPDX-License-Identifier: BSD-3-Clause
#include "eval/drawing.h"

#include <cmath>
#include <cstdio>

namespace adit {

namespace {

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", v + 0.0);
  std::string s = text;
  if (s.ends_with(".0")) s.resize(s.size() - 2);
  return s == "-0" ? "0" : s;
}

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + value + "\"";
}
std::string attribute(const std::string& name, double value) {
  return attribute(name, number(value));
}

std::string paint(const std::string& name, Colour colour) {
  std::string text = attribute(name, hex_of(colour));
  if (colour.a < 255) {
    char alpha[16];
    std::snprintf(alpha, sizeof alpha, "%.2f", colour.a / 255.0);
    text += attribute(name + "-opacity", alpha);
  }
  return text;
}

std::string path_of(const std::vector<Vec2>& line, bool closed) {
  std::string d;
  for (size_t k = 0; k < line.size(); ++k) d += (k == 0 ? "M" : "L") + number(line[k].x()) + " " + number(line[k].y());
  return closed ? d + "Z" : d;
}

std::string svg_of(const Area& area) {
  std::string d;
  for (const auto& ring : area.rings) d += path_of(ring, true);
  return "<path" + attribute("d", d) + paint("fill", area.colour) + " fill-rule=\"evenodd\"/>\n";
}

std::string svg_of(const Line& line) {
  std::string text = "<path" + attribute("d", path_of(line.p, false)) + " fill=\"none\"" +
                     paint("stroke", line.colour) + attribute("stroke-width", line.width_px) +
                     " stroke-linejoin=\"round\" stroke-linecap=\"round\"";
  if (line.dash_px > 0) text += attribute("stroke-dasharray", number(line.dash_px) + " " + number(line.dash_px));
  return text + "/>\n";
}

std::string svg_of(const Disc& disc) {
  std::string text = "<circle" + attribute("cx", disc.centre.x()) + attribute("cy", disc.centre.y()) +
                     attribute("r", disc.radius_px) + paint("fill", disc.fill);
  if (disc.rim_px > 0) text += paint("stroke", disc.rim) + attribute("stroke-width", disc.rim_px);
  text += disc.title.empty() ? "/>" : "><title>" + escaped(disc.title) + "</title></circle>";
  if (!disc.link.empty())
    text = "<a" + attribute("href", escaped(disc.link)) + attribute("aria-label", escaped(disc.title)) + ">" + text +
           "</a>";
  return text + "\n";
}

std::string svg_of(const Words& words) {
  const Type& type = words.type;
  static const char* anchors[] = {"start", "middle", "end"};
  std::string text = "<text" + attribute("x", words.at.x()) + attribute("y", words.at.y()) +
                     attribute("font-size", type.size_px) +
                     attribute("text-anchor", anchors[static_cast<int>(type.anchor)]) + paint("fill", type.colour);
  if (type.bold) text += " font-weight=\"700\"";
  if (type.halo_px > 0)
    text += " paint-order=\"stroke\" stroke=\"#fff\" stroke-opacity=\".9\" stroke-linejoin=\"round\"" +
            attribute("stroke-width", 2 * type.halo_px);
  return text + " pointer-events=\"none\">" + escaped(words.text) + "</text>\n";
}

std::string svg_of(const Layer& layer) {
  return "<image" + attribute("x", layer.low.x()) + attribute("y", layer.low.y()) +
         attribute("width", layer.high.x() - layer.low.x()) + attribute("height", layer.high.y() - layer.low.y()) +
         " preserveAspectRatio=\"none\" href=\"data:image/png;base64," + base64(encode_png(layer.picture)) + "\"/>\n";
}

}  // namespace

std::string to_svg(const Drawing& drawing, const std::string& alt) {
  std::string svg = "<svg viewBox=\"0 0 " + number(drawing.width_px) + " " + number(drawing.height_px) +
                    "\" role=\"img\" aria-label=\"" + escaped(alt) + "\"><title>" + escaped(alt) +
                    "</title>\n<rect width=\"100%\" height=\"100%\"" + paint("fill", drawing.background) + "/>\n";
  for (const auto& item : drawing.items) svg += std::visit([](const auto& one) { return svg_of(one); }, item);
  return svg + "</svg>";
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace adit
