// Thin ownership around the GDAL C API: registration, quiet errors, handles. Private to src/io.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "io/deferred/gdal_functions.h"

namespace tetropolis::gdal {

/// Registers GDAL's drivers once per process. Call before any other GDAL function. Throws
/// Error(kUsage) if PROJ cannot use its database.
void initialise();

/// Text that GDAL hands over, in UTF-8: what is not is taken for Latin-1.
std::string utf8(const char* text);

/// What a failure of GDAL's readers is about, as far as its text tells.
enum class About {
  kGeometry,  ///< That of one feature, in JSON or GML: a coordinate that is text, an odd number of
              ///< them, a member that is missing.
  kSystem,    ///< A reference system that PROJ does not know.
  kAnything,  ///< Else, such as a file that is cut.
};

/// While it lives, GDAL's messages on this thread are collected here and printed nowhere.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

  /// Failures so far, and the first and last of them on one line ("" if none).
  std::int64_t failures() const { return failures_; }
  const std::string& first() const { return first_; }
  const std::string& last() const { return last_; }
  /// ": " and the last failure, or nothing: to end an error message with.
  std::string reason() const;
  /// The same of some of them.
  std::int64_t failures(About about) const { return of(about).count; }
  const std::string& first(About about) const { return of(about).first; }
  void reset();

  /// What GDAL says of features that it passes over, because their geometry cannot be read.
  const std::vector<std::string>& passed_over() const { return passed_over_; }

 private:
  struct Some {
    std::int64_t count = 0;
    std::string first;
  };
  const Some& of(About about) const { return by_about_[static_cast<std::size_t>(about)]; }

  static void CPL_STDCALL collect(CPLErr kind, CPLErrorNum number, const char* message) noexcept;

  std::int64_t failures_ = 0;
  std::string first_;
  std::string last_;
  std::array<Some, 3> by_about_;
  std::vector<std::string> passed_over_;
};

struct SrsDeleter {
  void operator()(OGRSpatialReferenceH srs) const { OSRDestroySpatialReference(srs); }
};
using Srs = std::unique_ptr<std::remove_pointer_t<OGRSpatialReferenceH>, SrsDeleter>;

struct TransformDeleter {
  void operator()(OGRCoordinateTransformationH t) const { OCTDestroyCoordinateTransformation(t); }
};
using Transform =
    std::unique_ptr<std::remove_pointer_t<OGRCoordinateTransformationH>, TransformDeleter>;

struct DatasetDeleter {
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<std::remove_pointer_t<GDALDatasetH>, DatasetDeleter>;

struct FeatureDeleter {
  void operator()(OGRFeatureH feature) const { OGR_F_Destroy(feature); }
};
using Feature = std::unique_ptr<std::remove_pointer_t<OGRFeatureH>, FeatureDeleter>;

struct GeometryDeleter {
  void operator()(OGRGeometryH geometry) const { OGR_G_DestroyGeometry(geometry); }
};
using Geometry = std::unique_ptr<std::remove_pointer_t<OGRGeometryH>, GeometryDeleter>;

/// An option of GDAL's configuration on this thread while it lives, whatever was set before.
class ConfigOption {
 public:
  /// The key is kept, not copied.
  ConfigOption(const char* key, const char* value);
  ~ConfigOption();
  ConfigOption(const ConfigOption&) = delete;
  ConfigOption& operator=(const ConfigOption&) = delete;

 private:
  const char* key_;
  std::optional<std::string> before_;
};

/// Words, or keys and values, as GDAL wants them.
class StringList {
 public:
  StringList() = default;
  ~StringList() { CSLDestroy(list_); }
  StringList(const StringList&) = delete;
  StringList& operator=(const StringList&) = delete;

  StringList& add(const char* word) {
    list_ = CSLAddString(list_, word);
    return *this;
  }
  StringList& set(const char* key, const char* value) {
    list_ = CSLSetNameValue(list_, key, value);
    return *this;
  }
  /// Null where there are none.
  char** list() const { return list_; }

 private:
  char** list_ = nullptr;
};

/// A folder of GDAL's in memory while it lives.
class MemoryFolder {
 public:
  MemoryFolder();
  ~MemoryFolder();
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  /// The name for GDAL of a file in it.
  std::string path(const std::string& name) const { return path_ + "/" + name; }
  std::vector<std::string> names() const;
  /// Of a file, while nobody writes it; empty if there is none.
  std::string_view bytes(const std::string& name) const;

 private:
  std::string path_;
};

/// Parses what normalise_crs accepts, and vertical systems. Null as below.
Srs parse_whole_srs(const std::string& text);

/// Parses what normalise_crs accepts into its horizontal part, x first. Null if it is not a
/// reference system; the error handler in force then knows why.
Srs parse_srs(const std::string& text);

/// Metres per unit of height of a compound or vertical system, else 1; negative where it counts
/// downwards.
double vertical_unit_metres(OGRSpatialReferenceH srs);

/// What stands for the name of the vertical system where heights are those above the ellipsoid.
inline constexpr const char* kEllipsoidal = "ellipsoidal";

/// The name of the vertical system in a compound one, or of a vertical one; kEllipsoidal for
/// systems of three dimensions; else "".
std::string vertical_name(OGRSpatialReferenceH srs);

/// See normalise_crs. Never throws; "" for local systems in metres and the like. `expected`: what a
/// definition without a code is named if it says the same; no more has to be looked up then.
std::string canonical_name(OGRSpatialReferenceH srs, const std::string& expected = "");

}  // namespace tetropolis::gdal
