// SPDX-License-Identifier: BSD-3-Clause
#include "base/h5.h"

#include "base/error.h"
#include "base/parallel.h"

#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <numeric>

namespace adit {
namespace {

// Debian's serial HDF5 is not safe to call from two threads at once.
std::recursive_mutex& library() {
  static std::recursive_mutex mutex;
  // Where a disk is full a file cannot be closed, over which the library falls when it shuts down at exit (1.10). We
  // close what we open.
  static const herr_t asked = H5dont_atexit();
  static_cast<void>(asked);
  return mutex;
}
using Turn = std::lock_guard<std::recursive_mutex>;

// An open HDF5 object, closed at the end of its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() { shut(); }
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  bool valid() const { return id_ >= 0; }
  operator hid_t() const { return id_; }
  bool shut() {
    const bool good = id_ < 0 || close_(id_) >= 0;
    id_ = -1;
    return good;
  }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class T>
struct Stored;  // memory and file type of T
template <>
struct Stored<double> {
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
  static hid_t disk() { return H5T_IEEE_F64LE; }
};
template <>
struct Stored<float> {
  static hid_t memory() { return H5T_NATIVE_FLOAT; }
  static hid_t disk() { return H5T_IEEE_F32LE; }
};
template <>
struct Stored<std::int32_t> {
  static hid_t memory() { return H5T_NATIVE_INT32; }
  static hid_t disk() { return H5T_STD_I32LE; }
};
template <>
struct Stored<std::int64_t> {
  static hid_t memory() { return H5T_NATIVE_INT64; }
  static hid_t disk() { return H5T_STD_I64LE; }
};
template <>
struct Stored<std::uint8_t> {
  static hid_t memory() { return H5T_NATIVE_UINT8; }
  static hid_t disk() { return H5T_STD_U8LE; }
};

std::uint64_t count(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::uint64_t{1}, std::multiplies<>());
}

std::string shape_name(const Shape& shape) {
  std::string text;
  for (std::uint64_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return "(" + text + ")";
}

// Whole rows of about 256 KiB.
std::uint64_t chunk_rows(const Shape& shape, size_t bytes) {
  constexpr std::uint64_t chunk_bytes = 256 << 10;
  const std::uint64_t row = bytes * count(shape) / shape[0];
  return std::clamp<std::uint64_t>(chunk_bytes / row, 1, shape[0]);
}

// An empty array has no chunks.
Handle storage(const Shape& shape, size_t bytes, Packing packing, bool& good) {
  Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  good = how.valid() && H5Pset_obj_track_times(how, false) >= 0;
  if (count(shape) == 0) return how;
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  chunk[0] = chunk_rows(shape, bytes);
  const std::uint8_t zero = 0;
  good = good && H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data()) >= 0 &&
         H5Pset_fill_value(how, H5T_NATIVE_UINT8, &zero) >= 0 && H5Pset_fill_time(how, H5D_FILL_TIME_ALLOC) >= 0;
  if (packing == Packing::small) good = good && H5Pset_shuffle(how) >= 0 && H5Pset_deflate(how, 1) >= 0;
  good = good && H5Pset_fletcher32(how) >= 0;
  return how;
}

// HDF5's filters, applied by us: the library would take one chunk after the other on one thread.

// Bytes of like weight side by side.
std::vector<std::uint8_t> shuffled(std::span<const std::uint8_t> bytes, size_t width) {
  const size_t n = bytes.size() / width;
  std::vector<std::uint8_t> out(bytes.size());
  for (size_t k = 0; k < width; ++k)
    for (size_t i = 0; i < n; ++i) out[k * n + i] = bytes[i * width + k];
  return out;
}

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> out(size);
  ADIT_CHECK(compress2(out.data(), &size, bytes.data(), bytes.size(), 1) == Z_OK);
  out.resize(size);
  return out;
}

// Fletcher's sum of 16-bit words, each of them high byte first; an odd last byte is a high one.
std::uint32_t fletcher32(std::span<const std::uint8_t> bytes) {
  std::uint32_t a = 0, b = 0;
  const auto fold = [](std::uint32_t s) { return (s & 0xFFFF) + (s >> 16); };
  size_t i = 0;
  while (i + 1 < bytes.size()) {
    // So many words that the sums do not overflow.
    for (size_t n = std::min<size_t>(360, (bytes.size() - i) / 2); n > 0; --n, i += 2)
      b += a += (std::uint32_t{bytes[i]} << 8) | bytes[i + 1];
    a = fold(a), b = fold(b);
  }
  if (i < bytes.size()) {
    b += a += std::uint32_t{bytes[i]} << 8;
    a = fold(a), b = fold(b);
  }
  return (fold(b) << 16) | fold(a);
}

// A chunk as it lies in the file.
std::vector<std::uint8_t> filtered(std::span<const std::uint8_t> bytes, size_t width, Packing packing) {
  std::vector<std::uint8_t> out = packing == Packing::quick ? std::vector<std::uint8_t>(bytes.begin(), bytes.end())
                                  : width > 1               ? deflated(shuffled(bytes, width))
                                                            : deflated(bytes);
  const std::uint32_t sum = fletcher32(out);
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(sum >> (8 * k)));
  return out;
}

}  // namespace

struct H5Writer::Impl {
  std::string called;
  Packing packing;
  Handle file{-1, H5Fclose};

  void demand(bool good, const std::string& what) const {
    if (!good) throw Error(called + ": cannot write " + what + " (no space or no permission?)", Fault::file);
  }

  void attribute(const std::string& path, const std::string& key, hid_t disk, hid_t memory, const void* value) {
    const Turn turn(library());
    const Handle at(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(at, key.c_str(), disk, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    demand(H5Awrite(attribute, memory, value) >= 0, path + " @" + key);
  }

  // Chunks `first` on, whose bytes lie one behind the other.
  void chunks(hid_t set, const std::string& path, std::span<const std::uint8_t> bytes, const Shape& shape, size_t width,
              std::uint64_t first) {
    const size_t chunk = chunk_rows(shape, width) * (count(shape) / shape[0]) * width, n = bytes.size() / chunk;
    std::vector<std::vector<std::uint8_t>> packed(n);
    parallel_for(n, [&](size_t i) { packed[i] = filtered(bytes.subspan(i * chunk, chunk), width, packing); });
    std::vector<hsize_t> at(shape.size(), 0);
    for (size_t i = 0; i < n; ++i) {
      at[0] = (first + i) * chunk_rows(shape, width);
      demand(H5Dwrite_chunk(set, H5P_DEFAULT, 0, at.data(), packed[i].size(), packed[i].data()) >= 0, path);
    }
  }
};

H5Writer::H5Writer(const std::string& file, const std::string& called, Packing packing)
    : impl_(std::make_unique<Impl>()) {
  const Turn turn(library());
  impl_->called = called;
  impl_->packing = packing;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  // The format of 1.8: checksums over the file's own bookkeeping, and every reader since knows it.
  const bool good =
      H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0 && H5Pset_obj_track_times(creation, false) >= 0;
  impl_->file = Handle(good ? H5Fcreate(file.c_str(), H5F_ACC_TRUNC, creation, access) : -1, H5Fclose);
  impl_->demand(impl_->file.valid(), "this file");
}

H5Writer::~H5Writer() {
  const Turn turn(library());
  impl_->file.shut();
}

void H5Writer::group(const std::string& path) {
  const Turn turn(library());
  const Handle how(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(how, false);
  const Handle made(H5Gcreate2(impl_->file, path.c_str(), H5P_DEFAULT, how, H5P_DEFAULT), H5Gclose);
  impl_->demand(made.valid(), path);
}

void H5Writer::number(const std::string& path, const std::string& key, double value) {
  impl_->attribute(path, key, Stored<double>::disk(), Stored<double>::memory(), &value);
}

void H5Writer::integer(const std::string& path, const std::string& key, std::int64_t value) {
  impl_->attribute(path, key, Stored<std::int64_t>::disk(), Stored<std::int64_t>::memory(), &value);
}

void H5Writer::text(const std::string& path, const std::string& key, const std::string& value) {
  const Turn turn(library());
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, value.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  impl_->attribute(path, key, type, type, value.c_str());
}

template <class T>
void H5Writer::array(const std::string& path, const Shape& shape, const std::function<std::vector<T>()>& next) {
  ADIT_CHECK(!shape.empty());
  const Turn turn(library());
  bool good = true;
  const Handle how = storage(shape, sizeof(T), impl_->packing, good);
  const std::vector<hsize_t> size(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
  const Handle set(H5Dcreate2(impl_->file, path.c_str(), Stored<T>::disk(), space, H5P_DEFAULT, how, H5P_DEFAULT),
                   H5Dclose);
  impl_->demand(good && set.valid(), path);
  const std::uint64_t whole = count(shape) * sizeof(T);
  if (whole == 0) return;
  const size_t chunk = chunk_rows(shape, sizeof(T)) * (count(shape) / shape[0]) * sizeof(T);
  constexpr size_t at_once = 16;  // chunks
  std::vector<std::uint8_t> waiting;
  std::uint64_t taken = 0, done = 0;  // bytes and chunks
  while (taken < whole) {
    const std::vector<T> piece = next();
    taken += piece.size() * sizeof(T);
    if (piece.empty() || taken > whole)
      throw Error(impl_->called + ": " + path + ": its pieces do not add up to " + shape_name(shape));
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(piece.data());
    waiting.insert(waiting.end(), bytes, bytes + piece.size() * sizeof(T));
    // The last chunk has its full size in the file, the rest of it zero.
    if (taken == whole) waiting.resize((waiting.size() + chunk - 1) / chunk * chunk, 0);
    if (taken < whole && waiting.size() < at_once * chunk) continue;
    const size_t full = waiting.size() / chunk * chunk;
    impl_->chunks(set, path, {waiting.data(), full}, shape, sizeof(T), done);
    waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(full));
    done += full / chunk;
  }
}

template <class T>
void H5Writer::array(const std::string& path, std::span<const T> values, const Shape& shape) {
  ADIT_CHECK(!shape.empty() && count(shape) == values.size());
  constexpr size_t at_once = 4 << 20;  // bytes
  size_t at = 0;
  array<T>(path, shape, [&] {
    const size_t from = at;
    at = std::min(values.size(), at + at_once / sizeof(T));
    return std::vector<T>(values.begin() + static_cast<std::ptrdiff_t>(from),
                          values.begin() + static_cast<std::ptrdiff_t>(at));
  });
}

void H5Writer::close() {
  const Turn turn(library());
  impl_->demand(H5Fflush(impl_->file, H5F_SCOPE_GLOBAL) >= 0, "this file");
  impl_->demand(impl_->file.shut(), "this file");
}

template void H5Writer::array<double>(const std::string&, std::span<const double>, const Shape&);
template void H5Writer::array<float>(const std::string&, std::span<const float>, const Shape&);
template void H5Writer::array<std::int32_t>(const std::string&, std::span<const std::int32_t>, const Shape&);
template void H5Writer::array<std::uint8_t>(const std::string&, std::span<const std::uint8_t>, const Shape&);
template void H5Writer::array<double>(const std::string&, const Shape&, const std::function<std::vector<double>()>&);
template void H5Writer::array<float>(const std::string&, const Shape&, const std::function<std::vector<float>()>&);
template void H5Writer::array<std::int32_t>(const std::string&, const Shape&,
                                            const std::function<std::vector<std::int32_t>()>&);
template void H5Writer::array<std::uint8_t>(const std::string&, const Shape&,
                                            const std::function<std::vector<std::uint8_t>()>&);

struct H5Reader::Impl {
  std::string name;
  Handle file{-1, H5Fclose};

  [[noreturn]] void fail(const std::string& what) const { throw Error(name + ": " + what); }

  Handle dataset(const std::string& path) const {
    Handle set(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.valid()) fail("has no array " + path + ", or it is damaged");
    return set;
  }

  Handle attribute(const std::string& path, const std::string& key) const {
    Handle found(H5Aopen_by_name(file, path.c_str(), key.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!found.valid()) fail("has no attribute '" + key + "' at " + path);
    const Handle space(H5Aget_space(found), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 1) fail("attribute '" + key + "' at " + path + " must be one value");
    return found;
  }

  template <class T>
  T value(const std::string& path, const std::string& key) const {
    const Turn turn(library());
    const Handle found = attribute(path, key);
    T value{};
    if (H5Aread(found, Stored<T>::memory(), &value) < 0)
      fail("attribute '" + key + "' at " + path + " must be a number");
    return value;
  }
};

H5Reader::H5Reader(const std::string& file) : impl_(std::make_unique<Impl>()) {
  const Turn turn(library());
  impl_->name = file;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::error_code failed;
  if (!std::filesystem::exists(file, failed)) impl_->fail("no such file");
  if (std::filesystem::is_directory(file, failed)) impl_->fail("is a folder, an HDF5 file is needed");
  const htri_t ours = H5Fis_hdf5(file.c_str());
  if (ours < 0) throw Error(file + ": cannot be read (no permission?)", Fault::file);
  if (ours == 0) impl_->fail("is not an HDF5 file");
  impl_->file = Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!impl_->file.valid()) impl_->fail("is damaged or cut short");
}

H5Reader::~H5Reader() {
  const Turn turn(library());
  impl_->file.shut();
}

const std::string& H5Reader::file() const {
  return impl_->name;
}

bool H5Reader::has_attribute(const std::string& path, const std::string& key) const {
  const Turn turn(library());
  return H5Aexists_by_name(impl_->file, path.c_str(), key.c_str(), H5P_DEFAULT) > 0;
}

double H5Reader::number(const std::string& path, const std::string& key) const {
  return impl_->value<double>(path, key);
}

std::int64_t H5Reader::integer(const std::string& path, const std::string& key) const {
  return impl_->value<std::int64_t>(path, key);
}

std::string H5Reader::text(const std::string& path, const std::string& key) const {
  const Turn turn(library());
  const Handle found = impl_->attribute(path, key);
  const Handle type(H5Aget_type(found), H5Tclose);
  const bool plain = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
  std::string value(plain ? H5Tget_size(type) : 0, '\0');
  if (!plain || H5Aread(found, type, value.data()) < 0)
    impl_->fail("attribute '" + key + "' at " + path + " must be a text of fixed length");
  return value.substr(0, value.find('\0'));
}

std::vector<std::string> H5Reader::names(const std::string& path) const {
  const Turn turn(library());
  const Handle group(H5Gopen2(impl_->file, path.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group.valid()) impl_->fail("has no group " + path);
  std::vector<std::string> names;
  const auto note = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, note, &names) < 0) impl_->fail(path + " is damaged");
  std::sort(names.begin(), names.end());
  return names;
}

Shape H5Reader::shape(const std::string& path) const {
  const Turn turn(library());
  const Handle set = impl_->dataset(path);
  const Handle space(H5Dget_space(set), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) impl_->fail(path + " is damaged");
  std::vector<hsize_t> size(static_cast<size_t>(rank));
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  return {size.begin(), size.end()};
}

template <class T>
std::vector<T> H5Reader::array(const std::string& path, const Shape& shape) const {
  const Turn turn(library());
  const Shape found = this->shape(path);
  if (found != shape) impl_->fail(path + " has shape " + shape_name(found) + ", " + shape_name(shape) + " is needed");
  const Handle set = impl_->dataset(path);
  std::vector<T> values(count(shape));
  if (!values.empty() && H5Dread(set, Stored<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    impl_->fail(path + " is damaged or not of numbers");
  return values;
}

template std::vector<double> H5Reader::array<double>(const std::string&, const Shape&) const;
template std::vector<float> H5Reader::array<float>(const std::string&, const Shape&) const;
template std::vector<std::int32_t> H5Reader::array<std::int32_t>(const std::string&, const Shape&) const;
template std::vector<std::uint8_t> H5Reader::array<std::uint8_t>(const std::string&, const Shape&) const;

}  // namespace adit
