// For the headers that are compiled ahead of it: unit_tests.cmake.
