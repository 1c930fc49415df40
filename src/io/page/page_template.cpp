#include "page_template.h"

// GCC and Clang know no other way in C++20 to take a file in as it is.
#ifdef __APPLE__
#define TETROPOLIS_SECTION ".const_data\n"
#define TETROPOLIS_PREVIOUS ".text\n"
#define TETROPOLIS_SYMBOL(name) "_" #name
#else
#define TETROPOLIS_SECTION ".pushsection .rodata\n"
#define TETROPOLIS_PREVIOUS ".popsection\n"
#define TETROPOLIS_SYMBOL(name) #name
#endif
#define TETROPOLIS_GLOBAL(name) ".globl " TETROPOLIS_SYMBOL(name) "\n" TETROPOLIS_SYMBOL(name) ":\n"

asm(TETROPOLIS_SECTION                            //
        TETROPOLIS_GLOBAL(tetropolis_page_begin)  //
    ".incbin \"" TETROPOLIS_PAGE "\"\n"           //
    TETROPOLIS_GLOBAL(tetropolis_page_end)        //
    ".byte 0\n"                                   //
    TETROPOLIS_PREVIOUS);

extern "C" const char tetropolis_page_begin[], tetropolis_page_end[];

namespace tetropolis {

std::string_view page_template() {
  return {tetropolis_page_begin,
          static_cast<std::size_t>(tetropolis_page_end - tetropolis_page_begin)};
}

}  // namespace tetropolis
