// SPDX-License-Identifier: BSD-3-Clause
#include "base/ply.h"

#include "base/error.h"
#include "base/files.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little);

struct TypeName {
  const char *name, *old_name;
  PlyType type;
  size_t bytes;
};
constexpr TypeName types[] = {
    {"char", "int8", PlyType::int8, 1},        {"uchar", "uint8", PlyType::uint8, 1},
    {"short", "int16", PlyType::int16, 2},     {"ushort", "uint16", PlyType::uint16, 2},
    {"int", "int32", PlyType::int32, 4},       {"uint", "uint32", PlyType::uint32, 4},
    {"float", "float32", PlyType::float32, 4}, {"double", "float64", PlyType::float64, 8},
};

const TypeName& info(PlyType type) {
  return *std::find_if(std::begin(types), std::end(types), [&](const TypeName& t) { return t.type == type; });
}

template <class T>
double from_bytes(const char* bytes) {
  T v;
  std::memcpy(&v, bytes, sizeof v);
  return static_cast<double>(v);
}

double decode(PlyType type, const char* bytes) {
  switch (type) {
    case PlyType::int8:
      return from_bytes<std::int8_t>(bytes);
    case PlyType::uint8:
      return from_bytes<std::uint8_t>(bytes);
    case PlyType::int16:
      return from_bytes<std::int16_t>(bytes);
    case PlyType::uint16:
      return from_bytes<std::uint16_t>(bytes);
    case PlyType::int32:
      return from_bytes<std::int32_t>(bytes);
    case PlyType::uint32:
      return from_bytes<std::uint32_t>(bytes);
    case PlyType::float32:
      return from_bytes<float>(bytes);
    case PlyType::float64:
      return from_bytes<double>(bytes);
  }
  return 0;
}

template <class T>
void to_bytes(std::string& out, double value) {
  const T v = static_cast<T>(value);
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

void encode(PlyType type, double value, std::string& out) {
  switch (type) {
    case PlyType::int8:
      return to_bytes<std::int8_t>(out, value);
    case PlyType::uint8:
      return to_bytes<std::uint8_t>(out, value);
    case PlyType::int16:
      return to_bytes<std::int16_t>(out, value);
    case PlyType::uint16:
      return to_bytes<std::uint16_t>(out, value);
    case PlyType::int32:
      return to_bytes<std::int32_t>(out, value);
    case PlyType::uint32:
      return to_bytes<std::uint32_t>(out, value);
    case PlyType::float32:
      return to_bytes<float>(out, value);
    case PlyType::float64:
      return to_bytes<double>(out, value);
  }
}

// Takes numbers from the body, one after the other, in whichever format it is written.
class Reader {
 public:
  enum Format { ascii, little, big };

  explicit Reader(const std::string& file) : file_(file) {
    std::error_code failed;
    if (std::filesystem::is_directory(file, failed)) throw Error(file + ": is a folder, a file is needed");
    in_.open(file, std::ios::binary);
    if (!in_) {
      const bool absent = !std::filesystem::exists(file, failed);
      throw Error(file + (absent ? ": no such file" : ": cannot read: " + std::string(std::strerror(errno))),
                  absent ? Fault::bad_input : Fault::file);
    }
    const auto size = std::filesystem::file_size(file, failed);
    behind_ = failed ? 0 : size;
  }

  std::string line() {
    std::string l;
    for (;;) {
      if (!has(1)) {
        if (l.empty()) fail("ends within its header");
        break;
      }
      const char c = text_[at_++];
      if (c == '\n') break;
      l += c;
    }
    if (!l.empty() && l.back() == '\r') l.pop_back();
    return l;
  }

  void expect(Format format) { format_ = format; }

  double next(PlyType type) {
    if (format_ == ascii) return next_word();
    char bytes[8];
    const size_t n = info(type).bytes;
    if (!has(n)) fail("is cut short: its header promises more than there is");
    std::memcpy(bytes, text_.data() + at_, n);
    at_ += n;
    if (format_ == big) std::reverse(bytes, bytes + n);
    return decode(type, bytes);
  }

  size_t bytes_left() const { return text_.size() - at_ + behind_; }
  [[noreturn]] void fail(const std::string& what) const { throw Error(file_ + ": this PLY file " + what); }

 private:
  // Whether n more bytes are in the block, which is filled again where they are not.
  bool has(size_t n) {
    if (at_ + n <= text_.size()) return true;
    text_.erase(0, at_);
    at_ = 0;
    const size_t held = text_.size(), more = std::min<size_t>(behind_, 1 << 20);
    text_.resize(held + more);
    in_.read(text_.data() + held, static_cast<std::streamsize>(more));
    text_.resize(held + static_cast<size_t>(in_.gcount()));
    behind_ = static_cast<size_t>(in_.gcount()) == more ? behind_ - more : 0;
    return n <= text_.size();
  }

  double next_word() {
    while (has(1) && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (!has(1)) fail("is cut short: its header promises more than there is");
    has(longest_word);  // the whole word is in the block, if there is as much
    double v = 0;
    const auto [end, failed] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
    if (failed != std::errc()) fail("has no number where one is due: '" + text_.substr(at_, 12) + "'");
    at_ = static_cast<size_t>(end - text_.data());
    return v;
  }

  static constexpr size_t longest_word = 400;
  std::string file_, text_;
  std::ifstream in_;
  size_t at_ = 0, behind_ = 0;  // in the block; bytes of the file behind it
  Format format_ = ascii;
};

PlyType type_named(const std::string& name, const Reader& in) {
  for (const TypeName& t : types)
    if (name == t.name || name == t.old_name) return t.type;
  in.fail("has a property of unknown type '" + name + "'");
}

void read_property(std::istringstream& words, PlyElement& element, std::vector<PlyType>& counts, const Reader& in) {
  PlyColumn column;
  std::string type;
  words >> type;
  PlyType count = PlyType::uint8;
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    count = type_named(count_type, in);
    column.list = true;
  }
  column.type = type_named(type, in);
  words >> column.name;
  element.columns.push_back(std::move(column));
  counts.push_back(count);
}

// The header; counts[e][c] is the type in which list c of element e counts.
Ply read_header(Reader& in, std::vector<std::vector<PlyType>>& counts) {
  if (in.bytes_left() < 4 || in.line() != "ply") in.fail("does not begin with 'ply'");
  Ply ply;
  for (;;) {
    std::istringstream words(in.line());
    std::string word;
    words >> word;
    if (word == "end_header") break;
    if (word == "format") {
      words >> word;
      if (word != "ascii" && word != "binary_little_endian" && word != "binary_big_endian")
        in.fail("has unknown format '" + word + "'");
      in.expect(word == "ascii" ? Reader::ascii : word == "binary_little_endian" ? Reader::little : Reader::big);
    } else if (word == "element") {
      PlyElement element;
      if (!(words >> element.name >> element.rows)) in.fail("has an element without name and count");
      ply.elements.push_back(std::move(element));
      counts.emplace_back();
    } else if (word == "property") {
      if (ply.elements.empty()) in.fail("has a property before any element");
      read_property(words, ply.elements.back(), counts.back(), in);
    }
  }
  return ply;
}

void read_rows(Reader& in, const PlyElement& element, const std::vector<PlyType>& counts, const PlySink& sink) {
  // Every row takes a byte at least: a header that lies cannot make us reserve the machine.
  if (element.rows > in.bytes_left() && !element.columns.empty())
    in.fail("is cut short: " + std::to_string(element.rows) + " rows of '" + element.name + "' are promised");
  sink.element(element);
  std::vector<std::vector<double>> values(element.columns.size());
  for (size_t row = 0; row < element.rows && !element.columns.empty(); ++row) {
    for (size_t k = 0; k < element.columns.size(); ++k) {
      const PlyColumn& c = element.columns[k];
      const double items = c.list ? in.next(counts[k]) : 1;
      if (items < 0) in.fail("has a list of negative length");
      values[k].clear();
      for (double i = 0; i < items; ++i) values[k].push_back(in.next(c.type));
    }
    sink.row(element, values);
  }
}

void append_row(const PlyElement& element, size_t row, std::string& out) {
  for (const PlyColumn& c : element.columns) {
    if (!c.list) {
      encode(c.type, c.value[row], out);
      continue;
    }
    const size_t begin = c.offset[row], end = c.offset[row + 1];
    encode(PlyType::uint8, static_cast<double>(end - begin), out);
    for (size_t i = begin; i < end; ++i) encode(c.type, c.value[i], out);
  }
}

}  // namespace

const PlyColumn* PlyElement::find(const std::string& column) const {
  for (const PlyColumn& c : columns)
    if (c.name == column) return &c;
  return nullptr;
}

const PlyElement* Ply::find(const std::string& element) const {
  for (const PlyElement& e : elements)
    if (e.name == element) return &e;
  return nullptr;
}

void read_ply(const std::string& file, const PlySink& sink) {
  Reader in(file);
  std::vector<std::vector<PlyType>> counts;
  const Ply header = read_header(in, counts);
  for (size_t e = 0; e < header.elements.size(); ++e) read_rows(in, header.elements[e], counts[e], sink);
}

Ply read_ply(const std::string& file) {
  Ply ply;
  PlySink sink;
  sink.element = [&](const PlyElement& element) {
    ply.elements.push_back(element);
    for (PlyColumn& c : ply.elements.back().columns) {
      c.value.reserve(c.list ? 3 * element.rows : element.rows);
      if (c.list) c.offset.assign(1, 0);
    }
  };
  sink.row = [&](const PlyElement&, const std::vector<std::vector<double>>& row) {
    std::vector<PlyColumn>& columns = ply.elements.back().columns;
    for (size_t k = 0; k < columns.size(); ++k) {
      columns[k].value.insert(columns[k].value.end(), row[k].begin(), row[k].end());
      if (columns[k].list) columns[k].offset.push_back(static_cast<std::uint32_t>(columns[k].value.size()));
    }
  };
  read_ply(file, sink);
  return ply;
}

void write_ply(const std::string& file, const Ply& ply) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment adit\n";
  for (const PlyElement& e : ply.elements) {
    header += "element " + e.name + " " + std::to_string(e.rows) + "\n";
    for (const PlyColumn& c : e.columns) {
      ADIT_CHECK(c.list ? c.offset.size() == e.rows + 1 : c.value.size() == e.rows);
      header += "property " + std::string(c.list ? "list uchar " : "") + info(c.type).name + " " + c.name + "\n";
    }
  }
  header += "end_header\n";
  write_whole(file, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out << header;
    std::string block;
    for (const PlyElement& e : ply.elements) {
      for (size_t row = 0; row < e.rows; ++row) {
        append_row(e, row, block);
        if (block.size() < (1u << 20) && row + 1 < e.rows) continue;
        out.write(block.data(), static_cast<std::streamsize>(block.size()));
        block.clear();
      }
    }
    out.close();
    if (!out) throw Error(file + ": cannot write: " + std::strerror(errno), Fault::file);
  });
}

}  // namespace adit
