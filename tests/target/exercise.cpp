// Prints one line per module of the core: name and hash of its results. The same text on every
// target, or the first line that differs names the module that is not the same to the bit.

#include "exercise.hpp"

#include "text.hpp"

namespace {
cairn_test::Exercise exercise;
}

int main() {
  const cairn_test::Exercise::Stage* stages = cairn_test::Exercise::stages();
  for (int i = 0; i < cairn_test::Exercise::kStages; ++i) {
    cairn_test::write(stages[i].name);
    cairn_test::write(" ");
    cairn_test::write_hex64((exercise.*stages[i].run)());
    cairn_test::write("\n");
  }
  return 0;
}
