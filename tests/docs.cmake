# Fails when the C++ of docs/integrating.md is not, to the letter, what tests/docs/vma_allocator.cpp compiles.
file(READ docs/integrating.md page)
file(READ tests/docs/vma_allocator.cpp source)
string(REGEX REPLACE ".*// \\[docs\\]\n(.*)// \\[/docs\\].*" "\\1" code "${source}")
string(FIND "${page}" "```cpp\n${code}```" at)
if(at EQUAL -1)
    message(FATAL_ERROR "docs/integrating.md does not hold the allocator of tests/docs/vma_allocator.cpp")
endif()
