#include "data_folders.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>

#include <dlfcn.h>
#include <link.h>

#include "gdal_support.h"

namespace tetropolis::gdal {

namespace fs = std::filesystem;

namespace {

/// The shared library or program that holds this code; empty if the system does not tell.
fs::path own_file() {
  Dl_info info{};
  void* map = nullptr;
  if (dladdr1(reinterpret_cast<void*>(&use_own_data), &info, &map, RTLD_DL_LINKMAP) == 0) return {};
  const char* name = static_cast<const link_map*>(map)->l_name;
  std::error_code error;  // The program itself has no name there.
  return fs::canonical(*name != '\0' ? name : "/proc/self/exe", error);
}

}  // namespace

void use_own_data() {
  const fs::path share = own_file().parent_path().parent_path() / "share" / "tetropolis";
  std::error_code error;
  if (fs::is_directory(share / "gdal", error))
    CPLSetConfigOption("GDAL_DATA", (share / "gdal").c_str());
  if (!fs::is_regular_file(share / "proj" / "proj.db", error)) return;
  StringList folders;
  folders.add((share / "proj").c_str());
  // PROJ looks nowhere else once it has a list.
  for (const char* name : {"PROJ_DATA", "PROJ_LIB"}) {
    const char* value = std::getenv(name);
    std::istringstream list(value != nullptr ? value : "");
    for (std::string folder; std::getline(list, folder, ':');) folders.add(folder.c_str());
  }
  OSRSetPROJSearchPaths(folders.list());
}

}  // namespace tetropolis::gdal
