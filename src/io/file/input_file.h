// What readers ask of a file before they read it, and how they refuse it. Private to src/io.
#pragma once

#include <filesystem>
#include <string>

namespace tetropolis {

/// Throws Error(kInput, "PATH: WHAT").
[[noreturn]] void fail_input(const std::filesystem::path& path, const std::string& what);

/// Throws Error(kInput) unless the file is there and an ordinary one: a pipe that nobody writes to
/// would hold a reader up for ever.
void require_ordinary_file(const std::filesystem::path& path);

/// Throws Error(kInput) "PATH: to TASK takes about X GB, ...; REMEDY" if this process may not have
/// so many bytes: without it the system ends the program and nobody says why.
void require_memory(const std::filesystem::path& path, double bytes, const std::string& task,
                    const std::string& remedy);

}  // namespace tetropolis
