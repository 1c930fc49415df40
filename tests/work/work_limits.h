// The stored counts of work, tests/work/limits.txt.
#pragma once

#include <string>

namespace tetropolis::testing {

/// Fails the test if `value` is more than the stored one and its tolerance, or nothing is stored
/// under `name`; says so when it is far less, since then the stored one should be lowered. With
/// TETROPOLIS_UPDATE_WORK set, stores the value instead: the file is written when the program ends.
void expect_work(const std::string& name, double value);

}  // namespace tetropolis::testing
